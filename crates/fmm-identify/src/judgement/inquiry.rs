//! Door to all identifications: a machine, its experiments, and the options of their fits.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use fmm_fit::{Minimizer, Options};
use fmm_friction::{FamilyVisitor, LawFamily};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::force::ForceRecord;
use crate::experiment::{Experiment, Experiments};
use crate::fit::forces::nested_starts;
use crate::fit::stages::Begin;
use crate::identification::beside::closest;
use crate::identification::{Identification, Validation};
use crate::judgement::change::with_change;
use crate::judgement::comparison::explains;
use crate::judgement::trials::{Families, Family};
use crate::judgement::{Comparison, better_special_case};
use crate::machine::Machine;
use crate::machine::term::Term;
use crate::problem::Problem;
use crate::threads::{is_past, on_all_threads};
use crate::warning::Warning;

/// Observer of the trial steps of fits by laws of these names; a break ends a fit.
type Observer<'a> = dyn FnMut(&str, &Minimizer) -> ControlFlow<()> + Send + 'a;

/// Identifies the parameters of law family `F` from vibrations of one machine, or from forces along motions, with the
/// default options of an [`Inquiry`].
///
/// Standard uncertainties take the residuals as independent if they look like noise. If the law misses something, so
/// that neighbouring residuals are alike, they come from the correlation of the residuals where that gives more, and a
/// warning says so; the [`Fit`](fmm_fit::Fit) keeps those of independent residuals.
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
    Inquiry::of(machine, experiments).candidate(&Candidate::of::<F>())
}

/// Identifies the `experiments` by each of `candidates` and compares them, [`Inquiry::among`].
///
/// ```
/// use fmm_identify::{Candidate, ForceRecord, Machine, compare};
///
/// // 12 N and 30 N s/m, with 0.2 N of noise.
/// let times: Vec<f64> = (0..800).map(|i| 0.01 * f64::from(i)).collect();
/// let velocities: Vec<f64> = times.iter().map(|t| 0.06 * (3.0 * t).cos()).collect();
/// let noise = |i: usize| 0.2 * (1.7 * (i * i) as f64).sin();
/// let forces: Vec<f64> =
///     velocities.iter().enumerate().map(|(i, v)| 12.0 * v.signum() + 30.0 * v + noise(i)).collect();
/// let record = ForceRecord::of_velocities(&times, &velocities, &forces)?;
/// let candidates = ["coulomb", "coulomb + linear", "coulomb + linear + zero"];
/// let candidates = candidates.into_iter().map(Candidate::named).collect::<Result<Vec<_>, _>>()?;
/// let compared = compare(&Machine::per_unit_mass(), &[record], &candidates)?;
/// assert_eq!(compared.preferred().law(), "coulomb + linear");
/// println!("{compared}");
/// # Ok::<(), fmm_identify::IdentifyError>(())
/// ```
///
/// # Errors
/// Those of [`Inquiry::among`].
pub fn compare<'a>(
    machine: &Machine,
    experiments: impl Into<Experiments<'a>>,
    candidates: &[Candidate],
) -> Result<Comparison, IdentifyError> {
    Inquiry::of(machine, experiments).among(candidates)
}

/// Identifies vibrations by as many laws as they ask for, [`Inquiry::search`].
///
/// # Errors
/// Those of [`Inquiry::search`].
pub fn search(machine: &Machine, experiments: &[Experiment]) -> Result<Comparison, IdentifyError> {
    Inquiry::of(machine, experiments).search()
}

