//! Identification: the friction parameters of one law, out of records.

pub(crate) mod beside;
pub(crate) mod drift;
mod findings;
mod force;
mod limits;
mod motion;
mod profile;

use std::f64::consts::PI;

use fmm_fit::{Estimate, EvaluationError, Fit, Options};
use fmm_friction::Role;

use crate::error::IdentifyError;
use crate::experiment::clock::Clock;
use crate::experiment::nuisance::Nuisance;
use crate::experiment::scaled;
use crate::experiment::{Experiment, Experiments};
use crate::finding::Finding;
use crate::fit::stages::{Begin, Observer, fit_begun};
use crate::identification::drift::{as_fitted, with_drift};
use crate::identification::findings::findings;
use crate::identification::force::{ForceResults, MotionNoise};
use crate::law::Law;
use crate::law::naming::LINEAR;
use crate::law::naming::{Form, level_name};
use crate::machine::Machine;
use crate::problem::Problem;
use crate::problem::starts::Fitted;
use crate::problem::tangent::Tangent;
use crate::quantities::table::Table;
use crate::residuals::rules::SIGNIFICANT_FALL;
use crate::residuals::structure::{Covariance, ResidualStructure};
use crate::warning::Warning;

pub use force::Validation;
pub use motion::FittedMotion;
pub use profile::{Profile, Profiles};

/// Forms of a level, of which an identification states some, the most wanted last.
const FORMS: [Form; 4] = [Form::PerMass, Form::Force, Form::Mu, Form::Coefficient];

/// Friction parameters of one law, with their uncertainty and what limits them.
///
/// `Display` gives the report.
#[derive(Debug, Clone)]
pub struct Identification {
    law: String,
    pub(crate) fitted: Fitted,
    friction_at_rest: Option<f64>,
    machine: Machine,
    pub(crate) findings: Vec<Finding>,
    motions: Vec<FittedMotion>,
    warnings: Vec<Warning>,
    pub(crate) structure: ResidualStructure,
    pub(crate) covariance: Covariance,
    /// Distance (standard uncertainties) by which the linear damping would leave its bound, if it is there.
    pull_at_bound: Option<f64>,
    /// Disturbances of each record that were fitted beside its motion.
    disturbances: Vec<Vec<Nuisance>>,
    /// Amplitude of the records, or deviation of the forces, in the unit of the residuals.
    amplitude: f64,
    /// Results for forces along motions; `None` for vibrations.
    forces: Option<ForceResults>,
}

/// Distance (standard uncertainties) by which the linear damping would leave the bound that it lies on; `None` if it
/// lies on none.
fn pull_at_bound(problem: &Problem<'_>, fit: &Fit, covariance: &Covariance) -> Option<f64> {
    let index = fit.estimates().iter().position(|estimate| estimate.name() == LINEAR)?;
    fit.estimates()[index].status().is_at_bound().then_some(())?;
    let step = -Tangent::of(problem, fit)?.step(index, fit.residuals());
    Some(step / covariance.relaxed(index)?.sqrt())
}

/// F/m at rest that fitted `values` stand for: the sliding level of the law with what lies above it; `None` for laws
/// without.
fn friction_at_rest(table: &Table, values: &[f64]) -> Option<f64> {
    let parameters = || table.family.fitted().zip(&values[table.of_law()]);
    let (_, level) = parameters().nth(table.family.level()?)?;
    let above = parameters().filter(|(parameter, _)| matches!(parameter.role(), Role::Excess | Role::LevelAbove));
    Some(level + above.map(|(_, excess)| excess).sum::<f64>())
}

