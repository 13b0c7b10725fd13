//! Limits of an identification, found as warnings.

use fmm_fit::Fit;
use fmm_model::Restoring;

use crate::experiment::{Experiment, RecordSummary};
use crate::fit::{FittedMotion, Identification};
use crate::machine::Scale;
use crate::machine::terms::{LINEAR, QUADRATIC};
use crate::report::Warning;

/// Fewer half swings than this are few.
const ENOUGH_HALF_SWINGS: usize = 4;
/// A decision between stop and reversal closer than this is narrow.
const NARROW: f64 = 5e-3;

impl Warning {
    /// Everything that limits `identification` of `decays`.
    pub(crate) fn of(identification: &Identification, decays: &[Experiment]) -> Vec<Self> {
        let mut warnings = Vec::new();
        let machine = identification.machine();
        match (machine.scale(), machine.normal_load()) {
            (Scale::PerUnitMass, load) => warnings.push(Self::ScaleUnknown { load_known: load.is_some() }),
            (Scale::Mass(_) | Scale::Stiffness(_), None) => warnings.push(Self::NormalLoadUnknown),
            _ => {}
        }
        for decay in decays {
            let is_bent = machine.restoring() != Restoring::Linear || identification.terms().has_spring();
            Self::of_record(decay.summary(), is_bent, &mut warnings);
        }
        Self::of_fit(identification.fit(), &mut warnings);
        Self::of_damping(identification, &mut warnings);
        Self::of_residuals(identification, decays, &mut warnings);
        warnings.extend(Self::of_noise(identification, decays));
        let unit = decays.first().map_or("", |decay| decay.record().unit());
        let is_scaled = matches!(machine.scale(), Scale::Mass(_) | Scale::Stiffness(_));
        if is_scaled && !matches!(unit, "m" | "m/s" | "m/s²") {
            warnings.push(Self::NotSi { unit: unit.to_owned() });
        }
        warnings.extend(Self::of_narrow_stop(identification.motions()));
        warnings
    }

    /// That a turning point of `motions` was decided narrowly.
    pub(crate) fn of_narrow_stop(motions: &[FittedMotion]) -> Option<Self> {
        let narrowest = FittedMotion::narrowest_decision(motions).filter(|(margin, _)| margin.abs() < NARROW);
        narrowest.map(|(margin, time)| Self::NarrowStop { margin, time })
    }

    /// What limits what a record tells of a machine, whose spring `is_bent` or a straight line.
    pub(crate) fn of_record(summary: &RecordSummary, is_bent: bool, warnings: &mut Vec<Self>) {
        let (first, last) = summary.amplitudes;
        // Two turning points give one amplitude.
        if last >= first && summary.half_swings > 2 && !summary.is_driven {
            warnings.push(Self::NoDecay);
        }
        if summary.half_swings < ENOUGH_HALF_SWINGS && !summary.is_driven {
            warnings.push(Self::FewHalfSwings { count: summary.half_swings });
        }
        // A pendulum that is taken for one, or a spring that is fitted, has such a period.
        let period_change = summary.period_change.filter(|_| !is_bent);
        warnings.extend(period_change.map(|change| Self::PeriodDependsOnAmplitude { change }));
        warnings.extend(summary.saturation.map(|saturation| Self::Saturated { count: saturation.samples }));
        warnings.extend(summary.offset_step.map(|step| Self::OffsetStep {
            time: step.time,
            height: step.height,
            unit: summary.unit.clone(),
        }));
        warnings.extend(Self::of_disturbances(summary));
        if summary.spikes > 0 {
            warnings.push(Self::Spikes { count: summary.spikes });
        }
    }

    /// What limits any `fit`.
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
        /// Correlation from which on two parameters are one.
        const ONE: f64 = 1.0 - 1e-9;
        let count = fit.estimates().len();
        let as_one = |i: usize, j: usize| i != j && fit.correlation(i, j).is_some_and(|r| r.abs() > ONE);
        let together = (0..count).filter(|i| (0..count).any(|j| as_one(*i, j)));
        let names: Vec<&str> = together.map(|i| fit.estimates()[i].name()).collect();
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
        let structure = identification.structure();
        if structure.is_structured() {
            warnings.push(Self::StructuredResiduals {
                residual: structure.residual,
                noise: structure.noise,
                unit: decays.first().map_or_else(String::new, |decay| decay.record().unit().to_owned()),
                inflation: identification.inflation(),
            });
        }
    }
}