/// A machine and its experiments, with options, to be fitted by one law, by several, or by as many as they ask for.
///
/// ```
/// use std::ops::ControlFlow;
/// use std::time::Duration;
///
/// use fmm_identify::{Candidate, ForceRecord, Inquiry, Machine};
///
/// // A slide driven to and fro, 40 mm at 0.5 Hz; 12 N and 30 N s/m of friction, and a sensor whose zero is 3 N off.
/// let times: Vec<f64> = (0..400).map(|i| 0.01 * f64::from(i)).collect();
/// let turn = std::f64::consts::PI;
/// let positions: Vec<f64> = times.iter().map(|t| 0.02 * (turn * t).sin()).collect();
/// let velocities: Vec<f64> = times.iter().map(|t| 0.02 * turn * (turn * t).cos()).collect();
/// let forces: Vec<f64> = velocities.iter().map(|v| 12.0 * v.signum() + 30.0 * v + 3.0).collect();
///
/// let record = ForceRecord::of_positions(&times, &positions, &forces)?.with_velocities(&velocities)?;
/// let mut steps = 0;
/// let found = Inquiry::of(&Machine::per_unit_mass(), &[record])
///     .within(Duration::from_secs(60))
///     .observed_by(|_, _| {
///         steps += 1;
///         ControlFlow::Continue(())
///     })
///     .candidate(&Candidate::named("coulomb + linear + zero")?)?;
/// assert!((found.finding("friction_force").unwrap().value() - 12.0).abs() < 1e-9);
/// assert!((found.finding("damping").unwrap().value() - 30.0).abs() < 1e-7);
/// assert!((found.finding("zero").unwrap().value() - 3.0).abs() < 1e-9);
/// assert!(steps > 0);
/// println!("{found}");
/// # Ok::<(), fmm_identify::IdentifyError>(())
/// ```
pub struct Inquiry<'a> {
    pub(super) machine: Machine,
    pub(super) experiments: Experiments<'a>,
    pub(super) options: Options,
    observer: Mutex<Box<Observer<'a>>>,
    time_limit: Option<Duration>,
    #[cfg_attr(not(feature = "rayon"), expect(dead_code, reason = "there is one thread"))]
    threads: Option<usize>,
    pub(super) families: Vec<Family>,
    pub(super) held: Vec<(Option<String>, String, f64)>,
    validation: &'a [ForceRecord],
}

/// Fits of several laws to the same experiments, with warnings about those that could not be fitted.
#[derive(Default)]
struct Fits {
    candidates: Vec<Candidate>,
    identifications: Vec<Identification>,
    left_out: Vec<Warning>,
}

impl<'a> Inquiry<'a> {
    /// The `experiments` on `machine` with the default options.
    pub fn of(machine: &Machine, experiments: impl Into<Experiments<'a>>) -> Self {
        Self {
            machine: *machine,
            experiments: experiments.into(),
            options: Options::default(),
            observer: Mutex::new(Box::new(|_, _| ControlFlow::Continue(()))),
            time_limit: None,
            threads: None,
            families: Vec::new(),
            held: Vec::new(),
            validation: &[],
        }
    }

    /// The same with `options` for the solver.
    #[must_use]
    pub fn with_options(self, options: Options) -> Self {
        Self { options, ..self }
    }

    /// The same with an observer that gets the name of the law with every trial step; a break ends the fit. Steps of
    /// fits on several threads come in any order, and the observer must not wait for work of the pool.
    #[must_use]
    pub fn observed_by(self, observer: impl FnMut(&str, &Minimizer) -> ControlFlow<()> + Send + 'a) -> Self {
        Self { observer: Mutex::new(Box::new(observer)), ..self }
    }

    /// The same with an end after `limit`: a fit that goes on is cancelled, and gives the best that it had; of several
    /// laws that are compared, each gets an equal share of what is left. In a search no further law begins, a law that
    /// is being fitted is left out, and the first laws are fitted all the same.
    #[must_use]
    pub fn within(self, limit: Duration) -> Self {
        Self { time_limit: Some(limit), ..self }
    }

    /// The same on `threads` threads of its own, at least one; without the feature `rayon` there is one. The result
    /// does not depend on it.
    #[must_use]
    pub fn on_threads(self, threads: usize) -> Self {
        Self { threads: Some(threads.max(1)), ..self }
    }

