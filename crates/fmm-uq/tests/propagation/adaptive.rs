//! Promises of the adaptive procedure, against known results.

use fmm_uq::{Adaptive, Distribution, Input, Inputs, IntervalKind, MonteCarlo, OutputSample, UncertaintyError};

fn one(distribution: Result<Distribution, UncertaintyError>) -> Inputs {
    Inputs::new([Input::of("x", distribution.unwrap(), "1").unwrap()]).unwrap()
}

fn run(inputs: &Inputs, rule: Adaptive, seed: u64) -> Result<OutputSample, UncertaintyError> {
    MonteCarlo::adaptive(inputs, rule).with_seed(seed).run(|x| x[0])
}

/// How many of `runs` end with both ends of the interval within the tolerance of where they belong.
fn within(inputs: &Inputs, rule: Adaptive, kind: IntervalKind, tolerance: f64, ends: [f64; 2], runs: u64) -> u64 {
    let near = |seed: &u64| {
        let sample = run(inputs, rule, *seed).unwrap();
        let interval = match kind {
            IntervalKind::Shortest => sample.shortest_interval(0, 0.95).unwrap(),
            _ => sample.symmetric_interval(0, 0.95).unwrap(),
        };
        (interval.low - ends[0]).abs() <= tolerance && (interval.high - ends[1]).abs() <= tolerance
    };
    (0..runs).filter(near).count() as u64
}

/// The ends of a 95 % interval of a normal and of an exponential quantity, of which the shortest begins at the edge.
#[test]
fn what_is_stated_lies_within_the_tolerance() {
    const NORMAL: f64 = 1.959_963_984_540_054;
    let normal = one(Distribution::normal(0.0, 1.0));
    let exponential = one(Distribution::exponential(1.0));
    for (what, inputs, ends, tolerance, kind) in [
        ("normal, symmetric", &normal, [-NORMAL, NORMAL], 0.02, IntervalKind::Symmetric),
        ("normal, shortest", &normal, [-NORMAL, NORMAL], 0.02, IntervalKind::Shortest),
        ("exponential, shortest", &exponential, [0.0, 20f64.ln()], 0.02, IntervalKind::Shortest),
    ] {
        let rule = Adaptive::to_tolerance(tolerance).unwrap().with_interval(kind, 0.95).unwrap();
        let found = within(inputs, rule, kind, tolerance, ends, 100);
        // A promise of 95 % that is decided when it looks good holds in about nine of ten: 90 ± 3.
        assert!(found >= 81, "{what}: {found} of 100 runs end within {tolerance}");
    }
}

/// All shortest intervals of a rectangular quantity are equally short, so that trials cannot tell where they end.
#[test]
fn an_interval_that_never_settles_is_not_stated() {
    let rule = Adaptive::to_tolerance(0.005).unwrap().with_interval(IntervalKind::Shortest, 0.95).unwrap();
    let flat = one(Distribution::rectangular(0.0, 1.0));
    for seed in 0..10 {
        let found = run(&flat, rule.with_most_trials(2_000_000), seed);
        assert!(matches!(found, Err(UncertaintyError::TooFewTrials { trials: 2_000_000, .. })), "{seed}: {found:?}");
    }
}
