use std::f64::consts::PI;

use fmm_friction::{AccelerationCoulomb, Coulomb, CoulombStatic, CoulombViscous, Viscous};
use fmm_model::{Damping, Oscillator};

use super::*;
use crate::scenario::{Direction, Event, EventKind, Excitation, Mode};
use crate::trajectory::recorder::EVENT_BUDGET;

/// 1 kg on 2 N/m: with forces that are powers of two all centres and turning points of an undamped motion are exact.
fn machine(damping: f64) -> Oscillator {
    Oscillator::new(1.0, 2.0).unwrap().with_damping(Damping::linear(damping).unwrap())
}

fn run<L: PiecewiseLinearLaw<f64>>(
    machine: Oscillator,
    law: L,
    load: f64,
    start: (f64, f64),
) -> Result<Trajectory, SimulationError> {
    let scenario = Scenario::new(machine, law, load)?.starting_at(start.0, start.1)?;
    Exact.run(&scenario, &Sampling::uniform(0.01, 3001)?)
}

/// Kinds and positions (m) of the events.
fn story(motion: &Trajectory) -> Vec<(EventKind, f64)> {
    motion.events().iter().map(|event| (event.kind, event.position)).collect()
}

/// x = x₀ e^(−at) (cos ωt + (a/ω) sin ωt), v = −x₀ (k/mω) e^(−at) sin ωt.
#[test]
fn without_friction_samples_are_those_of_the_closed_form() {
    let motion = run(machine(0.4), Coulomb::new(0.0).unwrap(), 1.0, (0.5, 0.0)).unwrap();
    let (rate, angular) = (0.2, 1.96f64.sqrt());
    for (i, (x, v)) in motion.position().values().iter().zip(motion.velocity().values()).enumerate() {
        let time = 0.01 * i as f64;
        let (sin, cos) = (angular * time).sin_cos();
        let envelope = 0.5 * (-rate * time).exp();
        assert!((x - envelope * (cos + rate / angular * sin)).abs() < 1e-13, "{x} m at {time} s");
        assert!((v + envelope * 2.0 / angular * sin).abs() < 1e-13, "{v} m/s at {time} s");
    }
}

#[test]
fn a_load_equal_to_the_static_level_holds() {
    for sign in [1.0, -1.0] {
        for (law, edge) in [((0.25, 0.25), 0.125), ((0.25, 0.5), 0.25)] {
            let law = CoulombStatic::new(law.0, law.1).unwrap();
            let motion = run(machine(0.1), law, 1.0, (sign * edge, 0.0)).unwrap();
            assert_eq!(story(&motion), [(EventKind::Start, sign * edge)], "{law:?}");
            assert_eq!((motion.events()[0].next, motion.events()[0].margin()), (Mode::Stick, 0.0), "{law:?}");
            assert!(motion.position().values().iter().all(|x| *x == sign * edge), "{law:?}: it moves");
            assert!(motion.velocity().values().iter().all(|v| *v == 0.0), "{law:?}: it moves");
        }
    }
}

#[test]
fn one_ulp_beyond_breaks_away_towards_the_centre() {
    for sign in [1.0f64, -1.0] {
        for (breakaway, edge) in [(0.25, 0.125f64), (0.5, 0.25)] {
            let (law, beyond) = (CoulombStatic::new(0.25, breakaway).unwrap(), sign * edge.next_up());
            let motion = run(machine(0.0), law, 1.0, (beyond, 0.0)).unwrap();
            // The sliding level shifts the centre to 0.125 m, about which the start is mirrored.
            let mirrored = 2.0 * sign * 0.125 - beyond;
            assert_eq!(story(&motion), [(EventKind::Start, beyond), (EventKind::Stop, mirrored)], "{law:?}");
            assert_eq!(motion.events()[0].next, Mode::Slip(Direction::of(-sign)), "{law:?}");
        }
    }
}

/// At the edge of the stick zone as division gives it, k x rounds to above N μ for some loads. Nothing drives the
/// contact there either, so that it must not be said to reverse for ever without moving.
#[test]
fn a_load_that_rounding_puts_beyond_the_static_level_comes_to_rest() {
    let (stiffness, force) = (1982.0, 7.79);
    let edge = force / stiffness;
    assert!(stiffness * edge > force, "the case is one in which rounding goes up");
    let machine = Oscillator::new(10.391, stiffness).unwrap();
    let motion = run(machine, Coulomb::new(force).unwrap(), 1.0, (edge, 0.0)).unwrap();
    assert!(motion.rest().is_some() && motion.half_cycles() <= 1, "{} half cycles", motion.half_cycles());
}

