//! A machine that no dry friction brakes.

use fmm_friction::Viscous;
use fmm_identify::{Candidate, Experiment, Machine, Preparation, Warning, compare, search};
use fmm_model::{Damping, Oscillator};
use fmm_record::Quantity;
use fmm_sim::{Sampling, Scenario, simulate};

use crate::simulated::{INTERVAL, MASS, STIFFNESS, record};

/// Linear and quadratic damping leave a friction of nothing, and no law can be said to have put that wrong.
#[test]
fn a_level_that_is_not_there_misleads_nobody() {
    let damping = Damping::new(3.0, 60.0).unwrap();
    let machine = Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(damping);
    let scenario = Scenario::new(machine, Viscous::new(0.0).unwrap(), 1.0).unwrap().starting_at(0.05, 0.0).unwrap();
    let motion = simulate(&scenario, &Sampling::uniform(INTERVAL, 4000).unwrap()).unwrap();
    let candidates = ["coulomb_viscous", "coulomb_viscous + quadratic"].map(|name| Candidate::named(name).unwrap());
    let mut levels = Vec::new();
    for seed in 0..6 {
        let record = record(motion.position().values(), 1e-4, seed, Quantity::Displacement, "m");
        let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        let found = compare(&Machine::per_unit_mass(), std::slice::from_ref(&decay), &candidates).unwrap();
        assert_eq!(found.preferred().law(), "coulomb_viscous + quadratic");
        levels.push(found.preferred().finding("friction_per_mass").unwrap().value());
        let is_misled = |warning: &Warning| matches!(warning, Warning::Misled { .. });
        assert!(!found.warnings().iter().any(is_misled), "seed {seed}: {found}");
        let found = search(&Machine::per_unit_mass(), &[decay]).unwrap();
        assert_eq!(found.preferred().law(), "viscous + quadratic", "seed {seed}: {found}");
    }
    assert!(levels.iter().any(|level| *level > 0.0), "m/s²: {levels:?}");
}

/// The headline of one law alone, which explains a record, excludes no other law.
#[test]
fn one_law_alone_excludes_no_other() {
    let machine = Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(Damping::new(3.0, 0.0).unwrap());
    let scenario = Scenario::new(machine, Viscous::new(0.0).unwrap(), 1.0).unwrap().starting_at(0.05, 0.0).unwrap();
    let motion = simulate(&scenario, &Sampling::uniform(INTERVAL, 4000).unwrap()).unwrap();
    let record = record(motion.position().values(), 1e-4, 1, Quantity::Displacement, "m");
    let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    let alone =
        compare(&Machine::per_unit_mass(), std::slice::from_ref(&decay), &[Candidate::named("viscous").unwrap()])
            .unwrap();
    assert!(alone.headline().contains("; no other law was tried; a comparison"), "{}", alone.headline());
    let both = ["viscous", "coulomb"].map(|name| Candidate::named(name).unwrap());
    let both = compare(&Machine::per_unit_mass(), std::slice::from_ref(&decay), &both).unwrap();
    assert!(both.headline().contains("excludes the other law that was tried"), "{}", both.headline());
    // What is not there has an upper bound where a law with it was fitted.
    assert!(!both.headline().contains("no dry friction is seen"), "{}", both.headline());
    let mixed = ["viscous", "coulomb_viscous"].map(|name| Candidate::named(name).unwrap());
    let mixed = compare(&Machine::per_unit_mass(), std::slice::from_ref(&decay), &mixed).unwrap();
    let headline = mixed.headline();
    let bound =
        headline.split("coulomb_viscous allows a friction_per_mass of ").nth(1).unwrap_or_else(|| panic!("{headline}"));
    let bound: f64 = bound.split(' ').next().unwrap().parse().unwrap();
    // A hundredth of the largest force of the spring by the mass, 9.5 m/s².
    assert!(bound > 0.0 && bound < 0.095, "{bound} m/s²");
}
