//! Friction that depends on the position, as where a flexure presses the contact while it deflects.

use fmm_friction::Coulomb;
use fmm_identify::{Candidate, Comparison, Experiment, Inquiry, Preparation, search};
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Sampling, Scenario, simulate};

use crate::simulated::{INTERVAL, LOAD, MASS, STIFFNESS, machine, record};

const MU: f64 = 0.08;
/// Release (m).
const RELEASE: f64 = 0.02;
/// Damping of the machine (N s/m).
const DAMPING: f64 = 0.3;

/// A release under a load that rises by the share `rise` from the middle to the release, with noise of the velocity of a
/// thousandth of its peak; the coefficient of friction in the mean over the path; and the curvature (1/m²) over that mean.
fn released(rise: f64, seed: u64) -> (Record, f64, f64) {
    let damping = Damping::linear(DAMPING).unwrap();
    let oscillator = Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(damping);
    let scenario = Scenario::new(oscillator, Coulomb::new(MU).unwrap(), LOAD).unwrap();
    let curvature = rise / (RELEASE * RELEASE);
    let scenario = scenario.under_curved_load(curvature).unwrap().starting_at(RELEASE, 0.0).unwrap();
    let motion = simulate(&scenario, &Sampling::uniform(INTERVAL, 3000).unwrap()).unwrap();
    let (x, v) = (motion.position().values(), motion.velocity().values());
    let path: f64 = v.iter().map(|v| v.abs()).sum();
    let mean = 1.0 + curvature * x.iter().zip(v).map(|(x, v)| x * x * v.abs()).sum::<f64>() / path;
    (record(v, 2.6e-4, seed, Quantity::Velocity, "m/s"), MU * mean, curvature / mean)
}

fn searched(record: &Record) -> Comparison {
    search(&machine(), &[Experiment::ring_down(record, &Preparation::default()).unwrap()]).unwrap()
}

/// The percentage before `end` after `begin` in a headline.
fn percentage(headline: &str, begin: &str, end: &str) -> f64 {
    let said = headline.split(begin).nth(1).and_then(|said| said.split(end).next());
    said.and_then(|said| said.trim().parse().ok()).unwrap_or_else(|| panic!("{headline}"))
}

#[test]
fn friction_that_rises_with_the_deflection_is_found() {
    for (rise, seed) in [(0.3, 1), (0.2, 2), (-0.2, 3)] {
        let (record, mu, curvature) = released(rise, seed);
        let found = searched(&record);
        assert!(found.preferred().law().contains("position"), "{rise}: {found}");
        for (name, truth) in [("mu", mu), ("friction_over_position", curvature), ("damping_per_mass", DAMPING / MASS)] {
            let (low, high) = found
                .preferred()
                .finding(name)
                .and_then(|it| it.interval(0.99))
                .unwrap_or_else(|| panic!("{name}: {found}"));
            assert!((low..=high).contains(&truth), "{rise}: {name} {truth} in {low} to {high}");
        }
    }
}

/// A rise that a record does not show moves the level by no more than the headline says.
#[test]
fn friction_over_the_position_that_does_not_show_has_its_price_in_the_headline() {
    let mut hidden = 0;
    for seed in 0..8 {
        let (record, mu, curvature) = released(0.005, seed);
        let found = searched(&record);
        let headline = found.headline();
        if found.preferred().law().contains("position") || found.preferred().law().contains("change") {
            continue;
        }
        hidden += 1;
        let unseen = percentage(&headline, "if it is the same at all positions (", " % more");
        let said = headline.split("if it is the same at all positions").nth(1).unwrap();
        let moved = percentage(said, "would move its level by ", " %");
        let finding = found.preferred().finding("mu").unwrap();
        let error = (finding.value() - mu).abs() - 2.5 * finding.uncertainty().unwrap();
        assert!(100.0 * curvature * RELEASE * RELEASE < unseen && error < 0.01 * moved * mu, "seed {seed}: {headline}");
    }
    assert!(hidden >= 6, "{hidden}");
}

/// A law that is named and has none is doubted where the record shows it, and named with it is right.
#[test]
fn a_named_law_without_it_is_doubted() {
    let (record, mu, _) = released(0.3, 7);
    let decays = [Experiment::ring_down(&record, &Preparation::default()).unwrap()];
    let inquiry = |name: &str| Inquiry::of(&machine(), &decays).among(&[Candidate::named(name).unwrap()]).unwrap();
    let (without, with) = (inquiry("coulomb_viscous"), inquiry("coulomb + linear + position"));
    let doubts = |found: &Comparison| found.warnings().iter().any(|said| said.to_string().contains("the position"));
    assert!(doubts(&without) && !without.is_conclusive(), "{without}");
    assert!(!doubts(&with) && with.is_decided(), "{with}");
    let (low, high) = with.preferred().finding("mu").and_then(|mu| mu.interval(0.99)).unwrap();
    assert!((low..=high).contains(&mu), "{mu} in {low} to {high}");
    let state = Inquiry::of(&machine(), &decays).among(&[Candidate::named("dahl + position").unwrap()]).unwrap_err();
    assert!(state.to_string().contains("internal state"), "{state}");
}
