//! Many starts and profile intervals: what they find, and what they say when there is nothing to find.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use fmm_fit::{
    EvaluationError, FitError, Minimizer, MultiStart, Options, Outcome, ProfileEnd, ProfileInterval, ResidualVariance,
    Residuals, solve, solve_observed,
};
use fmm_model::{Bounds, Parameter};

/// Residuals from a closure of the parameters and the index.
struct Problem<F> {
    parameters: Vec<Parameter>,
    count: usize,
    residual: F,
}

impl<F: Fn(&[f64], usize) -> f64> Residuals for Problem<F> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.count
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        residuals.iter_mut().enumerate().for_each(|(i, r)| *r = (self.residual)(p, i));
        Ok(())
    }
}

fn problem<F: Fn(&[f64], usize) -> f64>(bounds: &[(f64, f64)], count: usize, residual: F) -> Problem<F> {
    let name = |(j, (lower, upper)): (usize, &(f64, f64))| {
        Parameter::named(format!("p{j}"), format!("p{j}"), "1").bounded(Bounds::new(*lower, *upper).unwrap())
    };
    Problem { parameters: bounds.iter().enumerate().map(name).collect(), count, residual }
}

const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Problem 2 of Moré, Garbow and Hillstrom: 0 at (5, 4), and a local minimum of 48.98 at (11.41…, −0.8968…).
fn freudenstein_roth(p: &[f64], i: usize) -> f64 {
    let y = p[1];
    if i == 0 { -13.0 + p[0] + ((5.0 - y) * y - 2.0) * y } else { -29.0 + p[0] + ((y + 1.0) * y - 14.0) * y }
}

#[test]
fn the_lower_minimum_of_a_textbook_function_is_found() {
    let problem = problem(&[(-20.0, 20.0), (-12.0, 8.0)], 2, freudenstein_roth);
    // From the usual start there is only the local one.
    let local = solve(&problem, &[0.5, -2.0], &Options::default()).unwrap();
    assert!((local.sum_of_squares() - 48.984_253_679_24).abs() < 1e-9, "S = {}", local.sum_of_squares());
    let lowest = MultiStart::around(problem.parameters(), &[0.5, -2.0], 31, 0).solve(&problem).unwrap();
    assert!(
        (lowest.values()[0] - 5.0).abs() < 1e-9 && (lowest.values()[1] - 4.0).abs() < 1e-9,
        "{:?}",
        lowest.values()
    );
}

#[test]
fn equal_seeds_give_equal_bits_on_any_number_of_threads() {
    let problem = problem(&[FREE, (-10.0, 10.0)], 2, freudenstein_roth);
    // Few steps: the ends are as far apart as the starts.
    let search = |seed: u64| {
        let options = Options::default().with_max_iterations(2);
        let search = MultiStart::around(problem.parameters(), &[0.5, -2.0], 69, seed).with_options(options);
        search.solve(&problem).unwrap().values().iter().map(|value| value.to_bits()).collect::<Vec<_>>()
    };
    let found = search(42);
    assert_eq!(found, search(42));
    assert_ne!(found, search(43));
    #[cfg(feature = "rayon")]
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(found, pool.install(|| search(42)), "{threads} threads");
    }
}

#[test]
fn periods_of_a_wave_are_separate_minima() {
    // A sine of 3 rad/s sampled for 10 s: a minimum about every 2 π/10 of frequency.
    let wave = problem(&[(0.5, 6.0), FREE, FREE], 101, |p, i| {
        let t = 0.1 * i as f64;
        p[1] * (p[0] * t).cos() + p[2] * (p[0] * t).sin() - (3.0 * t + 0.4).sin() - 0.01 * ((i * 37 % 11) as f64 - 5.0)
    });
    let start = [1.0, 1.0, 1.0];
    let alone = solve(&wave, &start, &Options::default()).unwrap();
    let found = MultiStart::around(wave.parameters(), &start, 39, 0).solve(&wave).unwrap();
    assert!((found.values()[0] - 3.0).abs() < 0.01, "{} rad/s", found.values()[0]);
    assert!(found.sum_of_squares() < 0.1 * alone.sum_of_squares(), "{alone}");
}

