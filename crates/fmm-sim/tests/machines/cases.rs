//! Machines on which engines once went wrong, and events at the times of samples.

use fmm_friction::{
    BoucWen, BristleLaw, Coulomb, CoulombStatic, Dahl, FamilyMember, Gms, Karnopp, LuGre, MaxwellSlip, Stribeck,
};
use fmm_model::{Damping, Dual, Oscillator, Restoring, Scalar};
use fmm_sim::{Bristle, Channels, Engine, EventKind, Excitation, RungeKutta, Sampling, Scenario, Trajectory, simulate};

use crate::draw::{Cause, Machine};
use crate::referee::{Contact, Referee};

fn oscillator(restoring: Restoring) -> Oscillator {
    Oscillator::new(1.0, 100.0).unwrap().with_restoring(restoring)
}

fn bristles<L: BristleLaw<f64>>(law: L, oscillator: Oscillator, start: f64, sampling: &Sampling) -> Trajectory {
    let scenario = Scenario::new(oscillator, law, 1.0).unwrap().starting_at(start, 0.0).unwrap();
    let motion = Bristle::default().run(&scenario, sampling).unwrap();
    assert!(motion.energy_imbalance(&scenario).is_some_and(|imbalance| imbalance < 1e-9));
    motion
}

/// Half a cycle across a gap: two arcs of the spring and a way of constant speed, but for a friction of 2.5 % of the
/// spring's force.
#[test]
fn bristles_released_outside_of_a_gap_move() {
    let gap = oscillator(Restoring::gap(0.01).unwrap());
    let sampling = Sampling::uniform(0.01, 101).unwrap().with_work();
    let curve = Stribeck::new(0.1, 0.12, 0.05, 1.0, 0.0).unwrap();
    let motions = [
        bristles(Dahl::new(0.1, 100.0, 1.0).unwrap(), gap, 0.05, &sampling),
        bristles(LuGre::new(0.1, 0.1, 0.05, 1.0, 100.0, 0.0, 0.0).unwrap(), gap, 0.05, &sampling),
        bristles(BoucWen::new(100.0, 1.0, 1000.0, 0.0, 1.0).unwrap(), gap, 0.05, &sampling),
        bristles(MaxwellSlip::new(&[(100.0, 0.1)]).unwrap(), gap, 0.05, &sampling),
        bristles(Gms::new(curve, 1.0, &[(100.0, 1.0)]).unwrap(), gap, -0.05, &sampling),
    ];
    for motion in &motions {
        let reversal = motion.events().iter().find(|event| event.kind == EventKind::Reversal).expect("it turns");
        assert!((reversal.time - 0.365).abs() < 2e-3, "{} s", reversal.time);
    }
    // With these numbers the first three laws are one.
    for (first, other) in motions[0].position().values().iter().zip(motions[1].position().values()) {
        assert!((first - other).abs() < 1e-10, "{first} m, {other} m");
    }
}

/// The turn that ends a step lies a few micrometres behind the stop, and the step begins before it.
#[test]
fn a_turn_just_behind_a_stop_is_that_of_the_stop() {
    let machine = Oscillator::new(1.042_138_152_143_404, 125.252_012_281_128_57).unwrap();
    let machine = machine
        .with_damping(Damping::new(0.0, 3.418_914_738_055_105).unwrap())
        .with_restoring(Restoring::stop(0.004_099_105_438_817_825, 0.499_069_778_472_510_44).unwrap());
    let law = CoulombStatic::new(0.064_790_394_412_786_07, 0.103_497_667_685_049_55).unwrap();
    let scenario = Scenario::new(machine, law, 0.275_059_849_899_340_2).unwrap();
    let scenario = scenario.starting_at(0.005_689_856_315_713_716, -0.011_128_633_643_386_048).unwrap();
    let times = vec![0.0, 1.094_033_623_997_866_5, 1.131_758_921_377_103_3, 1.169_484_218_756_340_1];
    let motion = RungeKutta::default().run(&scenario, &Sampling::at(times).unwrap().with_work()).unwrap();
    let imbalance = motion.energy_imbalance(&scenario).unwrap();
    assert!(imbalance < 1e-13, "{imbalance:e}");
}

