//! Checkpoint of a fit, from which another process can continue it.

use std::time::Instant;

use crate::error::FitError;
use crate::problem::residuals::Residuals;
use crate::solver::evaluation::Scheme;
use crate::solver::minimizer::{Attempt, Minimizer, Phase, check_start};
use crate::solver::options::Options;
use crate::solver::outcome::Outcome;

/// A fit between two steps, without what its problem can tell again: residuals and derivatives are evaluated once more,
/// uncounted.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Checkpoint {
    options: Options,
    phase: Phase,
    #[serde(with = "crate::solver::bits")]
    start: Vec<f64>,
    #[serde(with = "crate::solver::bits")]
    values: Vec<f64>,
    attempt: usize,
    best: Option<Attempt>,
    is_saddle_left: bool,
    iterations: usize,
    #[serde(with = "crate::solver::bits")]
    radius: f64,
    #[serde(with = "crate::solver::bits")]
    scaling: Vec<f64>,
    scheme: Scheme,
    #[serde(with = "crate::solver::bits")]
    floor: Vec<f64>,
    residual_evaluations: usize,
    jacobian_evaluations: usize,
}

impl From<Minimizer> for Checkpoint {
    fn from(minimizer: Minimizer) -> Self {
        if let Some(stored) = minimizer.stored {
            return *stored;
        }
        Self {
            options: minimizer.options,
            phase: minimizer.phase,
            start: minimizer.start,
            values: minimizer.current.values,
            attempt: minimizer.attempt,
            best: minimizer.best,
            is_saddle_left: minimizer.is_saddle_left,
            iterations: minimizer.iterations,
            radius: minimizer.region.radius,
            scaling: minimizer.region.scaling,
            scheme: minimizer.evaluator.scheme,
            floor: minimizer.evaluator.floor,
            residual_evaluations: minimizer.evaluator.residual_evaluations,
            jacobian_evaluations: minimizer.evaluator.jacobian_evaluations,
        }
    }
}

impl From<Checkpoint> for Minimizer {
    fn from(stored: Checkpoint) -> Self {
        let mut minimizer = Self::new(stored.options.clone());
        if !matches!(stored.phase, Phase::Idle) {
            minimizer.stored = Some(Box::new(stored));
        }
        minimizer
    }
}

impl Minimizer {
    /// Takes up a stored fit of `problem` where it was and brings it to its end, as if it had not been interrupted; one
    /// of another problem is not found out. A time limit begins again. (Feature `serde`.)
    ///
    /// # Errors
    /// [`FitError`] if the problem does not allow it; [`FitError::NotStarted`] if nothing was stored.
    #[cfg_attr(docsrs, doc(cfg(feature = "serde")))]
    pub fn resume<P: Residuals + ?Sized>(&mut self, problem: &P) -> Result<Outcome, FitError> {
        self.take_up(problem)?;
        if matches!(self.phase, Phase::Idle) {
            return Err(FitError::NotStarted);
        }
        loop {
            if let Some(outcome) = self.iterate(problem) {
                return Ok(outcome);
            }
        }
    }

