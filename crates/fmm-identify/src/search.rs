//! The search for the law that a record asks for: it begins simple and widens as the residuals ask.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use fmm_fit::{Options, Progress};

use crate::comparison::{closest, explains};
use crate::judgement::Judgement;
use crate::sign::{Addition, Sign, signs};
use crate::{Candidate, Comparison, Identification, IdentifyError, Machine, RingDown, Warning};

/// How laws are searched for. The default tries as many as the record asks for, on two threads.
///
/// ```
/// use std::time::Duration;
///
/// use fmm_identify::Search;
///
/// let search = Search::default().within(Duration::from_secs(2));
/// assert_eq!(search, Search::default().within(Duration::from_millis(2000)));
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Search {
    held: Vec<(Option<String>, String, f64)>,
    time_limit: Option<Duration>,
    threads: usize,
}

impl Default for Search {
    fn default() -> Self {
        Self { held: Vec::new(), time_limit: None, threads: 2 }
    }
}

impl Search {
    /// The same with the parameter called `name` held at `value`, in the unit in which it would be fitted: of the law called `law`, or of
    /// every law that has one of that name.
    #[must_use]
    pub fn holding(mut self, law: Option<&str>, name: &str, value: f64) -> Self {
        self.held.push((law.map(str::to_owned), name.to_owned(), value));
        self
    }

    /// The same ended after `limit`: no further law is begun, and one that is being fitted is left out.
    #[must_use]
    pub fn within(self, limit: Duration) -> Self {
        Self { time_limit: Some(limit), ..self }
    }

    /// The same on so many threads, at least one. The result does not depend on it.
    #[must_use]
    pub fn on_threads(self, threads: usize) -> Self {
        Self { threads: threads.max(1), ..self }
    }

    /// The candidates of these names, with what is held.
    fn candidates(&self, names: &[&str]) -> Result<Vec<Candidate>, IdentifyError> {
        names.iter().map(|name| self.candidate(name)).collect()
    }

    fn candidate(&self, name: &str) -> Result<Candidate, IdentifyError> {
        let (name, own) = name.split_once(',').unwrap_or((name, ""));
        let mut candidate = Candidate::named(name)?;
        if let Some((parameter, value)) = own.split_once('=') {
            let is_given =
                self.held.iter().any(|(law, held, _)| held == parameter.trim() && is_meant(law.as_deref(), &candidate));
            if let (false, Ok(value)) = (is_given, value.trim().parse()) {
                candidate = candidate.holding(parameter.trim(), value)?;
            }
        }
        for (law, parameter, value) in &self.held {
            if is_meant(law.as_deref(), &candidate) && candidate.has_parameter(parameter) {
                candidate = candidate.holding(parameter, *value)?;
            }
        }
        Ok(candidate)
    }
}

/// Whether what is held of `law`, or of all if it is none, is meant for the `candidate`.
fn is_meant(law: Option<&str>, candidate: &Candidate) -> bool {
    law.is_none_or(|law| candidate.law_name() == law)
}

/// Laws of the first stage.
const SIMPLE: [&str; 3] = ["viscous", "coulomb", "coulomb_viscous"];
/// Laws that change with speed, with the viscous part that a simple law has.
const OF_SPEED: [&str; 7] = [
    "berger+linear",
    "stribeck,exponent=2",
    "stribeck_lorentzian",
    "coulomb+quadratic",
    "coulomb_viscous+quadratic",
    "acceleration_coulomb",
    "hyperbolic+linear",
];
/// Presliding over less of the amplitude than this (1) is none that a record shows.
const LEAST_PRESLIDING: f64 = 2e-3;
/// Steps of a converter that presliding must exceed to be seen.
const STEPS_OF_PRESLIDING: f64 = 3.0;
/// Iterations of a fit with presliding, whose motion has no closed form: one that needs more is led by something else.
const MOST_ITERATIONS: usize = 25;
/// Laws with presliding.
const WITH_STATE: [&str; 1] = ["dahl+linear,exponent=1"];

/// Identifies `decays` by as many laws as they ask for.
///
/// First viscous damping, Coulomb friction and both. If the residuals of these show signs of something else, or are alike where they
/// should be noise, laws whose friction changes with speed; and laws with presliding if there are signs of that. What was looked for
/// is in [`Comparison::signs`].
///
/// # Errors
/// [`IdentifyError`] as for [`identify`](crate::identify), and for a parameter that no law has.
pub fn search(machine: &Machine, decays: &[RingDown], search: &Search) -> Result<Comparison, IdentifyError> {
    search_observed(machine, decays, search, &Options::default(), |_, _| ControlFlow::Continue(()))
}