#[test]
fn starts_without_values_are_left_out() {
    // No value in one half, a minimum in the other.
    let half = problem(&[(-1.0, 1.0)], 3, |p, i| if p[0] < 0.0 { f64::NAN } else { p[0] - 0.5 + 0.1 * i as f64 });
    let search = MultiStart::around(half.parameters(), &[-0.5], 31, 0);
    assert!((search.solve(&half).unwrap().values()[0] - 0.4).abs() < 1e-9);

    let nowhere = problem(&[(-1.0, 1.0)], 3, |_, _| f64::NAN);
    assert!(matches!(search.solve(&nowhere), Err(FitError::NoModel { .. })));
    let outside = MultiStart::from_starts(vec![vec![2.0]]).solve(&half);
    assert!(matches!(outside, Err(FitError::OutOfRange { what, .. }) if what.contains("outside its bounds")));
}

#[test]
fn a_cancelled_search_keeps_what_it_has() {
    let options = Options::default().with_cancel_flag(Arc::new(AtomicBool::new(true)));
    let problem = problem(&[FREE, FREE], 2, freudenstein_roth);
    let search = MultiStart::from_starts(vec![vec![0.5, -2.0]]).with_options(options);
    let found = search.solve(&problem).unwrap();
    assert_eq!((found.outcome(), found.values()), (Outcome::Cancelled, &[0.5, -2.0][..]));
}

/// A straight line with some scatter.
fn line(p: &[f64], i: usize) -> f64 {
    p[0] + p[1] * i as f64 - 2.0 - 0.5 * i as f64 - 0.3 * ((i * 37 % 11) as f64 - 5.0)
}

fn interval<F: Fn(&[f64], usize) -> f64>(
    problem: &Problem<F>,
    start: &[f64],
    name: &str,
    variance: ResidualVariance,
) -> Result<ProfileInterval, FitError> {
    let fit = solve(problem, start, &Options::default()).unwrap();
    ProfileInterval::of(problem, &fit, name, 0.95, variance, &Options::default())
}

#[test]
fn a_straight_line_has_the_interval_of_student_and_of_gauss() {
    let line = problem(&[FREE, FREE], 20, line);
    let fit = solve(&line, &[0.0, 0.0], &Options::default()).unwrap();
    for (j, name) in ["p0", "p1"].into_iter().enumerate() {
        let (lower, upper) = fit.interval(name, 0.95).unwrap();
        let found = interval(&line, &[0.0, 0.0], name, ResidualVariance::Estimated).unwrap();
        let reach = 1.959_963_984_540_054 * fit.unit_covariance(j, j).unwrap().sqrt();
        let value = fit.values()[j];
        let known = interval(&line, &[0.0, 0.0], name, ResidualVariance::Unit).unwrap();
        let ends = [found.lower(), found.upper(), known.lower(), known.upper()];
        for (end, expected) in ends.into_iter().zip([lower, upper, value - reach, value + reach]) {
            let ProfileEnd::At(end) = end else { panic!("{name}: {end:?}") };
            // Differences are good to about 1e-10 of the slopes.
            assert!((end - expected).abs() < 1e-8, "{name}: {end} instead of {expected}");
        }
        assert!(found.points().is_sorted_by_key(|point| point.0) && found.points().len() < 12);
    }
}

