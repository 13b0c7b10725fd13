//! What a free vibration cannot tell.

use fmm_friction::{Coulomb, CoulombStatic, Viscous};
use fmm_identify::{Known, Machine, Offset, Preparation, RingDown, Warning, identify};
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
    let decay = RingDown::prepare(&without_friction(), &Preparation::default().offset(Offset::Fixed(0.0))).unwrap();
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
    let decay = RingDown::prepare(&without_friction(), &Preparation::default()).unwrap();
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

/// A static level only decides at which turning point the motion ends.
#[test]
fn the_static_level_has_no_influence_on_a_free_decay() {
    let decay = RingDown::prepare(&release(15e-3, 2e-4, 3), &Preparation::default()).unwrap();
    let found = identify::<CoulombStatic>(&Machine::per_unit_mass(), &[decay]).unwrap();
    let name = "static_friction_per_mass";
    assert_eq!(found.finding(name).unwrap().uncertainty(), None);
    assert!(found.warnings().contains(&Warning::NoInfluence { parameter: name.to_owned() }), "{found}");
}

/// u(μ) grows with what is uncertain from elsewhere, in quadrature.
#[test]
fn inputs_from_elsewhere_enter_the_uncertainty() {
    let exact = |value| Known::exact(value).unwrap();
    let relative = |machine: &Machine, gain: f64| {
        let preparation = Preparation::default().gain_uncertainty(gain);
        let decay = RingDown::prepare(&release(22e-3, 2e-4, 3), &preparation).unwrap();
        let found = identify::<Coulomb>(machine, &[decay]).unwrap();
        let mu = found.finding("mu").unwrap();
        mu.uncertainty().unwrap() / mu.value()
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
