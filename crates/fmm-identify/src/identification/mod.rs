//! The main job: friction parameters of one law out of ring-down records.

pub(crate) mod drift;
mod findings;
mod limits;
mod profile;

use std::ops::ControlFlow;

use fmm_fit::{Estimate, EvaluationError, Fit, Options, Progress};
use fmm_friction::{LawFamily, Role};
use fmm_sim::{Event, EventKind, Trajectory};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::Experiment;
use crate::experiment::nuisance::Nuisance;
use crate::experiment::scaled;
use crate::finding::Finding;
use crate::fit::stages::{Begin, Near, Observer, fit_begun};
use crate::identification::drift::{as_fitted, with_drift};
use crate::identification::findings::findings;
use crate::law::Law;
use crate::law::naming::LINEAR;
use crate::law::naming::{Level, level_name};
use crate::machine::{Machine, Terms};
use crate::problem::Problem;
use crate::problem::fitted::Fitted;
use crate::problem::tangent::Tangent;
use crate::quantities::table::Table;
use crate::residuals::noise::ResidualNoise;
use crate::residuals::rules::SIGNIFICANT;
use crate::residuals::structure::{Covariance, ResidualStructure};
use crate::warning::Warning;

pub use profile::{Profile, Profiles};

/// End of the fitted motion of one record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedMotion {
    stop_time: Option<f64>,
    half_swings: usize,
    narrowest: Option<(f64, f64)>,
}

impl FittedMotion {
    /// The motion behind `trajectory`, which begins at `start` (s) on the time axis of a record sampled every
    /// `interval` (s).
    pub(crate) fn of_events(start: f64, interval: f64, trajectory: &Trajectory) -> Self {
        // A velocity of nearly zero at the first sample reverses at once, or does not: that is no swing of the record.
        let turns = |event: &&Event| matches!(event.kind, EventKind::Reversal | EventKind::Stop);
        let begun = |event: &&Event| event.time > interval;
        let decided = trajectory.events().iter().filter(turns).filter(begun);
        let margins = decided.clone().map(|event| (event.margin(), start + event.time));
        Self {
            stop_time: trajectory.rest().map(|event| start + event.time),
            half_swings: decided.count(),
            narrowest: margins.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs())),
        }
    }

    /// Margin and time (s) of the most narrowly decided turning point of `motions`.
    pub(crate) fn narrowest_decision(motions: &[Self]) -> Option<(f64, f64)> {
        let decided = motions.iter().filter_map(|motion| motion.narrowest);
        decided.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
    }

    /// When the contact stops for good, on the time axis of the record (s); `None` if it does not before the end.
    pub fn stop_time(&self) -> Option<f64> {
        self.stop_time
    }

    /// Number of times at which the velocity reaches zero.
    pub fn half_swings(&self) -> usize {
        self.half_swings
    }
}

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
    amplitude: f64,
}

/// Identifies the parameters of law family `F` from ring-downs of one machine.
///
/// Standard uncertainties take the residuals as independent if they look like noise. If the law misses something, so
/// that neighbouring residuals are alike, they come from [`CorrelatedCovariance`](fmm_fit::CorrelatedCovariance) where
/// that gives more, and a warning says so; the [`Fit`] keeps those of independent residuals.
///
/// The law explains all dissipation that `machine` does not claim as its own known damping. Start values come
/// from the records; the fit starts from each hypothesis that the amplitudes allow and keeps the best end.
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
pub fn identify<F: LawFamily>(machine: &Machine, decays: &[Experiment]) -> Result<Identification, IdentifyError> {
    identify_with::<F>(machine, &Terms::NONE, decays)
}

/// Like [`identify`], with `terms` beside the law and fixed parameters.
///
/// # Errors
/// Those of [`identify`], and terms that do not fit the law.
pub fn identify_with<F: LawFamily>(
    machine: &Machine,
    terms: &Terms,
    decays: &[Experiment],
) -> Result<Identification, IdentifyError> {
    identify_observed::<F>(machine, terms, decays, &Options::default(), &mut |_| ControlFlow::Continue(()))
}

