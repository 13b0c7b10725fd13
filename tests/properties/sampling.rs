//! Sampling looks at a motion and does not change it.

use fmm_sim::{Channels, Engine, Exact, Sampling, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::case::{Case, cases, exactly};

/// Samples of the same instants, taken by two samplings, agree to the rounding of both.
fn same_samples(case: &Case, what: &str, samples: impl Iterator<Item = (f64, [f64; 2], [f64; 2])>) {
    for (time, one, other) in samples {
        let tolerance = 2.0 * case.rounding(time);
        let position = one[0] - other[0];
        let velocity = (one[1] - other[1]) / case.angular();
        assert!(position.abs() <= tolerance, "{what}, {time} s: {position:e} m, {tolerance:e} m allowed: {case}");
        assert!(velocity.abs() <= tolerance, "{what}, {time} s: {velocity:e} m · ω₀, {tolerance:e} m allowed: {case}");
    }
}

fn state(motion: &Trajectory, index: usize) -> [f64; 2] {
    [motion.position().values()[index], motion.velocity().values()[index]]
}

/// The events of `part` are the first ones of `whole`, to the last bit, up to time `end`.
fn same_events(case: &Case, whole: &Trajectory, part: &Trajectory, end: f64) {
    let expected: Vec<_> = whole.events().iter().take_while(|event| event.time <= end).copied().collect();
    assert_eq!(part.events(), expected, "events up to {end} s: {case}");
}

#[test]
fn any_window_sees_the_same() {
    let mut random = ChaCha8Rng::seed_from_u64(41);
    for case in cases(41, 1000) {
        let (whole, sampling) = (case.run(), case.sampling());
        for _ in 0..4 {
            let first = random.random_range(0..case.count);
            let window = sampling.window(first..random.random_range(first + 1..=case.count)).unwrap();
            let part = exactly(&case, &case.scenario(), &window);
            assert_eq!(part.position().values().len(), window.count(), "{case}");
            same_events(&case, &whole, &part, window.end());
            let pairs = (0..window.count()).map(|i| (window.time(i), state(&part, i), state(&whole, first + i)));
            same_samples(&case, "window", pairs);
        }
    }
}

/// A finer interval by a power of two contains the same instants, to the last bit.
#[test]
fn more_samples_change_nothing() {
    let mut random = ChaCha8Rng::seed_from_u64(42);
    for case in cases(42, 1000) {
        let coarse = case.run();
        let factor = 1 << random.random_range(1..4);
        let fine =
            Case { interval: case.interval / f64::from(factor), count: (case.count - 1) * factor as usize + 1, ..case };
        let finer = fine.run();
        same_events(&case, &finer, &coarse, case.sampling().end());
        assert_eq!(finer.events().len(), coarse.events().len(), "{case}");
        let pairs = (0..case.count).map(|i| {
            let time = case.sampling().time(i);
            assert_eq!(time, fine.sampling().time(i * factor as usize));
            (time, state(&coarse, i), state(&finer, i * factor as usize))
        });
        same_samples(&case, "finer", pairs);
    }
}

/// Later samples, the choice of channels and the old content of a trajectory do not change a sample by a bit.
#[test]
fn length_channels_and_used_memory_leave_no_trace() {
    let mut used = Trajectory::new();
    for case in cases(43, 1000) {
        let (whole, scenario) = (case.run(), case.scenario());
        let half = case.sampling().window(0..case.count / 2).unwrap();
        let part = exactly(&case, &scenario, &half);
        same_events(&case, &whole, &part, half.end());
        assert_eq!(part.position().values(), &whole.position().values()[..half.count()], "{case}");
        assert_eq!(part.velocity().values(), &whole.velocity().values()[..half.count()], "{case}");

        let keeping = |channels| exactly(&case, &scenario, &case.sampling().keeping(channels));
        let (positions, velocities) = (keeping(Channels::Position), keeping(Channels::Velocity));
        assert_eq!((positions.position(), velocities.velocity()), (whole.position(), whole.velocity()), "{case}");
        assert!(positions.velocity().values().is_empty() && velocities.position().values().is_empty());
        let all = keeping(Channels::All);
        assert_eq!((all.position(), all.velocity()), (whole.position(), whole.velocity()), "{case}");

        Exact.run_into(&scenario, &case.sampling(), &mut used).unwrap();
        assert_eq!(used, whole, "{case}");
    }
}

/// Sample times of a window are the very numbers of the whole.
#[test]
fn windows_of_windows() {
    let whole = Sampling::uniform(0.1, 1000).unwrap();
    let window = whole.window(100..900).and_then(|window| window.window(50..2000)).unwrap();
    assert_eq!((window.first(), window.count()), (150, 750));
    for index in 0..window.count() {
        assert_eq!(window.time(index), whole.time(150 + index), "sample {index}");
    }
}
