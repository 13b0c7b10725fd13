//! Options of a fit: limits, tolerances and the first radius.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::error::FitError;

/// Conditions under which a fit stops, and its beginning. The defaults suit every problem that the crate is tested on.
///
/// ```
/// use std::time::Duration;
/// use fmm_fit::Options;
///
/// let options = Options::default().with_max_iterations(200).with_time_limit(Duration::from_secs(10));
/// assert_eq!(options.max_iterations(), 200);
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Options {
    pub(crate) max_iterations: usize,
    pub(crate) max_evaluations: usize,
    pub(crate) time_limit: Option<Duration>,
    pub(crate) cancel: Option<Arc<AtomicBool>>,
    pub(crate) cost_tolerance: f64,
    pub(crate) step_tolerance: f64,
    pub(crate) gradient_tolerance: f64,
    pub(crate) polish_steps: usize,
    pub(crate) restarts: usize,
    pub(crate) jacobian_check: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            max_iterations: 5000,
            max_evaluations: usize::MAX,
            time_limit: None,
            cancel: None,
            cost_tolerance: 1e-12,
            step_tolerance: 1e-12,
            gradient_tolerance: 1e-10,
            polish_steps: 40,
            restarts: 3,
            jacobian_check: cfg!(debug_assertions),
        }
    }
}

impl Options {
    /// Greatest number of trial steps, over all restarts (5000).
    #[must_use]
    pub fn with_max_iterations(mut self, iterations: usize) -> Self {
        self.max_iterations = iterations;
        self
    }

    /// Greatest number of evaluations of the residuals, about, those for differences included (no limit). The limit
    /// is looked at between trial steps.
    #[must_use]
    pub fn with_max_evaluations(mut self, evaluations: usize) -> Self {
        self.max_evaluations = evaluations;
        self
    }

    /// Longest time of a fit (no limit). The clock is looked at between trial steps.
    #[must_use]
    pub fn with_time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = Some(limit);
        self
    }

    /// Stop between trial steps once another thread has stored `true` here.
    #[must_use]
    pub fn with_cancel_flag(mut self, flag: Arc<AtomicBool>) -> Self {
        self.cancel = Some(flag);
        self
    }

    /// The relative reduction of the sum of squares, predicted and actual, below which the search ends (1e-12).
    /// At 1e-8 fits with large residuals end digits away from the minimum.
    #[must_use]
    pub fn with_cost_tolerance(mut self, tolerance: f64) -> Self {
        self.cost_tolerance = tolerance;
        self
    }

    /// The relative length of a step, in the scaling of the solver, below which the search ends (1e-12).
    #[must_use]
    pub fn with_step_tolerance(mut self, tolerance: f64) -> Self {
        self.step_tolerance = tolerance;
        self
    }

    /// The largest cosine between the residual and a free column of the Jacobian that counts as zero (1e-10).
    #[must_use]
    pub fn with_gradient_tolerance(mut self, tolerance: f64) -> Self {
        self.gradient_tolerance = tolerance;
        self
    }

    /// Greatest number of Gauss–Newton steps that sharpen the minimum once the search has ended (40). Without
    /// them about half of the digits are right, as a sum of squares is flat near its minimum.
    #[must_use]
    pub fn with_polish_steps(mut self, steps: usize) -> Self {
        self.polish_steps = steps;
        self
    }

    /// The number of times that a stalled search begins again with another radius (3, the most that has an effect).
    #[must_use]
    pub fn with_restarts(mut self, restarts: usize) -> Self {
        self.restarts = restarts;
        self
    }

    /// Lets [`solve`](crate::solve) compare the derivatives that a problem gives with differences at the start, as
    /// [`check_jacobian`](crate::check_jacobian) does (in debug builds yes, in release builds no). What it finds is in
    /// [`Fit::jacobian_mismatches`](crate::Fit::jacobian_mismatches) and changes nothing else; its evaluations are not
    /// counted.
    #[must_use]
    pub fn with_jacobian_check(mut self, check: bool) -> Self {
        self.jacobian_check = check;
        self
    }

    /// The limit on trial steps.
    pub fn max_iterations(&self) -> usize {
        self.max_iterations
    }

    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// The same options for a fit that is one of several, the first of which began then.
    pub(crate) fn remaining(&self, began: Instant) -> Self {
        let time_limit = self.time_limit.map(|limit| limit.saturating_sub(began.elapsed()));
        Self { time_limit, ..self.clone() }
    }

    pub(crate) fn validate(&self) -> Result<(), FitError> {
        let tolerances = [
            ("cost tolerance", self.cost_tolerance),
            ("step tolerance", self.step_tolerance),
            ("gradient tolerance", self.gradient_tolerance),
        ];
        for (option, value) in tolerances {
            if !(0.0..1.0).contains(&value) {
                return Err(FitError::option(&format!("the option {option}"), "at least 0 and below 1", value));
            }
        }
        Ok(())
    }
}
