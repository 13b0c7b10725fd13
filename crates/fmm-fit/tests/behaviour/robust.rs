//! Robust and weighted fits of simulated data.

use fmm_fit::{
    Derivatives, EvaluationError, FitError, Loss, Options, Residuals, Robust, Weighted, median_deviation, solve,
    solve_robust,
};
use fmm_model::{Bounds, Parameter};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// y = a + b exp(−c t).
#[derive(Debug)]
struct Decay {
    y: Vec<f64>,
    parameters: Vec<Parameter>,
}

const TRUE: [f64; 3] = [0.5, 2.0, 0.9];

fn time(i: usize) -> f64 {
    0.15 * i as f64
}

impl Residuals for Decay {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.y.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        for (i, (r, y)) in residuals.iter_mut().zip(&self.y).enumerate() {
            *r = p[0] + p[1] * (-p[2] * time(i)).exp() - y;
        }
        if let Some(jacobian) = jacobian {
            let n = self.len();
            for i in 0..n {
                let decay = (-p[2] * time(i)).exp();
                jacobian[i] = 1.0;
                jacobian[n + i] = decay;
                jacobian[2 * n + i] = -p[1] * time(i) * decay;
            }
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}

/// The decay plus `noise(i)`.
fn decay(count: usize, mut noise: impl FnMut(usize) -> f64) -> Decay {
    let y = (0..count).map(|i| TRUE[0] + TRUE[1] * (-TRUE[2] * time(i)).exp() + noise(i)).collect();
    let parameters = ["offset", "amplitude", "rate"].map(|name| Parameter::new(name, name, "1")).to_vec();
    Decay { y, parameters }
}

/// A standard normal number (Box and Muller).
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (radius, angle): (f64, f64) = (random.random(), random.random());
    (-2.0 * (1.0 - radius).ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
}

/// One in ten residuals is ten times as large, and the noise of the others doubles along the record.
fn contaminated(random: &mut ChaCha8Rng) -> Decay {
    decay(60, |i| {
        let outlying = if random.random::<f64>() < 0.1 { 10.0 } else { 1.0 };
        0.02 * (0.7 + 0.7 * i as f64 / 60.0) * outlying * normal(random)
    })
}

/// Mean square errors of the three parameters by `values`, of the same records for everyone.
fn errors(runs: usize, mut values: impl FnMut(&Decay) -> Vec<f64>) -> [f64; 3] {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut errors = [0.0; 3];
    for _ in 0..runs {
        let values = values(&contaminated(&mut random));
        for j in 0..3 {
            errors[j] += (values[j] - TRUE[j]).powi(2) / runs as f64;
        }
    }
    errors
}

#[test]
fn intervals_cover_the_truth_as_often_as_they_say() {
    const RUNS: usize = 400;
    let of_squares = errors(RUNS, |problem| solve(problem, &TRUE, &Options::default()).unwrap().values().to_vec());
    for loss in [Loss::SoftL1, Loss::Huber, Loss::Cauchy, Loss::Arctan, Loss::Tukey] {
        let (mut stated, mut held) = ([0; 3], [0; 3]);
        let errors = errors(RUNS, |problem| {
            let fit = solve_robust(problem, &TRUE, loss, None, &Options::default()).unwrap();
            for j in 0..3 {
                if let Some((lower, upper)) = fit.interval(problem.parameters[j].name(), 0.95) {
                    stated[j] += 1;
                    held[j] += usize::from(lower <= TRUE[j] && TRUE[j] <= upper);
                }
            }
            fit.values().to_vec()
        });
        println!("{loss:?}: covered {held:?} of {stated:?}, errors {errors:.7?} and {of_squares:.7?} of least squares");
        for j in 0..3 {
            // Losses that forget may leave a parameter to one of the first readings, and then state nothing.
            assert!(stated[j] >= RUNS * 98 / 100, "{loss:?}: {} intervals of parameter {j}", stated[j]);
            let share = held[j] as f64 / stated[j] as f64;
            // Of 400 runs 95 % ± 1.1 %; three times that.
            assert!((0.917..=0.983).contains(&share), "{loss:?}: parameter {j} is covered in {share}");
            assert!(errors[j] < 0.3 * of_squares[j], "{loss:?}: parameter {j} has mean square error {}", errors[j]);
        }
    }
}

#[test]
fn a_start_far_away_is_no_reason_to_forget_everything() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let problem = decay(60, |_| 0.02 * normal(&mut random));
    for loss in [Loss::Cauchy, Loss::Arctan, Loss::Tukey] {
        for scale in [Some(0.1), None] {
            let fit = solve_robust(&problem, &[5.0, 5.0, 0.2], loss, scale, &Options::default()).unwrap();
            // A few standard uncertainties of 0.005, 0.02 and 0.02.
            assert!((fit.values()[2] - 0.9).abs() < 0.08, "{loss:?}, {scale:?}: {:?}", fit.values());
            assert_eq!(fit.fit().estimates()[0].start(), 5.0);
            assert!((fit.scale() / 0.1 - 1.0).abs() < 0.6 || scale.is_none());
        }
    }
    // The bare problem knows nothing at such a start, and says so.
    let bare = Robust::new(&problem, Loss::Tukey, 0.1).unwrap();
    let fit = solve(&bare, &[5.0, 5.0, 0.2], &Options::default()).unwrap();
    assert_eq!(fit.rank(), 0);
    assert!(
        fit.null_directions().iter().all(|direction| direction.to_string().ends_with("no influence on the residuals"))
    );
}