/// A variance from elsewhere counts with its own degrees of freedom, and the curve of a straight line is its parabola.
#[test]
fn a_straight_line_has_a_parabola_of_any_variance() {
    let line = problem(&[FREE, FREE], 20, line);
    let options = Options::default();
    let fit = solve(&line, &[0.0, 0.0], &options).unwrap();
    let variance = ResidualVariance::Effective { variance: 0.25, degrees_of_freedom: 5.0 };
    let found = ProfileInterval::of(&line, &fit, "p1", 0.95, variance, &options).unwrap();
    let (best, unit) = (fit.values()[1], fit.unit_covariance(1, 1).unwrap());
    // Student's quantile for 5 degrees of freedom.
    let reach = 2.570_581_836 * 0.5 * unit.sqrt();
    let ends = [found.lower(), found.upper()].map(|end| end.value().unwrap());
    assert!((ends[0] - best + reach).abs() < 1e-8 && (ends[1] - best - reach).abs() < 1e-8, "{ends:?}");
    assert!((found.threshold() - 2.570_581_836_f64.powi(2)).abs() < 1e-8);
    let curve = found.curve(&line, &fit, 6, &options).unwrap();
    assert!(curve.len() == 13 && curve.is_sorted_by_key(|point| point.0));
    assert!(curve[0].0 < ends[0] && curve[12].0 > ends[1] && curve[6] == (best, 0.0));
    for (value, misfit) in curve {
        let parabola = (value - best).powi(2) / (0.25 * unit);
        assert!((misfit - parabola).abs() < 1e-6, "{misfit} instead of {parabola} at {value}");
    }
    for variance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let variance = ResidualVariance::Effective { variance, degrees_of_freedom: 5.0 };
        let refused = ProfileInterval::of(&line, &fit, "p1", 0.95, variance, &options);
        assert!(matches!(refused, Err(FitError::Undetermined { .. })), "{refused:?}");
    }
}

/// A curve ends at the bound that ends the interval, and an open side goes as far as the other.
#[test]
fn a_curve_goes_as_far_as_its_interval() {
    let readings = [0.97, 1.01, 0.98, 1.02, 0.99];
    let rise = |p: &[f64], i: usize| p[0] * (1.0 - (-p[1] * (i + 1) as f64).exp()) - readings[i];
    let options = Options::default();
    for (bounds, end) in [(FREE, None), ((0.0, 5.0), Some(5.0))] {
        let rise = problem(&[FREE, bounds], 5, rise);
        let fit = solve(&rise, &[1.0, 1.0], &options).unwrap();
        let found = ProfileInterval::of(&rise, &fit, "p1", 0.95, ResidualVariance::Estimated, &options).unwrap();
        let curve = found.curve(&rise, &fit, 5, &options).unwrap();
        let (first, last) = (curve[0], curve[10]);
        assert!(first.0 < found.lower().value().unwrap() && first.1 > found.threshold());
        assert!(last.1 < found.threshold());
        let as_far = 2.0 * fit.values()[1] - first.0;
        assert!((last.0 - end.unwrap_or(as_far)).abs() < 1e-12, "{last:?}");
    }
}

#[test]
fn a_limit_on_evaluations_holds_for_a_whole_interval() {
    let line = problem(&[FREE, FREE], 20, line);
    let fit = solve(&line, &[0.0, 0.0], &Options::default()).unwrap();
    let ask = |most: usize| {
        let options = Options::default().with_max_evaluations(most);
        ProfileInterval::of(&line, &fit, "p1", 0.95, ResidualVariance::Estimated, &options)
    };
    let all = ask(usize::MAX).unwrap().residual_evaluations();
    // Half of them end within one of the fits.
    let refused = ask(all / 2).unwrap_err();
    assert!(matches!(&refused, FitError::NoMinimum { what } if what.contains("evaluations")), "{refused}");
    assert_eq!(ask(all + 1).unwrap().residual_evaluations(), all);
}

