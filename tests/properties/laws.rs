//! Laws that become others in a limit give the same numbers there to the last bit, and all keep the promises of
//! their trait.

use fmm_friction::{
    BristleLaw, Coulomb, CoulombStatic, CoulombViscous, Dahl, LawFamily, PiecewiseLinearLaw, Regime, SlidingLaw,
    Viscous,
};
use fmm_sim::{Mode, Trajectory, simulate_into};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::case::{Case, cases, exactly, log_uniform};

fn with<L: PiecewiseLinearLaw<f64>>(case: &Case, law: L) -> Trajectory {
    exactly(case, &case.with_law(law), &case.sampling())
}

/// A case and a viscous coefficient that damps about as much as its machine may.
fn cases_with_viscosity(seed: u64) -> impl Iterator<Item = (Case, f64)> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    cases(seed, 1000).map(move |case| {
        let critical = 2.0 * (case.stiffness * case.mass).sqrt();
        let ratio = log_uniform(&mut random, -4.0, 0.3);
        (case, if case.normal_load > 0.0 { ratio * critical / case.normal_load } else { ratio })
    })
}

#[test]
fn viscous_friction_is_damping_of_the_machine() {
    for (case, viscous) in cases_with_viscosity(91) {
        let damped = Case { damping: case.damping + case.normal_load * viscous, ..case };
        let both = with(&case, CoulombViscous::new(case.sliding, viscous).unwrap());
        assert_eq!(both, with(&damped, Coulomb::new(case.sliding).unwrap()), "β = {viscous} s/m: {case}");
        let alone = with(&case, Viscous::new(viscous).unwrap());
        assert_eq!(alone, with(&damped, Coulomb::new(0.0).unwrap()), "β = {viscous} s/m: {case}");
        assert_eq!(alone, with(&case, CoulombViscous::new(0.0, viscous).unwrap()), "β = {viscous} s/m: {case}");
    }
}

#[test]
fn equal_levels_are_coulomb() {
    for case in cases(92, 1000) {
        let coulomb = with(&case, Coulomb::new(case.sliding).unwrap());
        assert_eq!(with(&case, CoulombStatic::new(case.sliding, case.sliding).unwrap()), coulomb, "{case}");
        assert_eq!(with(&case, CoulombViscous::new(case.sliding, 0.0).unwrap()), coulomb, "{case}");
    }
}

#[test]
fn an_unloaded_contact_is_none() {
    for (case, viscous) in cases_with_viscosity(93) {
        let unloaded = Case { normal_load: 0.0, ..case };
        let free = with(&unloaded, Viscous::new(0.0).unwrap());
        assert_eq!(with(&unloaded, CoulombViscous::new(case.sliding, viscous).unwrap()), free, "{case}");
        assert_eq!(unloaded.run(), free, "{case}");
    }
}

/// The static level decides at which turning point the motion ends; until then it changes nothing.
#[test]
fn static_level_only_ends_the_motion() {
    let mut earlier = 0;
    for case in cases(94, 1500) {
        let (held, coulomb) = (case.run(), with(&case, Coulomb::new(case.sliding).unwrap()));
        let (last, passed) = held.events().split_last().unwrap();
        let same = |one: &fmm_sim::Event, other: &fmm_sim::Event| {
            (one.time, one.position, one.velocity) == (other.time, other.position, other.velocity)
        };
        assert!(
            passed.iter().zip(coulomb.events()).all(|(one, other)| same(one, other) && one.next == other.next),
            "{case}"
        );
        assert!(same(last, &coulomb.events()[passed.len()]), "{case}");
        let until = if last.next == Mode::Stick { last.time } else { f64::INFINITY };
        let moving = (0..case.count).take_while(|index| case.sampling().time(*index) < until).count();
        assert_eq!(held.position().values()[..moving], coulomb.position().values()[..moving], "{case}");
        assert_eq!(held.velocity().values()[..moving], coulomb.velocity().values()[..moving], "{case}");
        earlier += usize::from(coulomb.events().len() > held.events().len());
    }
    assert!(earlier > 20, "{earlier} cases end at an earlier turning point");
}

