//! Fits in which something is wrong, missing or asked to stop.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use fmm_fit::{
    Derivatives, EstimateStatus, EvaluationError, FTest, FitError, Minimizer, NonFinite, Options, Outcome, Residuals,
    solve, solve_observed,
};
use fmm_model::{Bounds, Parameter};
use statrs::distribution::{ContinuousCDF, StudentsT};

pub(crate) type Value = Result<f64, EvaluationError>;

/// Residuals from a closure of the parameters and the index.
pub(crate) struct Problem<F> {
    parameters: Vec<Parameter>,
    count: usize,
    residual: F,
}

impl<F: Fn(&[f64], usize) -> Value> Residuals for Problem<F> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.count
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        for (i, r) in residuals.iter_mut().enumerate() {
            *r = (self.residual)(p, i)?;
        }
        Ok(())
    }
}

pub(crate) fn problem(
    bounds: &[(f64, f64)],
    count: usize,
    residual: impl Fn(&[f64], usize) -> f64,
) -> Problem<impl Fn(&[f64], usize) -> Value> {
    fallible(bounds, count, move |p: &[f64], i| Ok(residual(p, i)))
}

pub(crate) fn fallible<F: Fn(&[f64], usize) -> Value>(bounds: &[(f64, f64)], count: usize, residual: F) -> Problem<F> {
    let name = |(j, (lower, upper)): (usize, &(f64, f64))| {
        Parameter::named(format!("p{j}"), format!("p{j}"), "1").bounded(Bounds::new(*lower, *upper).unwrap())
    };
    let parameters = bounds.iter().enumerate().map(name).collect();
    Problem { parameters, count, residual }
}

pub(crate) const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// A decay with a little deterministic scatter.
pub(crate) fn decay(p: &[f64], i: usize) -> f64 {
    let t = 0.1 * i as f64;
    p[0] * (-p[1] * t).exp() - 2.0 * (-0.7 * t).exp() - 0.01 * ((i * 37 % 11) as f64 - 5.0)
}

pub(crate) fn rosenbrock(p: &[f64], i: usize) -> f64 {
    if i == 0 { 10.0 * (p[1] - p[0] * p[0]) } else { 1.0 - p[0] }
}

#[test]
fn a_bad_start_is_refused_by_name() {
    let decay = problem(&[(0.0, 10.0), FREE], 50, decay);
    let message = |start: &[f64]| solve(&decay, start, &Options::default()).unwrap_err().to_string();
    assert_eq!(message(&[1.0]), "the start has 1 values, but the problem has 2 parameters");
    assert_eq!(message(&[-1.0, 1.0]), "the start value of p0 is -1, outside its bounds [0, 10]");
    assert_eq!(message(&[1.0, f64::NAN]), "the start value of p1 must be finite, but is NaN");
    assert_eq!(message(&[1.0, -1e4]), "residual 1 is inf at the start, so that the sum of squares is not finite");
    let few = problem(&[FREE; 3], 2, |p, _| p[0]);
    let error = solve(&few, &[1.0; 3], &Options::default()).unwrap_err();
    assert!(matches!(error, FitError::Undetermined { .. }));
    assert_eq!(error.to_string(), "2 residuals cannot determine 3 free parameters; give at least as many residuals");
    let broken = fallible(&[FREE], 2, |_, _| Err(EvaluationError::message("no record")));
    let error = solve(&broken, &[1.0], &Options::default()).unwrap_err();
    assert_eq!(error.to_string(), "the model failed at the start: no record");
    let options = Options::default().with_cost_tolerance(f64::NAN);
    assert!(matches!(solve(&decay, &[1.0, 1.0], &options), Err(FitError::OutOfRange { .. })));
    assert!(matches!(Minimizer::default().fit(), Err(FitError::NotStarted)));
}

