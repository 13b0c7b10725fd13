//! Runs under forces, beside a reference that knows no events: classical Runge-Kutta with steps so short that kinks do
//! not matter.

use fmm_friction::{BoucWen, BristleLaw, Dahl, LuGre, MaxwellSlip, Regime};
use fmm_model::{Damping, Oscillator};

use super::*;
use crate::scenario::{Direction, EventKind, Excitation, Mode, State};

/// x and v at the samples of `sampling`, by `steps` steps of order 4 a sample.
fn reference<L: BristleLaw<f64>>(scenario: &Scenario<f64, L>, sampling: &Sampling, steps: usize) -> Vec<State> {
    let oscillator = scenario.oscillator();
    let drive = Forcing::of(scenario);
    let (mut index, mut piece) = (0, drive.piece(0));
    let State { position, velocity } = scenario.initial();
    let mut y = [position, velocity, 0.0];
    let step = sampling.interval().unwrap() / steps as f64;
    let mut states = vec![scenario.initial()];
    for sample in 1..sampling.count() {
        for part in 0..steps {
            let time = ((sample - 1) * steps + part) as f64 * step;
            while time + 0.5 * step > piece.end {
                index += 1;
                piece = drive.piece(index);
            }
            let rates = |time: f64, [x, v, z]: [f64; 3]| {
                let mut rate = [0.0];
                scenario.law().rate(v, &[z], Regime::ALL_HOLD, &mut rate);
                let friction = scenario.normal_load() * scenario.law().coefficient(v, &[z], &rate);
                let machine = oscillator.damping_force(v) + oscillator.restoring_force(x);
                [v, (piece.force(time) - machine - friction) / oscillator.mass(), rate[0]]
            };
            let ahead = |rate: [f64; 3], by: f64| std::array::from_fn(|i| y[i] + by * rate[i]);
            let first = rates(time, y);
            let second = rates(time + 0.5 * step, ahead(first, 0.5 * step));
            let third = rates(time + 0.5 * step, ahead(second, 0.5 * step));
            let last = rates(time + step, ahead(third, step));
            y = std::array::from_fn(|i| y[i] + step / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + last[i]));
        }
        states.push(State { position: y[0], velocity: y[1] });
    }
    states
}

/// The largest difference from the reference, relative to the largest speed; after every event of which the energy must
/// balance and the direction must be another.
fn check<L: BristleLaw<f64>>(what: &str, scenario: &Scenario<f64, L>, sampling: &Sampling, steps: Option<usize>) {
    let motion = Bristle::default().run(scenario, &sampling.clone().with_work()).unwrap();
    let imbalance = motion.energy_imbalance(scenario).unwrap();
    // Each of some hundred swings may be off by the tolerance.
    assert!(imbalance < 10.0 * Bristle::default().tolerance(), "{what}: energy is off by {imbalance:e}");
    let mut going = None;
    for event in motion.events() {
        let turns = event.kind == EventKind::Reversal && !event.grazing;
        assert!(!(turns && Some(event.next) == going), "{what}: no turn at {} s, {:?}", event.time, event.next);
        going = if event.next == Mode::Stick { None } else { Some(event.next) };
    }
    let Some(steps) = steps else { return };
    let fastest = motion.velocity().values().iter().fold(0.0f64, |most, v| most.max(v.abs()));
    for (index, expected) in reference(scenario, sampling, steps).iter().enumerate() {
        let error = (motion.velocity().values()[index] - expected.velocity).abs() / fastest;
        // What a kink within a step of the reference leaves.
        assert!(error < 1e-5, "{what}: v is off by {error:e} of the fastest at {} s", sampling.time(index));
    }
}

fn dahl(level: f64, stiffness: f64) -> Dahl {
    Dahl::new(level, stiffness, 1.0).unwrap()
}

fn lugre(level: f64, stiffness: f64) -> LuGre {
    LuGre::new(level, level * 1.5, 0.05, 1.0, stiffness, 3.0 * level, 0.1 * level).unwrap()
}

fn bouc_wen(level: f64, stiffness: f64) -> BoucWen {
    let softening = stiffness / level;
    BoucWen::new(stiffness, 1.0, softening * 0.6, softening * 0.4, 1.0).unwrap()
}