    /// The same with family `F`, a user's law, beside the catalogue of a search. Its trials are those of
    /// [`SEARCH`](LawFamily::SEARCH), each after the laws of the catalogue at that stage.
    #[must_use]
    pub fn including<F: LawFamily>(mut self) -> Self {
        self.families.push(Families.visit::<F>());
        self
    }

    /// The same with the parameter `name` fixed at `value` in a search, in the unit of the fit: of the law `law`, or of
    /// every law that has it.
    #[must_use]
    pub fn holding(mut self, law: Option<&str>, name: &str, value: f64) -> Self {
        self.held.push((law.map(str::to_owned), name.to_owned(), value));
        self
    }

    /// The same with `records` of forces to which nothing is fitted. A [comparison](Self::among) prefers the law that
    /// predicts them best.
    #[must_use]
    pub fn validated_by(self, records: &'a [ForceRecord]) -> Self {
        Self { validation: records, ..self }
    }

    /// The identification by a law with its terms, as [`identify`] gives it.
    ///
    /// # Errors
    /// Those of [`identify`], and terms that do not fit the law.
    pub fn candidate(&self, candidate: &Candidate) -> Result<Identification, IdentifyError> {
        let (candidate, end) = (self.allowed(candidate), self.end());
        self.on_pool(|| self.fit(&candidate, self.experiments, Begin::Anywhere, &self.options, end))
    }

    /// The comparison of `candidates` by an identification each. A law that cannot be fitted is left out, with a
    /// warning that has the reason; a law that ends above a special case of it is fitted again from there.
    ///
    /// Of forces along motions, two laws are compared at the samples that count for both, and by what each leaves at
    /// others beyond its usual residual.
    ///
    /// # Errors
    /// Those of [`identify`] if no law can be fitted, [`IdentifyError::Missing`] without a candidate,
    /// [`IdentifyError::Contradiction`] for a candidate that is given twice, and [`IdentifyError::NotPredicted`] for a
    /// record of the validation.
    pub fn among(&self, candidates: &[Candidate]) -> Result<Comparison, IdentifyError> {
        let candidates: Vec<Candidate> = candidates.iter().map(|candidate| self.allowed(candidate)).collect();
        let candidates = candidates.as_slice();
        let names: Vec<String> = candidates.iter().map(Candidate::name).collect();
        if let Some((_, twice)) = names.iter().enumerate().find(|(place, name)| names[..*place].contains(name)) {
            return Err(IdentifyError::contradiction(format!("{twice} is given twice; leave one out")));
        }
        let end = self.end();
        self.on_pool(|| {
            let mut fitted = self.fit_each(candidates, self.experiments, end)?;
            let mut decays: &[Experiment] = &[];
            let drifting;
            if let Experiments::Vibrations(own) = self.experiments {
                decays = own;
                drifting = closest(&fitted.identifications).and_then(|found| found.with_drift(own));
                if let Some(drifting) = &drifting {
                    let with_drift = self.fit_each(candidates, drifting.into(), end)?;
                    if explains(&with_drift.identifications) {
                        (decays, fitted) = (drifting, with_drift);
                    }
                }
            }
            let Fits { candidates, identifications, left_out } = fitted;
            let validations = identifications.iter().map(|found| self.validations(found)).collect::<Result<_, _>>()?;
            let mut comparison = Comparison::of(decays, &candidates, identifications, validations, None)?;
            comparison.warnings.extend(left_out);
            Ok(comparison)
        })
    }

