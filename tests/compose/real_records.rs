//! Records that others measured, against independent fits of the same models.

use std::path::PathBuf;

use fmm_identify::{Candidate, Comparison, Experiment, Identification, Machine, Preparation, Warning, compare};
use fmm_record::{Column, Quantity, Reader, Record};

pub(crate) fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/data").join(name)
}

pub(crate) fn fork() -> Record {
    let reader = Reader::default().channel("data").quantity(Quantity::Velocity).unit("V");
    reader.read(data("BrowserForkCompoundFirst1.mat")).unwrap().record
}

pub(crate) fn wheel() -> Record {
    let reader = Reader::default().quantity(Quantity::Velocity).unit("rad/s");
    reader.read(data("bicycle_wheel_radial_gyro.csv")).unwrap().record
}

pub(crate) fn pendulum() -> Record {
    let channel = Column::Name("theta_rad".to_owned());
    let reader = Reader::default().channel(channel).quantity(Quantity::Displacement).unit("rad");
    reader.read(data("single_pendulum_55s_1khz.csv")).unwrap().record
}

fn by_all_laws(record: &Record) -> Comparison {
    let decay = Experiment::ring_down(record, &Preparation::default()).unwrap();
    compare(&Machine::per_unit_mass(), &[decay], &Candidate::standard()).unwrap()
}

fn value(found: &Identification, name: &str) -> f64 {
    found.finding(name).unwrap_or_else(|| panic!("no {name}")).value()
}

fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found} against {expected} ± {tolerance}");
}

/// Tolerances are half a unit of the last digit of the independent fits.
#[test]
fn bicycle_fork() {
    let comparison = by_all_laws(&fork());
    for (found, rms) in comparison.identifications().iter().zip([19.9e-3, 12.8e-3, 12.3e-3]) {
        close(found.rms_residual(), rms, 0.05e-3, &format!("rms residual of {} (V)", found.law()));
    }
    let both = comparison.preferred();
    assert_eq!(both.law(), "coulomb_viscous");
    close(value(both, "natural_frequency_hz"), 0.6288, 1e-4, "natural frequency (Hz)");
    close(value(both, "damping_per_mass"), 0.0136, 5e-4, "damping per mass (1/s)");
    close(value(both, "friction_per_mass"), 0.0299, 3e-4, "friction per mass (V/s)");
    assert_eq!(both.finding("mu"), None);
    assert!(comparison.warnings().contains(&Warning::ScaleUnknown { load_known: false }));
    assert!(comparison.is_decided());

    // The residuals are correlated over hundreds of samples: their number is no number of witnesses, for the
    // uncertainties no more than for the preference. They are largest at the frequency of the fork itself, where they
    // look like damping.
    let damping = both.fit().estimate("damping_per_mass").unwrap().standard_uncertainty().unwrap();
    let widened = both.finding("damping_per_mass").unwrap().uncertainty().unwrap();
    assert!((5.0..25.0).contains(&(widened / damping)), "u(c/m) = {widened} 1/s, {damping} 1/s if independent");
    let lead = comparison.scores()[1] - comparison.scores()[2];
    assert!((2.0..100.0).contains(&lead), "Coulomb and viscous leads Coulomb by {lead}");
}

#[test]
fn bicycle_wheel() {
    let comparison = by_all_laws(&wheel());
    for (found, rms) in comparison.identifications().iter().zip([10.17e-3, 11.87e-3, 7.72e-3]) {
        close(found.rms_residual(), rms, 0.005e-3, &format!("rms residual of {} (rad/s)", found.law()));
    }
    let both = comparison.preferred();
    assert_eq!(both.law(), "coulomb_viscous");
    close(value(both, "natural_frequency_hz"), 2.3734, 5e-5, "natural frequency (Hz)");
    close(value(both, "damping_per_mass"), 0.26, 0.01, "damping per mass (1/s)");
    close(value(both, "friction_per_mass"), 0.40, 0.01, "friction per mass (rad/s²)");
}

#[test]
fn pendulum_is_too_large_for_a_linear_spring() {
    let comparison = by_all_laws(&pendulum());
    let both = comparison.identifications().iter().find(|found| found.law() == "coulomb_viscous").unwrap();
    let structured = |warning: &Warning| matches!(warning, Warning::StructuredResiduals { .. });
    let large = |warning: &Warning| matches!(warning, Warning::PeriodDependsOnAmplitude { change } if (-0.2..-0.02).contains(change));
    assert!(both.warnings().iter().any(structured), "{both}");
    assert!(comparison.warnings().iter().any(large), "{comparison}");
}

/// The bias that a fixed number of records would hide: the initial velocity is free, and differs from the sample.
#[test]
fn the_initial_velocity_is_not_the_first_sample() {
    let record = wheel();
    let found = &by_all_laws(&record).identifications()[2].clone();
    let fitted = value(found, "initial_velocity") + value(found, "offset");
    assert!((fitted - record.values()[0]).abs() > 1e-4, "fitted {fitted} rad/s, measured {} rad/s", record.values()[0]);
}
