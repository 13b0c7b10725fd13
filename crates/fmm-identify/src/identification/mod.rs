//! The main job: friction parameters of one law out of ring-down records.

pub(crate) mod beside;
pub(crate) mod drift;
mod findings;
mod force;
mod limits;
mod motion;
mod profile;

use std::ops::ControlFlow;

use fmm_fit::{Estimate, EvaluationError, Fit, Options, Progress};
use fmm_friction::{LawFamily, Role};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::nuisance::Nuisance;
use crate::experiment::scaled;
use crate::experiment::{Experiment, Experiments};
use crate::finding::Finding;
use crate::fit::stages::{Begin, Near, Observer, fit_begun};
use crate::identification::drift::{as_fitted, with_drift};
use crate::identification::findings::findings;
use crate::identification::force::ForceResults;
use crate::law::Law;
use crate::law::naming::LINEAR;
use crate::law::naming::{Level, level_name};
use crate::machine::{Machine, Terms};
use crate::problem::Problem;
use crate::problem::fitted::Fitted;
use crate::problem::tangent::Tangent;
use crate::quantities::table::Table;
use crate::residuals::noise::ResidualNoise;
use crate::residuals::rules::SIGNIFICANT_FALL;
use crate::residuals::structure::{Covariance, ResidualStructure};
use crate::warning::Warning;

pub use force::Validation;
pub use motion::FittedMotion;
pub use profile::{Profile, Profiles};

/// Meanings of a level, of which an identification states some, the most wanted last.
const LEVELS: [Level; 4] = [Level::PerMass, Level::Force, Level::Mu, Level::Coefficient];

/// Friction parameters of one law, with their uncertainty and what limits them.
///
/// `Display` gives the report.
#[derive(Debug, Clone)]
pub struct Identification {
    law: String,
    fitted: Fitted,
    friction_at_rest: Option<f64>,
    machine: Machine,
    findings: Vec<Finding>,
    motions: Vec<FittedMotion>,
    warnings: Vec<Warning>,
    structure: ResidualStructure,
    covariance: Covariance,
    /// By how many standard uncertainties the linear damping would leave its bound, if it is there.
    pull_at_bound: Option<f64>,
    /// Of each record, what was fitted beside its motion.
    disturbances: Vec<Vec<Nuisance>>,
    /// Amplitude of the records, or deviation of the forces, in the unit of the residuals.
    amplitude: f64,
    /// Results for forces along motions; `None` for vibrations.
    forces: Option<ForceResults>,
}

/// Identifies the parameters of law family `F` from vibrations of one machine, or from forces along motions.
///
/// Standard uncertainties take the residuals as independent if they look like noise. If the law misses something, so
/// that neighbouring residuals are alike, they come from [`CorrelatedCovariance`](fmm_fit::CorrelatedCovariance) where
/// that gives more, and a warning says so; the [`Fit`] keeps those of independent residuals.
///
/// The law explains all dissipation that `machine` does not claim as its own known damping. Start values come
/// from the records; the fit starts from each hypothesis that the amplitudes allow and keeps the best end.
///
/// A [force along a motion](crate::ForceRecord) depends on nothing that is known of a machine. At rest, and between two
/// samples with velocities of opposite signs, friction by a law of the speed that leaps there lies anywhere between two
/// levels: such a sample does not count, and a static level is fixed at the sliding one. A law with internal state has
/// a value there; the deflection of its bristles at the beginning of each record is fitted.
///
/// # Errors
/// [`IdentifyError`] if there is no record, if records disagree in quantity or unit, or if the fit cannot begin.
/// The result says how the fit *ends*.
///
/// ```
/// use fmm_friction::CoulombViscous;
/// use fmm_identify::{Machine, Preparation, Experiment, identify};
/// use fmm_record::{Quantity, Record};
/// # use fmm_model::Oscillator;
/// # use fmm_sim::{Engine, Exact, Sampling, Scenario};
///
/// // A velocity record; here a simulated one: 2 Hz, c/m = 0.05 1/s, F/m = 0.3 m/s², 1 kHz.
/// # let scenario = Scenario::new(Oscillator::per_unit_mass(2.0)?, CoulombViscous::new(0.3, 0.05)?, 1.0)?;
/// # let motion = Exact.run(&scenario.starting_at(0.02, 0.0)?, &Sampling::uniform(1e-3, 2000)?)?;
/// # let velocity = motion.velocity().values().to_vec();
/// let record = Record::new(0.0, 1e-3, velocity, Quantity::Velocity, "m/s")?;
///
/// let decay = Experiment::ring_down(&record, &Preparation::default())?;
/// let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &[decay])?;
/// assert!((found.finding("friction_per_mass").unwrap().value() - 0.3).abs() < 1e-9);
/// assert!((found.finding("damping_per_mass").unwrap().value() - 0.05).abs() < 1e-8);
/// println!("{found}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify<'a, F: LawFamily>(
    machine: &Machine,
    experiments: impl Into<Experiments<'a>>,
) -> Result<Identification, IdentifyError> {
    identify_with::<F>(machine, &Terms::NONE, experiments)
}

