//! Limits of a method: figures that do not exist, runs beyond their cap, ranges where a method ends.

use std::sync::atomic::{AtomicU64, Ordering};

use fmm_model::coverage_factor;
use fmm_uq::{
    Adaptive, Distribution, Gum, Input, Inputs, IntervalKind, Linearisation, MonteCarlo, Observations, Scalar,
    UncertaintyError, VarianceShare, propagate,
};

fn normal(value: f64, u: f64) -> Inputs {
    Inputs::new([Input::new("x", value, u, "m").unwrap()]).unwrap()
}

#[test]
fn an_adaptive_run_keeps_its_cap() {
    let inputs = normal(0.0, 1.0);
    for (level, cap, done) in [(0.95, 205_000, 200_000), (0.95, 99_999, 0), (0.999_999, 1_000_000, 0)] {
        let rule = Adaptive::to_tolerance(1e-6).unwrap().with_interval(IntervalKind::Symmetric, level).unwrap();
        let calls = AtomicU64::new(0);
        let counted = |x: &[f64]| {
            // A run that does not keep its cap must not keep the test waiting.
            (calls.fetch_add(1, Ordering::Relaxed) < 3_000_000).then_some(x[0]).ok_or("far beyond the cap")
        };
        let error = MonteCarlo::adaptive(&inputs, rule.with_most_trials(cap)).run(counted).unwrap_err();
        assert_eq!(calls.load(Ordering::Relaxed), done, "level {level}, at most {cap}: {error}");
        match error {
            UncertaintyError::TooFewTrials { what, trials } if done > 0 => {
                assert!(trials == done && what.contains("not stable"), "{what}");
            }
            UncertaintyError::TooFewTrials { what, trials } => {
                assert_eq!(trials, cap);
                let needed = if level > 0.99 { "takes 1000000000 trials" } else { "takes 100000 trials" };
                assert!(what.contains(needed), "{what}");
            }
            other => panic!("{other}"),
        }
    }
}

/// Student's t of one and two degrees of freedom has no variance, and of one no mean.
#[test]
fn a_variance_that_is_infinite_is_not_stated() {
    for (observed, mean_exists) in [(&[1.0, 2.0][..], false), (&[1.0, 2.0, 2.5], true)] {
        let few = Input::mean_of("few", &Observations::new(observed).unwrap(), "m").unwrap();
        let inputs = Inputs::new([few, Input::new("x", 1.0, 0.1, "m").unwrap()]).unwrap();
        let run = MonteCarlo::new(&inputs, 20_000).unwrap();
        let sample = run.run(|x| x[0] + x[1]).unwrap();
        let error = sample.standard_uncertainty(0).unwrap_err();
        assert!(
            matches!(&error, UncertaintyError::NoAnswer { what } if what.contains("which few has, has no standard deviation")),
            "{error}"
        );
        assert!(error.to_string().contains("few"), "{error}");
        assert_eq!(sample.estimate(0).is_ok(), mean_exists, "{observed:?}");
        assert!(
            sample.standard_errors(0).is_err() && sample.covariance(0, 0).is_err() && sample.ellipsoid(0.9).is_err()
        );
        // What does exist is stated: the interval, and the median by any name.
        assert!(sample.symmetric_interval(0, 0.95).is_ok() && sample.shortest_interval(0, 0.95).is_ok());
        let parts = run.run_blocks(0..20, |x| x[0] + x[1]).unwrap();
        assert_eq!(run.finish(parts).unwrap(), sample);

        let adaptive = MonteCarlo::adaptive(&inputs, Adaptive::to_tolerance(0.1).unwrap()).run(|x| x[0]);
        assert!(matches!(adaptive, Err(UncertaintyError::NoAnswer { .. })), "{adaptive:?}");
        let shares = VarianceShare::of_all(&inputs, 10_000, 0, 0.0, |x: &[f64]| x[0] + x[1]);
        assert!(matches!(shares, Err(UncertaintyError::NoAnswer { .. })), "{shares:?}");
    }
    let three = Input::mean_of("few", &Observations::new(&[1.0, 2.0, 3.0, 3.5]).unwrap(), "m").unwrap();
    let sample = MonteCarlo::new(&Inputs::new([three]).unwrap(), 20_000).unwrap().run(|x| x[0]).unwrap();
    assert!(sample.standard_uncertainty(0).is_ok(), "ν = 3 has a variance");
}