#[test]
fn a_parameter_at_its_bound_has_a_one_sided_interval() {
    // Free, the offset would be negative by about half of its standard uncertainty.
    let bounded = problem(&[(2.3, f64::INFINITY), FREE], 20, line);
    let fit = solve(&bounded, &[3.0, 0.0], &Options::default()).unwrap();
    assert!(fit.estimates()[0].status().is_at_bound());
    let found = interval(&bounded, &[3.0, 0.0], "p0", ResidualVariance::Estimated).unwrap();
    assert_eq!(found.lower(), ProfileEnd::Bound(2.3));
    let ProfileEnd::At(upper) = found.upper() else { panic!("{:?}", found.upper()) };
    // The equation of the end, from a fit with the offset held there.
    let held = solve(&problem(&[(upper, upper), FREE], 20, line), &[upper, 0.0], &Options::default()).unwrap();
    let t = (held.sum_of_squares() - fit.sum_of_squares()).sqrt() / fit.residual_standard_deviation().unwrap();
    let nu = fit.degrees_of_freedom();
    assert_eq!(nu, 19);
    // Student's quantile for 19 degrees of freedom.
    assert!((t - 2.093_024_054).abs() < 1e-7, "t = {t}");
    // From inside, an end on the bound.
    let wide = problem(&[(1.0, 2.2), FREE], 20, line);
    let found = interval(&wide, &[2.0, 0.0], "p0", ResidualVariance::Estimated).unwrap();
    assert_eq!(found.upper(), ProfileEnd::Bound(2.2));
}

#[test]
fn ends_without_an_end_are_open_or_the_edge_of_the_model() {
    // A rise that is over at the second reading: the rate has no upper limit.
    let readings = [0.97, 1.01, 0.98, 1.02, 0.99];
    let rise = |p: &[f64], i: usize| p[0] * (1.0 - (-p[1] * (i + 1) as f64).exp()) - readings[i];
    let found = interval(&problem(&[FREE, FREE], 5, rise), &[1.0, 1.0], "p1", ResidualVariance::Estimated).unwrap();
    assert!(matches!((found.lower(), found.upper()), (ProfileEnd::At(_), ProfileEnd::Open)), "{found:?}");
    assert_eq!(found.upper().value(), None);
    // The same model with no value beyond a rate of 30/s.
    let cut = |p: &[f64], i: usize| if p[1] > 30.0 { f64::NAN } else { rise(p, i) };
    let found = interval(&problem(&[FREE, FREE], 5, cut), &[1.0, 1.0], "p1", ResidualVariance::Estimated).unwrap();
    let ProfileEnd::Edge(edge) = found.upper() else { panic!("{:?}", found.upper()) };
    assert!((edge - 30.0).abs() < 1e-6, "edge at {edge}");
    // Bounded, the bound ends it.
    let bounds = [FREE, (0.0, 50.0)];
    let found = interval(&problem(&bounds, 5, rise), &[1.0, 1.0], "p1", ResidualVariance::Estimated).unwrap();
    assert_eq!(found.upper(), ProfileEnd::Bound(50.0));
    // What nothing determines is open on both sides.
    let idle = problem(&[FREE, FREE, FREE], 20, line);
    let found = interval(&idle, &[0.0, 0.0, 1.0], "p2", ResidualVariance::Estimated).unwrap();
    assert_eq!((found.lower(), found.upper()), (ProfileEnd::Open, ProfileEnd::Open));
}

#[test]
fn a_lower_minimum_on_the_way_is_an_error_that_leads_there() {
    // Two wells, the right one with S = 0 at 1, the left one with about 0.04 near -1.
    let wells = problem(&[FREE], 2, |p, i| if i == 0 { p[0] * p[0] - 1.0 } else { 0.1 * (p[0] - 1.0) });
    let fit = solve(&wells, &[-2.0], &Options::default()).unwrap();
    assert!((fit.sum_of_squares() - 0.04).abs() < 1e-3, "S = {}", fit.sum_of_squares());
    let found = ProfileInterval::of(&wells, &fit, "p0", 0.95, ResidualVariance::Unit, &Options::default());
    let Err(FitError::LowerMinimum { values, lower, .. }) = found else { panic!("{found:?}") };
    assert!((values[0] - 1.0).abs() < 1e-9 && lower < 1e-18, "{values:?}");
    // From there the two wells are one interval.
    let fit = solve(&wells, &values, &Options::default()).unwrap();
    let found = ProfileInterval::of(&wells, &fit, "p0", 0.95, ResidualVariance::Unit, &Options::default()).unwrap();
    for (end, sign) in [(found.lower(), -1.0), (found.upper(), 1.0)] {
        let at = end.value().unwrap();
        let square = (at * at - 1.0).powi(2) + 0.01 * (at - 1.0).powi(2);
        assert!((square.sqrt() - 1.959_963_984_540_054).abs() < 1e-8 && at * sign > 1.5, "end at {at}");
    }
}

