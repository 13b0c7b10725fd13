//! The motion itself: the equation of motion between any two samples, and the automaton at every event.

use std::f64::consts::TAU;

use fmm_sim::{Direction, EventKind, Mode, Sampling, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::case::{Case, cases, exactly, log_uniform, sense};
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
    assert_eq!(motion.half_cycles(), events.len() - 1, "{case}");
}

#[test]
fn equation_of_motion_and_automaton() {
    let (mut stopped, mut reversed) = (0, 0);
    for case in cases(5, 1500) {
        let motion = case.run();
        decides_by_the_load(&case, &motion);
        obeys_the_equation_of_motion(&case, &motion);
        stopped += usize::from(motion.rest().is_some() && motion.events().len() > 1);
        reversed += usize::from(motion.half_cycles() > 3);
    }
    assert!(stopped > 200 && reversed > 200, "{stopped} cases stop and {reversed} reverse more than thrice");
}

/// Machine and start of a case that is chosen rather than drawn, without sampling to speak of.
fn started(mass: f64, stiffness: f64, damping: f64, friction: f64, start: (f64, f64)) -> Case {
    Case {
        mass,
        stiffness,
        damping,
        sliding: friction,
        breakaway: friction,
        normal_load: 1.0,
        position: start.0,
        velocity: start.1,
        interval: TAU / (stiffness / mass).sqrt() / 4.0,
        count: 40,
    }
}

/// A start where N μ/k puts the edge of the stick zone, and a few ulp around it, holds or stops within a half swing,
/// whichever way k x is rounded.
#[test]
fn starts_on_the_edge_come_to_rest() {
    let mut random = ChaCha8Rng::seed_from_u64(51);
    for _ in 0..1000 {
        let (mass, stiffness) = (log_uniform(&mut random, -3.0, 3.0), log_uniform(&mut random, -3.0, 6.0));
        let friction = log_uniform(&mut random, -3.0, 3.0);
        let mut edge = friction / stiffness;
        edge = if random.random_bool(0.5) { edge } else { -edge };
        for position in [edge.next_down().next_down(), edge.next_down(), edge, edge.next_up(), edge.next_up().next_up()]
        {
            let case = started(mass, stiffness, 0.0, friction, (position, 0.0));
            let motion = case.run();
            assert!(
                motion.rest().is_some() && motion.half_cycles() <= 1,
                "{} half cycles: {case}",
                motion.half_cycles()
            );
        }
    }
}

/// However large the damping, a motion away from the centre turns at
///
/// ```text
/// t = ln[(λ₁ v₀ + ω₀² y₀)/(λ₂ v₀ + ω₀² y₀)]/(λ₁ − λ₂),   λ₁ = a + √(a² − ω₀²),   λ₂ = ω₀²/λ₁
/// ```
///
/// with y counted from the centre, in which nothing cancels. There it stops, or creeps back.
#[test]
fn any_overdamped_motion_turns_in_time() {
    let mut random = ChaCha8Rng::seed_from_u64(52);
    for _ in 0..1000 {
        let (mass, angular) = (log_uniform(&mut random, -3.0, 3.0), log_uniform(&mut random, -1.0, 4.0));
        let (ratio, stiffness) = (log_uniform(&mut random, 0.05, 12.0), mass * angular * angular);
        let velocity = angular * log_uniform(&mut random, -4.0, 0.0);
        let reach = velocity / angular / ratio;
        let position = if random.random_bool(0.5) { 0.0 } else { reach * random.random_range(0.0..3.0) };
        let friction = stiffness * reach * random.random_range(0.0..1.0);
        let case = started(mass, stiffness, 2.0 * ratio * (mass * stiffness).sqrt(), friction, (position, velocity));

        let (rate, square) = (case.damping / (2.0 * mass), stiffness / mass);
        let root = rate * (1.0 - square / rate / rate).sqrt();
        let (fast, distance) = (rate + root, position + friction / stiffness);
        let slow = square / fast;
        let time = ((fast * velocity + square * distance) / (slow * velocity + square * distance)).ln() / (2.0 * root);
        let turn = ((fast * distance + velocity) * (-slow * time).exp()
            - (slow * distance + velocity) * (-fast * time).exp())
            / (2.0 * root)
            - friction / stiffness;
        let motion = exactly(&case, &case.scenario(), &Sampling::uniform(1.01 * time, 2).unwrap());
        assert_eq!(motion.half_cycles(), 1, "no turn at {time} s: {case}");
        let event = &motion.events()[1];
        // 1 − 1/ζ² > 0.2 costs up to 5 ulp of the root, once in each factor; the engine has as many from a² − ω₀².
        assert!((event.time / time - 1.0).abs() < 1e-13, "turns at {} s, not {time} s: {case}", event.time);
        let slack = 1e-14 * (distance + reach);
        assert!((event.position - turn).abs() < slack, "turns at {} m, not {turn} m: {case}", event.position);
    }
}

/// Turning points of a machine without friction follow its logarithmic decrement at its damped frequency.
#[test]
fn decrement_and_damped_frequency_are_those_of_the_machine() {
    let mut random = ChaCha8Rng::seed_from_u64(53);
    for _ in 0..1000 {
        let (mass, stiffness) = (log_uniform(&mut random, -3.0, 3.0), log_uniform(&mut random, -3.0, 6.0));
        let ratio = log_uniform(&mut random, -5.0, -0.3);
        let start = (log_uniform(&mut random, -6.0, 0.0), 0.0);
        let case = started(mass, stiffness, 2.0 * ratio * (mass * stiffness).sqrt(), 0.0, start);
        let (motion, machine) = (case.run(), case.oscillator());
        let (decrement, frequency) = (machine.logarithmic_decrement().unwrap(), machine.damped_frequency().unwrap());
        assert!(motion.half_cycles() >= 15, "{} half cycles: {case}", motion.half_cycles());
        for triple in motion.events().windows(3) {
            let (got, period) = ((triple[0].position / triple[2].position).ln(), triple[2].time - triple[0].time);
            // Ten periods are counted from zero, so that one of them is known to about ten ulp.
            assert!((period * frequency - 1.0).abs() < 1e-14, "period {period} s at {frequency} Hz: {case}");
            assert!((got - decrement).abs() < 1e-14 * (1.0 + decrement), "decrement {got}, not {decrement}: {case}");
        }
    }
}
