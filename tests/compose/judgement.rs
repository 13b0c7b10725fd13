//! Records that are hard to judge: each judgement must be right, or say what is the matter.

use std::f64::consts::TAU;
use std::path::PathBuf;

use fmm_friction::Coulomb;
use fmm_identify::{
    Candidate, Comparison, Experiment, Finding, Identification, IdentifyError, Inquiry, Known, Machine, Preparation,
    Warning, compare, search,
};
use fmm_model::{Damping, Oscillator, Restoring};
use fmm_record::{Column, Quantity, Reader, Record};
use fmm_sim::{Engine, Exact, Sampling, Scenario};

use crate::measurement::white;

/// The file called `name`, of this folder or of those by which records are tried.
fn path(name: &str) -> PathBuf {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let paths = ["tests/data/judgement", "crates/fmm-record/tests/data"].map(|folder| root.join(folder).join(name));
    paths.into_iter().find(|path| path.exists()).unwrap_or_else(|| panic!("no file {name}"))
}

fn record(name: &str, quantity: Quantity, unit: &str) -> Record {
    Reader::default().quantity(quantity).unit(unit).read(path(name)).unwrap().record
}

fn machine() -> Machine {
    let mass = Machine::of_mass(Known::exact(10.391).unwrap()).unwrap();
    mass.with_normal_load(Known::exact(14.0).unwrap()).unwrap()
}

fn judged(name: &str, quantity: Quantity, unit: &str) -> Comparison {
    let decay = Experiment::ring_down(&record(name, quantity, unit), &Preparation::default()).unwrap();
    search(&machine(), &[decay]).unwrap()
}

/// True if the 95 % interval of the finding called `name` holds `truth`.
fn holds(found: &Identification, name: &str, truth: f64) -> bool {
    let (low, high) = found.interval(name, 0.95).unwrap_or_else(|| panic!("no interval of {name}: {found}"));
    (low..=high).contains(&truth)
}

/// Friction that falls from 0.12 to 0.06: no law of one level is left.
#[test]
fn friction_that_falls_is_seen() {
    let comparison = judged("bad_120.csv", Quantity::Velocity, "m/s");
    let left: Vec<&str> = comparison.not_excluded().map(Identification::law).collect();
    for simple in ["viscous", "coulomb", "coulomb_viscous"] {
        assert!(!left.contains(&simple), "{comparison}");
    }
    assert!(left.iter().any(|law| law.starts_with("stribeck")), "{comparison}");
    let preferred = comparison.preferred();
    assert!(holds(preferred, "sliding_mu", 0.06) && holds(preferred, "static_mu", 0.12), "{comparison}");
    assert!(comparison.score_tests().iter().any(fmm_identify::ScoreTest::is_significant));
    // A law that is far from the friction over the speed is named and not fitted; a fit of it alone agrees.
    let viscous = "viscous + quadratic";
    assert!(comparison.excluded().iter().any(|law| law == viscous), "{comparison}");
    assert!(comparison.to_string().contains("excluded without a fit"), "{comparison}");
    assert!(comparison.identifications().iter().all(|found| found.law() != viscous), "{comparison}");
    let all = [viscous, preferred.law().split(',').next().unwrap()].map(|law| Candidate::named(law).unwrap());
    let decay =
        Experiment::ring_down(&record("bad_120.csv", Quantity::Velocity, "m/s"), &Preparation::default()).unwrap();
    let fitted = compare(&machine(), &[decay], &all).unwrap();
    assert!(fitted.not_excluded().all(|found| found.law() != viscous), "{fitted}");
}

/// The same friction in five times the noise: nothing is decided, and laws that fall are named.
#[test]
fn friction_that_may_fall_is_left_open() {
    let comparison = judged("und_122.csv", Quantity::Velocity, "m/s");
    assert!(!comparison.is_decided(), "{comparison}");
    assert!(comparison.warnings().contains(&Warning::Undecided));
    assert!(comparison.not_excluded().any(|found| found.law().starts_with("stribeck")), "{comparison}");
}

/// Presliding too small to be seen: the level is that of the truth, 1.2 N.
#[test]
fn presliding_that_cannot_be_seen_does_no_harm() {
    let comparison = judged("dahlt_60.csv", Quantity::Velocity, "m/s");
    assert!(holds(comparison.preferred(), "friction_force", 1.2), "{comparison}");
}