/// Like [`identify_with`], with options for the solver and an observer of every trial step, which may end the fit. Where
/// fits from several starts go on several threads, it is told of their steps in any order, and must not wait for work
/// of the pool.
///
/// # Errors
/// Those of [`identify_with`].
pub fn identify_observed<F: LawFamily>(
    machine: &Machine,
    terms: &Terms,
    decays: &[Experiment],
    options: &Options,
    observer: &mut (dyn FnMut(&Progress<'_>) -> ControlFlow<()> + Send),
) -> Result<Identification, IdentifyError> {
    identify_by(Law::of::<F>(), machine, terms, decays, Begin::Anywhere, options, observer)
}

/// Like [`identify_observed`], by a law that is known at run time.
pub(crate) fn identify_by(
    law: Law,
    machine: &Machine,
    terms: &Terms,
    decays: &[Experiment],
    begin: Begin<'_>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Identification, IdentifyError> {
    let problem = Problem::of(law, *machine, terms.clone(), decays)?;
    let fit = fit_begun(&problem, begin, options, observer)?;
    // One instrument for all records; the worst statement counts.
    let gain = decays.iter().map(|decay| decay.summary().gain_uncertainty).fold(0.0, f64::max);
    let failure = |error: EvaluationError| IdentifyError::simulation(law.name, error);
    let structure = ResidualStructure::of(&fit, decays);
    let covariance = Covariance::of(&problem, &fit, &structure).map_err(failure)?;
    let found = findings(machine, problem.table(), &fit, &covariance, gain);
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
    let mut identification = Identification {
        law: terms.name(law.name),
        friction_at_rest: friction_at_rest(problem.table(), fit.values()),
        machine: *machine,
        structure,
        disturbances: decays.iter().map(|decay| decay.nuisances().to_vec()).collect(),
        pull_at_bound: pull_at_bound(&problem, &fit, &covariance),
        covariance,
        amplitude: scaled(decays).map(|(decay, weight)| weight * decay.summary().amplitudes.0).fold(0.0, f64::max),
        fitted: Fitted { law: problem.table().family, terms: terms.clone(), fit },
        findings: found,
        motions,
        warnings: Vec::new(),
    };
    identification.warnings = Warning::of(&identification, decays);
    identification.warnings.extend(contradicted);
    let held = problem.table().family.held_breakaway();
    identification
        .warnings
        .extend(held.map(|held| Warning::StaticLevelHeld { parameter: held.parameter().name().to_owned() }));
    Ok(identification)
}

impl Candidate {
    pub(crate) fn identify(
        &self,
        machine: &Machine,
        decays: &[Experiment],
        options: &Options,
        observer: &mut Observer<'_>,
    ) -> Result<Identification, IdentifyError> {
        identify_by(*self.law(), machine, self.terms(), decays, Begin::Anywhere, options, observer)
    }

    /// Like [`identify`](Self::identify), begun near other fits of the same records.
    pub(crate) fn identify_near(
        &self,
        machine: &Machine,
        decays: &[Experiment],
        near: Option<&Near<'_>>,
        options: &Options,
        observer: &mut Observer<'_>,
    ) -> Result<Identification, IdentifyError> {
        let begin = near.map_or(Begin::Anywhere, Begin::Near);
        identify_by(*self.law(), machine, self.terms(), decays, begin, options, observer)
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
        let samples = |decays: &[Experiment]| decays.iter().map(|decay| decay.summary().samples).sum::<usize>();
        let (given, fitted) = (samples(decays), self.fitted.fit.residuals().len());
        if decays.len() != self.motions.len() || given != fitted {
            let (count, expected) = (decays.len(), self.motions.len());
            return Err(IdentifyError::wrong_record(format!(
                "the identification is that of {expected} record(s) with {fitted} samples, but {count} with {given} were given"
            )));
        }
        Ok(as_fitted(decays, &self.disturbances))
    }

    pub(crate) fn covariance(&self) -> &Covariance {
        &self.covariance
    }

    pub(crate) fn structure(&self) -> ResidualStructure {
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

    /// Positions at which a law can leap (1): the samples of a half cycle for a law that comes to rest within a dead zone,
    /// else one.
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

    /// Independent residuals that those of this fit count as (1).
    pub(crate) fn effective_count(&self) -> f64 {
        self.covariance.effective_count()
    }

    /// Changes that the parameters of this fit to `problem` can follow, those on a bound included; `None` if the derivatives
    /// cannot be had.
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
            && self.pull_at_bound.is_some_and(|pull| pull < -SIGNIFICANT)
    }

    /// By how much this fit is worse than that by `other`, in variances of the noise that the residuals of the other
    /// show in the direction in which the laws differ (1), and the degrees of freedom with which that variance is
    /// known.
    pub(crate) fn misfit_beside(&self, other: &Self) -> (f64, f64) {
        let floor = self.floor().max(other.floor());
        let excess = self.fitted.fit.sum_of_squares().max(floor) - other.fitted.fit.sum_of_squares().max(floor);
        let pairs = self.fitted.fit.residuals().iter().zip(other.fitted.fit.residuals());
        let difference: Vec<f64> = pairs.map(|(own, theirs)| own - theirs).collect();
        let rounding = floor / difference.len().max(1) as f64;
        let variance = other.noise().variance_along(&difference).max(rounding);
        let freedom = 2.0 * other.noise().ordinates_along(&difference);
        let misfit = if excess > 0.0 && variance > 0.0 { excess / variance } else { 0.0 };
        (misfit, freedom.min(other.fitted.fit.degrees_of_freedom() as f64).max(1.0))
    }

    /// The findings that mean the same in both, each with that of `other`: what has the same name, and the sliding
    /// levels, which laws name as they like.
    pub(crate) fn common_findings<'a>(&'a self, other: &'a Self) -> Vec<(&'a Finding, &'a Finding)> {
        let (own, theirs) = (self.level_names(), other.level_names());
        let same = |finding: &'a Finding| {
            let name = finding.parameter().name();
            let at = own.iter().position(|level| level == name);
            let counterpart = at.map_or(name, |at| theirs.get(at).map_or(name, String::as_str));
            other.finding(counterpart).map(|theirs| (finding, theirs))
        };
        self.findings.iter().filter_map(same).collect()
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
            let names =
                [Level::Mu, Level::Force, Level::PerMass].map(|level| level_name(parameter.parameter().name(), level));
            names.iter().find_map(|name| self.finding(name).filter(|finding| finding.parameter().unit() == unit))
        });
        std::iter::once(sliding).chain(at_rest).collect()
    }

    /// Names of the findings of the first level, as friction per mass, force and coefficient; empty for laws without.
    fn level_names(&self) -> Vec<String> {
        let Some(level) = self.fitted.law.level() else { return Vec::new() };
        let Some(parameter) = self.fitted.law.fitted().nth(level) else { return Vec::new() };
        [Level::PerMass, Level::Force, Level::Mu].map(|level| level_name(parameter.parameter().name(), level)).to_vec()
    }

    /// Sum of squares below which a fit reproduces its records to rounding, and none is better than another.
    pub(crate) fn floor(&self) -> f64 {
        (1e-12 * self.amplitude).powi(2) * self.fitted.fit.residuals().len() as f64
    }
}

/// The identification with the smallest residuals.
pub(crate) fn closest<'a>(identifications: impl IntoIterator<Item = &'a Identification>) -> Option<&'a Identification> {
    identifications.into_iter().min_by(|a, b| a.rms_residual().total_cmp(&b.rms_residual()))
}