#[test]
fn what_is_no_question_for_a_profile_is_refused() {
    let options = Options::default();
    let variance = ResidualVariance::Estimated;
    let straight = problem(&[FREE, FREE], 20, line);
    let fit = solve(&straight, &[0.0, 0.0], &options).unwrap();
    let ask =
        |name: &str, level: f64| ProfileInterval::of(&straight, &fit, name, level, variance, &options).unwrap_err();
    assert_eq!(ask("mass", 0.95).to_string(), "there is no parameter called mass");
    assert!(matches!(ask("p0", 1.0), FitError::OutOfRange { .. }));
    assert!(matches!(ask("p0", f64::NAN), FitError::OutOfRange { .. }));
    let fixed = problem(&[(2.0, 2.0), FREE], 20, line);
    assert!(matches!(interval(&fixed, &[2.0, 0.0], "p0", variance), Err(FitError::Problem { .. })));
    let other = problem(&[FREE, FREE], 19, line);
    let refused = ProfileInterval::of(&other, &fit, "p0", 0.95, variance, &options);
    assert!(matches!(refused, Err(FitError::OtherFit { .. })));
    let exact = problem(&[FREE, FREE], 2, line);
    assert!(matches!(interval(&exact, &[0.0, 0.0], "p0", variance), Err(FitError::Undetermined { .. })));
    let stopped = solve(&straight, &[0.0, 0.0], &Options::default().with_max_iterations(0)).unwrap();
    let refused = ProfileInterval::of(&straight, &stopped, "p0", 0.95, variance, &options);
    assert!(matches!(&refused, Err(FitError::NoMinimum { what }) if what.contains("not at a minimum")));
    let refused =
        ProfileInterval::of(&straight, &fit, "p0", 0.95, variance, &Options::default().with_max_iterations(0));
    assert!(matches!(&refused, Err(FitError::NoMinimum { what }) if what.contains("fixed at")), "{refused:?}");
}

#[test]
fn a_limit_on_time_holds_for_all_of_a_search() {
    let calls = AtomicUsize::new(0);
    let slow = problem(&[FREE, FREE], 2, |p, i| {
        calls.fetch_add(1, Ordering::Relaxed);
        std::thread::sleep(std::time::Duration::from_millis(1));
        freudenstein_roth(p, i)
    });
    let options = Options::default().with_time_limit(std::time::Duration::from_millis(100));
    let search = MultiStart::around(slow.parameters(), &[0.5, -2.0], 7, 0).with_options(options);
    assert_eq!(search.solve(&slow).unwrap().outcome(), Outcome::TimedOut);
    // Without the limit all fits take some 200 ms; one step of each may run over it.
    assert!(calls.load(Ordering::Relaxed) < 1000, "{calls:?} calls");
}