/// An encoder that ends in rest: its thousand samples of rest have one error, and are left out.
#[test]
fn a_rest_without_noise_is_left_out() {
    let comparison = judged("enc1.csv", Quantity::Displacement, "m");
    let summary = &comparison.records()[0];
    assert!(summary.samples < 1400 && summary.rest_from.is_some_and(|time| (1.3..1.4).contains(&time)), "{summary:?}");
    let simple = comparison.identifications().iter().find(|found| found.law() == "coulomb_viscous").unwrap();
    assert!((simple.finding("mu").unwrap().value() - 0.25).abs() < 5e-4, "{comparison}");
    assert!((simple.finding("damping").unwrap().value() - 0.275).abs() < 0.03, "{comparison}");
    let right = comparison.is_decided() && holds(comparison.preferred(), "mu", 0.25);
    let loud = !comparison.is_decided() && comparison.not_excluded().any(|found| found.law() == "coulomb_viscous");
    assert!(right || loud, "{comparison}");
    assert!(comparison.warnings().iter().any(|warning| matches!(warning, Warning::Rounded { .. })), "{comparison}");
}

#[test]
fn slow_drift_is_fitted_beside_the_motion() {
    let comparison = judged("drift_50um.csv", Quantity::Displacement, "m");
    assert!(comparison.warnings().contains(&Warning::Drift), "{comparison}");
    assert!(holds(comparison.preferred(), "mu", 0.25), "{comparison}");
    assert!(holds(comparison.preferred(), "damping", 0.275), "{comparison}");
}

#[test]
fn hum_is_not_the_machine() {
    let comparison = judged("hum7.csv", Quantity::Velocity, "m/s");
    assert!((comparison.records()[0].frequency - 2.198).abs() < 0.02, "{comparison}");
    assert!(comparison.warnings().iter().any(|warning| matches!(warning, Warning::Hum { .. })), "{comparison}");
    assert!(holds(comparison.preferred(), "mu", 0.25), "{comparison}");
}

#[test]
fn the_first_of_two_releases_is_used() {
    let comparison = judged("two_v.csv", Quantity::Velocity, "m/s");
    let second = |warning: &Warning| matches!(warning, Warning::FurtherRelease { time } if (1.9..2.1).contains(time));
    assert!(comparison.warnings().iter().any(second), "{comparison}");
    assert!(holds(comparison.preferred(), "mu", 0.25), "{comparison}");
}

/// Every `stride`-th sample of a small pendulum with presliding.
fn pendulum(stride: usize) -> (Machine, Experiment) {
    let reader = Reader::default().channel(Column::Name("encoder_counts".to_owned()));
    let reader = reader.time(Column::Name("t_s".to_owned())).quantity(Quantity::Displacement).unit("1");
    let record = reader.read(path("small_pendulum_10khz.csv")).unwrap().record.scaled(1.570_796_3e-4, "rad").unwrap();
    let values = record.values().iter().copied().step_by(stride).collect();
    let record =
        Record::new(record.start(), record.interval() * stride as f64, values, Quantity::Displacement, "rad").unwrap();
    let decay = Experiment::ring_down(&record, &Preparation::default().from(0.35)).unwrap();
    (Machine::per_unit_mass().with_restoring(Restoring::sine(1.0).unwrap()), decay)
}

fn pendulum_by(stride: usize, laws: &[&str]) -> Comparison {
    let (machine, decay) = pendulum(stride);
    let candidates: Vec<Candidate> = laws.iter().map(|law| Candidate::named(law).unwrap()).collect();
    compare(&machine, &[decay], &candidates).unwrap()
}

/// The default search finds the law with presliding at either rate, and says that it leaves something out.
#[test]
fn presliding_is_looked_for() {
    for stride in [1, 10] {
        let (machine, decay) = pendulum(stride);
        let comparison = search(&machine, &[decay]).unwrap();
        let preferred = comparison.preferred();
        assert!(preferred.finding("contact_stiffness_per_mass").is_some(), "{comparison}");
        let left_out = |warning: &Warning| matches!(warning, Warning::StructuredResiduals { .. });
        assert!(comparison.warnings().iter().any(left_out), "{comparison}");
    }
}

/// The law with presliding is preferred at either rate, and another candidate moves the distance of the two by little.
#[test]
fn presliding_is_seen_however_often_it_is_sampled() {
    let distance = |comparison: &Comparison| comparison.scores()[0] - comparison.scores()[1];
    let fast = pendulum_by(1, &["coulomb", "dahl"]);
    let slow = pendulum_by(10, &["coulomb", "dahl"]);
    let with_another = pendulum_by(10, &["coulomb", "dahl", "viscous"]);
    for comparison in [&fast, &slow, &with_another] {
        assert!(comparison.is_decided() && comparison.preferred().law() == "dahl", "{comparison}");
    }
    let ratio = distance(&fast) / distance(&slow);
    assert!((0.5..2.0).contains(&ratio), "misfits of {} and {}", distance(&fast), distance(&slow));
    assert_eq!(distance(&slow), distance(&with_another));
}