/// P(a, x) ≈ xᵃ/Γ(a + 1) where x is small.
#[test]
fn gamma_quantiles_of_small_shapes() {
    for (shape, gamma, probabilities) in [
        (0.5, 0.886_226_925_452_758, [1e-9, 1e-7, 1e-5]),
        (0.1, 0.951_350_769_866_873_2, [1e-6, 0.01, 0.05]),
        (0.01, 0.994_325_851_191_506, [1e-3, 0.3, 0.7]),
    ] {
        for p in probabilities {
            let expected = (p * gamma).powf(1.0 / shape);
            // The next term of the series, and what the power makes of the rounding of its base.
            let tolerance = 2.0 * expected + 1e-13 / shape;
            for scale in [1.0, 1e-3] {
                let x = Distribution::gamma(shape, scale).unwrap().quantile(p).unwrap() / scale;
                assert!((x / expected - 1.0).abs() < tolerance, "shape {shape}, p = {p}: {x:e}, not {expected:e}");
            }
        }
    }
}

/// Student's t of 1, 2 and 4 degrees of freedom has quantiles in closed form.
#[test]
fn coverage_factors_of_high_levels() {
    for level in [0.5, 0.95, 0.999, 1.0 - 1e-6, 1.0 - 1e-8, 1.0 - 1e-12] {
        let q: f64 = 0.5 * (1.0 - level);
        let alpha = (4.0 * q * (1.0 - q)).sqrt();
        let four = 2.0 * ((alpha.acos() / 3.0).cos() / alpha - 1.0).sqrt();
        let closed = [(1.0, 1.0 / (std::f64::consts::PI * q).tan()), (2.0, level * 2f64.sqrt() / alpha), (4.0, four)];
        for (nu, expected) in closed {
            let k = coverage_factor(level, nu).unwrap();
            assert!((k / expected - 1.0).abs() < 1e-12, "level {level}, ν {nu}: {k}, not {expected}");
        }
    }
}

#[test]
fn a_model_that_leaves_its_expansion_is_not_adequate() {
    fn fifth<D: Scalar>(x: &[D]) -> D {
        x[0] + x[0] * x[0] * x[0] * x[0] * x[0] * 0.05
    }
    fn kink<D: Scalar>(x: &[D]) -> D {
        x[0].abs()
    }
    fn root<D: Scalar>(x: &[D]) -> D {
        x[0].sqrt()
    }
    for value in [0.0, 0.3, -1.0] {
        let inputs = normal(value, 1.0);
        let exact = propagate(&inputs, kink).unwrap();
        assert_eq!(exact.linearisation(), Linearisation::NotExpandable, "|x| at {value}");
        let stepped = Gum::new(&inputs).propagate_by_differences(kink::<f64>).unwrap().single().unwrap();
        assert!(stepped.linearisation().is_suspect(), "|x| at {value} by differences");
    }
    let exact = propagate(&normal(0.0, 1.0), fifth).unwrap();
    assert_eq!(exact.linearisation(), Linearisation::NotExpandable);
    assert!(exact.second_order().is_none() && exact.expanded_to_second_order(0.95).is_err());
    let stepped = Gum::new(&normal(0.0, 1.0)).propagate_by_differences(fifth::<f64>).unwrap().single().unwrap();
    assert!(stepped.linearisation().is_suspect());
    // No root of negative numbers, although the slope at 1.5 exists.
    assert_eq!(propagate(&normal(1.5, 1.0), root).unwrap().linearisation(), Linearisation::NotExpandable);
    // Within their uncertainties these are straight lines, and a bounded input is not asked beyond its limits.
    assert_eq!(propagate(&normal(1.0, 0.01), fifth).unwrap().linearisation(), Linearisation::Adequate);
    assert_eq!(propagate(&normal(1.0, 0.3), kink).unwrap().linearisation(), Linearisation::Adequate);
    for bounded in [Distribution::rectangular(0.0, 0.1), Distribution::arc_sine(0.0, 0.1)] {
        let inputs = Inputs::new([Input::of("x", bounded.unwrap(), "m").unwrap()]).unwrap();
        let limited = |x: &[fmm_uq::Taylor]| if (0.0..=0.1).contains(&x[0].value()) { Ok(x[0]) } else { Err("beyond") };
        assert_eq!(propagate(&inputs, limited).unwrap().linearisation(), Linearisation::Adequate, "{inputs:?}");
    }
}