/// A stop may be so stiff that the machine comes back from it within the step that has taken it there.
#[test]
fn hard_stops_are_passed() {
    for ratio in [10.0, 700.0, 1000.0, 1e4, 1e6] {
        let machine = oscillator(Restoring::stop(0.01, ratio).unwrap());
        let scenario = Scenario::new(machine, Coulomb::new(0.1).unwrap(), 1.0).unwrap();
        let scenario = scenario.starting_at(0.02, 0.0).unwrap();
        let motion = RungeKutta::default().run(&scenario, &Sampling::uniform(0.01, 101).unwrap().with_work());
        let motion = motion.unwrap_or_else(|error| panic!("{ratio}: {error}"));
        let imbalance = motion.energy_imbalance(&scenario).unwrap();
        assert!(imbalance < 1e-11 && motion.half_cycles() > 3, "{ratio}: {imbalance:e}");
        // ½ k (x² + (b − 1)(x − g)²) falls by the work of friction.
        let [start, turn, ..] = motion.events() else { panic!("{ratio}: it never turns") };
        let way = (start.position - turn.position).abs();
        let lost = machine.potential_energy(start.position) - machine.potential_energy(turn.position);
        assert!((lost / (0.1 * way) - 1.0).abs() < 1e-13 * ratio.max(1e3), "{ratio}: {lost} J");
    }
}

/// Friction rises at 1/500 of the greatest speed and less, for a few hundred-thousandths of a half cycle.
#[test]
fn the_tolerance_governs_a_narrow_stribeck_curve() {
    let oscillator = oscillator(Restoring::Linear);
    let sampling = Sampling::uniform(0.2, 11).unwrap();
    for (fall_speed, exponent) in [(1e-3, 2.0), (1e-4, 2.0), (1e-5, 1.0), (3e-4, 1.3)] {
        let law = LuGre::new(0.1, 0.2, fall_speed, exponent, 200.0, 0.0, 0.0).unwrap();
        let machine = Machine {
            oscillator,
            start: (0.05, 0.0),
            cause: Cause::Free,
            load: 1.0,
            friction: 0.1,
            amplitude: 0.05,
            angular: 10.0,
            end: 2.0,
        };
        let (mut referee, mut budget) = (Referee::new(&machine, Contact::Bristle(&law)), 1_000_000);
        let at = |index| referee.advance(sampling.time(index), &mut budget).expect("a few thousand steps")[0];
        let expected: Vec<f64> = (0..sampling.count()).map(at).collect();
        for tolerance in [1e-8, 1e-10, 1e-12] {
            let scenario = Scenario::new(oscillator, law, 1.0).unwrap().starting_at(0.05, 0.0).unwrap();
            let motion = Bristle::new(tolerance).unwrap().run(&scenario, &sampling).unwrap();
            let pairs = motion.position().values().iter().zip(&expected);
            let off = pairs.map(|(x, y)| (x - y).abs() / 0.05).fold(0.0, f64::max);
            assert!(off < tolerance.max(1e-12), "{fall_speed} m/s, to {tolerance:e}: {off:e} off");
        }
    }
}

/// A long step after very short ones, whose polynomial predicts nothing so far ahead: as good as any other.
#[test]
fn a_bad_prediction_does_not_spoil_a_step() {
    let machine = Oscillator::new(6.613_641_991_945_747, 180.105_250_648_551).unwrap();
    let law = Dahl::new(1.623_468_701_990_882_6e-7, 0.215_822_633_048_437_93, 0.637_798_192_887_835_6).unwrap();
    let scenario = Scenario::new(machine, law, 3.096_188_898_224_162_8).unwrap();
    let scenario = scenario.starting_at(-0.002_790_904_625_833_019, 0.0).unwrap();
    let scenario = scenario.driven_by(Excitation::constant(0.190_535_259_230_396_46).unwrap());
    let motion = Bristle::default().run(&scenario, &Sampling::uniform(0.0925, 51).unwrap().with_work()).unwrap();
    let imbalance = motion.energy_imbalance(&scenario).unwrap();
    assert!(imbalance < 1e-11, "{imbalance:e}");
}

