//! Friction over speed without a law, of driven motions, impacts, and contacts that hold more than they slide with.

use std::f64::consts::{PI, TAU};

use fmm_friction::{CoulombStatic, CoulombViscous};
use fmm_identify::{
    Drive, Experiment, FrictionCurve, FrictionLevel, ImpactTrial, Known, Machine, Preparation, Source, identify,
};
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, Excitation, Sampling, Scenario};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

/// Mass (kg), natural frequency (Hz), damping (N s/m) and sliding friction (N) of the machine.
const MASS: f64 = 10.0;
const FREQUENCY: f64 = 2.0;
const DAMPING: f64 = 2.0;
const FRICTION: f64 = 3.0;
const RATE: f64 = 400.0;

/// The machine with a static friction of this many times the sliding one.
fn scenario(holding: f64) -> Scenario<f64, CoulombStatic> {
    let machine = Oscillator::new(MASS, MASS * (TAU * FREQUENCY).powi(2)).unwrap();
    let machine = machine.with_damping(Damping::linear(DAMPING).unwrap());
    Scenario::new(machine, CoulombStatic::new(FRICTION, holding * FRICTION).unwrap(), 1.0).unwrap()
}

/// Noise of a velocity (m/s), 0.1 % of the largest one.
const NOISE: f64 = 3e-4;

/// Velocity (m/s) of the scenario in `duration` (s) with this `noise` (m/s).
fn velocity(scenario: &Scenario<f64, CoulombStatic>, duration: f64, noise: f64, seed: u64) -> Record {
    let sampling = Sampling::uniform(1.0 / RATE, (duration * RATE) as usize).unwrap();
    let motion = Exact.run(scenario, &sampling).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, noise).unwrap();
    let values = motion.velocity().values().iter().map(|value| value + noise.sample(&mut random)).collect();
    Record::sampled(RATE, values, Quantity::Velocity, "m/s").unwrap()
}

/// A force (N) that sweeps from 0.7 to 1.3 of the natural frequency in ten seconds.
fn sweep() -> Vec<f64> {
    let at = |i: u32| f64::from(i) / RATE;
    (0..4000).map(|i| 9.0 * (TAU * FREQUENCY * (0.7 + 0.03 * at(i)) * at(i)).sin()).collect()
}

fn driven(holding: f64, noise: f64, seed: u64) -> Experiment {
    let scenario = scenario(holding).driven_by(Excitation::sampled_force(1.0 / RATE, sweep()).unwrap());
    let force = Record::sampled(RATE, sweep(), Quantity::Force, "N").unwrap();
    let response = velocity(&scenario, 10.0, noise, seed);
    Experiment::driven(&response, Drive::force(&force).unwrap(), &Preparation::default()).unwrap()
}

/// The ring-down from a `release` (m).
fn ring_down(holding: f64, release: f64, seed: u64) -> Experiment {
    let response = velocity(&scenario(holding).starting_at(release, 0.0).unwrap(), 6.0, NOISE, seed);
    Experiment::ring_down(&response, &Preparation::default()).unwrap()
}

/// The band of `curve` holds the friction and damping of the machine over this factor.
fn require_truth(curve: &FrictionCurve, factor: f64) {
    for (speed, (low, high)) in curve.speeds().iter().zip(curve.band(0.99).unwrap()) {
        let truth = (FRICTION + DAMPING * speed) / factor;
        assert!(low <= truth && truth <= high, "{truth} at {speed} is outside [{low}, {high}]");
        assert!(high - low < 0.3 * truth, "[{low}, {high}] at {speed} says nothing");
    }
}

/// A measured force tells friction as a force, whatever is known of mass and stiffness; a load makes it a coefficient.
#[test]
fn a_force_tells_the_scale_of_the_curve() {
    let experiments = [driven(1.0, NOISE, 1)];
    let free = FrictionCurve::of(&Machine::unknown(), &experiments).unwrap();
    assert_eq!(free.unit(), "N");
    require_truth(&free, 1.0);
    let mass = |uncertainty| Machine::of_mass(Known::new(1.004 * MASS, uncertainty).unwrap()).unwrap();
    let known = FrictionCurve::of(&mass(0.05 * MASS), &experiments).unwrap();
    require_truth(&known, 1.0);
    // A law that is fitted per mass is drawn as the force that it is.
    let found = identify::<CoulombViscous>(&mass(0.05 * MASS), &experiments).unwrap();
    for (speed, force) in known.by_law(&found, &experiments).unwrap() {
        let truth = FRICTION + DAMPING * speed;
        assert!((force / truth - 1.0).abs() < 0.01, "{force} for {truth} at {speed}");
    }
    // The force tells the mass far better than that is declared.
    let [free, known] = [&free, &known].map(FrictionCurve::mean_over_path);
    assert!((known.value() - free.value()).abs() < 0.05 * free.uncertainty(), "{known} beside {free}");
    assert!((known.uncertainty() / free.uncertainty() - 1.0).abs() < 0.02, "{known} beside {free}");
    let loaded = Machine::unknown().with_normal_load(Known::new(20.0, 0.02).unwrap()).unwrap();
    let coefficient = FrictionCurve::of(&loaded, &experiments).unwrap();
    assert_eq!(coefficient.unit(), "1");
    require_truth(&coefficient, 20.0);
    let of_load = |level: &FrictionLevel| level.contributions().iter().any(|(from, _)| *from == Source::NormalLoad);
    assert!(coefficient.levels().iter().all(of_load));
}