/// Like [`identify`], with `terms` beside the law and fixed parameters.
///
/// # Errors
/// Those of [`identify`], and terms that do not fit the law.
pub fn identify_with<'a, F: LawFamily>(
    machine: &Machine,
    terms: &Terms,
    experiments: impl Into<Experiments<'a>>,
) -> Result<Identification, IdentifyError> {
    identify_observed::<F>(machine, terms, experiments, &Options::default(), &mut |_| ControlFlow::Continue(()))
}

/// Like [`identify_with`], with options for the solver and an observer of every trial step, which may end the fit.
/// Where fits from several starts go on several threads, it is told of their steps in any order, and must not wait for
/// work of the pool.
///
/// # Errors
/// Those of [`identify_with`].
pub fn identify_observed<'a, F: LawFamily>(
    machine: &Machine,
    terms: &Terms,
    experiments: impl Into<Experiments<'a>>,
    options: &Options,
    observer: &mut (dyn FnMut(&Progress<'_>) -> ControlFlow<()> + Send),
) -> Result<Identification, IdentifyError> {
    identify_by(Law::of::<F>(), machine, terms, experiments.into(), Begin::Anywhere, options, observer)
}

/// Like [`identify_observed`], by a law that is known at run time.
pub(crate) fn identify_by(
    law: Law,
    machine: &Machine,
    terms: &Terms,
    experiments: Experiments<'_>,
    begin: Begin<'_>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Identification, IdentifyError> {
    let problem = Problem::of(law, *machine, terms.clone(), experiments)?;
    let fit = fit_begun(&problem, begin, options, observer)?;
    let (terms, decays) = (&problem.quantities().terms, problem.experiments());
    let forces = problem.forces().map(|forces| ForceResults::of(&forces, &fit));
    let spread = forces.as_ref().map_or(1.0, ForceResults::spread);
    // One instrument for all records; the worst statement counts.
    let gain = decays.iter().map(|decay| decay.summary().gain_uncertainty).fold(0.0, f64::max);
    let failure = |error: EvaluationError| IdentifyError::simulation(law.name, error);
    let mut structure = ResidualStructure::of(&fit, experiments);
    structure.residual *= spread.sqrt();
    let covariance = Covariance::of(&problem, &fit, &structure).map_err(failure)?.times(spread);
    let found = findings(machine, problem.quantities(), &fit, &covariance, gain);
    if let Some(finding) = found.iter().find(|finding| !finding.is_representable()) {
        return Err(IdentifyError::beyond_numbers(finding.parameter(), finding.value()));
    }

    let mut motions = Vec::with_capacity(decays.len());
    for (record, decay) in decays.iter().enumerate() {
        let trajectory = problem.events(record, fit.values()).map_err(failure)?;
        let start = decay.record().start() - decay.sensor().delay();
        motions.push(FittedMotion::of_events(start, decay.record().interval(), &trajectory));
    }
    let contradicted: Vec<Warning> = Warning::of_knowledge(&problem, &fit).collect();
    let amplitudes = scaled(decays).map(|(decay, weight)| weight * decay.summary().amplitudes.0);
    let amplitude = amplitudes.fold(forces.as_ref().map_or(0.0, ForceResults::deviation), f64::max);
    let friction_at_rest = friction_at_rest(problem.quantities(), fit.values()).filter(|_| forces.is_none());
    let mut identification = Identification {
        law: terms.name(law.name),
        friction_at_rest,
        machine: *machine,
        structure,
        disturbances: decays.iter().map(|decay| decay.nuisances().to_vec()).collect(),
        pull_at_bound: pull_at_bound(&problem, &fit, &covariance),
        covariance,
        amplitude,
        fitted: Fitted { law: problem.quantities().family, terms: terms.clone(), fit },
        findings: found,
        motions,
        warnings: Vec::new(),
        forces,
    };
    identification.warnings = match identification.force_unit() {
        Some(unit) => Warning::of_force(&identification, unit),
        None => Warning::of(&identification, decays),
    };
    identification.warnings.extend(contradicted);
    let held = problem.quantities().family.held_breakaway();
    identification
        .warnings
        .extend(held.map(|held| Warning::StaticLevelHeld { parameter: held.parameter().name().to_owned() }));
    Ok(identification)
}

impl Candidate {
    /// Identifies the parameters of this law and its terms, as [`identify`].
    ///
    /// ```
    /// use fmm_identify::{Candidate, ForceRecord, Machine};
    ///
    /// // A slide driven to and fro, 40 mm at 0.5 Hz; 12 N and 30 N s/m of friction, and a sensor whose zero is 3 N off.
    /// let times: Vec<f64> = (0..400).map(|i| 0.01 * f64::from(i)).collect();
    /// let turn = std::f64::consts::PI;
    /// let positions: Vec<f64> = times.iter().map(|t| 0.02 * (turn * t).sin()).collect();
    /// let velocities: Vec<f64> = times.iter().map(|t| 0.02 * turn * (turn * t).cos()).collect();
    /// let forces: Vec<f64> = velocities.iter().map(|v| 12.0 * v.signum() + 30.0 * v + 3.0).collect();
    ///
    /// let record = ForceRecord::of_positions(&times, &positions, &forces)?.with_velocities(&velocities)?;
    /// let found = Candidate::named("coulomb + linear + zero")?.identify(&Machine::per_unit_mass(), &[record])?;
    /// assert!((found.finding("friction_force").unwrap().value() - 12.0).abs() < 1e-9);
    /// assert!((found.finding("damping").unwrap().value() - 30.0).abs() < 1e-7);
    /// assert!((found.finding("zero").unwrap().value() - 3.0).abs() < 1e-9);
    /// println!("{found}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`identify_with`].
    pub fn identify<'a>(
        &self,
        machine: &Machine,
        experiments: impl Into<Experiments<'a>>,
    ) -> Result<Identification, IdentifyError> {
        self.identify_observed(machine, experiments.into(), &Options::default(), &mut |_| ControlFlow::Continue(()))
    }

    pub(crate) fn identify_observed(
        &self,
        machine: &Machine,
        experiments: Experiments<'_>,
        options: &Options,
        observer: &mut Observer<'_>,
    ) -> Result<Identification, IdentifyError> {
        identify_by(*self.law(), machine, self.terms(), experiments, Begin::Anywhere, options, observer)
    }

    /// Like [`identify_observed`](Self::identify_observed), begun near other fits of the same records.
    pub(crate) fn identify_near(
        &self,
        machine: &Machine,
        decays: &[Experiment],
        near: Option<&Near<'_>>,
        options: &Options,
        observer: &mut Observer<'_>,
    ) -> Result<Identification, IdentifyError> {
        let begin = near.map_or(Begin::Anywhere, Begin::Near);
        identify_by(*self.law(), machine, self.terms(), decays.into(), begin, options, observer)
    }

    /// Names of the parameters of a fit to `decays`: of the oscillator, the damping, the law, and the initial state.
    ///
    /// # Errors
    /// [`IdentifyError::Missing`], and as [`Layout::of`].
    pub(crate) fn parameters(&self, machine: &Machine, decays: &[Experiment]) -> Result<Vec<String>, IdentifyError> {
        if decays.is_empty() {
            return Err(IdentifyError::no_record());
        }
        let (_, parameters) = Table::of(*self.law(), machine, self.terms().clone(), decays)?;
        Ok(parameters.iter().map(|parameter| parameter.name().to_owned()).collect())
    }
}