/// The lower of two minima is found, and with far fewer steps than all fits take: those that lead to the higher one are
/// given up.
#[test]
fn of_several_starts_the_best_is_finished() {
    let problem = problem(&[FREE, FREE], 2, freudenstein_roth);
    let starts: Vec<Vec<f64>> = (0..8).map(|i| vec![3.0 * f64::from(i) - 4.0, 1.5 * f64::from(i) - 5.0]).collect();
    let mut steps = 0;
    let mut count = |_: &Minimizer| {
        steps += 1;
        ControlFlow::Continue(())
    };
    let best = MultiStart::from_starts(starts.clone()).solve_observed(&problem, &mut count).unwrap();
    assert!((best.values()[0] - 5.0).abs() < 1e-9 && (best.values()[1] - 4.0).abs() < 1e-9, "{:?}", best.values());
    let mut all = 0;
    for start in &starts {
        let count = |_: &Minimizer| {
            all += 1;
            ControlFlow::Continue(())
        };
        solve_observed(&problem, start, &Options::default(), count).unwrap();
    }
    assert!(2 * steps < all, "{steps} steps in place of {all}");
    assert!(matches!(MultiStart::from_starts(vec![]).solve(&problem), Err(FitError::NotStarted)));
}

/// At first the fit that leads to the lower minimum is far behind the one that is at the other: half of the fits are
/// given up, no more.
#[test]
fn a_fit_of_the_better_half_may_overtake_the_best() {
    let problem = problem(&[FREE, FREE], 2, freudenstein_roth);
    let starts = [vec![5.0, 60.0], vec![5.0, 600.0], vec![5.0, 2000.0], vec![11.4, -0.9]];
    let best = MultiStart::from_starts(starts.to_vec()).solve(&problem).unwrap();
    assert!((best.values()[0] - 5.0).abs() < 1e-9 && (best.values()[1] - 4.0).abs() < 1e-9, "{:?}", best.values());
}

/// Fits that have come to the same place by the first comparison, after six steps, are one from there on.
#[test]
fn fits_that_meet_go_on_as_one() {
    let noisy = problem(&[FREE, FREE, FREE], 101, |p, i| {
        let t = 0.1 * i as f64;
        p[1] * (p[0] * t).cos() + p[2] * (p[0] * t).sin() - (3.0 * t + 0.4).sin() - 0.01 * ((i * 37 % 11) as f64 - 5.0)
    });
    let steps_from = |starts: &[Vec<f64>]| {
        let mut steps = 0;
        let count = |_: &Minimizer| {
            steps += 1;
            ControlFlow::Continue(())
        };
        MultiStart::from_starts(starts.to_vec()).solve_observed(&noisy, count).unwrap();
        steps
    };
    let start = vec![2.8, 1.0, 1.0];
    let alone = steps_from(std::slice::from_ref(&start));
    assert!(alone > 6, "{alone} steps say nothing");
    assert_eq!(steps_from(&vec![start; 4]), alone + 3 * 6);
}

/// Three fits of five are at the higher minimum at first. One of them goes on, and so does the last, which leads to the
/// lower one.
#[test]
fn the_room_of_fits_that_meet_goes_to_others() {
    let problem = problem(&[FREE, FREE], 2, freudenstein_roth);
    let mut starts = vec![vec![11.412_779, -0.896_805]; 3];
    starts.extend([vec![-50.0, -5.0], vec![5.0, 2000.0]]);
    let best = MultiStart::from_starts(starts.clone()).solve(&problem).unwrap();
    assert!((best.values()[0] - 5.0).abs() < 1e-9 && (best.values()[1] - 4.0).abs() < 1e-9, "{:?}", best.values());
}

/// An observer that breaks ends all fits, and the best so far is given.
#[test]
fn an_observer_ends_all_fits() {
    let problem = problem(&[FREE, FREE], 2, freudenstein_roth);
    let starts = [vec![0.5, -2.0], vec![6.0, 5.0], vec![20.0, 20.0]];
    let mut steps = 0;
    let few = |_: &Minimizer| {
        steps += 1;
        if steps < 8 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let best = MultiStart::from_starts(starts.to_vec()).solve_observed(&problem, few).unwrap();
    assert_eq!(steps, 8);
    let at = |start: &[f64]| freudenstein_roth(start, 0).powi(2) + freudenstein_roth(start, 1).powi(2);
    assert!(starts.iter().all(|start| best.sum_of_squares() <= at(start)));
}