/// A base that is moved shows what a ring-down shows: friction per mass.
#[test]
fn a_base_shows_the_curve() {
    let base: Vec<f64> = sweep().iter().map(|force| force / MASS).collect();
    let force: Vec<f64> = sweep().iter().map(|force| -force).collect();
    let scenario = scenario(1.0).driven_by(Excitation::sampled_force(1.0 / RATE, force).unwrap());
    let base = Drive::base(&Record::sampled(RATE, base, Quantity::Acceleration, "m/s^2").unwrap()).unwrap();
    let response = velocity(&scenario, 10.0, NOISE, 2);
    let experiment = Experiment::driven(&response, base, &Preparation::default()).unwrap();
    let curve = FrictionCurve::of(&Machine::per_unit_mass(), &[experiment]).unwrap();
    assert_eq!(curve.unit(), "m/s²");
    require_truth(&curve, MASS);
}

/// The blow of a hammer and a ring-down share one curve; the mobility of the blow shows none.
#[test]
fn an_impact_and_a_ring_down_share_the_curve() {
    let pulse = |i: u32| if (60..76).contains(&i) { 160.0 * (PI * f64::from(i - 60) / 16.0).sin() } else { 0.0 };
    let force: Vec<f64> = (0..2400).map(pulse).collect();
    let struck = scenario(1.0).driven_by(Excitation::sampled_force(1.0 / RATE, force.clone()).unwrap());
    let force = Record::sampled(RATE, force, Quantity::Force, "N").unwrap();
    let trial = ImpactTrial::prepare(&force, &velocity(&struck, 6.0, NOISE, 3)).unwrap();
    let machine = Machine::unknown();
    let impact = Experiment::impact(&trial).unwrap();
    require_truth(&FrictionCurve::of(&machine, std::slice::from_ref(&impact)).unwrap(), 1.0);
    let both = FrictionCurve::of(&machine, &[impact, ring_down(1.0, 0.025, 4)]).unwrap();
    assert_eq!(both.unit(), "N");
    require_truth(&both, 1.0);
    let error = FrictionCurve::of(&machine, &[Experiment::mobility(&trial, None).unwrap()]).unwrap_err();
    assert!(error.to_string().contains("not from their mobility"), "{error}");
}

/// A static level half above the sliding one ends a ring-down earlier and holds a driven motion at its turning points;
/// the curve is that of sliding. Only the driven motion shows the level, and the curve says so.
#[test]
fn a_static_level_is_not_taken_for_friction_at_low_speeds() {
    // Some of the releases end where sliding friction alone would not hold.
    for release in [0.022, 0.0228, 0.0236, 0.0244, 0.0252] {
        let free = FrictionCurve::of(&Machine::per_unit_mass(), &[ring_down(1.5, release, 5)]).unwrap();
        require_truth(&free, MASS);
        assert!(free.limits().is_empty(), "{:?}", free.limits());
    }
    let curve = FrictionCurve::of(&Machine::unknown(), &[driven(1.5, NOISE, 8)]).unwrap();
    require_truth(&curve, 1.0);
    assert!(curve.limits().iter().any(|limit| limit.contains("holds more")), "{:?}", curve.limits());
}

/// A static level that a record hardly shows belongs to the uncertainty near rest.
#[test]
fn a_static_level_that_does_not_show_is_allowed_for() {
    for seed in 20..28 {
        let rest = FrictionCurve::of(&Machine::unknown(), &[driven(1.5, 2e-3, seed)]).unwrap().at_rest();
        assert!((rest.value() - FRICTION).abs() < 2.6 * rest.uncertainty(), "{rest} of seed {seed}");
    }
}
