//! Friction that changes during the record: found where the record shows it, priced where it does not.

use std::path::PathBuf;

use fmm_friction::{Coulomb, CoulombViscous};
use fmm_identify::{Comparison, Experiment, Finding, Known, Machine, Preparation, Source, identify, search};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Reader, Record};
use fmm_sim::{Sampling, Scenario, simulate};

use crate::measurement::white;

/// The record called `name`, of which `tests/data/trials/SOURCES.md` states the truth.
fn experiment(name: &str) -> Experiment {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/trials").join(format!("{name}.csv"));
    let is_velocity = ["control", "wear_0.2_percent", "load_over_time_9"].contains(&name);
    let (quantity, unit) = if is_velocity { (Quantity::Velocity, "m/s") } else { (Quantity::Displacement, "m") };
    let record = Reader::default().quantity(quantity).unit(unit).read(path).unwrap().record;
    Experiment::ring_down(&record, &Preparation::default()).unwrap()
}

fn searched(name: &str, machine: &Machine) -> Comparison {
    search(machine, &[experiment(name)]).unwrap()
}

fn machine(mass: f64, load: f64) -> Machine {
    let machine = Machine::of_mass(Known::exact(mass).unwrap()).unwrap();
    machine.with_normal_load(Known::exact(load).unwrap()).unwrap()
}

fn finding<'a>(comparison: &'a Comparison, name: &str) -> &'a Finding {
    comparison.preferred().finding(name).unwrap_or_else(|| panic!("no {name}: {comparison}"))
}

/// Distance of a finding from the `truth`, in its standard uncertainties.
fn distance(finding: &Finding, truth: f64) -> f64 {
    (finding.value() - truth).abs() / finding.uncertainty().unwrap()
}

/// Without the term the level is 21 u (wear) and up to 84 u (load) off.
#[test]
fn a_change_is_named_and_the_level_is_that_in_the_mean_over_the_path() {
    let wear = searched("wear_0.2_percent", &machine(2.0, 1.0659));
    let change = finding(&wear, "friction_change_per_half_cycle");
    assert!(change.value() < 0.0 && distance(change, -0.002) < 2.5, "{wear}");
    // 0.25 at first, less 0.2 % with each of twenty half cycles of which the first are the longest.
    assert!(distance(finding(&wear, "mu"), 0.2465) < 2.5, "{wear}");
    for (name, mass, load, mu) in [
        ("load_over_time_5", 1.692_731_2, 0.528_108_619, 0.2623),
        ("load_over_time_9", 10.194_862_3, 6.464_986_19, 0.1102),
    ] {
        let found = searched(name, &machine(mass, load));
        assert!(finding(&found, "friction_change_per_half_cycle").value() > 0.0, "{found}");
        assert!(distance(finding(&found, "mu"), mu) < 2.5, "{found}");
        assert!(found.headline().contains("friction_change_per_half_cycle"), "{found}");
    }
}

/// Eight half cycles do not tell wear from viscous damping: the headline states the assumption and its price, which
/// covers the truth.
#[test]
fn a_change_that_does_not_show_has_its_price_in_the_headline() {
    let found = searched("wear_1_percent", &machine(2.244_770_56, 2.329_165_36));
    let change = found.friction_change().unwrap();
    assert!(!change.is_shown() && change.largest_unseen() > 0.01, "{change:?}");
    let mu = finding(&found, "mu");
    assert!(distance(mu, 0.3133) > 5.0, "{found}");
    assert!((mu.value() - 0.3133).abs() < mu.value() * (change.price * change.largest_unseen()).abs(), "{found}");
    // The change that there is makes the error that there is.
    let moved = mu.value() * (1.0 - change.price * -0.01);
    assert!((moved / 0.3133 - 1.0).abs() < 0.03, "{moved}");
    assert!(found.headline().contains("if the friction is steady"), "{}", found.headline());
}

/// The damping of the machine, known from a run without contact, tells them apart.
#[test]
fn a_known_damping_shows_the_change() {
    let damping = Known::new(0.1262 * 2.244_770_56, 1e-4).unwrap();
    let found = searched("wear_1_percent", &machine(2.244_770_56, 2.329_165_36).with_damping(damping).unwrap());
    assert!(found.preferred().law().ends_with("+ change"), "{found}");
    let change = finding(&found, "friction_change_per_half_cycle");
    assert!(distance(change, -0.01) < 2.5 && change.uncertainty().unwrap() < 0.002, "{found}");
    assert!(distance(finding(&found, "mu"), 0.3133) < 2.0, "{found}");
}

/// A statement of how steady the friction is enters the uncertainty, with a share of its own.
#[test]
fn declared_steadiness_is_in_the_uncertainty() {
    let known = machine(2.244_770_56, 2.329_165_36).with_steady_friction(0.01).unwrap();
    let found = searched("wear_1_percent", &known);
    let mu = finding(&found, "mu");
    let budget = mu.budget().unwrap();
    let is_steadiness = |name: &str| name == Source::Steadiness.to_string();
    assert!(budget.contributions().any(|part| is_steadiness(part.input.name()) && part.share > 0.2), "{found}");
    assert!(distance(mu, 0.3133) < 2.0, "{found}");
    assert!(found.friction_change().is_none());
    let alone = identify::<CoulombViscous>(&known, &[experiment("wear_1_percent")]).unwrap();
    assert_eq!(alone.law(), "coulomb + linear + change");
}

/// A contact that warms: friction falls to 0.7 of itself, half of it within a sixth of the record. A straight change misses
/// that; the curved one has the mean over the path.
#[test]
fn a_change_that_slows_down_is_curved() {
    let load = |time: f64| 14.0 * (0.7 + 0.3 * 0.5f64.powf(time / 1.0));
    let loads: Vec<f64> = (0..=240).map(|step| load(0.025 * f64::from(step))).collect();
    let oscillator = Oscillator::new(10.391, 1982.0).unwrap();
    let scenario = Scenario::new(oscillator, Coulomb::new(0.05).unwrap(), 14.0).unwrap();
    let scenario = scenario.under_sampled_load(0.025, loads).unwrap().starting_at(0.022, 0.0).unwrap();
    let motion = simulate(&scenario, &Sampling::uniform(2e-3, 3000).unwrap()).unwrap();
    let mut velocity = motion.velocity().values().to_vec();
    let path: f64 = velocity.iter().map(|v| v.abs()).sum();
    let weighted = velocity.iter().enumerate().map(|(i, v)| load(2e-3 * i as f64) / 14.0 * v.abs());
    let truth = 0.05 * weighted.sum::<f64>() / path;
    velocity.iter_mut().zip(white(3e-4, 5, 3000)).for_each(|(v, noise)| *v += noise);
    let record = Record::new(0.0, 2e-3, velocity, Quantity::Velocity, "m/s").unwrap();
    let experiment = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    let found = search(&machine(10.391, 14.0), &[experiment]).unwrap();
    assert!(found.preferred().law().contains("curved change"), "{found}");
    let mu = finding(&found, "mu");
    assert!(distance(mu, truth) < 2.5 && mu.uncertainty().unwrap() < 0.02 * truth, "{found}: {truth}");
}

/// Friction that is steady is taken for it.
#[test]
fn steady_friction_shows_no_change() {
    let found = searched("control", &machine(11.805_157_7, 14.713_691_5));
    let change = found.friction_change().unwrap();
    assert!(!change.is_shown() && change.uncertainty < 1e-3, "{change:?}");
    assert!(found.not_excluded().all(|law| !law.law().contains("change")), "{found}");
}
