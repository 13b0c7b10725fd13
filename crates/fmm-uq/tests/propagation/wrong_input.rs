//! Everything that a caller can get wrong is refused with an error of its own kind.

use fmm_uq::{
    Adaptive, Distribution, FailureKind, Input, Inputs, IntervalKind, MonteCarlo, UncertaintyError, VarianceShare,
    propagate,
};

fn one() -> Inputs {
    Inputs::new([Input::new("x", 1.0, 0.1, "m").unwrap()]).unwrap()
}

#[test]
fn correlations_that_are_not_positive_semidefinite() {
    let three = ["a", "b", "c"].map(|name| Input::new(name, 1.0, 0.1, "m").unwrap());
    let impossible = [("a", "b", 0.9), ("a", "c", 0.9), ("b", "c", -0.9)];
    let error = Inputs::new(three).unwrap().with_correlations(&impossible).unwrap_err();
    assert!(
        matches!(error, UncertaintyError::Invalid { ref what } if what.contains("smallest eigenvalue of the correlation matrix is -")),
        "{error}"
    );
}

#[test]
fn scales_that_are_not_positive() {
    for bad in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
        for (what, refused) in [
            ("normal", Distribution::normal(0.0, bad)),
            ("t", Distribution::student_t(0.0, bad, 5.0)),
            ("exponential", Distribution::exponential(bad)),
            ("scale of gamma", Distribution::gamma(2.0, bad)),
            ("shape of gamma", Distribution::gamma(bad, 2.0)),
            ("inexactness", Distribution::curvilinear_trapezoid(-1.0, 1.0, bad)),
        ] {
            let error = refused.unwrap_err();
            assert!(matches!(error, UncertaintyError::Invalid { .. }), "{what} of {bad}: {error}");
        }
    }
    let error = Input::new("x", 1.0, -0.1, "m").unwrap_err();
    assert!(error.to_string().ends_with("but is -0.1 m"), "{error}");
    let error = Distribution::student_t(0.0, 1.0, -3.0).unwrap_err();
    assert!(error.to_string().ends_with("but are -3"), "{error}");
}

#[test]
fn limits_that_are_inverted() {
    for (lower, upper) in [(1.0, -1.0), (1.0, 1.0), (f64::NAN, 1.0), (0.0, f64::NAN), (-1e308, 1e308)] {
        for (what, refused) in [
            ("rectangular", Distribution::rectangular(lower, upper)),
            ("triangular", Distribution::triangular(lower, upper)),
            ("trapezoid", Distribution::trapezoid(lower, upper, 0.5)),
            ("curvilinear trapezoid", Distribution::curvilinear_trapezoid(lower, upper, 0.1)),
            ("arc sine", Distribution::arc_sine(lower, upper)),
        ] {
            let error = refused.unwrap_err();
            assert!(matches!(error, UncertaintyError::Invalid { .. }), "{what} {lower} {upper}: {error}");
        }
    }
}

#[test]
fn models_that_give_no_number() {
    let error = propagate(&one(), |x| x[0] * f64::NAN).unwrap_err();
    assert!(matches!(error, UncertaintyError::Model { source: None, .. }), "{error}");
    let trials = MonteCarlo::new(&one(), 10).unwrap().run(|_| f64::NAN).unwrap_err();
    let UncertaintyError::TooManyFailures { first, .. } = &trials else { panic!("{trials}") };
    assert_eq!(first.kind, FailureKind::NotFinite { output: 0 });
    let error = VarianceShare::of_all(&one(), 10_000, 0, 0.0, |_: &[f64]| f64::NAN).unwrap_err();
    assert!(error.to_string().contains("failed in 10000 of"), "{error}");
    let run = MonteCarlo::adaptive(&one(), Adaptive::to_digits(2).unwrap());
    let error = run.run(|_| f64::INFINITY).unwrap_err();
    assert!(matches!(error, UncertaintyError::TooManyFailures { .. }), "{error}");
}

#[test]
fn runs_of_no_trials() {
    assert!(matches!(MonteCarlo::new(&one(), 0), Err(UncertaintyError::Invalid { .. })));
    let run = MonteCarlo::new(&one(), 10).unwrap();
    let nothing = run.run_blocks(0..0, |x| x[0]).unwrap();
    assert_eq!(nothing.trials(), 0);
    let error = run.finish(nothing).unwrap_err();
    assert!(matches!(error, UncertaintyError::PartialRun { block: Some(0), .. }), "{error}");
}

#[test]
fn more_trials_than_there_is_memory_for_can_be_ended() {
    let count = std::sync::atomic::AtomicU64::new(0);
    let stop = |_: fmm_uq::Progress| {
        let before = count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        if before < 20 { std::ops::ControlFlow::Continue(()) } else { std::ops::ControlFlow::Break(()) }
    };
    let run = MonteCarlo::new(&one(), 1 << 53).unwrap().with_progress(&stop);
    assert!(matches!(run.run(|x| x[0]), Err(UncertaintyError::Cancelled { .. })));
    assert!(matches!(run.run_blocks(0..u64::MAX, |x| x[0]), Err(UncertaintyError::Cancelled { .. })));
}

#[test]
fn coverage_probabilities_outside_of_0_and_1() {
    let sample = MonteCarlo::new(&one(), 1000).unwrap().run(|x| x[0]).unwrap();
    let budget = propagate(&one(), |x| x[0]).unwrap();
    for level in [0.0, 1.0, -0.5, 95.0, f64::NAN] {
        let results = [
            sample.symmetric_interval(0, level).err(),
            sample.shortest_interval(0, level).err(),
            sample.ellipsoid(level).err(),
            sample.rectangle(level).err(),
            budget.expanded(level).err(),
            Distribution::normal(0.0, 1.0).unwrap().quantile(level).err(),
            Adaptive::to_digits(2).unwrap().with_interval(IntervalKind::Shortest, level).err(),
        ];
        for (at, error) in results.into_iter().enumerate() {
            assert!(matches!(error, Some(UncertaintyError::Invalid { .. })), "{at}, {level}: {error:?}");
        }
    }
}

#[test]
fn parts_of_different_runs_or_twice_the_same() {
    let run = MonteCarlo::new(&one(), 3000).unwrap().with_seed(1);
    let part = |run: &MonteCarlo, index| run.run_blocks(run.shard(index, 3), |x| x[0]).unwrap();
    let (first, second) = (part(&run, 0), part(&run, 1));
    let seed = first.clone().merge(part(&run.clone().with_seed(2), 1)).unwrap_err();
    assert!(seed.to_string().contains("if their seeds agree, but one has 1 and another 2"), "{seed}");
    let wider = Inputs::new([Input::new("x", 1.0, 0.2, "m").unwrap()]).unwrap();
    let wider = first.clone().merge(part(&MonteCarlo::new(&wider, 3000).unwrap().with_seed(1), 1)).unwrap_err();
    assert!(wider.to_string().contains("inputs (by fingerprint)"), "{wider}");
    let pair = run.run_blocks(1..2, |x| [x[0], x[0]]).unwrap();
    let pair = first.clone().merge(pair).unwrap_err();
    assert!(pair.to_string().contains("if their numbers of outputs agree, but one has 1 and another 2"), "{pair}");
    let twice = first.clone().merge(second).unwrap().merge(first).unwrap_err();
    assert!(matches!(twice, UncertaintyError::PartialRun { block: Some(0), .. }), "{twice}");
}