#[test]
fn uncertainties_too_small_to_square_are_refused() {
    let tiny = |error: UncertaintyError| assert!(error.to_string().contains("is so small"), "{error}");
    tiny(Observations::new(&[1e-200, 2e-200, 3e-200]).unwrap_err());
    tiny(Distribution::empirical(&[1e-200, 2e-200]).unwrap_err());
    tiny(propagate(&normal(1.0, 1e-200), |x| x[0] * 1e-200).unwrap_err());
    tiny(
        MonteCarlo::new(&normal(1.0, 0.1), 1000)
            .unwrap()
            .run(|x| x[0] * 1e-200)
            .unwrap()
            .standard_uncertainty(0)
            .unwrap_err(),
    );
    tiny(VarianceShare::of_all(&normal(1.0, 0.1), 10_000, 0, 0.0, |x: &[f64]| x[0] * 1e-200).unwrap_err());
    // Equal values have no spread at all, however small they are; a sum keeps its largest part.
    assert_eq!(Observations::new(&[1e-200; 3]).unwrap().standard_uncertainty(), 0.0);
    let both = Inputs::new([Input::new("a", 1.0, 1e-200, "m").unwrap(), Input::new("b", 1.0, 0.1, "m").unwrap()]);
    let budget = propagate(&both.unwrap(), |x| x[0] * 1e-200 + x[1]).unwrap();
    assert_eq!(budget.standard_uncertainty(), 0.1);
    // Second-order terms are squares as well, and keep their unit out of it.
    let extreme = propagate(&normal(1e-160, 1e-170), |x| x[0] * 1e160 * x[0] + x[0]).unwrap();
    assert_eq!(extreme.linearisation(), Linearisation::Adequate, "{extreme}");
    let second = extreme.second_order().unwrap().standard_uncertainty;
    assert!((second / 3e-170 - 1.0).abs() < 1e-12, "{second}");
}

#[test]
fn a_constant_output_has_no_shares() {
    let error = VarianceShare::of_all(&normal(1.0, 0.1), 10_000, 0, 0.0, |_: &[f64]| 3.0).unwrap_err();
    assert!(error.to_string().contains("does not vary"), "{error}");
    let error = VarianceShare::of_all(&normal(1.0, 0.1), 10_000, 0, 0.5, |_: &[f64]| f64::NAN).unwrap_err();
    assert!(error.to_string().contains("the model failed in"), "{error}");
}

/// Whole blocks with one output, and then with two: the model changed, and no parts were mixed up.
#[test]
fn a_model_whose_number_of_outputs_changes_is_told_so() {
    let calls = AtomicU64::new(0);
    let changing = |_: &[f64]| vec![1.0; 1 + usize::from(calls.fetch_add(1, Ordering::Relaxed) >= 64_000)];
    let error = MonteCarlo::new(&normal(1.0, 0.1), 128_000).unwrap().run(changing).unwrap_err();
    assert!(error.to_string().contains("must not change"), "{error}");
    assert!(!error.to_string().contains("partial"), "{error}");
    let calls = AtomicU64::new(0);
    let changing = |_: &[fmm_uq::Taylor]| {
        vec![fmm_uq::Taylor::from(1.0); 1 + usize::from(calls.fetch_add(1, Ordering::Relaxed) > 0)]
    };
    let error = Gum::new(&normal(1.0, 0.1)).propagate(changing).unwrap_err();
    assert!(error.to_string().contains("gives 1 outputs, then 2"), "{error}");
    let error = Gum::new(&normal(1.0, 0.1)).propagate(|_: &[fmm_uq::Taylor]| Vec::new()).unwrap_err();
    assert!(error.to_string().ends_with("but gives 0"), "{error}");
}

/// a − b with r = 1 and equal uncertainties does not vary: zero is the answer and no shortcoming of the linear one.
#[test]
fn a_difference_of_fully_correlated_inputs_is_certain() {
    let two = Inputs::new([Input::new("a", 2.0, 0.1, "m").unwrap(), Input::new("b", 1.7, 0.1, "m").unwrap()]).unwrap();
    let inputs = two.with_correlations(&[("a", "b", 1.0)]).unwrap();
    let exact = propagate(&inputs, |x| x[0] - x[1]).unwrap();
    let stepped = Gum::new(&inputs).propagate_by_differences(|x| x[0] - x[1]).unwrap().single().unwrap();
    for budget in [exact, stepped] {
        assert_eq!((budget.standard_uncertainty(), budget.linearisation()), (0.0, Linearisation::Adequate));
        assert!(!budget.to_string().contains("warning"), "{budget}");
        assert_eq!(budget.expanded(0.95).unwrap().uncertainty, 0.0);
    }
    // What cancels to first order alone is still flagged: a² − 4 b + b²/3 … at slopes that cancel.
    let curved = propagate(&inputs, |x| x[0] * x[0] - x[1] * 4.0).unwrap();
    assert_eq!(curved.linearisation(), Linearisation::ZeroUncertainty);
    // Without the second order nobody has looked.
    let quick = Gum::new(&inputs).first_order_only().propagate(|x: &[fmm_uq::Taylor]| x[0] - x[1]).unwrap();
    assert_eq!(quick.outputs()[0].linearisation(), Linearisation::ZeroUncertainty);
}

#[test]
#[should_panic(expected = "the model's own words")]
fn a_panic_of_the_model_passes_through() {
    let _ = MonteCarlo::new(&normal(1.0, 0.1), 10).unwrap().run(|_| -> f64 { panic!("the model's own words") });
}