/// A law made by its family is the law, and the family's engine is the exact one.
#[test]
fn families_make_their_laws() {
    fn made<L: LawFamily>(case: &Case, values: &[f64]) -> Trajectory {
        let mut motion = Trajectory::new();
        simulate_into::<L, _>(&case.with_law(L::at(values).unwrap()), &case.sampling(), None, &mut motion).unwrap();
        motion
    }
    for (case, viscous) in cases_with_viscosity(95).take(200) {
        let (mu, hold) = (case.sliding, case.breakaway);
        assert_eq!(made::<Coulomb>(&case, &[mu]), with(&case, Coulomb::new(mu).unwrap()), "{case}");
        assert_eq!(made::<CoulombStatic>(&case, &[mu, hold]), case.run(), "{case}");
        assert_eq!(made::<Viscous>(&case, &[viscous]), with(&case, Viscous::new(viscous).unwrap()), "{case}");
        let both = with(&case, CoulombViscous::new(mu, viscous).unwrap());
        assert_eq!(made::<CoulombViscous>(&case, &[mu, viscous]), both, "{case}");
    }
}

#[test]
fn sliding_laws_never_push() {
    fn kept<L: SlidingLaw<f64>>(law: &L, speed: f64) {
        assert!(law.coefficient(speed) >= 0.0 && law.coefficient(speed).is_finite(), "{speed} m/s");
        assert!(law.coefficient(0.0) <= law.breakaway(), "{} > {}", law.coefficient(0.0), law.breakaway());
    }
    let mut random = ChaCha8Rng::seed_from_u64(96);
    for _ in 0..1000 {
        let speed = log_uniform(&mut random, -9.0, 3.0);
        let (mu, viscous) = (log_uniform(&mut random, -6.0, 1.0), log_uniform(&mut random, -6.0, 3.0));
        kept(&Coulomb::new(mu).unwrap(), speed);
        kept(&CoulombStatic::new(mu, mu * random.random_range(1.0..3.0)).unwrap(), speed);
        kept(&CoulombViscous::new(mu, viscous).unwrap(), speed);
        kept(&Viscous::new(viscous).unwrap(), speed);
    }
}

/// Dahl's law is odd, never leaves its box, loads towards the level in the direction of motion and does not depend on
/// the rate: its slope over the path is the same at any speed.
#[test]
fn dahl_keeps_the_promises_of_a_bristle() {
    let mut random = ChaCha8Rng::seed_from_u64(97);
    for _ in 0..1000 {
        let (mu, stiffness) = (log_uniform(&mut random, -3.0, 1.0), log_uniform(&mut random, 1.0, 8.0));
        let law = Dahl::new(mu, stiffness, random.random_range(0.3..4.0)).unwrap();
        let rate = |velocity: f64, state: f64| {
            let mut rate = [0.0];
            law.rate(velocity, &[state], Regime::ALL_HOLD, &mut rate);
            rate[0]
        };
        let (bound, velocity) = (law.bound(0), log_uniform(&mut random, -6.0, 1.0));
        let state = random.random_range(-0.999..0.999) * bound;
        assert_eq!(rate(-velocity, -state), -rate(velocity, state), "{law:?} at z = {state} m");
        assert_eq!(law.coefficient(-velocity, &[-state], &[0.0]), -law.coefficient(velocity, &[state], &[0.0]));
        assert!(rate(velocity, state) > 0.0 && rate(-velocity, state) < 0.0, "{law:?} at z = {state} m");
        assert_eq!(rate(2.0 * velocity, state), 2.0 * rate(velocity, state), "{law:?} at z = {state} m");
        let beyond = bound * random.random_range(1.001..2.0);
        assert!(rate(velocity, beyond) < 0.0 && rate(-velocity, -beyond) > 0.0, "{law:?} at z = {beyond} m");
        assert!(law.coefficient(velocity, &[bound], &[0.0]) <= mu * (1.0 + 2.0 * f64::EPSILON), "{law:?}");
    }
}