#[test]
fn a_higher_static_level_ends_the_motion_at_an_earlier_turning_point() {
    // The centres are at ∓0.125 m, so that each half cycle is 0.25 m shorter; held are 0.125, 0.25, 0.3 and 0.75 m.
    let turns = [1.0, -0.75, 0.5, -0.25, 0.0];
    for (breakaway, half_cycles) in [(0.25, 4), (0.5, 3), (0.6, 3), (1.5, 1)] {
        let law = CoulombStatic::new(0.25, breakaway).unwrap();
        let motion = run(machine(0.0), law, 1.0, (1.0, 0.0)).unwrap();
        let positions: Vec<_> = motion.events().iter().map(|event| event.position).collect();
        assert_eq!(positions, turns[..=half_cycles], "{law:?}");
        assert_eq!(motion.rest().map(|rest| rest.kind), Some(EventKind::Stop), "{law:?}");
    }
}

#[test]
fn without_oscillation_nothing_reverses_twice() {
    let critical = 2.0 * 2f64.sqrt();
    for ratio in [1.0, 1.0 + 1e-9, 1.5, 40.0] {
        for start in [(1.0, 0.0), (1.0, 5.0), (1.0, -20.0), (-0.1, 3.0), (0.0, -1.0)] {
            let motion = run(machine(ratio * critical), Coulomb::new(0.25).unwrap(), 1.0, start).unwrap();
            assert!(motion.half_cycles() <= 1, "ζ = {ratio}: {} half cycles from {start:?}", motion.half_cycles());
            // It holds, or creeps on towards the edge of the stick zone without ever reaching it.
            let (last, end) = (motion.events().last().unwrap(), motion.position().values().last().unwrap());
            assert!(last.next == Mode::Stick || end.abs() >= 0.125 - 1e-15, "ζ = {ratio}: {end} m from {start:?}");
        }
    }
}

#[test]
fn without_friction_reversals_are_half_a_damped_period_apart() {
    let machine = machine(0.02);
    let half_period = PI / machine.damped_angular_frequency().unwrap();
    let ratio = (-machine.logarithmic_decrement().unwrap() / 2.0).exp();
    let motion = run(machine, Coulomb::new(0.0).unwrap(), 1.0, (0.3, 0.0)).unwrap();
    assert_eq!(motion.events().len(), 1 + (30.0 / half_period) as usize);
    for (n, event) in (0..).zip(motion.events()) {
        // 14 half cycles, each of a few ulp.
        let (time, position) = (f64::from(n) * half_period, 0.3 * (-ratio).powi(n));
        assert!((event.time - time).abs() < 1e-13, "reversal {n} at {} s, not {time} s", event.time);
        assert!((event.position - position).abs() < 1e-14, "reversal {n} at {} m, not {position} m", event.position);
    }
}

#[test]
fn an_unloaded_contact_does_nothing() {
    let free = run(machine(0.02), Viscous::new(0.0).unwrap(), 0.0, (0.3, -0.2)).unwrap();
    let unloaded = run(machine(0.02), CoulombStatic::new(0.3, 0.8).unwrap(), 0.0, (0.3, -0.2)).unwrap();
    assert_eq!(unloaded, free);
    assert_eq!(free.rest(), None);
    let resting = run(machine(0.02), Coulomb::new(0.3).unwrap(), 0.0, (0.0, 0.0)).unwrap();
    assert_eq!(resting.rest().map(Event::margin), Some(0.0), "a contact without load holds a spring without force");
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    let coulomb = |level| Coulomb::new(level).unwrap();
    let quadratic = machine(0.0).with_damping(Damping::new(0.1, 0.5).unwrap());
    let error = run(quadratic, coulomb(0.1), 1.0, (1.0, 0.0)).unwrap_err();
    assert_eq!(error, SimulationError::not_linear("nonlinear damping"));

    // Ten million half cycles in 30 s.
    let fast = Oscillator::new(1.0, 1e12).unwrap();
    let error = run(fast, coulomb(0.0), 1.0, (1.0, 0.0)).unwrap_err();
    assert!(error.to_string().contains(&format!("more than {EVENT_BUDGET} events")), "{error}");

    // v₀/ω is not a number of metres that exists, and neither is N μ_s one of newtons.
    let slow = Oscillator::new(1.0, 1e-20).unwrap();
    let error = run(slow, coulomb(0.0), 1.0, (0.0, 1e300)).unwrap_err();
    assert!(matches!(error, SimulationError::NotFinite { .. }), "{error}");
    let error = run(machine(0.0), coulomb(1e200), 1e200, (1.0, 0.0)).unwrap_err();
    assert!(matches!(error, SimulationError::NotFinite { .. }), "{error}");
}