/// A value that is held of one law is not held of the others, and a search that has no time reports what it has.
#[test]
fn a_search_holds_by_law_and_ends_in_time() {
    let decay =
        Experiment::ring_down(&record("bad_120.csv", Quantity::Velocity, "m/s"), &Preparation::default()).unwrap();
    let inquiry = || Inquiry::of(&machine(), std::slice::from_ref(&decay));
    let comparison = inquiry().holding(Some("stribeck"), "exponent", 1.0).search().unwrap();
    assert!(comparison.identifications().iter().any(|found| found.law() == "stribeck, exponent = 1"), "{comparison}");
    let hurried = || inquiry().within(std::time::Duration::ZERO);
    // What is held of the simple laws changes nothing of that.
    for hurried in [hurried(), hurried().holding(None, "damping_per_mass", 0.1)] {
        let comparison = hurried.search().unwrap();
        assert!(!comparison.is_complete() && comparison.warnings().contains(&Warning::TimeLimit), "{comparison}");
        assert_eq!(comparison.identifications().len(), 3);
    }
    assert!(matches!(search(&machine(), &[]), Err(IdentifyError::Missing { .. })));
    let nobody = inquiry().holding(None, "colour", 1.0).search();
    assert!(
        matches!(nobody, Err(IdentifyError::UnknownName { ref what }) if what.contains("\"colour\"")),
        "{nobody:?}"
    );
}

/// A value that is held under the name that a fit gives it is held of every law that has it, in all stages.
#[test]
fn a_search_holds_by_the_names_of_fits() {
    let decay =
        Experiment::ring_down(&record("bad_120.csv", Quantity::Velocity, "m/s"), &Preparation::default()).unwrap();
    let decays = [decay];
    let inquiry = Inquiry::of(&machine(), &decays).holding(None, "damping_per_mass", 0.1);
    let comparison = inquiry.search().unwrap();
    assert!(comparison.identifications().len() > 10, "{comparison}");
    for found in comparison.identifications() {
        let damping = found.finding("damping_per_mass").map(Finding::value);
        assert!(damping.is_none_or(|damping| damping == 0.1), "{found}");
    }
}

/// The result is the same on any number of threads.
#[test]
fn threads_change_nothing() {
    let decay =
        Experiment::ring_down(&record("bad_120.csv", Quantity::Velocity, "m/s"), &Preparation::default()).unwrap();
    let on = |threads: usize| {
        Inquiry::of(&machine(), std::slice::from_ref(&decay)).on_threads(threads).search().unwrap().to_string()
    };
    assert_eq!(on(1), on(3));
}

/// The drift that polynomials leave is taken for a law that falls or sticks: Coulomb and viscous friction are true.
#[test]
fn a_law_that_follows_a_drift_is_not_decided_for() {
    for seed in [7, 17] {
        let decay = Experiment::ring_down(&drifting(seed), &Preparation::default()).unwrap();
        let comparison = search(&machine(), &[decay]).unwrap();
        assert!(comparison.warnings().contains(&Warning::Drift), "{comparison}");
        let right = comparison.preferred().law() == "coulomb_viscous";
        assert!(right || !comparison.is_decided(), "{comparison}");
    }
}

/// The thesis' machine released at 22 mm: displacement, with a noise of 5 µm and a wave of 50 µm from end to end as
/// drift.
fn drifting(seed: u64) -> Record {
    let oscillator = Oscillator::new(10.391, 1982.0).unwrap().with_damping(Damping::linear(0.275).unwrap());
    let scenario = Scenario::new(oscillator, Coulomb::new(0.25).unwrap(), 14.0).unwrap().starting_at(22e-3, 0.0);
    let motion = Exact.run(&scenario.unwrap(), &Sampling::uniform(1e-3, 3000).unwrap()).unwrap();
    let drift = |i: usize| 25e-6 * (TAU * i as f64 / 3000.0 + 0.7 * seed as f64).sin();
    let samples = motion.position().values().iter().zip(white(5e-6, seed, 3000)).enumerate();
    let values = samples.map(|(i, (x, noise))| x + noise + drift(i)).collect();
    Record::new(0.0, 1e-3, values, Quantity::Displacement, "m").unwrap()
}