/// A wave on a soft contact, and a fast one on the machine of the thesis: steps that were too long saw zeros of the
/// velocity that were none, and shorter ones ended there all the same.
#[test]
fn a_zero_that_only_a_bad_step_saw_is_no_event() {
    let machine = Oscillator::new(1.0, 1.0).unwrap();
    let wave = Excitation::harmonic(2.0, 10.0, 0.0).unwrap();
    let soft = Scenario::new(machine, dahl(0.1, 0.1), 1.0).unwrap().starting_at(1.0, 0.0).unwrap().driven_by(wave);
    check("a soft contact", &soft, &Sampling::uniform(1e-3, 1000).unwrap(), Some(20));

    let machine = Oscillator::new(10.391, 1982.0).unwrap();
    let wave = Excitation::harmonic(100.0, 200.0, 0.0).unwrap();
    let fast = Scenario::new(machine, dahl(0.25, 250.0), 14.0).unwrap().starting_at(0.01, 0.0).unwrap().driven_by(wave);
    check("the thesis' machine", &fast, &Sampling::uniform(1e-3, 1000).unwrap(), Some(50));
}

/// Numbers between −1 and 1.
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Machines, contacts, starts and forces at random; every tenth run beside the reference.
fn check_random<L: BristleLaw<f64>>(name: &str, law: fn(f64, f64) -> L, is_sampled: bool) {
    let mut seed = 7;
    for case in 0..100 {
        let mut spread = |value: f64, decades: f64| value * 10f64.powf(decades * random(&mut seed));
        let (mass, stiffness, damping) = (spread(3.0, 0.7), spread(500.0, 1.0), spread(0.3, 1.0));
        let damping = Damping::linear(damping).unwrap();
        let machine = Oscillator::new(mass, stiffness).unwrap().with_damping(damping);
        let load = spread(5.0, 0.5);
        let law = law(spread(0.2, 0.3), spread(500.0, 1.0));
        let (amplitude, angular) = (spread(10.0, 1.0), spread(40.0, 1.0));
        let start = State { position: 0.01 * random(&mut seed), velocity: 0.1 * random(&mut seed) };
        let force = if is_sampled {
            // From one independent value to the next within 5 ms, on half of the cases rounded to eighths.
            let values = (0..60).map(|_| amplitude * random(&mut seed));
            let values = values.map(|f| if case % 2 == 0 { f } else { (8.0 * f).round() / 8.0 });
            Excitation::sampled_force(5e-3, values.collect::<Vec<_>>()).unwrap()
        } else {
            Excitation::harmonic(amplitude, angular, 3.0 * random(&mut seed)).unwrap()
        };
        let scenario = Scenario::new(machine, law, load).unwrap();
        let scenario = scenario.starting_at(start.position, start.velocity).unwrap().driven_by(force);
        let sampling = Sampling::uniform(5e-4, 801).unwrap();
        check(&format!("{name}, case {case}"), &scenario, &sampling, (case % 10 == 0).then_some(100));
    }
}

#[test]
fn waves_move_dahl_contacts_without_false_events() {
    check_random("Dahl", dahl, false);
}

#[test]
fn waves_move_lugre_contacts_without_false_events() {
    check_random("LuGre", lugre, false);
}

#[test]
fn waves_move_bouc_wen_contacts_without_false_events() {
    check_random("Bouc-Wen", bouc_wen, false);
}

#[test]
fn sampled_forces_move_dahl_contacts_without_false_events() {
    check_random("Dahl", dahl, true);
}

#[test]
fn sampled_forces_move_lugre_contacts_without_false_events() {
    check_random("LuGre", lugre, true);
}

#[test]
fn sampled_forces_move_bouc_wen_contacts_without_false_events() {
    check_random("Bouc-Wen", bouc_wen, true);
}

/// A counterface too slow to tell the level of a LuGre contact from its static one drags the state to its bound within
/// rounding. A blow then makes it fast: the state must fall to the sliding level.
#[test]
fn a_state_at_its_bound_leaves_it_with_the_speed() {
    let machine = Oscillator::new(1.0, 1e6).unwrap().with_damping(Damping::linear(500.0).unwrap());
    let law = LuGre::new(0.2, 0.3, 10.0, 2.0, 1e5, 0.0, 0.0).unwrap();
    let blow = Excitation::half_sine(-1e5, 0.002).unwrap().delayed(3.0).unwrap();
    let scenario = Scenario::new(machine, law, 5.0).unwrap().driven_by(Excitation::belt(5e-5).unwrap());
    let sampling = Sampling::uniform(1e-4, 30_020).unwrap();
    let motion = Bristle::default().run(&scenario.driven_by(blow), &sampling).unwrap();
    let [held, slid] = [29_999, 30_008].map(|index| motion.states()[0].values()[index] * 1e5);
    assert!((held + 0.3).abs() < 1e-6, "a coefficient of {held}");
    assert!((slid + 0.2).abs() < 1e-3, "a coefficient of {slid}");
}

