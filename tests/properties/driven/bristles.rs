//! Laws with internal state under all forces and belts: energy, events and, where two engines can, agreement.

use fmm_friction::{BoucWen, BristleLaw, Dahl, Gms, LuGre, MaxwellSlip, Stribeck};
use fmm_sim::{Bristle, Engine, EventKind, Exact, Mode, Scenario, SimulationError, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::contact::Family;
use super::modes::samples_follow_the_modes;
use super::setup::{Setup, draws, setups};
use crate::case::log_uniform;

/// Samples of a motion.
const SAMPLES: usize = 97;

/// Properties of a contact: a level (1), a stiffness (1/m) at which it is reached within the motion, a typical speed
/// (m/s), and the viscous coefficient (s/m) that would damp the machine critically.
struct Contact {
    level: f64,
    stiffness: f64,
    speed: f64,
    critical: f64,
}

/// Random machines with forces and belts, each with a scenario of what `law` makes of a random contact.
fn scenarios<L: BristleLaw<f64>>(
    seed: u64,
    linear: bool,
    law: impl Fn(&mut ChaCha8Rng, &Contact) -> L,
) -> impl Iterator<Item = (Setup, Scenario<f64, L>)> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    setups(seed, Family::Coulomb, linear, draws(2000)).map(move |setup| {
        let angular = setup.angular();
        let contact = Contact {
            level: setup.law[0],
            stiffness: setup.law[0] / setup.length * log_uniform(&mut random, 0.5, 2.5),
            speed: setup.length * angular,
            critical: 2.0 * setup.mass * angular / setup.normal_load,
        };
        let machine = setup.scenario(|_, value| value).expect("Coulomb's law takes any level");
        let law = law(&mut random, &contact);
        let scenario = Scenario::new(*machine.oscillator(), law, setup.normal_load)
            .and_then(|scenario| scenario.starting_at(setup.position, setup.velocity))
            .unwrap();
        let scenario = machine.excitations().iter().cloned().fold(scenario, Scenario::driven_by);
        (setup, scenario)
    })
}

/// The kind of each event fits the direction before and after it.
fn kinds_fit_the_motion(setup: &Setup, motion: &Trajectory) {
    for pair in motion.events().windows(2) {
        let (before, event) = (pair[0].next, &pair[1]);
        let fits = match event.kind {
            EventKind::Start => false,
            EventKind::Stop => before != Mode::Stick && event.next == Mode::Stick,
            EventKind::Reversal => before != Mode::Stick && (event.grazing || event.next != before),
            EventKind::Breakaway => before == Mode::Stick && event.next != Mode::Stick,
            _ => event.next == before,
        };
        assert!(fits && event.time >= pair[0].time, "{:?} after {before:?}, {event:?}: {setup}", event.kind);
    }
}

fn check<L: BristleLaw<f64> + std::fmt::Debug>(seed: u64, law: impl Fn(&mut ChaCha8Rng, &Contact) -> L) {
    let (mut checked, mut given_up) = (0, 0);
    for (setup, scenario) in scenarios(seed, false, law) {
        let sampling = setup.sampling(SAMPLES).with_work();
        let motion = match Bristle::default().run(&scenario, &sampling) {
            Ok(motion) => motion,
            Err(SimulationError::Exhausted { .. }) => {
                given_up += 1;
                continue;
            }
            Err(error) => panic!("{error}: {setup}"),
        };
        // Some hundred swings, each off by up to the tolerance.
        let imbalance = motion.energy_imbalance(&scenario).unwrap();
        assert!(
            imbalance < 300.0 * Bristle::default().tolerance(),
            "{imbalance:e} of the energy is missing: {:?} {setup}",
            scenario.law()
        );
        samples_follow_the_modes(&setup, &sampling, &motion, 1e-8);
        kinds_fit_the_motion(&setup, &motion);
        checked += 1;
    }
    assert!(given_up * 50 <= checked, "{given_up} of {} motions given up", checked + given_up);
}

#[test]
fn dahl_contacts_follow_forces_and_belts() {
    check(21, |_, contact| Dahl::new(contact.level, contact.stiffness, 1.0).unwrap());
}

#[test]
fn lugre_contacts_follow_forces_and_belts() {
    check(22, |random, contact| {
        let Contact { level, stiffness, speed, critical } = *contact;
        let fall = speed * log_uniform(random, -1.5, 0.0);
        let damping = critical * log_uniform(random, -2.0, 0.0);
        LuGre::new(level, level * random.random_range(1.0..2.0), fall, 2.0, stiffness, damping, 0.1 * critical).unwrap()
    });
}

#[test]
fn bouc_wen_contacts_follow_forces_and_belts() {
    check(23, |random, contact| {
        let (softening, share) = (contact.stiffness / contact.level, random.random_range(0.5..0.9));
        BoucWen::new(contact.stiffness, 1.0, softening * share, softening * (1.0 - share), 1.0).unwrap()
    });
}

#[test]
fn gms_contacts_follow_forces_and_belts() {
    check(24, |random, contact| {
        let Contact { level, stiffness, speed, .. } = *contact;
        let curve = Stribeck::new(level, level * random.random_range(1.0..2.0), 0.3 * speed, 2.0, 0.0).unwrap();
        Gms::new(curve, 10.0 * speed * stiffness / level, &[(stiffness, 0.6), (0.3 * stiffness, 0.4)]).unwrap()
    });
}

fn maxwell_slip(contact: &Contact) -> MaxwellSlip {
    let Contact { level, stiffness, .. } = *contact;
    MaxwellSlip::new(&[(stiffness, 0.5 * level), (0.3 * stiffness, 0.5 * level)]).unwrap()
}

#[test]
fn maxwell_slip_contacts_follow_forces_and_belts() {
    check(25, |_, contact| maxwell_slip(contact));
}

/// The engine for bristles has no closed form, the other one no steps.
#[test]
fn elements_move_alike_on_both_engines() {
    let (mut checked, mut events) = (0, 0);
    for (setup, scenario) in scenarios(26, true, |_, contact| maxwell_slip(contact)) {
        let sampling = setup.sampling(SAMPLES);
        let exact = Exact.run(&scenario, &sampling).unwrap_or_else(|error| panic!("{error}: {setup}"));
        let stepped = Bristle::default().run(&scenario, &sampling).unwrap_or_else(|error| panic!("{error}: {setup}"));
        let size = exact.position().values().iter().fold(setup.length, |size, x| size.max(x.abs()));
        let pairs = exact.position().values().iter().zip(stepped.position().values());
        let off = pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max) / size;
        assert!(off < 1e-7, "{off:e} of the greatest position apart: {setup}");
        (checked, events) = (checked + 1, events + exact.events().len());
    }
    assert!(events > 5 * checked, "{events} events in {checked} motions");
}
