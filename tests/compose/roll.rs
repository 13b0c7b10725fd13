//! Roll decay of a ship: a spring that softens and then hardens, fitted with friction and two kinds of damping.

use fmm_identify::{Candidate, Experiment, Machine, Preparation, compare, search};
use fmm_record::{Quantity, Record};

/// The model ship from its release on, until the waves of the basin come back.
fn roll() -> Experiment {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/roll_decay/kvlcc2_roll_21338.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let (times, angles): (Vec<f64>, Vec<f64>) = text
        .lines()
        .skip(1)
        .map(|line| {
            let (time, angle) = line.split_once(',').unwrap();
            (time.parse::<f64>().unwrap(), angle.parse::<f64>().unwrap())
        })
        .unzip();
    let record = Record::from_times(&times, angles, Quantity::Displacement, "rad").unwrap();
    Experiment::ring_down(&record, &Preparation::default().from(30.0).to(194.0)).unwrap()
}

/// Every law on a linear spring leaves 1.04e-3 rad and more of it. The stiffnesses per mass of a fit made elsewhere are
/// −2.95 1/(rad² s²) and 581 1/(rad⁴ s²), with residuals of 2.85e-4 rad.
#[test]
fn the_spring_of_a_ship_softens_and_hardens() {
    let names = ["coulomb_viscous+quadratic", "coulomb_viscous+quadratic+cubic spring+quintic spring"];
    let candidates = names.map(|name| Candidate::named(name).unwrap());
    let comparison = compare(&Machine::per_unit_mass(), &[roll()], &candidates).unwrap();
    let [linear, spring] = comparison.identifications() else { panic!("two laws") };
    assert!(linear.rms_residual() > 1e-3, "{linear}");
    assert!(spring.rms_residual() < 2.9e-4, "{spring}");
    assert_eq!(comparison.preferred().law(), spring.law());
    for (name, elsewhere, within) in
        [("cubic_stiffness_per_mass", -2.95, 0.1), ("quintic_stiffness_per_mass", 581.0, 10.0)]
    {
        let finding = spring.finding(name).unwrap();
        assert!((finding.value() - elsewhere).abs() < within, "{name}: {finding:?}");
    }
}

/// Nobody needs to know of the spring: the search finds it.
#[test]
fn the_search_finds_the_spring() {
    let found = search(&Machine::per_unit_mass(), &[roll()]).unwrap();
    assert!(found.preferred().law().ends_with("cubic spring + quintic spring"), "{found}");
    assert!(found.preferred().rms_residual() < 2.9e-4, "{found}");
}