#[test]
fn without_outliers_robust_fits_are_nearly_those_of_least_squares() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let problem = decay(2000, |_| 0.02 * normal(&mut random));
    let plain = solve(&problem, &TRUE, &Options::default()).unwrap();
    for loss in [Loss::Squares, Loss::SoftL1, Loss::Huber, Loss::Cauchy, Loss::Arctan, Loss::Tukey] {
        let robust = solve_robust(&problem, &TRUE, loss, None, &Options::default()).unwrap();
        assert!((robust.deviation().unwrap() / 0.02 - 1.0).abs() < 0.1);
        let scale = loss.efficient_scale() * robust.deviation().unwrap();
        assert!((robust.scale() / scale - 1.0).abs() < 1e-6, "{loss:?}: {} instead of {scale}", robust.scale());
        // 1/√0.95 = 1.026 but for least squares; from the scatter of 2000 residuals to about 3 %.
        let ratio = robust.standard_uncertainty(0).unwrap() / plain.estimates()[0].standard_uncertainty().unwrap();
        assert!((0.95..1.11).contains(&ratio), "{loss:?}: ratio {ratio}");
    }
}

#[test]
fn bounds_and_fixed_parameters_have_no_uncertainty() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut problem = decay(60, |_| 0.02 * normal(&mut random));
    problem.parameters[0] = Parameter::new("offset", "a", "1").bounded(Bounds::new(0.6, 1.0).unwrap());
    problem.parameters[1] = Parameter::new("amplitude", "b", "1").bounded(Bounds::new(2.0, 2.0).unwrap());
    let fit = solve_robust(&problem, &[0.7, 2.0, 1.0], Loss::Huber, Some(0.03), &Options::default()).unwrap();
    assert_eq!(fit.values()[..2], [0.6, 2.0]);
    assert_eq!((fit.standard_uncertainty(0), fit.standard_uncertainty(1)), (None, None));
    assert!(fit.standard_uncertainty(2).unwrap() > 0.0 && fit.covariance(2, 3).is_none());
    assert!(fit.interval("rate", 0.95).is_some() && fit.interval("rate", 1.0).is_none());
}

