//! Moments, quantiles and samples of all distributions against 40-digit figures.

use fmm_model::coverage_factor;
use fmm_uq::{Distribution, Input, Inputs, MonteCarlo};
use serde_json::Value;

fn oracle() -> Value {
    serde_json::from_str(include_str!("../data/jcgm101_distributions.json")).unwrap()
}

fn distribution(case: &Value) -> Distribution {
    let number = |name: &str| case["params"][name].as_f64().unwrap();
    let name = case["name"].as_str().unwrap();
    match name.split(' ').next().unwrap() {
        "rectangular" => Distribution::rectangular(number("a"), number("b")),
        "curvilinear" => Distribution::curvilinear_trapezoid(number("a"), number("b"), number("d")),
        "trapezoidal" => Distribution::trapezoid(number("a"), number("b"), number("beta")),
        "triangular" => Distribution::triangular(number("a"), number("b")),
        "arc" => Distribution::arc_sine(number("a"), number("b")),
        "Gaussian" => Distribution::normal(number("mu"), number("sigma")),
        "scaled" => Distribution::student_t(number("mu"), number("scale"), number("nu")),
        "exponential" => Distribution::exponential(number("mean")),
        "gamma" => Distribution::gamma(number("shape"), number("scale")),
        other => panic!("no such distribution: {other}"),
    }
    .unwrap()
}

#[test]
fn moments_and_quantiles() {
    for case in oracle()["distributions"].as_array().unwrap() {
        let (d, name) = (distribution(case), format!("{} {}", case["name"], case["params"]));
        let [mean, sd] = ["mean", "sd"].map(|key| case[key].as_f64().unwrap());
        assert!((d.mean() - mean).abs() <= 1e-15 * mean.abs().max(sd), "{name}: mean {}", d.mean());
        assert!((d.standard_deviation() / sd - 1.0).abs() < 1e-14, "{name}: sd {}", d.standard_deviation());
        for (p, x) in case["quantiles"].as_object().unwrap() {
            let (p, x): (f64, f64) = (p.parse().unwrap(), x.as_f64().unwrap());
            // 1e-10 of the distance from the centre, and the rounding of a value far from zero.
            let tolerance = 1e-10 * (x - mean).abs().max(0.1 * sd) + 2e-16 * mean.abs();
            let found = d.quantile(p).unwrap();
            assert!((found - x).abs() < tolerance, "{name}: quantile {p} is {found}, not {x}");
        }
    }
}

/// A million values: shares below each quantile, each within 5 standard errors √(p(1 − p)/n).
#[test]
fn samples_follow_the_quantiles() {
    let trials = 1_000_000;
    for case in oracle()["distributions"].as_array().unwrap() {
        let inputs = Inputs::new([Input::of("x", distribution(case), "").unwrap()]).unwrap();
        let sample = MonteCarlo::new(&inputs, trials).unwrap().run(|x| x[0]).unwrap();
        let values = sample.values(0).unwrap();
        for (p, x) in case["quantiles"].as_object().unwrap() {
            let (p, x): (f64, f64) = (p.parse().unwrap(), x.as_f64().unwrap());
            let share = values.iter().filter(|&&value| value <= x).count() as f64 / trials as f64;
            let error = (p * (1.0 - p) / trials as f64).sqrt();
            assert!((share - p).abs() < 5.0 * error, "{} {}: {share} below the quantile of {p}", case["name"], x);
        }
    }
}

#[test]
fn coverage_factors() {
    for row in oracle()["coverage_factors_t"].as_array().unwrap() {
        let nu = row["nu"].as_f64().unwrap_or(f64::INFINITY);
        for (key, level) in
            [("k68.27", 0.6827), ("k90", 0.90), ("k95", 0.95), ("k95.45", 0.9545), ("k99", 0.99), ("k99.73", 0.9973)]
        {
            let (expected, k) = (row[key].as_f64().unwrap(), coverage_factor(level, nu).unwrap());
            // The inverse of the incomplete beta function iterates to a fixed tolerance.
            assert!((k / expected - 1.0).abs() < 1e-11, "ν {nu}, {key}: {k}, not {expected}");
        }
    }
}

#[test]
fn the_empirical_distribution_is_its_values() {
    let values = [3.0, 1.0, 2.0, 2.0];
    let d = Distribution::empirical(&values).unwrap();
    assert_eq!((d.mean(), d.standard_deviation()), (2.0, 0.5f64.sqrt()));
    let quantiles = [0.1, 0.25, 0.26, 0.75, 0.76].map(|p| d.quantile(p).unwrap());
    assert_eq!(quantiles, [1.0, 1.0, 2.0, 2.0, 3.0]);
    let inputs = Inputs::new([Input::of("x", d, "").unwrap()]).unwrap();
    let sample = MonteCarlo::new(&inputs, 100_000).unwrap().run(|x| x[0]).unwrap();
    let twos = sample.values(0).unwrap().iter().filter(|&&x| x == 2.0).count();
    // Half of them, with a standard deviation of 158.
    assert!((twos as f64 - 5e4).abs() < 790.0, "{twos}");
}

#[test]
fn impossible_parameters_are_refused() {
    let nan = f64::NAN;
    let bad = [
        Distribution::constant(nan),
        Distribution::rectangular(1.0, 1.0),
        Distribution::rectangular(nan, 1.0),
        Distribution::rectangular(-f64::MAX, f64::MAX),
        Distribution::curvilinear_trapezoid(0.0, 1.0, 0.0),
        Distribution::curvilinear_trapezoid(0.0, 1.0, 0.6),
        Distribution::trapezoid(0.0, 1.0, 1.0),
        Distribution::triangular(1.0, 0.0),
        Distribution::arc_sine(0.0, f64::INFINITY),
        Distribution::normal(0.0, -1.0),
        Distribution::normal(0.0, 0.0),
        Distribution::student_t(0.0, 1.0, 0.5),
        Distribution::student_t(0.0, nan, 5.0),
        Distribution::exponential(0.0),
        Distribution::gamma(-1.0, 1.0),
        Distribution::gamma(1.0, f64::INFINITY),
        Distribution::empirical(&[]),
        Distribution::empirical(&[1.0, nan]),
    ];
    for (position, result) in bad.iter().enumerate() {
        assert!(result.is_err(), "{position}: {result:?}");
    }
    let message = Distribution::normal(0.0, -1.0).unwrap_err().to_string();
    assert_eq!(message, "the standard deviation must be positive and finite, but is -1");
    let d = Distribution::normal(0.0, 1.0).unwrap();
    assert!(d.quantile(0.0).is_err() && d.quantile(1.0).is_err() && d.quantile(nan).is_err());
}