impl Identification {
    /// The identification by a fit of `problem`.
    pub(crate) fn of(
        problem: &Problem<'_>,
        begin: Begin<'_>,
        options: &Options,
        observer: &mut Observer<'_>,
    ) -> Result<Self, IdentifyError> {
        let fit = fit_begun(problem, begin, options, observer)?;
        let (table, machine, decays) = (&problem.table, &problem.machine, problem.experiments());
        let motion_noise = MotionNoise::of(problem, &fit);
        let forces = problem.forces().map(|forces| ForceResults::of(&forces, &fit, &motion_noise));
        let spread = forces.as_ref().map_or(1.0, |forces| forces.spread);
        // One instrument for all records; the worst statement counts.
        let gain = decays.iter().map(|decay| decay.summary().gain_uncertainty).fold(0.0, f64::max);
        let failure = |error: EvaluationError| IdentifyError::simulation(problem.name(), error);
        let mut structure = ResidualStructure::of(&fit, problem.records());
        structure.residual *= spread.sqrt();
        let covariance = Covariance::of(problem, &fit, &structure).map_err(failure)?.times(spread);
        let findings = findings(machine, table, &fit, &covariance, gain, &Clock::of(decays), &motion_noise);
        if let Some(finding) = findings.iter().find(|finding| !finding.is_representable()) {
            return Err(IdentifyError::beyond_numbers(finding.parameter(), finding.value()));
        }
        let mut motions = Vec::with_capacity(decays.len());
        for (record, decay) in decays.iter().enumerate() {
            let trajectory = problem.events(record, fit.values()).map_err(failure)?;
            let start = decay.record().start() - decay.sensor().delay();
            motions.push(FittedMotion::of_events(start, decay.record().interval(), &trajectory));
        }
        let contradicted: Vec<Warning> = Warning::of_knowledge(problem, &fit).collect();
        let amplitudes = scaled(decays).map(|(decay, weight)| weight * decay.summary().amplitudes.0);
        let mut identification = Self {
            law: table.terms.name(table.family.name),
            friction_at_rest: friction_at_rest(table, fit.values()).filter(|_| forces.is_none()),
            machine: *machine,
            findings,
            motions,
            warnings: Vec::new(),
            structure,
            pull_at_bound: pull_at_bound(problem, &fit, &covariance),
            covariance,
            disturbances: decays.iter().map(|decay| decay.nuisances.clone()).collect(),
            amplitude: amplitudes.fold(forces.as_ref().map_or(0.0, |forces| forces.deviation), f64::max),
            fitted: Fitted { model: problem.candidate(), fit },
            forces,
        };
        identification.warnings = match identification.force_unit() {
            Some(unit) => Warning::of_force(&identification, unit),
            None => Warning::of(&identification, decays),
        };
        identification.warnings.extend(contradicted);
        let held = table.family.held_breakaway();
        let held = held.map(|held| Warning::StaticLevelHeld { parameter: held.parameter().name().to_owned() });
        identification.warnings.extend(held);
        Ok(identification)
    }

    /// Name of the law, with the terms beside it.
    pub fn law(&self) -> &str {
        &self.law
    }

    pub(crate) fn family(&self) -> Law {
        self.fitted.model.law
    }