/// A contact that is caught at the speed of its dead zone loses that energy to friction, on a belt as well.
#[test]
fn a_dead_zone_keeps_the_balance() {
    for belt in [0.0, 0.05, -0.2] {
        let scenario =
            Scenario::new(oscillator(Restoring::Linear), Karnopp::new(0.1, 0.2, 0.02).unwrap(), 1.0).unwrap();
        let scenario = scenario.starting_at(0.05, 0.0).unwrap().driven_by(Excitation::belt(belt).unwrap());
        let motion = simulate(&scenario, &Sampling::uniform(0.01, 200).unwrap().with_work()).unwrap();
        let imbalance = motion.energy_imbalance(&scenario).unwrap();
        assert!(imbalance < 1e-12 && motion.half_cycles() > 2, "{belt} m/s: {imbalance:e}");
    }
}

type Numbers = Dual<2>;

/// A machine under a law, samples at all times of its events and halfway between them. A sample at an event holds the
/// state after it: with the time T of the event moving by T_θ, x_θ there is that of the event, and v_θ = −a T_θ.
fn samples_at_events<L: FamilyMember<Number = Numbers> + Clone>(law: L, restoring: Restoring<Numbers>, driven: bool) {
    let machine = Oscillator::new(Numbers::variable(1.0, 0), Numbers::from(100.0)).unwrap().with_restoring(restoring);
    let scenario = Scenario::new(machine, law, Numbers::from(1.0)).unwrap();
    let mut scenario = scenario.starting_at(Numbers::variable(0.05, 1), Numbers::from(0.0)).unwrap();
    if driven {
        let wave = Excitation::harmonic(Numbers::from(2.0), Numbers::from(7.0), Numbers::from(0.3)).unwrap();
        scenario = scenario.driven_by(wave);
    }
    let first = simulate(&scenario, &Sampling::uniform(0.05, 21).unwrap()).unwrap();
    let events = || first.events().iter().skip(1).filter(|event| event.time.value() < 0.99);
    let mut times: Vec<f64> = events().map(|event| event.time.value()).collect();
    assert!(times.len() >= 2, "{} events", times.len());
    times.dedup();
    let last = 1.0;
    let between = times.iter().zip(times.iter().skip(1).chain([&last])).map(|(a, b)| 0.5 * (a + b));
    let mut all: Vec<f64> = between.chain(times.iter().copied()).chain([last]).collect();
    all.sort_by(f64::total_cmp);
    let motion = simulate(&scenario, &Sampling::at(all.clone()).unwrap().keeping(Channels::All)).unwrap();
    assert_eq!(motion.events().len(), first.events().iter().filter(|event| event.time.value() <= last).count());
    for event in events() {
        // Of several at one time the last one counts.
        if events().filter(|other| other.time.value() == event.time.value()).count() > 1 {
            continue;
        }
        let index = all.iter().position(|time| *time == event.time.value()).expect("a sample at the event");
        let [x, v, a] = [motion.position(), motion.velocity(), motion.acceleration()].map(|of| of.values()[index]);
        let case = format!("{} {:?} at {} s", motion.engine(), event.kind, event.time.value());
        // The rounding of a polynomial about the middle of a step.
        assert!((x - event.position.value()).abs() < 1e-15, "{case}: {x} m");
        assert!((v - event.velocity.value()).abs() < 1e-14, "{case}: {v} m/s");
        for direction in 0..2 {
            let late = event.time.partial(direction);
            // Where the event stays while the time goes on.
            let expected = [event.position.partial(direction) - v * late, event.velocity.partial(direction) - a * late];
            let got = [motion.position(), motion.velocity()].map(|of| of.partial(direction).unwrap()[index]);
            for (got, expected) in got.into_iter().zip(expected) {
                assert!((got - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{case}: {got} for {expected}");
            }
        }
    }
}

#[test]
fn samples_at_events_hold_the_state_after_them_with_its_derivatives() {
    let number = Numbers::from;
    let springs = [
        Restoring::Linear,
        Restoring::gap(number(0.01)).unwrap(),
        Restoring::stop(number(0.02), number(30.0)).unwrap(),
        Restoring::polynomial(number(100.0), number(0.0)).unwrap(),
    ];
    for restoring in springs {
        for driven in [false, true] {
            samples_at_events(CoulombStatic::new(number(0.3), number(0.4)).unwrap(), restoring, driven);
            let stribeck = Stribeck::new(number(0.2), number(0.4), number(0.05), number(1.0), number(0.0)).unwrap();
            samples_at_events(stribeck, restoring, driven);
            samples_at_events(Dahl::new(number(0.3), number(200.0), number(1.0)).unwrap(), restoring, driven);
        }
    }
}