    /// Puts a stored fit in place, if one waits.
    pub(crate) fn take_up<P: Residuals + ?Sized>(&mut self, problem: &P) -> Result<(), FitError> {
        let Some(stored) = self.stored.take() else { return Ok(()) };
        check_start(problem.parameters(), &stored.values)?;
        // Checks the problem, and makes the buffers.
        self.begin(problem, &stored.start)?;
        let has_radius = stored.scaling.len() == self.region.scaling.len();
        if !has_radius || stored.floor.len() != stored.values.len() {
            let (values, parameters) = (stored.scaling.len(), self.evaluator.free.len());
            return Err(FitError::count(format!(
                "the start has {values} values, but the problem has {parameters} parameters"
            )));
        }
        self.current.values = stored.values;
        self.evaluator.floor = stored.floor;
        self.evaluator.scheme = stored.scheme;
        self.evaluate_again(problem);
        self.region.set_model(&self.current.triangle, self.rank_threshold());
        (self.region.radius, self.region.scaling) = (stored.radius, stored.scaling);
        (self.phase, self.attempt, self.best) = (stored.phase, stored.attempt, stored.best);
        (self.is_saddle_left, self.iterations) = (stored.is_saddle_left, stored.iterations);
        self.evaluator.residual_evaluations = stored.residual_evaluations;
        self.evaluator.jacobian_evaluations = stored.jacobian_evaluations;
        self.began = self.options.time_limit.map(|_| Instant::now());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use argmin::core::checkpointing::{Checkpoint as Store, CheckpointingFrequency};
    use argmin::core::{Error, Executor, IterState, State};
    use fmm_model::{Parameter, Scalar};

    use super::*;
    use crate::fitting::argmin::BoundedLevenbergMarquardt;
    use crate::fitting::curve::ClosureProblem;

    fn problem() -> impl Residuals {
        let names = ["a", "b", "c"].map(Parameter::from);
        ClosureProblem::new(names, 40, |[a, b, c]: [fmm_model::Dual<3>; 3], residuals: &mut [fmm_model::Dual<3>]| {
            for (i, r) in (0_u32..).zip(residuals) {
                let t = 0.1 * f64::from(i);
                *r = a * (-b * t).exp() + c - 2.0 * (-0.7 * t).exp() - 0.01 * (f64::from(i * 37 % 11) - 5.0);
            }
        })
    }

    /// The same without derivatives.
    struct Plain<P>(P);

    impl<P: Residuals> Residuals for Plain<P> {
        fn parameters(&self) -> &[Parameter] {
            self.0.parameters()
        }
        fn len(&self) -> usize {
            self.0.len()
        }
        fn evaluate(
            &self,
            p: &[f64],
            residuals: &mut [f64],
            _: Option<&mut [f64]>,
        ) -> Result<(), crate::problem::residuals::EvaluationError> {
            self.0.evaluate(p, residuals, None)
        }
    }

    fn is_the_same_from_everywhere(problem: &impl Residuals) {
        let start = [0.3, 1.9, 1.0];
        let mut whole = Minimizer::new(Options::default());
        whole.minimize(problem, &start).unwrap();
        let mut taken_up = 0;
        let mut stored = Minimizer::new(Options::default());
        stored.begin(problem, &start).unwrap();
        loop {
            let text = serde_json::to_string(&stored).unwrap();
            let mut other: Minimizer = serde_json::from_str(&text).unwrap();
            assert!(matches!(other.fit(), Err(FitError::NotStarted)));
            // What has not been taken up is stored as it was.
            assert_eq!(serde_json::to_string(&other).unwrap(), text);
            assert_eq!(Some(other.resume(problem).unwrap()), whole.outcome());
            assert_eq!(other.values(), whole.values());
            assert_eq!(other.fit().unwrap().to_string(), whole.fit().unwrap().to_string());
            taken_up += 1;
            if stored.iterate(problem).is_some() {
                break;
            }
        }
        assert!(taken_up > 5, "{taken_up}");
    }

    #[test]
    fn a_fit_taken_up_anywhere_ends_as_if_it_had_not_been_left() {
        is_the_same_from_everywhere(&problem());
        is_the_same_from_everywhere(&Plain(problem()));
        assert!(matches!(Minimizer::default().resume(&problem()), Err(FitError::NotStarted)));
    }

    type FitState = IterState<Vec<f64>, (), (), (), (), f64>;

    /// Keeps the last state, the solver as text.
    struct Memory<'a>(&'a RefCell<Option<(String, FitState)>>);

    impl Store<BoundedLevenbergMarquardt, FitState> for Memory<'_> {
        fn save(&self, solver: &BoundedLevenbergMarquardt, state: &FitState) -> Result<(), Error> {
            *self.0.borrow_mut() = Some((serde_json::to_string(solver)?, state.clone()));
            Ok(())
        }
        fn load(&self) -> Result<Option<(BoundedLevenbergMarquardt, FitState)>, Error> {
            match &*self.0.borrow() {
                Some((text, state)) => Ok(Some((serde_json::from_str(text)?, state.clone().max_iters(1000)))),
                None => Ok(None),
            }
        }
        fn frequency(&self) -> CheckpointingFrequency {
            CheckpointingFrequency::Always
        }
    }

    #[test]
    fn argmin_takes_up_a_run_from_its_checkpoint() {
        let store: &'static RefCell<Option<(String, FitState)>> = Box::leak(Box::default());
        let run = |most: u64| {
            Executor::new(problem(), BoundedLevenbergMarquardt::new(Options::default()))
                .configure(|state| state.param(vec![0.3, 1.9, 1.0]).max_iters(most).counting(true))
                .checkpointing(Memory(store))
                .run()
                .unwrap()
        };
        let part = run(3);
        assert_eq!(part.solver.outcome(), None);
        let rest = run(1000);
        let mut whole = Minimizer::new(Options::default());
        whole.minimize(&problem(), &[0.3, 1.9, 1.0]).unwrap();
        assert_eq!(rest.solver.outcome(), whole.outcome());
        assert_eq!(rest.state.get_best_param().unwrap().as_slice(), whole.values());
        assert_eq!(rest.state.get_func_counts()["residuals_count"], whole.residual_evaluations() as u64);
        assert_eq!(rest.state.get_iter(), whole.iterations() as u64);
    }
}
