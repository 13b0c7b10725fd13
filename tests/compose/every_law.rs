//! Every law of the catalogue on the thesis' machine: the default search names it.

use fmm_friction::{
    AccelerationCoulomb, Berger, BoucWen, Coulomb, CoulombViscous, Dahl, ExponentialPair, Hyperbolic, Karnopp,
    LawFamily, LuGre, MakkarDixon, PowerLaw, RegularisedStribeck, Stribeck, StribeckLorentzian, Viscous,
};
use fmm_identify::{Comparison, Experiment, Identification, Machine, Preparation, search};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::{Sampling, Scenario, Trajectory, simulate_into};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// The default search on 3 s of a free vibration from 22 mm under 14 N with a contact of `values`, sampled at 1 kHz
/// with `noise` (m/s).
fn searched<F: LawFamily>(values: &[f64], noise: f64) -> Comparison {
    let oscillator = Oscillator::new(10.391, 1982.0).unwrap();
    let scenario = Scenario::new(oscillator, F::at(values).unwrap(), 14.0).unwrap().starting_at(0.022, 0.0).unwrap();
    let mut motion = Trajectory::new();
    simulate_into::<F, _>(&scenario, &Sampling::uniform(1e-3, 3000).unwrap(), None, &mut motion).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(16);
    let mut noisy = |velocity: &f64| {
        let normal: f64 = StandardNormal.sample(&mut random);
        velocity + noise * normal
    };
    let values = motion.velocity().values().iter().map(&mut noisy).collect();
    let record = Record::new(0.0, 1e-3, values, Quantity::Velocity, "m/s").unwrap();
    let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    search(&Machine::per_unit_mass(), &[decay]).unwrap()
}

/// Asserts that the law is preferred, or not excluded where the record does not decide.
fn assert_named<F: LawFamily>(values: &[f64]) {
    let comparison = searched::<F>(values, 1e-3);
    let is_right = |found: &Identification| found.law().split([' ', ',']).next() == Some(F::NAME);
    let is_named = if comparison.is_decided() {
        is_right(comparison.preferred())
    } else {
        comparison.not_excluded().any(is_right)
    };
    assert!(is_named, "{} of {values:?}: {comparison}", F::NAME);
}

#[test]
fn simple_laws_are_named() {
    assert_named::<Viscous>(&[0.2]);
    assert_named::<Coulomb>(&[0.25]);
    assert_named::<CoulombViscous>(&[0.25, 0.275 / 14.0]);
}

#[test]
fn laws_that_change_with_speed_are_named() {
    assert_named::<AccelerationCoulomb>(&[0.26, 0.24]);
    assert_named::<Stribeck>(&[0.2, 0.35, 0.05, 1.2, 0.02]);
    assert_named::<StribeckLorentzian>(&[0.2, 0.35, 0.05, 0.02]);
    assert_named::<Hyperbolic>(&[0.35, 3.0]);
    assert_named::<Berger>(&[0.228, 0.261, 2.852]);
    assert_named::<PowerLaw>(&[0.311, 0.2116, 0.031_48]);
    assert_named::<ExponentialPair>(&[0.2, 0.3, 10.0, 50.0]);
    assert_named::<MakkarDixon>(&[0.25, 100.0, 10.0, 0.1, 40.0, 0.02]);
    assert_named::<RegularisedStribeck>(&[0.3, 0.2, 0.01, 0.02]);
    assert_named::<Karnopp>(&[0.25, 0.3, 1e-3]);
}

#[test]
fn laws_with_a_state_are_named() {
    assert_named::<Dahl>(&[0.25, 1000.0, 1.0]);
    assert_named::<LuGre>(&[0.2, 0.3, 0.05, 2.0, 1000.0, 1.0, 0.02]);
    assert_named::<BoucWen>(&[250.0, 1.0, 600.0, 400.0, 1.0]);
}

/// A viscous part beside Coulomb friction is no rival where it would move nothing, and one where it may take a part of
/// the friction.
#[test]
fn damping_that_may_hide_leaves_the_record_undecided() {
    let told = searched::<Coulomb>(&[0.25], 1e-3);
    assert!(told.is_decided() && told.preferred().law() == "coulomb", "{told}");
    let hidden = searched::<Coulomb>(&[0.25], 3e-2);
    assert!(!hidden.is_decided(), "{hidden}");
    assert!(hidden.not_excluded().any(|found| found.law() == "coulomb_viscous"), "{hidden}");
}
