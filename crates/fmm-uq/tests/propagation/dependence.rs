//! Correlated inputs in a Monte Carlo: multivariate normal and t, and the Gaussian copula.

use fmm_uq::{Distribution, Input, Inputs, MonteCarlo, OutputSample, UncertaintyError};

const TRIALS: u64 = 400_000;

fn run(inputs: &Inputs) -> OutputSample {
    MonteCarlo::new(inputs, TRIALS).unwrap().run(<[f64]>::to_vec).unwrap()
}

#[test]
fn multivariate_normal() {
    let input = |name, u| Input::new(name, 1.0, u, "m").unwrap();
    let pairs = [("a", "b", 0.6), ("a", "c", -0.4), ("b", "c", 0.1)];
    let inputs = Inputs::new([input("a", 0.1), input("b", 2.0), input("c", 1e-3)]).unwrap();
    let sample = run(&inputs.with_correlations(&pairs).unwrap());
    for ((i, j), r) in [(0, 1), (0, 2), (1, 2)].into_iter().zip([0.6, -0.4, 0.1]) {
        // Standard error (1 − r²)/√M, at most 0.0016.
        let found = sample.correlation(i, j).unwrap();
        assert!((found - r).abs() < 0.008, "{i}, {j}: {found}, not {r}");
    }
    for (j, u) in [0.1, 2.0, 1e-3].into_iter().enumerate() {
        let [_, error] = sample.standard_errors(j).unwrap();
        assert!((sample.standard_uncertainty(j).unwrap() - u).abs() < 5.0 * error);
    }
}

#[test]
fn full_correlation_and_constants_among_the_correlated() {
    let inputs = Inputs::new([
        Input::new("a", 1.0, 0.1, "m").unwrap(),
        Input::new("b", 5.0, 0.3, "m").unwrap(),
        Input::new("c", 7.0, 0.0, "m").unwrap(),
    ]);
    let inputs = inputs.unwrap().with_correlations(&[("a", "b", -1.0), ("a", "c", 0.5), ("b", "c", -0.5)]).unwrap();
    let sample = run(&inputs);
    let (a, b) = (sample.values(0).unwrap(), sample.values(1).unwrap());
    assert!(a.iter().zip(b).all(|(a, b)| ((a - 1.0) / 0.1 + (b - 5.0) / 0.3).abs() < 1e-12));
    assert!(sample.values(2).unwrap().iter().all(|&c| c == 7.0));
}

/// Two multivariate t of one ensemble share their stretching: uncorrelated, but their squares are not independent.
#[test]
fn multivariate_t() {
    let nu = 8.0;
    let input = |name| Input::new(name, 0.0, 1.0, "m").unwrap();
    let inputs = Inputs::new([input("a"), input("b")]).unwrap().with_ensemble(&["a", "b"], nu).unwrap();
    assert_eq!(inputs.as_slice()[0].degrees_of_freedom(), nu);
    let sample = MonteCarlo::new(&inputs, TRIALS).unwrap().run(|x| [x[0], x[1], x[0] * x[0] * x[1] * x[1]]).unwrap();
    // E(a² b²) = ν²/((ν − 2)(ν − 4)), 8/3 here; for independent t's it would be (ν/(ν − 2))², 16/9. The product has
    // hardly a variance, so that a tenth is what its mean can be held to.
    assert!((sample.estimate(2).unwrap() - 8.0 / 3.0).abs() < 0.1, "{}", sample.estimate(2).unwrap());
    assert!(sample.correlation(0, 1).unwrap().abs() < 0.01);
    // The margin is t: its 97.5 % quantile is 2.3060, with √(p (1 − p)/M)/g = 0.0066 from the density 0.0376 there.
    let end = sample.symmetric_interval(0, 0.95).unwrap().high;
    assert!((end - 2.3060).abs() < 0.033, "{end}");
}

/// r of the normal scores gives (6/π) asin(r/2) between rectangular margins.
#[test]
fn gaussian_copula() {
    let input = |name: &str| Input::of(name, Distribution::rectangular(-1.0, 1.0).unwrap(), "m").unwrap();
    let inputs = Inputs::new([input("a"), input("b")]).unwrap().with_correlations(&[("a", "b", 0.5)]).unwrap();
    let sample = run(&inputs);
    let expected = 6.0 / std::f64::consts::PI * 0.25f64.asin();
    assert!((sample.correlation(0, 1).unwrap() - expected).abs() < 0.008);
    let u = sample.standard_uncertainty(0).unwrap();
    assert!((u - 1.0 / 3f64.sqrt()).abs() < 5.0 * sample.standard_errors(0).unwrap()[1], "{u}");
}

#[test]
fn simultaneous_observations() {
    let inputs = Inputs::from_observations(&[
        ("a", "m", &[1.0, 1.2, 0.9, 1.1, 1.05]),
        ("b", "m", &[2.0, 2.5, 1.9, 2.2, 2.0]),
        ("c", "m", &[3.0; 5]),
    ])
    .unwrap();
    let expected = inputs.correlation("a", "b").unwrap();
    assert!(expected > 0.9 && inputs.correlation("a", "c") == Some(0.0));
    assert!((run(&inputs).correlation(0, 1).unwrap() - expected).abs() < 0.02);
    let unequal = Inputs::from_observations(&[("a", "m", &[1.0, 2.0]), ("b", "m", &[1.0, 2.0, 3.0])]);
    assert!(matches!(unequal, Err(UncertaintyError::Invalid { what }) if what.contains("there are 2 and 3")));
    assert!(Inputs::from_observations(&[("a", "m", &[1.0])]).is_err());
    assert!(Inputs::from_observations(&[("a", "m", &[1.0, f64::NAN])]).is_err());
}

#[test]
fn ensembles_are_of_normal_inputs_and_do_not_overlap() {
    let limits = Input::of("c", Distribution::rectangular(0.0, 1.0).unwrap(), "m").unwrap();
    let inputs = ["a", "b"].map(|name| Input::new(name, 0.0, 1.0, "m").unwrap());
    let inputs = Inputs::new(inputs.into_iter().chain([limits])).unwrap();
    let ensemble = |names: &[&str], nu| inputs.clone().with_ensemble(names, nu);
    assert!(
        matches!(ensemble(&["a", "c"], 5.0), Err(UncertaintyError::Invalid { what }) if what.contains("neither normal"))
    );
    assert!(
        matches!(ensemble(&["a", "a"], 5.0), Err(UncertaintyError::Invalid { what }) if what.contains("in an ensemble already"))
    );
    let again = ensemble(&["a"], 5.0).unwrap().with_ensemble(&["b", "a"], 5.0);
    assert!(matches!(again, Err(UncertaintyError::Invalid { what }) if what.contains("in an ensemble already")));
    assert!(ensemble(&["a"], 0.5).is_err() && ensemble(&["d"], 5.0).is_err());
}
