//! Distributions beyond Table 1 of JCGM 101: moments and quantiles that are known, and samples that follow them.

use std::f64::consts::PI;

use fmm_uq::{Distribution, Input, Inputs, MonteCarlo, UncertaintyError};

type Made = Result<Distribution, UncertaintyError>;

fn all() -> Vec<Distribution> {
    let made: [Made; 5] = [
        Distribution::asymmetric_triangle(-1.0, 2.0, 3.0),
        Distribution::asymmetric_triangle(0.0, 0.0, 2.0),
        Distribution::beta(2.0, 5.0, -1.0, 3.0),
        Distribution::beta(0.3, 0.6, 0.0, 1.0),
        Distribution::log_normal(3.0, 0.4),
    ];
    made.into_iter().map(Result::unwrap).collect()
}

/// Mean and standard deviation by the quantiles of equal parts of probability.
#[test]
fn moments_are_those_of_the_quantiles() {
    const PARTS: u32 = 200_000;
    for distribution in all() {
        let quantile = |k: u32| distribution.quantile((f64::from(k) + 0.5) / f64::from(PARTS)).unwrap();
        let values: Vec<f64> = (0..PARTS).map(quantile).collect();
        let found = fmm_uq::Moments::of(&values).unwrap();
        let (mean, u) = (distribution.mean(), distribution.standard_deviation());
        // The last parts hold the tails, of which the middle is no mean.
        assert!((found.mean() - mean).abs() < 1e-4 * u, "{distribution}: mean {mean}, found {}", found.mean());
        let ratio = found.standard_deviation().unwrap() / u - 1.0;
        assert!(ratio.abs() < 1e-3, "{distribution}: u {u}, off by {ratio}");
        assert!(values.windows(2).all(|pair| pair[0] <= pair[1]), "{distribution} falls");
    }
}

/// Samples by their probabilities: the share below each of nine quantiles, to five standard deviations.
#[test]
fn samples_follow_the_quantiles() {
    const COUNT: u64 = 200_000;
    for distribution in all() {
        let inputs = Inputs::new([Input::of("x", distribution.clone(), "1").unwrap()]).unwrap();
        let sample = MonteCarlo::new(&inputs, COUNT).unwrap().with_seed(2).run(|x| x[0]).unwrap();
        for tenth in 1..10 {
            let p = f64::from(tenth) / 10.0;
            let q = distribution.quantile(p).unwrap();
            let values = sample.values(0).unwrap();
            let share =
                |below: &dyn Fn(f64) -> bool| values.iter().filter(|&&x| below(x)).count() as f64 / COUNT as f64;
            let tolerance = 5.0 * (p * (1.0 - p) / COUNT as f64).sqrt();
            // At a jump the probability lies between both.
            let (less, not_more) = (share(&|x| x < q), share(&|x| x <= q));
            assert!(less - tolerance <= p && p <= not_more + tolerance, "{distribution}, {p}: {less} to {not_more}");
        }
    }
}

fn close(found: f64, expected: f64, what: &str) {
    assert!((found / expected - 1.0).abs() < 1e-12, "{what}: {found}, not {expected}");
}

#[test]
fn values_in_closed_form() {
    let quantile = |made: &Made, p: f64| made.as_ref().unwrap().quantile(p).unwrap();
    let (arc, flat) = (Distribution::beta(0.5, 0.5, -1.0, 1.0), Distribution::beta(1.0, 1.0, 2.0, 6.0));
    let edge = Distribution::beta(0.05, 3.0, 0.0, 1.0);
    for p in [1e-6, 0.01, 0.3, 0.5, 0.8, 0.999] {
        let (sine, found) = ((PI * (p - 0.5)).sin(), quantile(&arc, p));
        assert!((found - sine).abs() < 1e-12, "arc sine at {p}: {found}, not {sine}");
        close(quantile(&flat, p), 2.0 + 4.0 * p, "flat");
    }
    // s^0.05/(0.05 B(0.05, 3)) with B = 2/(0.05 · 1.05 · 2.05).
    let p = 0.05_f64;
    close(quantile(&edge, p), (p * 0.05 * 2.0 / (0.05 * 1.05 * 2.05)).powf(20.0), "next to nothing");

    let lognormal = Distribution::log_normal(3.0, 0.4);
    close(quantile(&lognormal, 0.975), 3.0 * (0.4_f64 * 1.959_963_984_540_054).exp(), "log-normal");
    let triangle = Distribution::asymmetric_triangle(0.0, 1.0, 3.0).unwrap();
    close(triangle.standard_deviation(), (7.0f64 / 18.0).sqrt(), "triangle");
    assert_eq!(triangle.to_string(), "T(0, 1, 3)");
}

#[test]
fn impossible_parameters_are_refused() {
    let nan = f64::NAN;
    for made in [
        Distribution::asymmetric_triangle(0.0, 1.5, 1.0),
        Distribution::asymmetric_triangle(0.0, nan, 1.0),
        Distribution::asymmetric_triangle(1.0, 1.0, 1.0),
        Distribution::beta(0.0, 1.0, 0.0, 1.0),
        Distribution::beta(1.0, nan, 0.0, 1.0),
        Distribution::beta(1.0, 1.0, 1.0, 0.0),
        Distribution::log_normal(0.0, 1.0),
        Distribution::log_normal(1.0, 40.0),
    ] {
        assert!(made.is_err(), "{made:?}");
    }
}