    /// The problem of `experiments` by this law with its terms.
    pub(crate) fn problem<'a>(&self, experiments: impl Into<Experiments<'a>>) -> Result<Problem<'a>, IdentifyError> {
        Problem::of(&self.fitted.model, self.machine, experiments)
    }

    /// F/m at rest, in the unit of the friction per mass: the sliding level with what the law adds to it at zero speed;
    /// `None` for laws without a level.
    pub fn friction_at_rest(&self) -> Option<f64> {
        self.friction_at_rest
    }

    /// True if the machine has a spring, on which it swings.
    pub(crate) fn swings(&self) -> bool {
        self.finding("natural_frequency_hz").or(self.finding("stiffness")).is_some()
    }

    /// Declared machine.
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// The fit behind the findings: covariance, rank, residuals, intervals.
    pub fn fit(&self) -> &Fit {
        &self.fitted.fit
    }

    /// Everything found: fitted parameters first, then what follows from them and from the machine.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// The finding of this name, such as `"friction_per_mass"` or `"mu"`.
    pub fn finding(&self, name: &str) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.parameter().name() == name)
    }

    /// The interval that covers the finding of this name with probability `level`, [`Finding::interval`].
    ///
    /// ```no_run
    /// # fn of(found: &fmm_identify::Identification) {
    /// if let Some((low, high)) = found.interval("mu", 0.95) {
    ///     println!("μ lies between {low:.4} and {high:.4} with 95 %");
    /// }
    /// # }
    /// ```
    pub fn interval(&self, name: &str, level: f64) -> Option<(f64, f64)> {
        self.finding(name)?.interval(level)
    }

    /// The fitted motion of each record.
    pub fn motions(&self) -> &[FittedMotion] {
        &self.motions
    }

    /// Limits of the findings.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Root mean square of the residuals, in the unit of the records.
    pub fn rms_residual(&self) -> f64 {
        self.structure.residual
    }

    /// τ, how many neighbouring residuals tell no more than one (1).
    pub fn autocorrelation_time(&self) -> f64 {
        self.structure.autocorrelation_time
    }

    /// Model at every sample of record number `record` of `decays`, which must be those of the
    /// identification; `None` for another number.
    pub fn model(&self, decays: &[Experiment], record: usize) -> Option<Vec<f64>> {
        if record >= decays.len() {
            return None;
        }
        let decays = self.experiments(decays).ok()?;
        let problem = self.problem(&decays).ok()?;
        problem.model(record, self.fitted.fit.values()).ok()
    }

    /// The `decays`, which must be those of the identification, with what was fitted beside their motion.
    pub(crate) fn experiments(&self, decays: &[Experiment]) -> Result<Vec<Experiment>, IdentifyError> {
        let given: usize = decays.iter().map(Experiment::rows).sum();
        let fitted = self.fitted.fit.residuals().len() - self.covariance.knowledge.len();
        if decays.len() != self.motions.len() || given != fitted {
            let (count, expected) = (decays.len(), self.motions.len());
            return Err(IdentifyError::wrong_record(format!(
                "the identification is that of {expected} record(s) with {fitted} residuals, but {count} with {given} \
                 were given"
            )));
        }
        Ok(as_fitted(decays, &self.disturbances))
    }

    /// The `decays` with slow drift to be fitted beside their motion, if the residuals of this fit show any.
    pub(crate) fn with_drift(&self, decays: &[Experiment]) -> Option<Vec<Experiment>> {
        let problem = self.problem(decays).ok()?;
        with_drift(self, &problem, decays)
    }

    /// Number of parameters that the fit uses: those that the records determine, and those that ended on a bound
    /// other than zero, where a term is not merely left out.
    pub(crate) fn parameters_used(&self) -> usize {
        let is_used = |estimate: &&Estimate| estimate.status().is_at_bound() && estimate.value() != 0.0;
        self.fitted.fit.rank() + self.fitted.fit.estimates().iter().filter(is_used).count()
    }

    /// Positions at which a law can leap (1): the samples of a half cycle for a law that comes to rest within a dead
    /// zone, else one.
    pub(crate) fn leap_positions(&self) -> f64 {
        if self.finding("dead_zone").is_none() {
            return 1.0;
        }
        let half_swings: usize = self.motions.iter().map(FittedMotion::half_swings).sum();
        self.fitted.fit.residuals().len() as f64 / half_swings.max(1) as f64
    }

    /// Number of residuals that count.
    pub fn samples(&self) -> usize {
        let all = self.fitted.fit.residuals().len();
        self.counts().map_or(all, |counts| counts.iter().filter(|counts| **counts).count())
    }

    /// True if a viscous part that ended at zero would be significantly negative without its bound, as if friction fell
    /// with the speed.
    pub(crate) fn damping_would_be_negative(&self) -> bool {
        let Some(index) = self.fitted.fit.estimates().iter().position(|estimate| estimate.name() == LINEAR) else {
            return false;
        };
        self.fitted.fit.estimates()[index].status().is_at_bound()
            && self.pull_at_bound.is_some_and(|pull| pull < -SIGNIFICANT_FALL)
    }

    /// Linear damping per mass at a `share` of the critical one, over √(2π) of its standard uncertainty (1): the
    /// evidence against damping that may be anywhere below, over that at its best value. `None` where it has no
    /// uncertainty.
    pub(crate) fn range_of_damping(&self, share: f64) -> Option<f64> {
        let of = |name: &str| self.findings().iter().find(|finding| finding.parameter().name() == name);
        let u = of(LINEAR)?.unbounded_uncertainty().filter(|u| *u > 0.0)?;
        Some(4.0 * PI * share * of("natural_frequency_hz")?.value() / ((2.0 * PI).sqrt() * u))
    }

    /// Headline quantities: the friction at large speed and at rest, as coefficient, force or per mass, whichever is
    /// known; of a law without friction the damping.
    pub(crate) fn main_findings(&self) -> Vec<&Finding> {
        let sliding = self.level_names().into_iter().rev().find_map(|name| self.finding(&name));
        let Some(sliding) = sliding else {
            return ["damping", LINEAR].iter().find_map(|name| self.finding(name)).into_iter().collect();
        };
        let unit = sliding.parameter().unit();
        let at_rest = self
            .family()
            .fitted()
            .filter(|parameter| matches!(parameter.role(), Role::LevelAbove | Role::Excess | Role::Breakaway));
        let at_rest = at_rest.filter_map(|parameter| {
            let names = FORMS.map(|form| level_name(parameter.parameter().name(), false, form));
            names.iter().rev().find_map(|name| self.finding(name).filter(|finding| finding.parameter().unit() == unit))
        });
        let at_rest: Vec<&Finding> = at_rest.collect();
        // A level on its bound, which the motion nears at speeds that it never had, is no result.
        let is_open = sliding.value() == 0.0 && !at_rest.is_empty();
        Some(sliding).filter(|_| !is_open).into_iter().chain(at_rest).collect()
    }

    /// Names of the findings of the first level, as friction per mass, force and coefficient; empty for laws without.
    fn level_names(&self) -> Vec<String> {
        let Some(level) = self.family().level() else { return Vec::new() };
        let Some(parameter) = self.family().fitted().nth(level) else { return Vec::new() };
        FORMS.map(|form| level_name(parameter.parameter().name(), false, form)).to_vec()
    }

    /// Sum of squares below which a fit reproduces its records to rounding, and none is better than another.
    pub(crate) fn floor(&self) -> f64 {
        (1e-12 * self.amplitude).powi(2) * self.fitted.fit.residuals().len() as f64
    }
}
