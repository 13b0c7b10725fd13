//! The stages in which a fit is begun: with few samples, with a simple law, with a part of the record, or near another fit.

use std::ops::ControlFlow;

use fmm_fit::{Fit, Options, Outcome, Progress, Residuals, solve_observed};
use fmm_friction::CoulombViscous;
use fmm_model::Restoring;

use crate::problem::RingDownProblem;
use crate::{Identification, IdentifyError, Sign};

/// A fit by Coulomb and viscous friction to begin another one near, and what its residuals ask for.
pub(crate) struct Near<'a> {
    pub(crate) simple: &'a Identification,
    pub(crate) signs: &'a [Sign],
}

/// Shares of a record to which a pendulum is fitted before the whole, as its period depends on the amplitude.
const BEGINNINGS: [f64; 2] = [0.125, 0.4];

/// The best end of the fits from all start values. Displacements are first fitted up to their last peak, and from
/// there as a whole. Laws with more than a level and a viscous part continue the fit of one that has just these.
pub(crate) fn fit_in_stages(
    problem: &RingDownProblem<'_>,
    options: &Options,
    observer: &mut dyn FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Fit, IdentifyError> {
    if let Some(thinned) = problem.thinned() {
        // One fit of all samples, begun where a search with few of them has ended.
        let search = problem.with_records(&thinned);
        let found = fit_in_search(&search, options, observer)?;
        return best_fit(problem, problem.name(), vec![found.values().to_vec()], options, observer);
    }
    fit_in_search(problem, options, observer)
}

/// The best end of the fits from the starts near a simple fit, with few of the samples first.
pub(crate) fn fit_near(
    problem: &RingDownProblem<'_>,
    near: &Near<'_>,
    options: &Options,
    observer: &mut dyn FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Fit, IdentifyError> {
    let simple = RingDownProblem::new::<CoulombViscous>(*problem.machine(), problem.decays())?;
    let starts = problem.near(&simple, near.simple.fit().values(), near.signs);
    let starts = match problem.thinned() {
        Some(thinned) if starts.len() > 1 => {
            let search = problem.with_records(&thinned);
            vec![best_fit(&search, problem.name(), starts, options, observer)?.values().to_vec()]
        }
        _ => starts,
    };
    best_fit(problem, problem.name(), starts, options, observer)
}

/// The best end of the fits from everything that may be a start.
fn fit_in_search(
    problem: &RingDownProblem<'_>,
    options: &Options,
    observer: &mut dyn FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Fit, IdentifyError> {
    if !problem.is_elaborate() {
        return fit_simple(problem, options, observer);
    }
    let simple = RingDownProblem::new::<CoulombViscous>(*problem.machine(), problem.decays())?;
    let known = fit_simple(&simple, options, observer)?;
    let mut starts = problem.continued(&simple, known.values());
    starts.extend(problem.starts().into_iter().next());
    best_fit(problem, problem.name(), starts, options, observer)
}

/// The best end of the fits from start values that the records show.
fn fit_simple(
    problem: &RingDownProblem<'_>,
    options: &Options,
    observer: &mut dyn FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Fit, IdentifyError> {
    let mut starts = problem.starts();
    if let Some(swinging) = problem.up_to_last_peaks() {
        let problem = problem.with_records(&swinging);
        if let Ok(fit) = best_fit(&problem, problem.name(), problem.starts(), options, observer) {
            starts.push(fit.values().to_vec());
        }
    }
    if problem.machine().restoring() != Restoring::Linear {
        let mut begun = problem.starts();
        for share in BEGINNINGS {
            let beginning = problem.beginnings(share);
            let problem = problem.with_records(&beginning);
            if let Ok(fit) = best_fit(&problem, problem.name(), std::mem::take(&mut begun), options, observer) {
                begun.push(fit.values().to_vec());
            }
        }
        starts.extend(begun);
    }
    best_fit(problem, problem.name(), starts, options, observer)
}

/// The best end of the fits from `starts`. No other end is better than one that leaves rounding only.
pub(crate) fn best_fit(
    problem: &impl Residuals,
    law: &'static str,
    starts: Vec<Vec<f64>>,
    options: &Options,
    observer: &mut dyn FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Fit, IdentifyError> {
    let mut best: Option<Fit> = None;
    let mut failure = None;
    for start in starts {
        match solve_observed(problem, &start, options, |progress| observer(progress)) {
            Ok(fit) if fit.outcome() == Outcome::AtNoiseFloor => return Ok(fit),
            Ok(fit) if best.as_ref().is_none_or(|best| fit.sum_of_squares() < best.sum_of_squares()) => {
                best = Some(fit);
            }
            Ok(_) => {}
            Err(source) => failure = Some(IdentifyError::Fit { law, source }),
        }
    }
    best.ok_or_else(|| failure.unwrap_or(IdentifyError::TooFewHalfSwings { found: 0, needed: 2 }))
}