/// From rest, a push that soon turns round: the first swing takes 2 ms or less, the first step is longer than 0.1 s.
#[test]
fn the_first_swing_may_be_the_shortest() {
    fn check_first<L: BristleLaw<f64> + Clone>(name: &str, law: &L) {
        for push in [1e-3, 1e-4, 1e-5, 1e-7] {
            let machine = Oscillator::new(1.0, 1.0).unwrap();
            let force = Excitation::sampled_force(1.0, vec![push, push - 1.0]).unwrap();
            let scenario = Scenario::new(machine, law.clone(), 1.0).unwrap().driven_by(force);
            let sampling = Sampling::uniform(1e-3, 1000).unwrap();
            check(name, &scenario, &sampling, Some(20));
            let motion = Bristle::default().run(&scenario, &sampling).unwrap();
            let [start, reversal, ..] = motion.events() else { panic!("{name}: {:?}", motion.events()) };
            assert_eq!(start.next, Mode::Slip(Direction::Positive), "{name} under {push} N");
            assert_eq!(
                (reversal.kind, reversal.next),
                (EventKind::Reversal, Mode::Slip(Direction::Negative)),
                "{name}"
            );
            // m v = f t − t²/2 N/s, less what the damping of the bristles, below 1 N s/m, does in 2 ms.
            let time = 2.0 * push;
            assert!((reversal.time - time).abs() < 2e-3 * time, "{name}: at {}, not {time} s", reversal.time);
        }
    }
    check_first("Dahl", &dahl(0.2, 1.0));
    check_first("LuGre", &lugre(0.2, 1.0));
    check_first("Bouc-Wen", &bouc_wen(0.2, 1.0));
}

/// A force takes a contact to rest and on again; the narrower the bounds between which it just turns it round, the
/// nearer the velocity comes to touching zero.
#[test]
fn a_velocity_that_touches_zero_keeps_its_direction() {
    let machine = Oscillator::new(1.0, 1.0).unwrap();
    let sampling = Sampling::uniform(1e-3, 1001).unwrap();
    let run = |pull: f64| {
        let force = Excitation::sampled_force(0.25, vec![0.0, -pull, 2.0, 0.0, 0.0]).unwrap();
        Scenario::new(machine, dahl(0.2, 50.0), 1.0).unwrap().starting_at(0.0, 1.0).unwrap().driven_by(force)
    };
    let (mut passes, mut turns, mut touches) = (0.0, 20.0, 0);
    for _ in 0..60 {
        let pull = 0.5 * (passes + turns);
        let scenario = run(pull);
        check(&format!("a pull of {pull} N"), &scenario, &sampling, None);
        let motion = Bristle::default().run(&scenario, &sampling).unwrap();
        let early = motion.events()[1..].iter().filter(|event| event.time < 0.6);
        let early: Vec<_> = early.filter(|event| event.kind == EventKind::Reversal).collect();
        if early.iter().any(|event| event.next == Mode::Slip(Direction::Negative)) {
            turns = pull;
        } else {
            touches += early.len();
            passes = pull;
        }
    }
    assert!(turns - passes < 1e-14, "between {passes} N and {turns} N");
    assert!(touches > 0, "no velocity touches zero between {passes} N and {turns} N");
}

/// Elements that slide together when the motion turns come back to sliding at one instant, which rounding splits.
#[test]
fn elements_that_turned_together_slide_again_together() {
    let machine = Oscillator::new(0.01, 100.0).unwrap().with_damping(Damping::linear(2.0).unwrap());
    let law = MaxwellSlip::new(&[(50.0, 0.1), (15.0, 0.1)]).unwrap();
    let mut found = 0;
    for part in 1..=200 {
        let back = 3.0 - 2e-3 * f64::from(part);
        let force = Excitation::sampled_force(0.1, vec![0.0, 3.0, back, 5.0, 5.0 + back, 2.0, 3.0]).unwrap();
        let scenario = Scenario::new(machine, law.clone(), 1.0).unwrap().driven_by(force);
        let sampling = Sampling::uniform(1e-3, 601).unwrap();
        check(&format!("back to {back} N"), &scenario, &sampling, None);
        let motion = Bristle::default().run(&scenario, &sampling).unwrap();
        let yields: Vec<_> = motion.events().iter().filter(|event| matches!(event.kind, EventKind::Yield(_))).collect();
        found += yields.windows(2).filter(|pair| (pair[1].time - pair[0].time) < 1e-12).count();
    }
    assert!(found > 0, "no elements slide at one instant");
}