#[test]
fn a_region_without_values_is_avoided() {
    // The first full step from the start goes far into the region where the model has no value.
    for has_error in [false, true] {
        let guarded = fallible(&[FREE, FREE], 50, move |p: &[f64], i| {
            if p[1] < 1.5 {
                Ok(decay(p, i))
            } else if has_error {
                Err(EvaluationError::message("rate too large"))
            } else {
                Ok(f64::NAN)
            }
        });
        let fit = solve(&guarded, &[0.2, 1.4], &Options::default()).unwrap();
        assert!(fit.outcome().is_success(), "{}", fit.outcome());
        assert!((fit.values()[1] - 0.7).abs() < 0.02, "rate {}", fit.values()[1]);
    }
    // Here the minimum itself is out of reach.
    let cut = problem(&[FREE], 3, |p, _| if p[0] < 1.0 { f64::NAN } else { p[0] });
    let fit = solve(&cut, &[2.0], &Options::default()).unwrap();
    assert_eq!(fit.outcome(), Outcome::NonFinite);
    assert!((fit.values()[0] - 1.0).abs() < 1e-6, "value {}", fit.values()[0]);
    assert!(matches!(fit.non_finite(), Some(NonFinite::Residual { index: 0, value }) if value.is_nan()));
    assert!(
        fit.to_string().contains("some trial points had no finite value; at the last of them residual 0 is NaN"),
        "{fit}"
    );
}

/// A decay whose derivative by the rate, or one of whose residuals, has no value beyond a rate of `edge`.
struct Edged {
    edge: f64,
    is_derivative: bool,
    is_combined: bool,
    parameters: [Parameter; 2],
}

