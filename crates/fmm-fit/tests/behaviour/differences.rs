//! Differences where the model jumps, where a start is tiny, and where squares underflow.

use fmm_fit::{Derivatives, EvaluationError, FitError, Options, Outcome, Residuals, solve};
use fmm_model::{Bounds, Parameter};

/// A decay with an offset, whose model is `beyond` where the rate exceeds `wall`.
struct Walled {
    wall: f64,
    beyond: f64,
    parameters: [Parameter; 3],
}

impl Walled {
    fn new(wall: f64, beyond: f64, upper: f64) -> Self {
        let bounds = Bounds::new(-10.0, upper).unwrap();
        let parameters = [
            Parameter::new("amplitude", "a", "1"),
            Parameter::new("rate", "b", "1/s").bounded(bounds),
            Parameter::new("offset", "c", "1"),
        ];
        Self { wall, beyond, parameters }
    }
}

impl Residuals for Walled {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        40
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        for (i, r) in residuals.iter_mut().enumerate() {
            let t = 0.1 * i as f64;
            let data = 3.0 * (-1.5 * t).exp() + 0.2 + 0.05 * ((i * 37 % 11) as f64 - 5.0) / 5.0;
            let model = if p[1] > self.wall { self.beyond } else { p[0] * (-p[1] * t).exp() + p[2] };
            *r = model - data;
        }
        Ok(())
    }
}

#[test]
fn a_step_across_a_wall_is_no_noise_floor() {
    // What a bound at the wall gives, which no step crosses.
    let best = solve(&Walled::new(0.5, f64::NAN, 0.5), &[1.0, 0.1, 0.0], &Options::default()).unwrap();
    assert!(best.outcome().is_success());
    for beyond in [10.0, 1e3, 1e6, 1e12, -1e6] {
        for rate in [0.1, 0.3, 0.49, 0.5 - 2.5e-9, 0.5] {
            let walled = Walled::new(0.5, beyond, 10.0);
            let fit = solve(&walled, &[1.0, rate, 0.0], &Options::default()).unwrap();
            let excess = fit.sum_of_squares() / best.sum_of_squares() - 1.0;
            println!("beyond {beyond:e} from {rate}: {:?} excess {excess:e}, {}", fit.values(), fit.outcome());
            assert!(
                !fit.outcome().is_success() || excess < 1e-6,
                "beyond {beyond:e} from {rate}: S is {excess} too large, yet {}",
                fit.outcome()
            );
        }
    }
}

/// y = a exp(−b t) + c, exact data but for a little scatter, in any unit of y.
struct Decay {
    size: f64,
    is_exact: bool,
    parameters: [Parameter; 2],
}

impl Decay {
    fn new(size: f64) -> Self {
        Self {
            size,
            is_exact: false,
            parameters: [Parameter::new("amplitude", "a", "1"), Parameter::new("rate", "b", "1/s")],
        }
    }
}

impl Residuals for Decay {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        50
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        for (i, r) in residuals.iter_mut().enumerate() {
            let t = 0.1 * i as f64;
            let data = 2.0 * (-0.7 * t).exp() + 0.01 * ((i * 37 % 11) as f64 - 5.0);
            *r = p[0] * (-p[1] * t).exp() - self.size * data;
        }
        if let Some(jacobian) = jacobian {
            for i in 0..50 {
                let t = 0.1 * i as f64;
                jacobian[i] = (-p[1] * t).exp();
                jacobian[50 + i] = -t * p[0] * jacobian[i];
            }
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        if self.is_exact { Derivatives::Free } else { Derivatives::None }
    }
}

#[test]
fn a_tiny_start_is_a_start() {
    let usual = solve(&Decay::new(1.0), &[1.0, 0.1], &Options::default()).unwrap();
    for tiny in [1e-6, 1e-9, 1e-12, 1e-15, 1e-30, 1e-100, 1e-300, -1e-12] {
        for (is_exact, start) in
            [[tiny, 0.1], [1.0, tiny], [tiny, tiny]].into_iter().flat_map(|s| [(false, s), (true, s)])
        {
            let fit = solve(&Decay { is_exact, ..Decay::new(1.0) }, &start, &Options::default()).unwrap();
            println!("{start:?}: {:?} {} {}", fit.values(), fit.residual_evaluations(), fit.outcome());
            let error = fit.sum_of_squares() / usual.sum_of_squares() - 1.0;
            assert!(fit.outcome().is_success() && error < 1e-9, "{start:?}: {:?}, {}", fit.values(), fit.outcome());
        }
    }
}

/// Residuals that can be zero.
struct Zero([Parameter; 1]);
impl Residuals for Zero {
    fn parameters(&self) -> &[Parameter] {
        &self.0
    }
    fn len(&self) -> usize {
        2
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        residuals.fill(p[0] - 1.0);
        Ok(())
    }
}

#[test]
fn residuals_whose_squares_underflow_are_refused() {
    let usual = solve(&Decay::new(1.0), &[1.0, 0.1], &Options::default()).unwrap();
    for exponent in (130..=320).step_by(5) {
        let size: f64 = format!("1e-{exponent}").parse().unwrap();
        match solve(&Decay::new(size), &[size, 0.1], &Options::default()) {
            Ok(fit) => {
                let rate = fit.values()[1] / usual.values()[1] - 1.0;
                assert!(fit.sum_of_squares() > 0.0 && rate.abs() < 1e-7, "1e-{exponent}: rate {rate}");
                let relative = |fit: &fmm_fit::Fit| fit.estimates()[1].standard_uncertainty().unwrap();
                assert!((relative(&fit) / relative(&usual) - 1.0).abs() < 1e-6, "1e-{exponent}");
            }
            Err(error) => {
                assert!(exponent > 135, "1e-{exponent}: {error}");
                assert!(error.to_string().contains("underflow"), "{error}");
            }
        }
    }
    // Nothing at all is left of exact residuals, which is no underflow.
    let fit = solve(&Zero([Parameter::new("x", "x", "1")]), &[1.0], &Options::default());
    assert_eq!(fit.unwrap().outcome(), Outcome::AtNoiseFloor);
    let refused: Option<FitError> = solve(&Decay::new(1e-160), &[1e-160, 0.1], &Options::default()).err();
    assert!(refused.is_some());
}
