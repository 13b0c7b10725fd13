//! Bounded Levenberg–Marquardt method as a solver of argmin.

use argmin::core::{Error, IterState, KV, Problem, Solver, State, TerminationReason};

use crate::error::FitError;
use crate::problem::residuals::Residuals;
use crate::result::fit::Fit;
use crate::solver::minimizer::{Minimizer, Phase};
use crate::solver::options::Options;
use crate::solver::outcome::Outcome;

/// Names in argmin of the evaluations of residuals and of the Jacobian by the problem itself.
const RESIDUALS: &str = "residuals_count";
const JACOBIANS: &str = "jacobian_count";

/// The bounded Levenberg–Marquardt method as an [`argmin::core::Solver`] for every [`Residuals`] problem, without
/// any argmin-math type: observers, timeouts, Ctrl-C and iteration limits of the executor come with it.
///
/// The cost that argmin sees is the sum of squares, its counts `residuals_count` and `jacobian_count` are those of the
/// [`Fit`]. What argmin cannot express stays here:
/// [`outcome`](Self::outcome) and, with uncertainties and rank, [`fit`](Self::fit). A model that fails at a trial
/// point is not an error, and a cancelled run keeps its best point.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use argmin::core::observers::{Observe, ObserverMode};
/// use argmin::core::{Error, Executor, IterState, KV, State};
/// use fmm_fit::{BoundedLevenbergMarquardt, Options, Residuals};
/// use fmm_model::Parameter;
///
/// # struct Rosenbrock([Parameter; 2]);
/// # impl Residuals for Rosenbrock {
/// #     fn parameters(&self) -> &[Parameter] { &self.0 }
/// #     fn len(&self) -> usize { 2 }
/// #     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
/// #         residuals.copy_from_slice(&[10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]);
/// #         Ok(())
/// #     }
/// # }
/// struct Print;
/// impl<I: State> Observe<I> for Print {
///     fn observe_iter(&mut self, state: &I, _kv: &KV) -> Result<(), Error> {
///         println!("{}", state.get_iter());
///         Ok(())
///     }
/// }
///
/// let problem = Rosenbrock([Parameter::new("x", "x", "1"), Parameter::new("y", "y", "1")]);
/// let solver = BoundedLevenbergMarquardt::new(Options::default());
/// let result = Executor::new(problem, solver)
///     .configure(|state| state.param(vec![-1.2, 1.0]).max_iters(200))
///     .add_observer(Print, ObserverMode::Always)
///     .run()?;
/// let fit = result.solver.fit()?;
/// assert!(fit.outcome().is_success());
/// assert!((fit.values()[1] - 1.0).abs() < 1e-9);
/// # Ok::<(), argmin::core::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct BoundedLevenbergMarquardt {
    minimizer: Minimizer,
}

impl BoundedLevenbergMarquardt {
    /// A solver with the given options. Their limits hold beside those of the executor.
    pub fn new(options: Options) -> Self {
        Self { minimizer: Minimizer::new(options) }
    }

    /// The end of the fit; `None` if the executor stopped it.
    pub fn outcome(&self) -> Option<Outcome> {
        self.minimizer.outcome()
    }

    /// The result with uncertainties and rank; of a run that the executor stopped, at the values of its last
    /// iteration and as [`Outcome::Cancelled`].
    ///
    /// # Errors
    /// [`FitError::NotStarted`] before a run.
    pub fn fit(&self) -> Result<Fit, FitError> {
        self.minimizer.fit()
    }

    /// Tells argmin where the fit is and what it has cost.
    ///
    /// The points of the sharpening are the best ones though their sum of squares may be larger in its last digits, so
    /// that argmin, which compares these, gets them as such.
    fn report<O>(&self, mut state: FitState, problem: &mut Problem<O>) -> FitState {
        let minimizer = &self.minimizer;
        problem.counts.insert(RESIDUALS, minimizer.residual_evaluations() as u64);
        problem.counts.insert(JACOBIANS, minimizer.jacobian_evaluations() as u64);
        if matches!(minimizer.phase, Phase::Polish { .. } | Phase::Done(_)) {
            state.best_param = Some(minimizer.values().to_vec());
            state.best_cost = minimizer.sum_of_squares();
            state.last_best_iter = state.iter;
        }
        state.param(minimizer.values().to_vec()).cost(minimizer.sum_of_squares())
    }
}

/// Parameters and cost; argmin's places for gradient, Jacobian, Hessian and residuals stay empty.
type FitState = IterState<Vec<f64>, (), (), (), (), f64>;

impl<O: Residuals> Solver<O, FitState> for BoundedLevenbergMarquardt {
    fn name(&self) -> &'static str {
        "bounded Levenberg–Marquardt"
    }

    fn init(&mut self, problem: &mut Problem<O>, mut state: FitState) -> Result<(FitState, Option<KV>), Error> {
        let start = state.take_param().unwrap_or_default();
        let minimizer = &mut self.minimizer;
        problem.problem(RESIDUALS, |problem| Ok(minimizer.begin(problem, &start)?))?;
        Ok((self.report(state, problem), None))
    }

    fn next_iter(&mut self, problem: &mut Problem<O>, state: FitState) -> Result<(FitState, Option<KV>), Error> {
        let minimizer = &mut self.minimizer;
        let outcome = problem.problem(RESIDUALS, |problem| Ok(minimizer.iterate(problem)))?;
        let state = self.report(state, problem);
        let kv = argmin::kv!(
            "radius" => self.minimizer.radius();
            "residual_evaluations" => self.minimizer.residual_evaluations() as u64;
        );
        let state = match outcome {
            None => state,
            Some(outcome) if outcome.is_success() => state.terminate_with(TerminationReason::SolverConverged),
            Some(outcome) => state.terminate_with(TerminationReason::SolverExit(outcome.to_string())),
        };
        Ok((state, Some(kv)))
    }
}