#[test]
fn scales_that_are_none_are_refused() {
    let problem = decay(20, |_| 0.0);
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = solve_robust(&problem, &TRUE, Loss::Huber, Some(scale), &Options::default());
        assert!(matches!(refused, Err(FitError::OutOfRange { .. })), "scale {scale}");
    }
    // 1.4826 times the third smallest of five, or the middle of the last four.
    assert_eq!(median_deviation(&[1.0, -2.0, 3.0, -4.0, 50.0], 0), Some(3.0 * 1.482_602_218_505_602));
    assert_eq!(median_deviation(&[1.0, -2.0, 3.0, -4.0, 50.0], 1), Some(3.5 * 1.482_602_218_505_602));
    assert_eq!(median_deviation(&[1.0], 1), None);
}

#[test]
fn what_has_no_value_does_not_get_one_from_a_loss() {
    for loss in [Loss::SoftL1, Loss::Huber, Loss::Cauchy, Loss::Arctan, Loss::Tukey] {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut problem = decay(10, |_| 0.0);
            problem.y[4] = -value;
            let robust = Robust::new(&problem, loss, 0.1).unwrap();
            let error = solve(&robust, &TRUE, &Options::default()).unwrap_err();
            assert!(
                matches!(error, FitError::NoModel { ref what, .. } if what.starts_with("residual 4 ")),
                "{loss:?}: {error}"
            );
        }
        // As far as numbers go a residual is an outlier.
        let mut problem = decay(10, |_| 0.0);
        problem.y[4] = 1e200;
        let robust = Robust::new(&problem, loss, 0.1).unwrap();
        let mut residuals = vec![0.0; 10];
        robust.evaluate(&TRUE, &mut residuals, None).unwrap();
        assert!(residuals[4] < 0.0 && residuals[4].is_finite(), "{loss:?}: {}", residuals[4]);
    }
}

#[test]
fn weights_are_those_of_the_uncertainties() {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let uncertainty = |i: usize| if i.is_multiple_of(3) { 0.1 } else { 0.02 };
    let problem = decay(90, |i| uncertainty(i) * normal(&mut random));
    let uncertainties: Vec<f64> = (0..90).map(uncertainty).collect();
    let fit = solve(&Weighted::new(&problem, uncertainties.clone()).unwrap(), &[1.0; 3], &Options::default()).unwrap();
    // S is of the order of its degrees of freedom, 87 ± 13.
    assert!((fit.sum_of_squares() - 87.0).abs() < 40.0, "S = {}", fit.sum_of_squares());
    // The normal equations with weights, and their inverse.
    let mut jacobian = vec![0.0; 270];
    problem.evaluate(fit.values(), &mut vec![0.0; 90], Some(&mut jacobian)).unwrap();
    let matrix = nalgebra::DMatrix::from_fn(90, 3, |i, j| jacobian[90 * j + i] / uncertainties[i]);
    let covariance = (matrix.transpose() * matrix).try_inverse().unwrap();
    for i in 0..3 {
        for j in 0..3 {
            let found = fit.unit_covariance(i, j).unwrap();
            assert!((found / covariance[(i, j)] - 1.0).abs() < 1e-9, "({i}, {j}): {found}");
        }
    }
    // The combined evaluation and differences give the same.
    let robust = Robust::new(Weighted::new(&problem, uncertainties).unwrap(), Loss::Squares, 1.0).unwrap();
    assert_eq!(solve(&robust, &[1.0; 3], &Options::default()).unwrap().values(), fit.values());

    let few = Weighted::new(&problem, vec![1.0; 5]).unwrap_err().to_string();
    assert_eq!(few, "5 standard uncertainties were given for 90 residuals; give one for each");
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-310] {
        let mut uncertainties = vec![1.0; 90];
        uncertainties[7] = bad;
        let error = Weighted::new(&problem, uncertainties).unwrap_err();
        assert!(matches!(error, FitError::OutOfRange { ref what, .. } if what.contains("residual 7 ")), "{error}");
    }
}