/// A machine with a damper a billion times too strong: what rounding leaves of an acceleration that should vanish
/// outlives the beginning of a slip, and once turned it round for ever. Without inertia the velocity is (f − F)/c, and
/// the contact rests while |f| < F: it stops and lets go where the force crosses the level, within the delay m/c = 0.56
/// µs.
#[test]
fn a_damper_that_hides_inertia_leaves_the_events_of_the_force() {
    let damping = Damping::linear(30_968_428.776).unwrap();
    let machine = Oscillator::new(17.400_316, 104.571_22).unwrap().with_damping(damping);
    let (level, amplitude, angular, phase) = (2.305_094_1e-5 * 33.531_225, 7.618_859_9e-6, 8.658_777_9, 1.364_145);
    let scenario = Scenario::new(machine, CoulombViscous::new(2.305_094_1e-5, 0.0).unwrap(), 33.531_225)
        .unwrap()
        .driven_by(Excitation::base(-amplitude, angular, phase).unwrap());
    let motion = Exact.run(&scenario, &Sampling::uniform(0.01, 409).unwrap()).unwrap();
    let peak = 17.400_316 * amplitude * angular * angular;
    let events = &motion.events()[1..];
    assert!(events.len() >= 20, "{} events", events.len());
    for event in events {
        let force = -peak * (angular * event.time + phase).cos() - 104.571_22 * event.position;
        let expected = if event.next == Mode::Stick { EventKind::Stop } else { EventKind::Breakaway };
        assert_eq!(event.kind, expected, "at {} s", event.time);
        // peak · angular · m/c of the force goes by in the delay.
        assert!((force.abs() - level).abs() < 1e-4 * level, "{force} N at {} s", event.time);
    }
}

/// A contact whose friction is higher while it slows down starts and stops again and again under a load that falls to
/// the level of growing speed. At ten million seconds the last starts are nearer to that time than the numbers of a
/// clock are to each other, and must not be.
#[test]
fn starts_and_stops_end_when_the_load_has_fallen() {
    let damping = Damping::linear(2.853_2).unwrap();
    let machine = Oscillator::new(1.128_76, 0.106_73).unwrap().with_damping(damping);
    let law = AccelerationCoulomb::new(2.657_7e-5, 4.9e-3).unwrap();
    let pulse = Excitation::half_sine(1.87, 400.0).unwrap().delayed(1e7).unwrap();
    let scenario = Scenario::new(machine, law, 327.477).unwrap().driven_by(pulse);
    let motion = Exact.run(&scenario, &Sampling::uniform(100_005.0, 101).unwrap()).unwrap();
    let (first, last) = (motion.events()[1], motion.events().last().unwrap());
    assert_eq!(first.kind, EventKind::Breakaway);
    assert!(last.time > 1e7 + 400.0 && motion.events().len() < 2000, "{} events, {last:?}", motion.events().len());
}

#[test]
fn a_push_after_a_rest_starts_its_own_rhythm() {
    // A free decay has come to rest long before a constant force steps in at 20 s, and moves it for half a period.
    let push = Excitation::sampled_force(1.0, vec![4.0; 12]).unwrap().delayed(20.0).unwrap();
    let scenario = Scenario::new(machine(0.0), Coulomb::new(0.25).unwrap(), 1.0).unwrap();
    let scenario = scenario.starting_at(1.0, 0.0).unwrap().driven_by(push);
    let motion = Exact.run(&scenario, &Sampling::uniform(0.01, 3001).unwrap()).unwrap();
    let after: Vec<&Event> = motion.events().iter().filter(|event| event.time >= 20.0).collect();
    assert_eq!((after[0].kind, after[0].time), (EventKind::Breakaway, 20.0));
    // Two roundings of a time of 22 s.
    let half_cycle = after[1].time - 20.0;
    assert!((half_cycle - PI / 2f64.sqrt()).abs() < 1e-14 * 22.0, "a half cycle of {half_cycle} s");
}

#[test]
fn viscous_friction_on_a_fast_belt_pulls_with_the_relative_velocity() {
    // While the belt is faster the spring is in balance at N (μ + β v_b) / k = 2 (0.25 + 0.5 · 3)/2 m.
    let balance = 1.75;
    let belt = Excitation::belt(3.0).unwrap();
    let scenario = Scenario::new(machine(0.0), CoulombViscous::new(0.25, 0.5).unwrap(), 2.0).unwrap();
    let scenario = scenario.starting_at(balance, 0.0).unwrap().driven_by(belt);
    let motion = Exact.run(&scenario, &Sampling::uniform(0.01, 301).unwrap()).unwrap();
    // All numbers are sums of powers of two; a cosine and a sine of it may be one rounding off.
    let off = motion.position().values().iter().map(|x| (x - balance).abs()).fold(0.0, f64::max);
    assert!(off < 4.0 * f64::EPSILON * balance, "{off} m off the balance");
}