/// By how many standard uncertainties the linear damping would leave the bound that it lies on; `None` if it lies on
/// none.
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
    /// Name of the law, with the terms beside it.
    pub fn law(&self) -> &str {
        &self.law
    }

    /// The fit, near which others may begin.
    pub(crate) fn fitted(&self) -> &Fitted {
        &self.fitted
    }

    pub(crate) fn family(&self) -> Law {
        self.fitted.law
    }

    /// Terms beside the law, and fixed parameters.
    pub fn terms(&self) -> &Terms {
        &self.fitted.terms
    }

    /// F/m at rest, in the unit of the friction per mass: the sliding level with what the law adds to it at zero speed;
    /// `None` for laws without a level.
    pub fn friction_at_rest(&self) -> Option<f64> {
        self.friction_at_rest
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

    pub(crate) fn finding_mut(&mut self, name: &str) -> Option<&mut Finding> {
        self.findings.iter_mut().find(|finding| finding.parameter().name() == name)
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
        let problem = Problem::of(self.fitted.law, self.machine, self.fitted.terms.clone(), &decays).ok()?;
        problem.model(record, self.fitted.fit.values()).ok()
    }

    /// The `decays`, which must be those of the identification, with what was fitted beside their motion.
    pub(crate) fn experiments(&self, decays: &[Experiment]) -> Result<Vec<Experiment>, IdentifyError> {
        let given: usize = decays.iter().map(Experiment::rows).sum();
        let fitted = self.fitted.fit.residuals().len() - self.covariance.known_beforehand();
        if decays.len() != self.motions.len() || given != fitted {
            let (count, expected) = (decays.len(), self.motions.len());
            return Err(IdentifyError::wrong_record(format!(
                "the identification is that of {expected} record(s) with {fitted} residuals, but {count} with {given} were given"
            )));
        }
        Ok(as_fitted(decays, &self.disturbances))
    }

    pub(crate) fn covariance(&self) -> &Covariance {
        &self.covariance
    }

    pub(crate) fn residual_structure(&self) -> ResidualStructure {
        self.structure
    }

    /// Largest factor by which an uncertainty exceeds that of independent residuals (1).
    pub(crate) fn inflation(&self) -> f64 {
        self.covariance.inflation()
    }

    /// The `decays` with slow drift to be fitted beside their motion, if the residuals of this fit show any.
    pub(crate) fn with_drift(&self, decays: &[Experiment]) -> Option<Vec<Experiment>> {
        let problem = Problem::of(self.fitted.law, self.machine, self.fitted.terms.clone(), decays).ok()?;
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

    /// The noise that the residuals show.
    pub(crate) fn noise(&self) -> &ResidualNoise {
        self.covariance.noise_of_residuals()
    }

    /// Number of residuals that count.
    pub(crate) fn samples(&self) -> usize {
        let all = self.fitted.fit.residuals().len();
        self.counts().map_or(all, |counts| counts.iter().filter(|counts| **counts).count())
    }

    /// Independent residuals that those of this fit count as (1).
    pub(crate) fn effective_count(&self) -> f64 {
        self.covariance.effective_count()
    }

    /// Changes that the parameters of this fit to `problem` can follow, those on a bound included; `None` if the
    /// derivatives cannot be had.
    pub(crate) fn tangent(&self, problem: &Problem<'_>) -> Option<Tangent> {
        Tangent::of(problem, &self.fitted.fit)
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

    /// Headline quantities: the friction at large speed and at rest, as coefficient, force or per mass, whichever is
    /// known; of a law without friction the damping.
    pub(crate) fn main_findings(&self) -> Vec<&Finding> {
        let sliding = self.level_names().into_iter().rev().find_map(|name| self.finding(&name));
        let Some(sliding) = sliding else {
            return ["damping", LINEAR].iter().find_map(|name| self.finding(name)).into_iter().collect();
        };
        let unit = sliding.parameter().unit();
        let at_rest = self
            .fitted
            .law
            .fitted()
            .filter(|parameter| matches!(parameter.role(), Role::LevelAbove | Role::Excess | Role::Breakaway));
        let at_rest = at_rest.filter_map(|parameter| {
            let names = LEVELS.map(|level| level_name(parameter.parameter().name(), level));
            names.iter().rev().find_map(|name| self.finding(name).filter(|finding| finding.parameter().unit() == unit))
        });
        std::iter::once(sliding).chain(at_rest).collect()
    }

    /// Names of the findings of the first level, as friction per mass, force and coefficient; empty for laws without.
    fn level_names(&self) -> Vec<String> {
        let Some(level) = self.fitted.law.level() else { return Vec::new() };
        let Some(parameter) = self.fitted.law.fitted().nth(level) else { return Vec::new() };
        LEVELS.map(|level| level_name(parameter.parameter().name(), level)).to_vec()
    }

    /// Sum of squares below which a fit reproduces its records to rounding, and none is better than another.
    pub(crate) fn floor(&self) -> f64 {
        (1e-12 * self.amplitude).powi(2) * self.fitted.fit.residuals().len() as f64
    }
}
