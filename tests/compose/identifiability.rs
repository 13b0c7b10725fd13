//! Limits of a free vibration.

use fmm_friction::{Coulomb, CoulombStatic, CoulombViscous, Viscous};
use fmm_identify::{Experiment, Identification, Known, Machine, Offset, Preparation, Warning, identify};
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, Sampling, Scenario};

use crate::measurement::{DAMPING, MASS, STIFFNESS, release};

fn without_friction() -> Record {
    let machine = Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(Damping::linear(DAMPING).unwrap());
    let scenario = Scenario::new(machine, Coulomb::new(0.0).unwrap(), 0.0).unwrap();
    let motion = Exact.run(&scenario.starting_at(0.0, 0.3).unwrap(), &Sampling::uniform(1e-3, 5000).unwrap()).unwrap();
    Record::new(0.0, 1e-3, motion.velocity().values().to_vec(), Quantity::Velocity, "m/s").unwrap()
}

/// Mass, stiffness and damping may be scaled together: one direction is missing, and no mass is invented.
#[test]
fn mass_stiffness_and_damping_are_not_separable() {
    let decay = Experiment::ring_down(&without_friction(), &Preparation::default().offset(Offset::Fixed(0.0))).unwrap();
    let found = identify::<Viscous>(&Machine::unknown(), &[decay]).unwrap();
    let names: Vec<_> = found.fit().estimates().iter().map(|estimate| estimate.name().to_owned()).collect();
    assert_eq!(names, ["mass", "stiffness", "damping", "initial_position", "initial_velocity"]);
    assert_eq!((found.fit().rank(), found.fit().free_count()), (4, 5));
    let [direction] = found.fit().null_directions() else { panic!("one null direction expected") };
    for (component, expected) in direction.components().iter().zip([1.0, 1.0, 1.0, 0.0, 0.0]) {
        assert!((component - expected).abs() < 1e-6, "null direction {:?}", direction.components());
    }
    for name in ["mass", "stiffness", "damping"] {
        assert_eq!(found.finding(name).unwrap().uncertainty(), None, "{name} must have no uncertainty");
    }
    let ratio =
        |above: &str, below: &str| found.finding(above).unwrap().value() / found.finding(below).unwrap().value();
    assert!((ratio("stiffness", "mass") / (STIFFNESS / MASS) - 1.0).abs() < 1e-9);
    assert!((ratio("damping", "mass") / (DAMPING / MASS) - 1.0).abs() < 1e-7);
    let report = found.to_string();
    assert!(report.contains("mass, stiffness and damping"), "{report}");
}

#[test]
fn a_known_mass_makes_them_separable() {
    let decay = Experiment::ring_down(&without_friction(), &Preparation::default()).unwrap();
    let machine = Machine::of_mass(Known::new(MASS, 0.01).unwrap()).unwrap();
    let found = identify::<Viscous>(&machine, std::slice::from_ref(&decay)).unwrap();
    let stiffness = found.finding("stiffness").unwrap();
    assert!((stiffness.value() / STIFFNESS - 1.0).abs() < 1e-9, "stiffness {} N/m", stiffness.value());
    // The mass is all that is uncertain: u(k)/k = u(m)/m.
    assert!((stiffness.uncertainty().unwrap() / STIFFNESS / (0.01 / MASS) - 1.0).abs() < 1e-3);

    let machine = Machine::of_stiffness(Known::new(STIFFNESS, 2.0).unwrap()).unwrap();
    let found = identify::<Viscous>(&machine, &[decay]).unwrap();
    let mass = found.finding("mass").unwrap();
    assert!((mass.value() / MASS - 1.0).abs() < 1e-9, "mass {} kg", mass.value());
    assert!((mass.uncertainty().unwrap() / MASS / (2.0 / STIFFNESS) - 1.0).abs() < 1e-3);
}

