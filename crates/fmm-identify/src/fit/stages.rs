//! The stages in which a fit is begun: with few samples, with a simple law, with a part of the record, or near another
//! fit.

use std::ops::ControlFlow;
use std::sync::Mutex;

use fmm_fit::{Fit, FitError, Minimizer, MultiStart, Options, Outcome, Residuals, solve_observed};
use fmm_friction::CoulombViscous;
use fmm_model::Restoring;

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::fit::forces::fit_forces;
use crate::fit::response::Response;
use crate::problem::Problem;
use crate::problem::starts::Fitted;
use crate::residuals::structure::ResidualStructure;
use crate::threads::on_all_threads;

/// Observer of the trial steps of a fit; a break ends it.
pub(crate) type Observer<'o> = dyn FnMut(&Minimizer) -> ControlFlow<()> + Send + 'o;

/// Starts of the fit of a problem.
pub(crate) type Starts<'a> = dyn Fn(&Problem<'_>) -> Vec<Vec<f64>> + Sync + 'a;

/// Beginning of a fit.
#[derive(Clone, Copy)]
pub(crate) enum Begin<'a> {
    /// Wherever the records say.
    Anywhere,
    /// Start at these values, of one problem or of another one that tells the same.
    From(&'a Starts<'a>),
    /// Start at the end of a fit to the same records by a law that lacks some of the parameters, which begin at zero.
    Extended(&'a Fitted),
    /// Start at the end of a fit by the same law to the same records without filters in the sensors.
    Behind(&'a Fitted),
}

/// Relative fall of the sum of squares (1) below which a search for the lowest minimum ends, and its most iterations
/// from one start.
const ROUGH: f64 = 1e-6;
const MOST_ROUGH: usize = 30;

/// Most iterations of a search for corners of a spring. One that needs more creeps where the motion does not meet them.
const MOST_WITH_CORNERS: usize = 100;

/// Most iterations of one fit by a law with shapes. One that needs more creeps along a valley that the noise fills.
const MOST_FINAL: usize = 300;

/// The same by parameters in which fits take few steps.
const MOST_RECAST: usize = 100;

/// The same where all starts are followed: which of them leads to the lowest minimum shows long before one has crept to
/// its end.
const MOST_THOROUGH: usize = 100;
const MOST_THOROUGH_STARTS: usize = 8;

/// Starts that are taken from the linear response of a record, and those that are fitted of all, the nearest to the
/// records.
const MOST_FOLLOWED: usize = 4;
const MOST_STARTS: usize = 5;

/// Starts of a driven motion that are fitted, those nearest to the records.
const MOST_DRIVEN_STARTS: usize = 2;

/// Shares of a record to which a spring that is not linear is fitted before the whole: where the period depends on the
/// amplitude, a small error of it adds up.
const BEGINNINGS: [f64; 2] = [0.125, 0.4];

/// The best fit from where `begin` says: by parameters in which it takes few steps, if the law has such, and from there
/// on by its own.
pub(crate) fn fit_begun(
    problem: &Problem<'_>,
    begin: Begin<'_>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, IdentifyError> {
    if let Begin::Extended(special) = begin {
        return best_fit(problem, problem.name(), &[problem.extended(&special.fit)], options, observer);
    }
    if let Begin::Behind(plain) = begin {
        return best_fit(problem, problem.name(), &[problem.behind_sensors(plain.fit.values())], options, observer);
    }
    let limited = |most: usize| options.clone().with_max_iterations(options.max_iterations().min(most));
    let thinned = problem.thinned();
    let few = thinned.as_ref().map(|thinned| problem.with_records(thinned).simulated_roughly());
    let by_recast = few.as_ref().unwrap_or(problem).recast().and_then(|recast| {
        let found = fit_by_own(&recast, begin, &limited(MOST_RECAST), observer).ok()?;
        best_fit(problem, problem.name(), &[problem.of_recast(found.values())?], &limited(MOST_ROUGH), observer).ok()
    });
    by_recast.map_or_else(|| fit_by_own(problem, begin, options, observer), Ok)
}

fn fit_by_own(
    problem: &Problem<'_>,
    begin: Begin<'_>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, IdentifyError> {
    if let Some(forces) = problem.forces() {
        return fit_forces(problem, &forces, begin, options, observer);
    }
    match begin {
        Begin::From(starts) => fit_from(&problem.clone().bending_in_sight(), starts, options, observer),
        _ => fit_in_stages(problem, options, observer),
    }
}

/// The best end of the fits from all start values. Displacements are first fitted up to their last peak, and from
/// there as a whole. Laws with more than a level and a viscous part continue the fit of one that has just these.
fn fit_in_stages(problem: &Problem<'_>, options: &Options, observer: &mut Observer<'_>) -> Result<Fit, IdentifyError> {
    let thinned = problem.thinned();
    let few = thinned.as_ref().map(|thinned| problem.with_records(thinned).simulated_roughly());
    let search = few.as_ref().unwrap_or(problem);
    let found = if problem.is_elaborate() && !problem.has_spring() {
        let simple = Problem::of(&Candidate::of::<CoulombViscous>(), search.machine, search.experiments())?;
        let known = fit_simple(&simple, options, observer)?;
        let mut starts = search.continued(&simple, known.values());
        starts.extend(search.starts().into_iter().next());
        if Response::exists(search) {
            return fit_with_shapes(problem, search, (&simple, known.values()), &starts, options, observer);
        }
        fit_of_best(search, &starts, &rough(options), observer)?
    } else {
        let found = fit_simple(search, options, observer)?;
        if few.is_none() && !search.has_corners() {
            return Ok(found);
        }
        found
    };
    // One fit of all samples, begun where a rough search or one with few of them has ended.
    best_fit(problem, problem.name(), &[found.values().to_vec()], options, observer)
}

/// The best end of the fits from these `starts`, with few of the samples first.
fn fit_from(
    problem: &Problem<'_>,
    starts: &Starts<'_>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, IdentifyError> {
    let mut starts = lowest(problem, starts(problem), MOST_STARTS);
    let mut fit =
        |problem: &Problem<'_>, starts: &[Vec<f64>], options: &Options| fit_of_best(problem, starts, options, observer);
    let mut polish = options.clone();
    if let Some(thinned) = problem.thinned() {
        let found = fit(&problem.with_records(&thinned).simulated_roughly(), &starts, options)?;
        starts = vec![found.values().to_vec()];
        polish = polish.with_max_iterations(options.max_iterations().div_ceil(3));
    }
    fit(problem, &starts, &polish)
}

/// Those of `starts` with the smallest sums of squares, at most `count`.
pub(super) fn lowest(problem: &Problem<'_>, starts: Vec<Vec<f64>>, count: usize) -> Vec<Vec<f64>> {
    if starts.len() <= count {
        return starts;
    }
    let mut residuals = vec![0.0; problem.len()];
    let mut sum = |start: &Vec<f64>| match problem.evaluate(start, &mut residuals, None) {
        Ok(()) => residuals.iter().map(|residual| residual * residual).sum(),
        Err(_) => f64::INFINITY,
    };
    let mut sums: Vec<(f64, Vec<f64>)> = starts.into_iter().map(|start| (sum(&start), start)).collect();
    sums.sort_by(|a, b| a.0.total_cmp(&b.0));
    sums.into_iter().take(count).map(|(_, start)| start).collect()
}

/// The fit of a law with shapes to free vibrations on a linear spring, begun from `starts` and near a `simple` fit,
/// where a `search` with few of the samples ends. If its residuals do not look like noise, all starts are followed, and
/// the better of both is given.
fn fit_with_shapes(
    problem: &Problem<'_>,
    search: &Problem<'_>,
    simple: (&Problem<'_>, &[f64]),
    starts: &[Vec<f64>],
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, IdentifyError> {
    let problem = problem.clone().bending_in_sight();
    let search = search.clone().bending_in_sight().simulated_roughly();
    let options = &options.clone().with_max_iterations(options.max_iterations().min(MOST_FINAL));
    let found = fit_roughly(&search, simple, starts, options, observer)?;
    let start = problem.clamped(found.values());
    let fit = best_fit(&problem, problem.name(), &[start], options, observer);
    // Beside residuals that look like noise, no other minimum is lower by more than chance.
    let is_noise = |fit: &Fit| {
        fit.outcome() == Outcome::AtNoiseFloor || !ResidualStructure::of(fit, problem.experiments()).is_correlated()
    };
    if fit.as_ref().is_ok_and(is_noise) {
        return fit;
    }
    let starts = lowest(&search, starts.iter().map(|start| search.clamped(start)).collect(), MOST_THOROUGH_STARTS);
    let thorough = options.clone().with_max_iterations(options.max_iterations().min(MOST_THOROUGH));
    let thorough = best_fit_of_all(&search, &starts, &thorough, observer)
        .and_then(|end| best_fit(&problem, problem.name(), &[problem.clamped(end.values())], options, observer));
    match (fit, thorough) {
        (Ok(fit), Ok(other)) => Ok(if other.sum_of_squares() < fit.sum_of_squares() { other } else { fit }),
        (Ok(fit), Err(_)) => Ok(fit),
        (Err(_), thorough) => thorough,
    }
}

/// Ends of the fits of a law with shapes from `starts` and from the response of a `simple` fit,
/// near enough to tell which is the lowest minimum.
fn fit_roughly(
    problem: &Problem<'_>,
    simple: (&Problem<'_>, &[f64]),
    starts: &[Vec<f64>],
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, IdentifyError> {
    let mut starts: Vec<Vec<f64>> = starts.iter().map(|start| problem.clamped(start)).collect();
    if let Some(response) = Response::of(problem, simple.0, simple.1) {
        starts.extend(response.followed(&starts).into_iter().take(MOST_FOLLOWED));
    }
    fit_of_best(problem, &lowest(problem, starts, MOST_STARTS), &rough(options), observer)
}

/// The `options` of a search that only has to decide where the lowest minimum is.
fn rough(options: &Options) -> Options {
    let most = options.max_iterations().min(MOST_ROUGH);
    options.clone().with_cost_tolerance(ROUGH).with_polish_steps(0).with_restarts(0).with_max_iterations(most)
}

/// The best end of the fits from start values that the records show.
fn fit_simple(problem: &Problem<'_>, options: &Options, observer: &mut Observer<'_>) -> Result<Fit, IdentifyError> {
    let mut starts = problem.starts();
    if problem.is_driven() {
        starts = lowest(problem, starts, MOST_DRIVEN_STARTS);
    }
    if problem.has_corners() {
        return fit_with_corners(problem, starts, options, observer);
    }
    // Where the period depends on the amplitude, a fit creeps to the whole record unless it begins where one of the
    // beginning has ended.
    let is_bent = problem.machine.restoring() != Restoring::Linear || problem.has_spring();
    let mut fit = |problem: &Problem<'_>, starts: &[Vec<f64>]| {
        if is_bent {
            fit_of_best(problem, starts, options, observer)
        } else {
            best_fit(problem, problem.name(), starts, options, observer)
        }
    };
    let mut begun = Vec::new();
    if is_bent {
        begun = problem.starts();
        for share in BEGINNINGS {
            let beginning = problem.beginnings(share);
            let found = fit(&problem.with_records(&beginning), &std::mem::take(&mut begun));
            begun.extend(found.map(|fit| fit.values().to_vec()));
        }
    }
    starts.extend(begun.iter().cloned());
    if let Some(swinging) = problem.up_to_last_peaks() {
        let problem = problem.with_records(&swinging);
        begun.extend(problem.starts());
        starts.extend(fit(&problem, &begun).map(|fit| fit.values().to_vec()));
    }
    if let Some(smooth) = problem.between_reversals() {
        let found = fit(&problem.with_records(&smooth), &starts);
        starts.extend(found.map(|fit| fit.values().to_vec()));
    }
    fit(problem, &starts)
}

/// Ends of the fits from `starts` of a spring with corners, near enough to begin the last one: all of them to few
/// swings, the best of these to more and more.
fn fit_with_corners(
    problem: &Problem<'_>,
    mut starts: Vec<Vec<f64>>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, IdentifyError> {
    let most = options.max_iterations().min(MOST_WITH_CORNERS);
    let coarse = options.clone().with_cost_tolerance(ROUGH).with_polish_steps(0).with_max_iterations(most);
    for share in BEGINNINGS {
        let beginning = problem.beginnings(share);
        let problem = problem.with_records(&beginning);
        let fits = starts.iter().filter_map(|start| {
            let fit = solve_observed(&problem, start, &coarse, |progress| observer(progress)).ok()?;
            Some((fit.sum_of_squares(), fit.values().to_vec()))
        });
        let mut ends: Vec<_> = fits.collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.truncate((starts.len() / 3).max(2));
        if !ends.is_empty() {
            starts = ends.into_iter().map(|(_, values)| values).collect();
        }
    }
    fit_of_best(problem, &starts, &coarse, observer)
}

/// The best end of the fits from `starts`. No other end is better than one that leaves rounding only.
pub(crate) fn best_fit(
    problem: &impl Residuals,
    law: &'static str,
    starts: &[Vec<f64>],
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, IdentifyError> {
    best(law, starts.iter().map(|start| solve_observed(problem, start, options, |progress| observer(progress))))
}

/// The end of the fit from one of `starts`: the others are given up on the way.
fn fit_of_best(
    problem: &Problem<'_>,
    starts: &[Vec<f64>],
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, IdentifyError> {
    let search = MultiStart::from_starts(starts.to_vec()).with_options(options.clone());
    search
        .solve_observed(problem, |progress| observer(progress))
        .map_err(|source| IdentifyError::Fit { law: problem.name(), source })
}

/// Like [`best_fit`], with all fits at once.
fn best_fit_of_all(
    problem: &Problem<'_>,
    starts: &[Vec<f64>],
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, IdentifyError> {
    let observer = Mutex::new(observer);
    let observe = |progress: &Minimizer| match observer.lock() {
        Ok(mut observer) => observer(progress),
        Err(_) => ControlFlow::Break(()),
    };
    let fits = on_all_threads(starts.iter().collect(), |start| solve_observed(problem, start, options, observe));
    best(problem.name(), fits)
}

/// The best of `fits`.
fn best(law: &'static str, fits: impl IntoIterator<Item = Result<Fit, FitError>>) -> Result<Fit, IdentifyError> {
    let mut best: Option<Fit> = None;
    let mut failure = None;
    for fit in fits {
        match fit {
            Ok(fit) if fit.outcome() == Outcome::AtNoiseFloor => return Ok(fit),
            Ok(fit) if best.as_ref().is_none_or(|best| fit.sum_of_squares() < best.sum_of_squares()) => {
                best = Some(fit);
            }
            Ok(_) => {}
            Err(source) => failure = Some(IdentifyError::Fit { law, source }),
        }
    }
    best.ok_or_else(|| failure.unwrap_or(IdentifyError::too_few_half_swings(0, 2)))
}
