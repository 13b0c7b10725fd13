//! The motion itself: the equation of motion between any two samples, and the automaton at every event.

use fmm_sim::{Direction, EventKind, Mode, Trajectory};

use crate::case::{Case, cases, sense};
use crate::series::advance;

/// From each sample the power series of the equation of motion leads to the next one, over every event on the
/// way, where it arrives at zero velocity and at the position of the event.
fn obeys_the_equation_of_motion(case: &Case, motion: &Trajectory) {
    let (sampling, angular) = (case.sampling(), case.angular());
    let (positions, velocities) = (motion.position().values(), motion.velocity().values());
    let agree = |what: &str, time: f64, got: (f64, f64), expected: (f64, f64)| {
        // Twice, because both ends of a stretch are rounded.
        let tolerance = 2.0 * case.rounding(time);
        let (x, v) = (got.0 - expected.0, (got.1 - expected.1) / angular);
        assert!(x.abs() <= tolerance, "{what} at {time} s: position {x:e} m off, {tolerance:e} m allowed: {case}");
        assert!(v.abs() <= tolerance, "{what} at {time} s: velocity/ω₀ {v:e} m off, {tolerance:e} m allowed: {case}");
    };
    agree("start", 0.0, (positions[0], velocities[0]), (case.position, case.velocity));
    let mut current = 0;
    for index in 1..case.count {
        let (mut time, next) = (sampling.time(index - 1), sampling.time(index));
        let mut state = (positions[index - 1], velocities[index - 1]);
        while let Some(event) = motion.events().get(current + 1).filter(|event| event.time <= next) {
            state = advance(case, sense(motion.events()[current].next), state, event.time - time);
            agree("event", event.time, (event.position, event.velocity), state);
            (time, state) = (event.time, (event.position, event.velocity));
            current += 1;
        }
        let (sample, event) = ((positions[index], velocities[index]), &motion.events()[current]);
        if event.next == Mode::Stick {
            assert_eq!(sample, (event.position, 0.0), "sample {index} in stick: {case}");
        } else {
            agree("sample", next, sample, advance(case, sense(event.next), state, next - time));
            let along = sense(event.next) * sample.1 / angular;
            assert!(along >= -case.rounding(next), "sample {index} moves against its mode: {along:e} m: {case}");
        }
    }
    assert_eq!(current + 1, motion.events().len(), "events up to the last sample: {case}");
}

/// The decisions of the automaton, which are exact comparisons.
fn decides_by_the_load(case: &Case, motion: &Trajectory) {
    let events = motion.events();
    let hold = case.normal_load * case.breakaway;
    let start = &events[0];
    assert_eq!(
        (start.kind, start.time, start.position, start.velocity),
        (EventKind::Start, 0.0, case.position, case.velocity),
        "{case}"
    );
    for (index, event) in events.iter().enumerate() {
        assert_eq!((event.load, event.static_level), ((case.stiffness * event.position).abs(), hold), "{case}");
        let expected = if event.velocity != 0.0 {
            Mode::Slip(if event.velocity > 0.0 { Direction::Positive } else { Direction::Negative })
        } else if event.load <= hold {
            Mode::Stick
        } else {
            Mode::Slip(if event.position > 0.0 { Direction::Negative } else { Direction::Positive })
        };
        assert_eq!(event.next, expected, "event {index} at {} s: {case}", event.time);
        if event.velocity == 0.0 {
            let holds = event.margin() <= 0.0;
            assert_eq!(event.next == Mode::Stick, holds, "event {index}, margin {}: {case}", event.margin());
        }
    }
    for (index, pair) in events.windows(2).enumerate() {
        let (before, after) = (&pair[0], &pair[1]);
        assert!(before.time < after.time, "event {} is not later than the one before: {case}", index + 1);
        assert_eq!(after.velocity, 0.0, "velocity at event {}: {case}", index + 1);
        let kind = if after.next == Mode::Stick { EventKind::Stop } else { EventKind::Reversal };
        assert_eq!(after.kind, kind, "event {}: {case}", index + 1);
        if after.next != Mode::Stick {
            assert_eq!(sense(after.next), -sense(before.next), "event {} does not reverse: {case}", index + 1);
        }
        if index > 0 {
            let (farther, nearer) = (before.position.abs(), after.position.abs());
            // One ulp of the centre and one of the distance to it.
            let ulp = 2.0 * f64::EPSILON * case.size();
            assert!(nearer <= farther + ulp, "turning point {index}: {nearer} m after {farther} m: {case}");
        }
    }
    let rest = events.last().filter(|event| event.next == Mode::Stick);
    assert_eq!(motion.rest(), rest, "{case}");
    assert_eq!(motion.half_swings(), events.len() - 1, "{case}");
}

#[test]
fn equation_of_motion_and_automaton() {
    let (mut stopped, mut reversed) = (0, 0);
    for case in cases(5, 1500) {
        let motion = case.run();
        decides_by_the_load(&case, &motion);
        obeys_the_equation_of_motion(&case, &motion);
        stopped += usize::from(motion.rest().is_some() && motion.events().len() > 1);
        reversed += usize::from(motion.half_swings() > 3);
    }
    assert!(stopped > 200 && reversed > 200, "{stopped} cases stop and {reversed} reverse more than thrice");
}
