//! A decay over an offset that cannot be negative: the bound is met exactly, and the report says so.

use fmm_fit::{Automatic, EvaluationError, FitError, Model, MultiStart, Options, Residuals, solve};
use fmm_model::{Bounds, Parameter, Scalar};

/// y = a exp(−t/τ) + b.
struct Decay {
    parameters: [Parameter; 3],
    data: Vec<(f64, f64)>,
}

impl Model for Decay {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.data.len()
    }
    fn residuals<S: Scalar>(&self, p: &[S], residuals: &mut [S]) -> Result<(), EvaluationError> {
        for (residual, &(time, value)) in residuals.iter_mut().zip(&self.data) {
            *residual = p[0] * (-S::from(time) / p[1]).exp() + p[2] - value;
        }
        Ok(())
    }
}

fn main() -> Result<(), FitError> {
    let parameters = [
        Parameter::new("amplitude", "a", "m/s"),
        Parameter::new("time_constant", "τ", "s").bounded(Bounds::POSITIVE),
        Parameter::new("offset", "b", "m/s").bounded(Bounds::NOT_NEGATIVE),
    ];
    // 2 m/s with 0.7 s, and an instrument that shows 0.05 m/s too little.
    let data = (0..40).map(|i| 0.1 * f64::from(i)).map(|t| (t, 2.0 * (-t / 0.7).exp() - 0.05)).collect();
    let problem = Automatic::<_, 3>::new(Decay { parameters, data });
    let start = [1.0, 1.0, 0.1];

    let fit = solve(&problem, &start, &Options::default())?;
    println!("{fit}");
    assert!(fit.outcome().is_success() && fit.has_exact_jacobian());
    assert_eq!(fit.values()[2], 0.0, "the offset is at its bound");
    assert!(fit.estimates()[2].status().is_at_bound());
    // Without an offset to take the 0.05 m/s up, the decay has to be shorter.
    assert!((0.6..0.7).contains(&fit.values()[1]), "{} s", fit.values()[1]);

    let found = MultiStart::around(problem.parameters(), &start, 7, 0).solve(&problem)?;
    // One minimum only: no start ends lower, but for rounding.
    let ratio = found.sum_of_squares() / fit.sum_of_squares();
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
    Ok(())
}
