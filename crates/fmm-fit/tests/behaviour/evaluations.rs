//! Evaluations of a fit: equal digits however it is called, by itself or by argmin, and their number.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use argmin::core::observers::{Observe, ObserverMode};
use argmin::core::{Executor, KV, State};
use fmm_fit::{BoundedLevenbergMarquardt, Derivatives, EvaluationError, Minimizer, Options, Outcome, Residuals, solve};
use fmm_model::Parameter;

use crate::solver::{FREE, decay, problem, rosenbrock};

/// Counts the calls that argmin makes.
struct Count(Arc<AtomicUsize>);

impl<I: State> Observe<I> for Count {
    fn observe_iter(&mut self, _state: &I, kv: &KV) -> Result<(), argmin::core::Error> {
        assert!(kv.get("radius").is_some());
        self.0.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }
}

#[test]
fn equal_input_gives_equal_bits_also_in_used_buffers() {
    let decay = problem(&[FREE, (0.0, 5.0)], 3000, |p, i| decay(p, i % 80));
    let rosenbrock = problem(&[FREE, FREE], 2, rosenbrock);
    let fit = solve(&decay, &[1.0, 2.0], &Options::default()).unwrap();
    let mut minimizer = Minimizer::new(Options::default());
    for _ in 0..2 {
        minimizer.minimize(&rosenbrock, &[-1.2, 1.0]).unwrap();
        minimizer.minimize(&decay, &[1.0, 2.0]).unwrap();
        assert_eq!(minimizer.values(), fit.values());
        assert_eq!(minimizer.residual_evaluations(), fit.residual_evaluations());
        assert_eq!(minimizer.fit().unwrap().to_string(), fit.to_string());
    }
}

#[test]
fn a_combined_evaluation_changes_nothing_but_the_calls() {
    struct Counted<'a>(&'a [Parameter], bool, Cell<usize>);
    impl Residuals for Counted<'_> {
        fn parameters(&self) -> &[Parameter] {
            self.0
        }
        fn len(&self) -> usize {
            2
        }
        fn evaluate(
            &self,
            p: &[f64],
            residuals: &mut [f64],
            jacobian: Option<&mut [f64]>,
        ) -> Result<(), EvaluationError> {
            self.2.set(self.2.get() + 1);
            residuals.copy_from_slice(&[10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]);
            if let Some(jacobian) = jacobian {
                jacobian.copy_from_slice(&[-20.0 * p[0], -1.0, 10.0, 0.0]);
            }
            Ok(())
        }
        fn derivatives(&self) -> Derivatives {
            Derivatives::Free
        }
        fn is_cheaper_combined(&self) -> bool {
            self.1
        }
    }
    let parameters = [Parameter::new("x", "x", "1"), Parameter::new("y", "y", "1")];
    let fits = [false, true].map(|is_combined| {
        let problem = Counted(&parameters, is_combined, Cell::new(0));
        let fit = solve(&problem, &[-1.2, 1.0], &Options::default().with_jacobian_check(false)).unwrap();
        // Derivatives by themselves bring residuals along, which do not count.
        let apart = if is_combined { 0 } else { fit.jacobian_evaluations() };
        assert_eq!(problem.2.get(), fit.residual_evaluations() + apart);
        assert!(fit.has_exact_jacobian());
        fit
    });
    assert_eq!(fits[0].values(), fits[1].values());
    assert_eq!(fits[0].residual_evaluations(), fits[1].residual_evaluations());
}

#[test]
fn argmin_runs_the_same_iterations() {
    let direct = solve(&problem(&[FREE, FREE], 2, rosenbrock), &[-1.2, 1.0], &Options::default()).unwrap();
    let count = Arc::new(AtomicUsize::new(0));
    let solver = BoundedLevenbergMarquardt::new(Options::default());
    let result = Executor::new(problem(&[FREE, FREE], 2, rosenbrock), solver)
        .configure(|state| state.param(vec![-1.2, 1.0]).max_iters(500))
        .add_observer(Count(count.clone()), ObserverMode::Always)
        .run()
        .unwrap();
    let fit = result.solver.fit().unwrap();
    assert_eq!(fit.values(), direct.values());
    assert_eq!(fit.outcome(), direct.outcome());
    assert_eq!(count.load(Ordering::Relaxed), direct.iterations());
    assert_eq!(result.state.get_best_param().unwrap().as_slice(), direct.values());

    let solver = BoundedLevenbergMarquardt::new(Options::default());
    let result = Executor::new(problem(&[FREE, FREE], 2, rosenbrock), solver)
        .configure(|state| state.param(vec![-1.2, 1.0]).max_iters(4))
        .run()
        .unwrap();
    assert_eq!(result.solver.outcome(), None);
    let fit = result.solver.fit().unwrap();
    assert_eq!((fit.outcome(), fit.iterations()), (Outcome::Cancelled, 4));

    let solver = BoundedLevenbergMarquardt::new(Options::default());
    let refused = Executor::new(problem(&[(0.0, 1.0), FREE], 2, rosenbrock), solver)
        .configure(|state| state.param(vec![-1.2, 1.0]))
        .run();
    let message = refused.err().unwrap().to_string();
    assert_eq!(message, "the start value of p0 is -1.2, outside its bounds [0, 1]");
}

/// The best point and the cost that argmin holds are those that the fit gives.
#[test]
fn argmin_has_the_same_result_and_counts() {
    for start in (0..40).map(|i| [0.5 + 0.05 * f64::from(i), 1.2 - 0.02 * f64::from(i)]) {
        let solver = BoundedLevenbergMarquardt::new(Options::default());
        let result = Executor::new(problem(&[FREE, FREE], 50, decay), solver)
            .configure(|state| state.param(start.to_vec()).max_iters(500).counting(true))
            .run()
            .unwrap();
        let fit = result.solver.fit().unwrap();
        assert_eq!(result.state.get_best_param().unwrap().as_slice(), fit.values(), "from {start:?}");
        assert_eq!(result.state.get_best_cost(), fit.sum_of_squares());
        let counts = result.state.get_func_counts();
        assert_eq!(counts["residuals_count"], fit.residual_evaluations() as u64);
        assert_eq!(counts["jacobian_count"], fit.jacobian_evaluations() as u64);
    }
}

#[test]
fn many_residuals_need_one_jacobian_and_a_few_vectors() {
    // Two hundred thousand rows go through the factor in blocks.
    let tall = problem(&[FREE, FREE], 200_000, |p, i| decay(p, i % 50));
    let fit = solve(&tall, &[1.0, 1.0], &Options::default()).unwrap();
    let small = solve(&problem(&[FREE, FREE], 50, decay), &[1.0, 1.0], &Options::default()).unwrap();
    for j in 0..2 {
        // The same data 4000 times: the same values to the accuracy of differences, uncertainties 1/√4000.
        let difference = fit.values()[j] / small.values()[j] - 1.0;
        assert!(difference.abs() < 1e-9, "values differ by {difference}");
        let uncertainty = |fit: &fmm_fit::Fit| fit.estimates()[j].standard_uncertainty().unwrap();
        let ratio = uncertainty(&small) / uncertainty(&fit) / (199_998.0f64 / 48.0).sqrt();
        assert!((ratio - 1.0).abs() < 1e-6, "ratio {ratio}");
    }
}
