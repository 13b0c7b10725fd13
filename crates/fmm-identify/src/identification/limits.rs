//! Limits of an identification, found as warnings.

use fmm_fit::Fit;
use fmm_model::Restoring;

use crate::experiment::Experiment;
use crate::experiment::run_down::have_both_directions;
use crate::finding::Finding;
use crate::identification::findings::inseparable;
use crate::identification::{FittedMotion, Identification};
use crate::law::naming::LINEAR;
use crate::machine::Scale;
use crate::machine::term::QUADRATIC;
use crate::problem::Problem;
use crate::warning::Warning;

/// A decision between stop and reversal closer than this is narrow.
const NARROW: f64 = 5e-3;

/// Standard uncertainties between a known value and its estimate that chance exceeds once in 370 cases (1).
const CONTRADICTED: f64 = 3.0;

impl Warning {
    /// Quantities that the records contradict, of those that were known before a `fit` to `problem`.
    pub(crate) fn of_knowledge<'a>(problem: &'a Problem<'_>, fit: &'a Fit) -> impl Iterator<Item = Self> + 'a {
        let far = problem.prior.tensions(fit.values()).filter(|(_, distance)| distance.abs() > CONTRADICTED);
        far.map(|(index, distance)| Self::KnowledgeContradicted {
            parameter: fit.estimates()[index].name().to_owned(),
            distance: distance.abs(),
        })
    }

    /// Everything that limits `identification` of `decays`.
    pub(crate) fn of(identification: &Identification, decays: &[Experiment]) -> Vec<Self> {
        let mut warnings = Vec::new();
        let machine = identification.machine();
        match (machine.scale(), machine.normal_load()) {
            (Scale::PerUnitMass, load) => warnings.push(Self::ScaleUnknown { load_known: load.is_some() }),
            (Scale::Mass(_) | Scale::Stiffness(_), None) => warnings.push(Self::NormalLoadUnknown),
            _ => {}
        }
        // About an axis there is no slope.
        let is_line = |decay: &Experiment| decay.is_run_down() && matches!(decay.record().unit(), "m" | "m/s");
        if decays.iter().any(is_line) && !have_both_directions(decays) {
            warnings.push(Self::OneDirection);
        }
        for decay in decays {
            let is_bent = machine.restoring() != Restoring::Linear || identification.fitted.model.terms.has_spring();
            Self::of_record(decay.summary(), is_bent, &mut warnings);
        }
        for (number, experiment) in (1..).zip(decays) {
            let Some(impact) = &experiment.impact else { continue };
            let friction = identification.finding("friction_force").map(Finding::value);
            let recorded = experiment.record().duration();
            Self::of_impact(number, impact, recorded, friction.filter(|friction| *friction > 0.0), &mut warnings);
        }
        Self::of_fit(identification.fit(), &mut warnings);
        Self::of_damping(identification, &mut warnings);
        Self::of_residuals(identification, decays, &mut warnings);
        warnings.extend(Self::of_noise(identification, decays));
        let unit = decays.first().map_or("", |decay| decay.record().unit());
        let is_scaled = matches!(machine.scale(), Scale::Mass(_) | Scale::Stiffness(_));
        let is_angle = matches!(unit, "rad" | "rad/s" | "rad/s²");
        let needs_line = !is_angle || machine.normal_load().is_some();
        if is_scaled && needs_line && !matches!(unit, "m" | "m/s" | "m/s²") {
            warnings.push(Self::NotSi { unit: unit.to_owned() });
        }
        warnings.extend(Self::of_narrow_stop(identification.motions()));
        let value = |name: &str| identification.finding(name).map(Finding::value);
        let mass = if let Scale::Mass(mass) = machine.scale() { Some(mass.value()) } else { None };
        let load = machine.normal_load().map(|load| load.value());
        let frequency = value("natural_frequency_hz");
        warnings.extend(Self::of_plausibility(frequency, value("mu"), load, mass));
        warnings
    }

    /// Warning of a turning point of `motions` that was decided narrowly.
    pub(crate) fn of_narrow_stop(motions: &[FittedMotion]) -> Option<Self> {
        let narrowest = FittedMotion::narrowest_decision(motions).filter(|(margin, _)| margin.abs() < NARROW);
        narrowest.map(|(margin, time)| Self::NarrowStop { margin, time })
    }

    /// Limits of any `fit`.
    pub(crate) fn of_fit(fit: &Fit, warnings: &mut Vec<Self>) {
        if !fit.outcome().is_success() {
            warnings.push(Self::NotConverged { sentence: format!("the fit {}", fit.outcome()) });
        }
        for direction in fit.null_directions() {
            let mut participants = direction.participants();
            match (participants.next(), participants.next()) {
                (Some((parameter, _)), None) => warnings.push(Self::NoInfluence { parameter: parameter.to_owned() }),
                _ => warnings.push(Self::Inseparable { sentence: direction.to_string() }),
            }
        }
        warnings.extend(Self::of_correlations(fit));
        for estimate in fit.estimates().iter().filter(|estimate| estimate.status().is_at_bound()) {
            warnings.push(Self::AtBound { parameter: estimate.name().to_owned(), value: estimate.value() });
        }
    }

    /// Parameters that a rank does not show to be inseparable, as errors of an integrated motion tell them apart.
    fn of_correlations(fit: &Fit) -> Option<Self> {
        let names: Vec<&str> = inseparable(fit).into_iter().map(|i| fit.estimates()[i].name()).collect();
        (!names.is_empty()).then(|| Self::Inseparable {
            sentence: format!(
                "{} change together without an effect on this record, with correlations of ±1: hold one of them",
                names.join(", ")
            ),
        })
    }

    /// Dampers that came out negative.
    fn of_damping(identification: &Identification, warnings: &mut Vec<Self>) {
        for estimate in identification.fit().estimates() {
            if matches!(estimate.name(), LINEAR | QUADRATIC) && estimate.value() < 0.0 {
                let (parameter, unit) = (estimate.name().to_owned(), estimate.parameter().unit().to_owned());
                let law = identification.law().to_owned();
                warnings.push(Self::NegativeDamping { law, parameter, value: estimate.value(), unit });
            }
        }
    }

    /// Residuals that are not noise.
    fn of_residuals(identification: &Identification, decays: &[Experiment], warnings: &mut Vec<Self>) {
        let structure = identification.structure;
        if structure.is_structured() {
            warnings.push(Self::StructuredResiduals {
                residual: structure.residual,
                noise: structure.noise,
                unit: decays.first().map_or_else(String::new, |decay| decay.record().unit().to_owned()),
                inflation: identification.covariance.inflation,
            });
        }
    }

    /// Properties of the noise, from the residuals of `identification`, and a slow drift that was fitted.
    pub(crate) fn of_noise(identification: &Identification, decays: &[Experiment]) -> Vec<Self> {
        let mut warnings = Vec::new();
        let unit = || decays.first().map_or_else(String::new, |decay| decay.record().unit().to_owned());
        if decays.iter().any(Experiment::drifts) {
            warnings.push(Self::Drift);
        }
        let structure = identification.structure;
        if !structure.is_noisy() {
            return warnings;
        }
        if let Some(growth) = identification.covariance.noise.growth() {
            let share = growth.instantaneous.hypot(growth.by_amplitude);
            warnings.push(Self::GrowingNoise { floor: growth.floor, share, unit: unit() });
        }
        warnings.extend(structure.coloured_noise(identification.covariance.inflation));
        warnings
    }
}