impl Residuals for Edged {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        50
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        residuals.iter_mut().enumerate().for_each(|(i, r)| *r = decay(p, i));
        if !self.is_derivative && p[1] > self.edge {
            residuals[17] = f64::INFINITY;
        }
        if let Some(jacobian) = jacobian {
            for i in 0..50 {
                let t = 0.1 * i as f64;
                jacobian[i] = (-p[1] * t).exp();
                jacobian[50 + i] = -t * p[0] * jacobian[i];
            }
            if self.is_derivative && p[1] > self.edge {
                jacobian[50 + 17] = f64::NAN;
            }
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
    fn is_cheaper_combined(&self) -> bool {
        self.is_combined
    }
}

#[test]
fn what_is_not_finite_neither_ends_nor_spoils_a_fit_and_is_named_if_it_stays() {
    for (is_derivative, is_combined) in [(false, false), (false, true), (true, false), (true, true)] {
        let parameters = [Parameter::new("amplitude", "a", "1"), Parameter::new("rate", "b", "1/s")];
        let mut problem = Edged { edge: 1.5, is_derivative, is_combined, parameters };
        // The first full step leads beyond the edge.
        let fit = solve(&problem, &[0.2, 1.4], &Options::default()).unwrap();
        assert!(fit.outcome().is_success(), "{}", fit.outcome());
        assert!((fit.values()[1] - 0.7).abs() < 0.02, "rate {}", fit.values()[1]);
        assert!(fit.estimates().iter().all(|estimate| estimate.standard_uncertainty().unwrap() > 0.0));

        // The minimum itself is beyond it.
        problem.edge = 0.5;
        let fit = solve(&problem, &[2.0, 0.3], &Options::default()).unwrap();
        assert_eq!(fit.outcome(), Outcome::NonFinite);
        assert!(fit.values()[1] <= 0.5 && fit.sum_of_squares().is_finite());
        match fit.non_finite().unwrap() {
            NonFinite::Residual { index, value } => assert!(!is_derivative && (*index, *value) == (17, f64::INFINITY)),
            NonFinite::Derivative { parameter } => assert!(is_derivative && parameter == "rate"),
            other => panic!("{other:?}"),
        }
        let (named, report) = (fit.non_finite().unwrap().to_string(), fit.to_string());
        assert!(report.contains(&named), "{report}");

        // At the start it is an error with the same name.
        let error = solve(&problem, &[2.0, 0.6], &Options::default()).unwrap_err();
        assert!(error.to_string().contains(if is_derivative { "by rate" } else { "residual 17 is inf" }), "{error}");
    }
}

#[test]
fn limits_and_flags_end_a_fit_with_its_best_point() {
    let rosenbrock = problem(&[FREE, FREE], 2, rosenbrock);
    let start = [-1.2, 1.0];
    let run = |options: Options| solve(&rosenbrock, &start, &options).unwrap();
    let fit = run(Options::default().with_max_iterations(5));
    assert_eq!((fit.outcome(), fit.iterations()), (Outcome::MaxIterations, 5));
    assert!(fit.sum_of_squares() < 24.2, "S = {}", fit.sum_of_squares());
    assert_eq!(run(Options::default().with_max_evaluations(10)).outcome(), Outcome::MaxEvaluations);
    assert_eq!(run(Options::default().with_time_limit(Duration::ZERO)).outcome(), Outcome::TimedOut);
    let flag = Arc::new(AtomicBool::new(true));
    assert_eq!(run(Options::default().with_cancel_flag(flag)).outcome(), Outcome::Cancelled);

    let steps = Cell::new(0);
    let fit = solve_observed(&rosenbrock, &start, &Options::default(), |progress| {
        steps.set(steps.get() + 1);
        assert_eq!(progress.iterations(), steps.get());
        assert_eq!(progress.values().len(), 2);
        if steps.get() == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
    .unwrap();
    assert_eq!((fit.outcome(), fit.iterations()), (Outcome::Cancelled, 3));
}

#[test]
fn fixed_parameters_stay_and_cost_nothing() {
    let half = problem(&[FREE, (0.5, 0.5)], 50, decay);
    let fit = solve(&half, &[1.0, 0.5], &Options::default()).unwrap();
    assert_eq!(fit.values()[1], 0.5);
    assert_eq!(fit.estimates()[1].status(), EstimateStatus::Fixed);
    assert_eq!((fit.free_count(), fit.rank(), fit.degrees_of_freedom()), (1, 1, 49));
    assert_eq!((fit.covariance(0, 1), fit.estimates()[1].standard_uncertainty()), (None, None));

    let none = problem(&[(2.0, 2.0), (0.7, 0.7)], 50, decay);
    let fit = solve(&none, &[2.0, 0.7], &Options::default()).unwrap();
    assert_eq!((fit.outcome(), fit.residual_evaluations()), (Outcome::NoFreeParameters, 1));
    assert!(fit.outcome().is_success() && fit.sum_of_squares() > 0.0);
}

#[test]
fn a_discontinuous_model_does_not_pretend_to_converge() {
    // A staircase with tread 0.01: its differences see no slope, or a false one near a step.
    let sawtooth = problem(&[(-10.0, 10.0)], 3, |p, i| {
        let x = p[0] + i as f64;
        x + 0.2 * (x * 100.0).fract() + 5.0
    });
    let fit = solve(&sawtooth, &[3.123], &Options::default()).unwrap();
    assert_eq!(fit.outcome(), Outcome::Stalled);
    assert!(fit.sum_of_squares() < 3.0 * 10.0f64.powi(2), "the best point is kept");
}

#[test]
fn a_parameter_without_influence_is_named() {
    let idle = problem(&[FREE, FREE, FREE], 50, decay);
    let fit = solve(&idle, &[1.0, 1.0, 0.0], &Options::default()).unwrap();
    assert_eq!((fit.rank(), fit.null_directions().len()), (2, 1));
    assert_eq!(fit.null_directions()[0].to_string(), "p2 has no influence on the residuals");
    assert_eq!(fit.values()[2], 0.0, "a value that nothing determines stays");
    let report = fit.to_string();
    assert!(report.contains("not determined") && report.contains("[[warnings]]"), "{report}");

    let product = problem(&[FREE, FREE, FREE], 50, |p, i| decay(&[p[0] * p[1], p[2]], i));
    let fit = solve(&product, &[2.0, 0.5, 1.0], &Options::default()).unwrap();
    let text = fit.null_directions()[0].to_string();
    assert!(text.ends_with("only their product is determined"), "{text}");
}

/// The combination on which the residuals depend is named as far as one point shows it.
#[test]
fn what_is_determined_is_named_as_it_is() {
    let named = |start: &[f64], combined: fn(f64, f64) -> f64| {
        let pair = problem(&[FREE, FREE, FREE], 50, move |p, i| decay(&[combined(p[0], p[1]), p[2]], i));
        let fit = solve(&pair, start, &Options::default()).unwrap();
        assert!(fit.outcome().is_success() && fit.null_directions().len() == 1);
        fit.null_directions()[0].to_string()
    };
    let of_one_size = named(&[1.0, 1.0, 1.0], |a, b| a + b);
    assert!(of_one_size.ends_with("only their product or their sum is determined"), "{of_one_size}");
    let of_one_size = named(&[1.0, 1.0, 1.0], |a, b| a * b);
    assert!(of_one_size.ends_with("only their product or their sum is determined"), "{of_one_size}");
    let sum = named(&[1.5, 0.3, 1.0], |a, b| a + b);
    assert_eq!(
        sum,
        "p0 can grow by as much as p1 shrinks without changing the residuals; only their sum is determined"
    );
    let product = named(&[2.0, 0.5, 1.0], |a, b| a * b);
    assert_eq!(product, "p0 can grow as p1 shrinks without changing the residuals; only their product is determined");
    let ratio = named(&[2.0, 0.5, 1.0], |a, b| a / b);
    assert!(ratio.ends_with("can be scaled together without changing the residuals; only their ratios are determined"));
    let difference = named(&[3.0, 0.5, 1.0], |a, b| a - b);
    assert!(difference.ends_with("only their differences are determined"), "{difference}");
}

#[test]
fn messages_have_no_rows_of_zeros() {
    let positive = problem(&[(f64::MIN_POSITIVE, 1.0)], 2, |p, _| p[0]);
    let message = |start: f64| solve(&positive, &[start], &Options::default()).unwrap_err().to_string();
    assert_eq!(message(1e300), "the start value of p0 is 1e300, outside its bounds [2.2250738585072014e-308, 1]");
    let huge = problem(&[FREE], 2, |p, _| p[0]);
    let message = solve(&huge, &[-1e290], &Options::default()).unwrap_err().to_string();
    assert_eq!(message, "residual 0 is -1e290 at the start, so that the sum of squares is not finite");
}

#[test]
fn parameters_that_cannot_be_are_refused_by_name() {
    let refused = |parameters: [Parameter; 2]| {
        let pair =
            Problem { parameters: parameters.to_vec(), count: 3, residual: |p: &[f64], i| Ok(p[0] + p[1] * i as f64) };
        solve(&pair, &[2.0, 2.0], &Options::default()).unwrap_err().to_string()
    };
    let free = |name: &'static str| Parameter::new(name, name, "1");
    assert_eq!(
        refused([free("a"), free("b").bounded(Bounds::UNBOUNDED.at_least(3.0).at_most(1.0))]),
        "the bounds of b exclude each other: at least 3 and at most 1"
    );
    assert_eq!(refused([free("a"), free("a")]), "two parameters are called a; give each a name of its own");
}

#[test]
fn a_further_parameter_is_tested() {
    let offset = |p: &[f64], i: usize| decay(p, i) + p[2];
    let full = solve(&problem(&[FREE; 3], 50, offset), &[1.0, 1.0, 0.1], &Options::default()).unwrap();
    let restricted =
        solve(&problem(&[FREE, FREE, (0.0, 0.0)], 50, offset), &[1.0, 1.0, 0.0], &Options::default()).unwrap();
    let test = FTest::of(&restricted, &full).unwrap();
    assert_eq!(test.degrees_of_freedom, (1, 47));
    // For one parameter F is nearly the square of Student's t; the model is not quite linear.
    let estimate = &full.estimates()[2];
    let t = estimate.value() / estimate.standard_uncertainty().unwrap();
    assert!((test.f / (t * t) - 1.0).abs() < 0.05, "F = {}, t² = {}", test.f, t * t);
    // The probability of F(1, ν) is the two-sided one of Student's t at √F.
    let student = StudentsT::new(0.0, 1.0, 47.0).unwrap();
    let expected = 2.0 * student.sf(test.f.sqrt());
    assert!((test.p_value / expected - 1.0).abs() < 1e-9, "p = {} instead of {expected}", test.p_value);
    assert!(restricted.corrected_akaike().unwrap().is_finite());
    assert!(matches!(FTest::of(&full, &restricted), Err(FitError::Undetermined { .. })));
}

/// A fit that had converged stays so, however early it is told to stop sharpening.
#[test]
fn a_limit_within_the_sharpening_is_no_failure() {
    let decay = problem(&[FREE; 2], 50, decay);
    let start = [0.2, 1.4];
    let whole = solve(&decay, &start, &Options::default()).unwrap();
    let limited = |steps| solve(&decay, &start, &Options::default().with_max_iterations(steps)).unwrap();
    let outcomes: Vec<Outcome> = (1..=whole.iterations()).map(|steps| limited(steps).outcome()).collect();
    let converged = outcomes.iter().position(|outcome| outcome.is_success()).unwrap();
    assert!(outcomes[..converged].iter().all(|outcome| *outcome == Outcome::MaxIterations), "{outcomes:?}");
    assert!(outcomes[converged..].iter().all(|outcome| outcome.is_success()), "{outcomes:?}");
    assert!(converged + 1 < outcomes.len(), "nothing was sharpened: {outcomes:?}");
}

/// Derivatives that know nothing of the ripples let every search end in another of them.
struct Rippled([Parameter; 2]);

impl Residuals for Rippled {
    fn parameters(&self) -> &[Parameter] {
        &self.0
    }
    fn len(&self) -> usize {
        3
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let ripple = |x: f64| 0.4 * (40.0 * x).sin();
        residuals.copy_from_slice(&[p[0] - 3.0 + ripple(p[1]), p[1] + 2.0 + ripple(p[0]), 0.1 * p[0] * p[1] + 2.0]);
        if let Some(jacobian) = jacobian {
            jacobian.copy_from_slice(&[1.0, 0.0, 0.1 * p[1], 0.0, 1.0, 0.1 * p[0]]);
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}

/// Whichever search was the best, values, residuals and their squares belong together.
#[test]
fn the_best_of_several_searches_is_given_whole() {
    let problem = Rippled([Parameter::new("x", "x", "1"), Parameter::new("y", "y", "1")]);
    let mut stalled = 0;
    for start in (0..60).map(|i| [f64::from(i % 10) - 4.3, f64::from(i / 10) - 2.7]) {
        let fit = solve(&problem, &start, &Options::default()).unwrap();
        stalled += usize::from(fit.outcome() == Outcome::Stalled);
        let mut residuals = [0.0; 3];
        problem.evaluate(fit.values(), &mut residuals, None).unwrap();
        assert_eq!(fit.residuals(), residuals, "from {start:?}");
        let sum: f64 = residuals.iter().map(|r| r * r).sum();
        assert!((fit.sum_of_squares() / sum - 1.0).abs() < 1e-15, "{} and {sum}", fit.sum_of_squares());
    }
    assert!(stalled > 30, "{stalled} of 60 stalled");
}

/// A minimum that a domain cuts off by less than can be told is one.
#[test]
fn a_minimum_at_the_edge_of_the_domain_is_found() {
    let cut = problem(&[FREE], 2, |p, i| match i {
        0 if p[0] > 1.0 => f64::NAN,
        0 => p[0] - 1.000_01,
        _ => 1.0,
    });
    for start in [0.5, 1.0] {
        let fit = solve(&cut, &[start], &Options::default()).unwrap();
        assert!(fit.outcome().is_success(), "from {start}: {}", fit.outcome());
        assert!((fit.values()[0] - 1.0).abs() < 1e-4, "{:?}", fit.values());
    }
}
