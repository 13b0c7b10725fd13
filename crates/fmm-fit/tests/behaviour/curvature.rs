//! Sums of squares that bend otherwise than the linear model of the residuals.

use fmm_fit::{Automatic, Derivatives, EvaluationError, Model, Options, Residuals, check_jacobian, solve};
use fmm_model::{Parameter, Scalar};

/// Residuals from a function, of so many parameters.
struct Formula<const P: usize> {
    which: &'static str,
    count: usize,
    parameters: [Parameter; P],
}

const NAMES: [&str; 6] = ["x1", "x2", "x3", "x4", "x5", "x6"];

fn formula<const P: usize>(which: &'static str, count: usize) -> Automatic<Formula<P>, P> {
    let parameters = std::array::from_fn(|j| Parameter::new(NAMES[j], NAMES[j], "1"));
    Automatic::new(Formula { which, count, parameters })
}

impl<const P: usize> Model for Formula<P> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.count
    }
    fn residuals<S: Scalar>(&self, p: &[S], residuals: &mut [S]) -> Result<(), EvaluationError> {
        for (i, r) in residuals.iter_mut().enumerate() {
            let t = 0.1 * (i + 1) as f64;
            let k = (i + 1) as f64;
            *r = match (self.which, i) {
                ("freudenstein_roth", 0) => p[0] + ((-p[1] + 5.0) * p[1] - 2.0) * p[1] - 13.0,
                ("freudenstein_roth", _) => p[0] + ((p[1] + 1.0) * p[1] - 14.0) * p[1] - 29.0,
                ("jennrich_sampson", _) => -((p[0] * k).exp() + (p[1] * k).exp()) + 2.0 + 2.0 * k,
                ("biggs_exp6", _) => {
                    let data = (-t).exp() - 5.0 * (-10.0 * t).exp() + 3.0 * (-4.0 * t).exp();
                    p[2] * (-p[0] * t).exp() - p[3] * (-p[1] * t).exp() + p[5] * (-p[4] * t).exp() - data
                }
                _ => {
                    let data = 2.0 * (-0.5 * k).exp() + (-3.0 * k * 0.3).exp();
                    p[0] * (-p[1] * k).exp() + p[2] * (-p[3] * k).exp() - data
                }
            };
        }
        Ok(())
    }
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
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        self.0.evaluate(p, residuals, None)
    }
}

/// Minima to sixteen digits by Newton's method in fifty-digit arithmetic.
#[test]
fn minima_with_large_residuals_are_sharp() {
    // x₂ is a root of the derivative of S along the valley: (√22 − 2)·…, x₂ = (2 − √22)/3.
    let expected = (2.0 - 22f64.sqrt()) / 3.0;
    let freudenstein = formula::<2>("freudenstein_roth", 2);
    for start in [[0.5, -2.0], [15.0, -2.0], [10.0, -1.0]] {
        let fit = solve(&freudenstein, &start, &Options::default()).unwrap();
        let error = (fit.values()[1] / expected - 1.0).abs();
        println!("{start:?}: {:?} error {error:e}, S {} {}", fit.values(), fit.sum_of_squares(), fit.outcome());
        assert!(fit.outcome().is_success() && error < 1e-12, "x2 = {}, error {error:e}", fit.values()[1]);
    }
    // By symmetry both are the root of Σ k exp(x k) (2 + 2k − 2 exp(x k)) = 0.
    let slope = |x: f64| -> f64 {
        (1..=10)
            .map(|k| {
                let k = f64::from(k);
                k * (x * k).exp() * (1.0 + k - (x * k).exp())
            })
            .sum()
    };
    let (mut low, mut high) = (0.25, 0.26);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if slope(middle) > 0.0 { low = middle } else { high = middle }
    }
    let fit = solve(&formula::<2>("jennrich_sampson", 10), &[0.3, 0.4], &Options::default()).unwrap();
    println!("{:?} instead of {low}, {}", fit.values(), fit.outcome());
    assert!(fit.values().iter().all(|x| (x / low - 1.0).abs() < 1e-11), "{:?} instead of {low}", fit.values());
}

#[test]
fn a_saddle_is_left() {
    let starts = [[1.0, 2.0, 1.0, 1.0, 1.0, 1.0], [2.0, 8.0, 1.5, 4.0, 2.0, 1.5]];
    for start in starts {
        for is_exact in [true, false] {
            let biggs = formula::<6>("biggs_exp6", 13);
            let fit = if is_exact {
                solve(&biggs, &start, &Options::default())
            } else {
                solve(&Plain(biggs), &start, &Options::default())
            }
            .unwrap();
            println!("{:?} S {:e} {}", fit.values(), fit.sum_of_squares(), fit.outcome());
            assert!(fit.outcome().is_success() && fit.sum_of_squares() < 1e-12, "S = {:e}", fit.sum_of_squares());
        }
    }
    // Two decays that begin as one.
    let fit = solve(&formula::<4>("two decays", 20), &[1.0, 1.0, 1.0, 1.0], &Options::default()).unwrap();
    println!("{:?} S {:e} {}", fit.values(), fit.sum_of_squares(), fit.outcome());
    assert!(fit.outcome().is_success() && fit.sum_of_squares() < 1e-20, "S = {:e}", fit.sum_of_squares());
}

/// y = a exp(−b t) with a kink where b is 1; derivatives by b are `wrong` times the right ones.
struct Kinked {
    wrong: f64,
    parameters: [Parameter; 2],
}

impl Residuals for Kinked {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        10
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        for (i, r) in residuals.iter_mut().enumerate() {
            let t = 0.3 * i as f64;
            *r = p[0] * (-p[1] * t).exp() + (p[1] - 1.0).abs() - 2.0 * (-0.5 * t).exp();
        }
        if let Some(jacobian) = jacobian {
            for i in 0..10 {
                let t = 0.3 * i as f64;
                jacobian[i] = (-p[1] * t).exp();
                jacobian[10 + i] = self.wrong * (-t * p[0] * jacobian[i] + if p[1] < 1.0 { -1.0 } else { 1.0 });
            }
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}

#[test]
fn derivatives_that_are_not_those_of_the_residuals_are_named() {
    let kinked = |wrong| Kinked { wrong, parameters: ["a", "b"].map(|name| Parameter::new(name, name, "1")) };
    for p in [[1.0, 0.5], [1e6, 3.0], [1e-6, 0.1], [0.0, 0.2], [1.0, 1.0]] {
        assert_eq!(check_jacobian(&kinked(1.0), &p).unwrap(), [], "at {p:?}");
    }
    for wrong in [-1.0, 0.0, 0.99, 2.0] {
        let mismatches = check_jacobian(&kinked(wrong), &[1.0, 0.5]).unwrap();
        assert_eq!(mismatches.len(), 1);
        assert_eq!(mismatches[0].parameter, "b");
        assert!((mismatches[0].derivative - wrong * mismatches[0].difference).abs() < 1e-6);
        // At the kink no difference tells anything.
        assert_eq!(check_jacobian(&kinked(wrong), &[1.0, 1.0]).unwrap(), []);
    }
    let looked = |check| solve(&kinked(2.0), &[1.0, 0.5], &Options::default().with_jacobian_check(check)).unwrap();
    assert!(
        looked(true).to_string().contains("by differences") && !looked(false).to_string().contains("by differences")
    );
    assert_eq!((looked(true).jacobian_mismatches().len(), looked(false).jacobian_mismatches().len()), (1, 0));
    assert_eq!(looked(true).values(), looked(false).values());
    assert_eq!(check_jacobian(&Plain(kinked(2.0)), &[1.0, 0.5]).unwrap(), []);
}
