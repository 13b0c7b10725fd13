//! Fits repeated with other inputs, against fits from scratch.

use fmm_fit::{Automatic, Derivatives, EvaluationError, FitError, Model, Options, Refit, Residuals, solve};
use fmm_model::{Bounds, Parameter, Scalar};

/// A cooling cup, T = T₀ + a exp(−b t) + d t, in a room of temperature T₀ that drifts by d.
struct Cooling {
    parameters: [Parameter; 4],
}

impl Cooling {
    fn of(room: f64, drift: f64) -> Automatic<Self, 4> {
        let held = |value| Bounds::new(value, value).unwrap();
        let room = Parameter::new("room", "T₀", "°C").bounded(held(room));
        let drift = Parameter::new("drift", "d", "K/min").bounded(held(drift));
        let parameters = [room, drift, Parameter::new("amplitude", "a", "K"), Parameter::new("rate", "b", "1/min")];
        Automatic::new(Self { parameters })
    }
}

impl Model for Cooling {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        6
    }
    fn residuals<S: Scalar>(&self, p: &[S], residuals: &mut [S]) -> Result<(), EvaluationError> {
        let data = [(0.0, 80.1), (10.0, 55.9), (20.0, 41.3), (30.0, 32.8), (40.0, 27.6), (60.0, 22.9)];
        for (r, (t, data)) in residuals.iter_mut().zip(data) {
            *r = p[0] + p[1] * t + p[2] * (-p[3] * t).exp() - data;
        }
        Ok(())
    }
}

const START: [f64; 4] = [20.0, 0.0, 50.0, 0.05];

/// Amplitude and rate by a fit that holds these inputs.
fn from_scratch(inputs: &[f64]) -> Vec<f64> {
    let start = [inputs[0], inputs[1], START[2], START[3]];
    solve(&Cooling::of(inputs[0], inputs[1]), &start, &Options::default()).unwrap().values()[2..].to_vec()
}

#[test]
fn refits_are_fits_with_and_without_expected_changes() {
    let problem = Cooling::of(START[0], START[1]);
    let fit = solve(&problem, &START, &Options::default()).unwrap();
    let straight = Refit::prepare(&problem, &fit).unwrap();
    let bent = Refit::prepare(&problem, &fit).unwrap().expecting(&[0.5, 0.01]).unwrap();
    let one_only = Refit::prepare(&problem, &fit).unwrap().expecting(&[0.0, 0.01]).unwrap();
    for inputs in [[20.0, 0.0], [20.4, -0.013], [18.9, 0.02], [21.5, 0.03]] {
        let expected = from_scratch(&inputs);
        for refit in [&straight, &bent, &one_only] {
            for (found, expected) in refit.estimates(&inputs).unwrap().iter().zip(&expected) {
                assert!((found / expected - 1.0).abs() < 1e-8, "{found}, not {expected}, at {inputs:?}");
            }
        }
    }
}

/// Counts evaluations of the Jacobian.
struct Counted(Automatic<Cooling, 4>, std::sync::atomic::AtomicUsize);

impl Residuals for Counted {
    fn parameters(&self) -> &[Parameter] {
        self.0.parameters()
    }
    fn len(&self) -> usize {
        self.0.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        self.1.fetch_add(jacobian.is_some().into(), std::sync::atomic::Ordering::Relaxed);
        self.0.evaluate(p, residuals, jacobian)
    }
    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}

#[test]
fn expected_changes_save_evaluations() {
    let evaluations = |expected: bool| {
        let problem = Counted(Cooling::of(START[0], START[1]), 0.into());
        let fit = solve(&problem, &START, &Options::default()).unwrap();
        let mut refit = Refit::prepare(&problem, &fit).unwrap();
        if expected {
            refit = refit.expecting(&[0.5, 0.01]).unwrap();
        }
        let before = problem.1.load(std::sync::atomic::Ordering::Relaxed);
        for step in -10..=10 {
            refit.estimates(&[20.0 + 0.05 * f64::from(step), -0.001 * f64::from(step)]).unwrap();
        }
        problem.1.load(std::sync::atomic::Ordering::Relaxed) - before
    };
    let (straight, bent) = (evaluations(false), evaluations(true));
    assert!(straight >= 42, "{straight} evaluations of 21 refits with a straight line");
    assert!(bent <= 25, "{bent} evaluations of 21 refits with a polynomial");
}

#[test]
fn amounts_that_cannot_be_expected_are_refused() {
    let problem = Cooling::of(START[0], START[1]);
    let fit = solve(&problem, &START, &Options::default()).unwrap();
    let expecting = |spread: &[f64]| Refit::prepare(&problem, &fit).unwrap().expecting(spread).err();
    assert_eq!(expecting(&[0.5]).unwrap().to_string(), "1 values were given for 2 inputs");
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        let error = expecting(&[0.5, bad]);
        assert!(
            matches!(&error, Some(FitError::OutOfRange { what, .. }) if what.starts_with("drift ")),
            "{error:?} for {bad}"
        );
    }
}