/// As [`search`], with options for the solver and an observer that gets the law's name with every trial step.
///
/// # Errors
/// As for [`search`].
pub fn search_observed(
    machine: &Machine,
    decays: &[RingDown],
    search: &Search,
    options: &Options,
    observer: impl FnMut(&str, &Progress<'_>) -> ControlFlow<()> + Send,
) -> Result<Comparison, IdentifyError> {
    let (observer, begun) = (Mutex::new(observer), Instant::now());
    let run = Run { machine, decays, search, options, observer: &observer, begun };
    let mut found = Found::default();
    run.fit(search.candidates(&SIMPLE)?, &[], true, &mut found)?;
    let drifting = closest(&found.identifications).and_then(|found| found.with_drift(decays));
    let mut decays = decays;
    if let Some(drifting) = &drifting {
        let mut with_drift = Found::default();
        Run { decays: drifting, ..run }.fit(search.candidates(&SIMPLE)?, &[], true, &mut with_drift)?;
        if explains(&with_drift.identifications) {
            (decays, found) = (drifting, with_drift);
        }
    }
    let run = Run { decays, ..run };
    let mut signs = run.signs(&found);
    if found.asks_for_more(&signs) {
        run.fit(search.candidates(&OF_SPEED)?, &signs, false, &mut found)?;
        // A converter hides what is not longer than a few of its steps, and its steps look like presliding: neither moves where the
        // machine turns.
        let steps = decays.iter().map(|decay| {
            let summary = decay.summary();
            summary.resolution.filter(|_| summary.is_rounded()).unwrap_or(0.0) / summary.amplitudes.0
        });
        let least = steps.map(|step| STEPS_OF_PRESLIDING * step).fold(LEAST_PRESLIDING, f64::max);
        let seen =
            |sign: &Sign| sign.addition == Addition::Presliding && sign.significance() > 2.0 && sign.size > least;
        if signs.iter().any(seen) {
            let options = options.clone().with_max_iterations(MOST_ITERATIONS.min(options.max_iterations()));
            let run = Run { options: &options, ..run };
            run.fit(search.candidates(&WITH_STATE)?, &signs, false, &mut found)?;
        }
    }
    signs.retain(|sign| sign.uncertainty.is_finite());
    let mut comparison = Comparison::of(decays, &found.candidates, found.identifications)?;
    comparison.signs = signs;
    comparison.is_complete = !found.is_cut_short;
    if found.is_cut_short {
        comparison.warnings.push(Warning::TimeLimit);
    }
    Ok(comparison)
}

/// What a search has found so far.
#[derive(Default)]
struct Found {
    candidates: Vec<Candidate>,
    identifications: Vec<Identification>,
    is_cut_short: bool,
}

impl Found {
    /// Whether the simple laws leave something in the residuals.
    fn asks_for_more(&self, signs: &[Sign]) -> bool {
        let held_back = |found: &Identification| found.damping_would_be_negative();
        signs.iter().any(Sign::is_plain)
            || self.is_structured()
            || self.identification("coulomb_viscous").is_some_and(held_back)
    }

    /// Whether the residuals of the best law are alike where they should be noise.
    fn is_structured(&self) -> bool {
        let judgement = Judgement::of(&self.candidates, &self.identifications);
        judgement.is_some_and(|judgement| self.identifications[judgement.preferred].structure().is_correlated())
    }

    fn identification(&self, law: &str) -> Option<&Identification> {
        self.identifications.iter().find(|found| found.law() == law)
    }
}

struct Run<'a, F> {
    machine: &'a Machine,
    decays: &'a [RingDown],
    search: &'a Search,
    options: &'a Options,
    observer: &'a Mutex<F>,
    begun: Instant,
}

impl<F: FnMut(&str, &Progress<'_>) -> ControlFlow<()> + Send> Run<'_, F> {
    fn is_late(&self) -> bool {
        self.search.time_limit.is_some_and(|limit| self.begun.elapsed() >= limit)
    }

    /// Fits the `candidates`, each a piece of work for whichever thread is idle; laws that must be there are fitted whatever the time.
    fn fit(
        &self,
        candidates: Vec<Candidate>,
        signs: &[Sign],
        must: bool,
        found: &mut Found,
    ) -> Result<(), IdentifyError> {
        let next = AtomicUsize::new(0);
        let results: Vec<Mutex<Option<Result<Identification, IdentifyError>>>> =
            candidates.iter().map(|_| Mutex::new(None)).collect();
        let simple = found.identification("coulomb_viscous");
        let work = || {
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(candidate) = candidates.get(index) else { break };
                if !must && self.is_late() {
                    break;
                }
                let name = candidate.name();
                let mut observe = |progress: &Progress<'_>| {
                    if !must && self.is_late() {
                        return ControlFlow::Break(());
                    }
                    match self.observer.lock() {
                        Ok(mut observer) => observer(&name, progress),
                        Err(_) => ControlFlow::Break(()),
                    }
                };
                let result =
                    candidate.identify_near(self.machine, self.decays, simple, signs, self.options, &mut observe);
                if let Ok(mut slot) = results[index].lock() {
                    *slot = Some(result);
                }
            }
        };
        let threads = self.search.threads.min(candidates.len());
        std::thread::scope(|scope| {
            for _ in 1..threads {
                scope.spawn(work);
            }
            work();
        });
        for (candidate, result) in candidates.into_iter().zip(results) {
            let result = result.into_inner().ok().flatten();
            match result {
                Some(Ok(identification)) if must || !self.is_late() || identification.fit().outcome().is_success() => {
                    found.candidates.push(candidate);
                    found.identifications.push(identification);
                }
                Some(Err(error)) if must => return Err(error),
                // A law that cannot follow this record is no candidate for it.
                Some(Err(_)) => {}
                _ => found.is_cut_short = true,
            }
        }
        Ok(())
    }

    fn signs(&self, found: &Found) -> Vec<Sign> {
        let base = found.identification("coulomb_viscous");
        base.and_then(|base| signs(base, self.decays).ok()).unwrap_or_default()
    }
}