/// A static level only decides at which turning point the motion ends: it is not fitted, and the sliding level is that
/// of plain Coulomb friction.
#[test]
fn the_static_level_is_held() {
    let decay = Experiment::ring_down(&release(15e-3, 2e-4, 3), &Preparation::default()).unwrap();
    let decays = std::slice::from_ref(&decay);
    let found = identify::<CoulombStatic>(&Machine::per_unit_mass(), decays).unwrap();
    let coulomb = identify::<Coulomb>(&Machine::per_unit_mass(), decays).unwrap();
    let sliding = found.finding("sliding_friction_per_mass").unwrap();
    let plain = coulomb.finding("friction_per_mass").unwrap();
    assert_eq!((sliding.value(), sliding.uncertainty()), (plain.value(), plain.uncertainty()));
    assert_eq!(found.finding("static_friction_per_mass"), None);
    assert!(found.warnings().contains(&Warning::StaticLevelHeld { parameter: "static_coefficient".into() }), "{found}");
}

/// A parameter that ends on its bound is not known to be there: the others are less certain than with it fixed.
#[test]
fn a_bound_does_not_make_the_others_certain() {
    let truth = Coulomb::new(0.3).unwrap();
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), truth, 1.0).unwrap();
    let scenario = scenario.starting_at(0.02, 0.0).unwrap();
    let velocity = Exact.run(&scenario, &Sampling::uniform(1e-3, 1500).unwrap()).unwrap().velocity().values().to_vec();
    let mut at_bound = 0;
    for seed in 0..10 {
        let noise = crate::measurement::white(2e-4, seed, velocity.len());
        let noisy = velocity.iter().zip(noise).map(|(v, noise)| v + noise).collect();
        let record = Record::new(0.0, 1e-3, noisy, Quantity::Velocity, "m/s").unwrap();
        let decays = [Experiment::ring_down(&record, &Preparation::default()).unwrap()];
        let both = identify::<CoulombViscous>(&Machine::per_unit_mass(), &decays).unwrap();
        let alone = identify::<Coulomb>(&Machine::per_unit_mass(), &decays).unwrap();
        let u = |found: &Identification| found.finding("friction_per_mass").unwrap().uncertainty().unwrap();
        assert!(u(&both) > 2.0 * u(&alone), "u(F/m) = {} against {} m/s²", u(&both), u(&alone));
        at_bound += usize::from(both.finding("damping_per_mass").unwrap().value() == 0.0);
    }
    assert!(at_bound > 0, "no damping ended at its bound, so the test shows nothing");
}

/// u(μ) grows with what is uncertain from elsewhere, in quadrature.
#[test]
fn inputs_from_elsewhere_enter_the_uncertainty() {
    let exact = |value| Known::exact(value).unwrap();
    let relative = |machine: &Machine, gain: f64| {
        let preparation = Preparation::default().gain_uncertainty(gain);
        let decay = Experiment::ring_down(&release(22e-3, 2e-4, 3), &preparation).unwrap();
        let found = identify::<Coulomb>(machine, &[decay]).unwrap();
        let relative = |name: &str| {
            let finding = found.finding(name).unwrap();
            finding.uncertainty().unwrap() / finding.value()
        };
        // Friction per mass and coefficient see the gain alike; the frequency does not.
        assert!(relative("friction_per_mass") >= gain && relative("natural_frequency_hz") < 1e-3);
        relative("mu")
    };
    let base = Machine::of_mass(exact(MASS)).unwrap().with_normal_load(exact(14.0)).unwrap();
    let alone = relative(&base, 0.0);
    let load = base.with_normal_load(Known::new(14.0, 0.14).unwrap()).unwrap();
    assert!((relative(&load, 0.0) / alone.hypot(0.01) - 1.0).abs() < 1e-6);
    assert!((relative(&base, 0.005) / alone.hypot(0.005) - 1.0).abs() < 1e-6);
    let mass = Machine::of_mass(Known::new(MASS, 0.02 * MASS).unwrap()).unwrap().with_normal_load(exact(14.0)).unwrap();
    assert!((relative(&mass, 0.0) / alone.hypot(0.02) - 1.0).abs() < 1e-6);
    let held = base.with_damping(exact(DAMPING)).unwrap();
    let uncertain = base.with_damping(Known::new(DAMPING, 0.0341).unwrap()).unwrap();
    assert!(relative(&uncertain, 0.0) > 1.5 * relative(&held, 0.0));
}