    /// The fits of `candidates` to `experiments` until the `end`.
    fn fit_each(
        &self,
        candidates: &[Candidate],
        experiments: Experiments<'_>,
        end: Option<Instant>,
    ) -> Result<Fits, IdentifyError> {
        let mut fitted = Fits::default();
        let mut failure = None;
        // A law of which one step takes longer than its share leaves the others theirs.
        let share = end.map(|end| end.saturating_duration_since(Instant::now()) / candidates.len().max(1) as u32);
        for candidate in candidates {
            let end = share.and_then(|share| Instant::now().checked_add(share));
            match self.fit(candidate, experiments, Begin::Anywhere, &self.options, end) {
                Ok(found) => {
                    fitted.candidates.push(candidate.clone());
                    fitted.identifications.push(found);
                }
                Err(error) if error.is_of_law() => {
                    fitted.left_out.push(Warning::left_out(&format!("the law {}", candidate.name()), &error));
                    failure.get_or_insert(error);
                }
                Err(error) => return Err(error),
            }
        }
        if let Some(error) = failure.filter(|_| fitted.candidates.is_empty()) {
            return Err(error);
        }
        let Fits { candidates, identifications, .. } = &mut fitted;
        self.follow_special_cases(candidates, identifications, experiments, &self.options, end);
        Ok(fitted)
    }

    /// Agreement of `found` with each record of the validation.
    fn validations(&self, found: &Identification) -> Result<Vec<Validation>, IdentifyError> {
        let validate = |(record, number): (&ForceRecord, usize)| {
            let named = |source| IdentifyError::NotPredicted { record: number, source: Box::new(source) };
            found.validate(record).map_err(named)
        };
        self.validation.iter().zip(1..).map(validate).collect()
    }

    /// The `candidate` with friction that changes, where it is known how little it does.
    fn allowed(&self, candidate: &Candidate) -> Candidate {
        let is_open = self.machine.steadiness().is_some() && !candidate.terms.has(Term::Change);
        with_change(candidate).filter(|_| is_open).unwrap_or_else(|| candidate.clone())
    }

    /// End of the time limit, from now on.
    pub(super) fn end(&self) -> Option<Instant> {
        self.time_limit.and_then(|limit| Instant::now().checked_add(limit))
    }

    /// Does `work` on the threads that were asked for.
    pub(super) fn on_pool<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        #[cfg(feature = "rayon")]
        if let Some(threads) = self.threads {
            // A system that grants no threads leaves those that there are.
            if let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
                return pool.install(work);
            }
        }
        work()
    }

    /// Fits those of the `identifications` again that a special case of their law fits better, from where that one has
    /// ended; of two fits the better stays.
    pub(super) fn follow_special_cases(
        &self,
        candidates: &[Candidate],
        identifications: &mut [Identification],
        experiments: Experiments<'_>,
        options: &Options,
        end: Option<Instant>,
    ) {
        if is_past(end) {
            return;
        }
        let missed = |place: usize| Some((place, better_special_case(place, candidates, identifications)?));
        let missed: Vec<_> = (0..candidates.len()).filter_map(missed).collect();
        let fit = |(place, special): (usize, usize)| {
            let special = &identifications[special].fitted;
            let starts = |problem: &Problem<'_>| match experiments {
                Experiments::Forces(_) => nested_starts(problem, special),
                Experiments::Vibrations(_) => {
                    problem.starts().iter().take(1).map(|start| problem.nested(special, start)).collect()
                }
            };
            // A law that cannot begin there keeps its fit, and the sentence on it.
            Some((place, self.fit(&candidates[place], experiments, Begin::From(&starts), options, end).ok()?))
        };
        for (place, found) in on_all_threads(missed, fit).into_iter().flatten() {
            // A fit that determines nothing has not begun.
            let is_lower = found.fit().sum_of_squares() < identifications[place].fit().sum_of_squares();
            if is_lower && found.fit().rank() > 0 {
                identifications[place] = found;
            }
        }
    }

    /// The identification of `experiments` by one law, cancelled at the `end`.
    pub(super) fn fit(
        &self,
        candidate: &Candidate,
        experiments: Experiments<'_>,
        begin: Begin<'_>,
        options: &Options,
        end: Option<Instant>,
    ) -> Result<Identification, IdentifyError> {
        let problem = Problem::of(candidate, self.machine, experiments)?;
        let name = candidate.name();
        Identification::of(&problem, begin, options, &mut |progress| match self.observer.lock() {
            Ok(mut observer) if !is_past(end) => observer(&name, progress),
            _ => ControlFlow::Break(()),
        })
    }
}
