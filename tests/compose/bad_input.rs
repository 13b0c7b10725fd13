//! Records that should be refused, each with its reason, and records that are fitted with a warning.

use std::f64::consts::TAU;

use fmm_fit::{FitError, Options, Residuals, solve};
use fmm_friction::{Coulomb, CoulombViscous, Viscous};
use fmm_identify::{
    Candidate, Experiment, Identification, IdentifyError, Known, Machine, Offset, Preparation, Problem, Warning,
    identify,
};
use fmm_model::ModelError;
use fmm_record::{Quantity, Reader, Record, RecordError};

use crate::measurement::{release, white};
use crate::real_records::{data, fork};

const INTERVAL: f64 = 1e-3;
/// Standard deviation of white noise (m/s).
const NOISE: f64 = 1e-4;

fn record(values: Vec<f64>) -> Record {
    Record::new(0.0, INTERVAL, values, Quantity::Velocity, "m/s").unwrap()
}

/// `count` samples of a 2 Hz vibration that loses 0.01 m/s in a second, from 0.1 m/s on, with a little noise.
fn vibration(count: usize) -> Vec<f64> {
    let at = |(i, noise): (usize, f64)| {
        let time = i as f64 * INTERVAL;
        (0.1 - 0.01 * time) * (TAU * 2.0 * time).cos() + noise
    };
    white(NOISE, 1, count).into_iter().enumerate().map(at).collect()
}

fn prepare(values: Vec<f64>) -> Result<Experiment, IdentifyError> {
    Experiment::ring_down(&record(values), &Preparation::default())
}

fn identified(values: Vec<f64>) -> Identification {
    identify::<CoulombViscous>(&Machine::per_unit_mass(), &[prepare(values).unwrap()]).unwrap()
}

fn csv(text: &str) -> Result<Record, RecordError> {
    Reader::default().quantity(Quantity::Velocity).unit("m/s").read_from(text.as_bytes()).map(|reading| reading.record)
}

#[test]
fn files_that_are_missing_or_empty() {
    let error = fmm_record::open("no/such/file.mat").unwrap_err();
    assert!(matches!(error, RecordError::Io { .. }) && error.to_string().contains("no/such/file.mat"), "{error}");
    assert!(csv("").unwrap_err().to_string().contains("empty"));
    assert!(csv("time,velocity\n").unwrap_err().to_string().contains("no rows"));
}

#[test]
fn channels_that_are_not_there() {
    let error = Reader::default().channel("force").read_from("time,velocity\n0,1\n1,2\n".as_bytes()).unwrap_err();
    assert_eq!(error.to_string(), "there is no column \"force\"; the file has: \"time\", \"velocity\"");
    let file = fmm_record::open(data("BrowserForkCompoundFirst1.mat")).unwrap();
    let error = file.channel("force").unwrap_err().to_string();
    assert!(error.contains("\"force\"") && error.contains("data (30000×1)"), "{error}");
}

#[test]
fn times_that_are_not_uniform() {
    let text =
        |times: &[f64]| times.iter().fold("time,velocity\n".to_owned(), |text, time| format!("{text}{time},0.5\n"));
    let error = csv(&text(&[0.0, 0.1, 0.2, 0.35, 0.4, 0.5])).unwrap_err();
    assert!(matches!(error, RecordError::TimeAxis { index: Some(3), .. }), "{error}");
    assert!(error.to_string().starts_with("sampling is not uniform"), "{error}");
    let error = csv(&text(&[0.0, 0.1, 0.1, 0.2])).unwrap_err();
    assert!(matches!(error, RecordError::TimeAxis { index: Some(2), .. }), "{error}");
    assert!(error.to_string().starts_with("time must increase"), "{error}");
}

#[test]
fn numbers_that_are_not_finite() {
    for bad in ["NaN", "inf", "-inf"] {
        let error = csv(&format!("time,velocity\n0,1\n0.1,{bad}\n0.2,3\n")).unwrap_err();
        assert!(matches!(error, RecordError::Values { index: 1, .. }), "{bad}: {error}");
        assert!(error.to_string().starts_with("1 of 3 samples"), "{bad}: {error}");
    }
    let error = Record::new(0.0, 1.0, vec![0.0, f64::NAN], Quantity::Velocity, "m/s").unwrap_err();
    assert_eq!(
        error.to_string(),
        "1 of 2 samples is not finite; the first is sample 1 (at 1 s); cut the record there, or fill the gap"
    );
}

#[test]
fn records_in_which_nothing_moves() {
    assert!(
        matches!(prepare(vec![0.0; 5000]), Err(IdentifyError::NotSeen { what }) if what.contains("constant at 0 "))
    );
    assert!(matches!(prepare(vec![0.0; 3]), Err(IdentifyError::TooFew { found: 3, .. })));
    assert!(matches!(prepare(white(NOISE, 1, 5000)), Err(IdentifyError::TooFew { .. })));
    let force = Record::new(0.0, 1.0, vec![0.0; 99], Quantity::Force, "N").unwrap();
    let error = Experiment::ring_down(&force, &Preparation::default()).unwrap_err();
    assert!(matches!(error, IdentifyError::WrongRecord { ref what } if what.contains("force")), "{error}");
}

/// Two half swings are the least; two or three are fitted with a warning.
#[test]
fn records_with_few_swings() {
    let error = prepare(vibration(200)).unwrap_err();
    assert!(matches!(error, IdentifyError::TooFew { needed: 2, .. }), "{error}");
    let found = identified(vibration(700));
    let few = |warning: &Warning| matches!(warning, Warning::FewHalfSwings { count: 2..=3 });
    assert!(found.warnings().iter().any(few), "{found}");
}

/// Without decay both dissipations go to zero and stay there, and the report says that there is nothing to find.
#[test]
fn a_record_without_decay() {
    let steady = |growth: f64| -> Vec<f64> {
        (0..5000).map(|i| f64::from(i) * INTERVAL).map(|t| (0.1 + growth * t) * (TAU * 2.0 * t).cos()).collect()
    };
    for growth in [0.0, 2e-3] {
        let found = identified(steady(growth));
        let friction = found.finding("friction_per_mass").unwrap().value();
        let damping = found.finding("damping_per_mass").unwrap().value();
        assert!(friction < 1e-6 && damping < 1e-6, "growth {growth}: {friction} m/s², {damping} 1/s");
        assert!(growth == 0.0 || found.warnings().contains(&Warning::NoDecay), "{found}");
    }
}

#[test]
fn clipped_samples_are_warned_of() {
    let clipped = vibration(4000).iter().map(|value| value.clamp(-0.08, 0.08)).collect();
    let found = identified(clipped);
    let count = found.warnings().iter().find_map(|warning| match warning {
        Warning::Saturated { count } => Some(*count),
        _ => None,
    });
    assert!(count.is_some_and(|count| count > 50), "{found}");
    let saturated = |warning: &Warning| matches!(warning, Warning::Saturated { .. });
    assert!(!identified(vibration(4000)).warnings().iter().any(saturated));
}

#[test]
fn a_step_in_the_offset_is_warned_of() {
    let stepped =
        vibration(8000).iter().enumerate().map(|(i, value)| value + if i < 4100 { 0.0 } else { 0.02 }).collect();
    let found = identified(stepped);
    let step = found.warnings().iter().find_map(|warning| match warning {
        Warning::OffsetStep { time, height, .. } => Some((*time, *height)),
        _ => None,
    });
    let (time, height) = step.unwrap_or_else(|| panic!("no step found\n{found}"));
    assert!((time - 4.1).abs() < 0.5 && (height - 0.02).abs() < 0.003, "step of {height} m/s at {time} s");
}

#[test]
fn machines_that_cannot_be() {
    for bad in [0.0, -1.0] {
        let error = Machine::of_mass(Known::exact(bad).unwrap()).unwrap_err();
        assert!(matches!(error, ModelError::NotPositive { quantity: "mass", .. }), "{error}");
        assert!(Machine::of_stiffness(Known::exact(bad).unwrap()).is_err());
        assert!(Machine::per_unit_mass().with_normal_load(Known::exact(bad).unwrap()).is_err());
    }
    assert!(Known::exact(f64::NAN).is_err() && Known::new(1.0, f64::INFINITY).is_err());
    assert!(Machine::per_unit_mass().with_damping(Known::exact(-0.1).unwrap()).is_err());
}

#[test]
fn a_start_outside_the_bounds() {
    let decay = prepare(vibration(4000)).unwrap();
    let problem =
        Problem::of(&Candidate::of::<Viscous>(), Machine::per_unit_mass(), std::slice::from_ref(&decay)).unwrap();
    let start = [2.0, -0.5, 0.0, 0.1, 0.0];
    assert_eq!(problem.parameters().len(), start.len());
    let error = solve(&problem, &start, &Options::default()).unwrap_err();
    let FitError::OutOfRange { what, value } = &error else { panic!("{error}") };
    assert!(what.contains("damping_per_mass") && *value == -0.5, "{error}");
}

#[test]
fn records_that_do_not_belong_together() {
    let velocity = prepare(vibration(4000)).unwrap();
    let volts = Experiment::ring_down(&fork(), &Preparation::default()).unwrap();
    let error = identify::<Coulomb>(&Machine::per_unit_mass(), &[velocity, volts]).unwrap_err();
    assert!(matches!(error, IdentifyError::WrongRecord { .. }), "{error}");
    assert!(matches!(
        identify::<Coulomb>(&Machine::per_unit_mass(), &[] as &[Experiment]),
        Err(IdentifyError::Missing { .. })
    ));
}

#[test]
fn matlab_files_that_are_cut_off() {
    let bytes = std::fs::read(data("BrowserForkCompoundFirst1.mat")).unwrap();
    let error = Reader::default().parse(&bytes[..bytes.len() / 2]).unwrap_err();
    assert!(matches!(error, RecordError::Damaged { .. }) && error.to_string().contains("cut off"), "{error}");

    let mut hdf5 = vec![b' '; 512];
    hdf5[..19].copy_from_slice(b"MATLAB 7.3 MAT-file");
    hdf5.extend_from_slice(b"\x89HDF\r\n\x1a\n");
    let error = Reader::default().parse(hdf5).unwrap_err();
    assert!(matches!(error, RecordError::Damaged { .. }) && error.to_string().contains("HDF5"), "{error}");
    assert!(error.to_string().contains("7.3"), "{error}");
}

/// Spikes are left out, and said to be.
#[test]
fn spikes_are_left_out() {
    let mut values = vibration(4000);
    values[1500] += 0.5;
    values[2222] -= 0.5;
    let found = identified(values);
    let clean = identified(vibration(4000));
    assert!(found.warnings().contains(&Warning::Spikes { count: 2 }), "{found}");
    let friction = |found: &Identification| found.finding("friction_per_mass").unwrap().value();
    assert!((friction(&found) / friction(&clean) - 1.0).abs() < 1e-3);
}

#[test]
fn the_offset_of_a_rest_needs_a_rest() {
    let rest = Preparation::default().offset(Offset::Rest);
    let decay = Experiment::ring_down(&release(22e-3, 2e-4, 5), &rest).unwrap();
    let fitted = Experiment::ring_down(&release(22e-3, 2e-4, 5), &Preparation::default()).unwrap();
    let held = decay.summary().held_offset.expect("held");
    let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &[fitted]).unwrap();
    let offset = found.finding("offset").unwrap().value();
    assert!((held - offset).abs() < 5e-5, "held at {held} m/s, fitted {offset} m/s");
    let error = Experiment::ring_down(&record(vibration(4000)), &rest).unwrap_err();
    assert!(matches!(error, IdentifyError::NotSeen { .. }), "{error}");
}

/// A record that begins at rest is used from its first peak on.
#[test]
fn rest_before_the_release_is_not_fitted() {
    let decay = Experiment::ring_down(&release(22e-3, 2e-4, 5), &Preparation::default()).unwrap();
    let release = decay.summary().release.expect("a release");
    assert!((release - 1.0).abs() < 0.06, "released at {release} s");
    // A quarter period after the release, 0.114 s.
    assert!((decay.summary().from - release - 0.114).abs() < 0.01, "begins at {} s", decay.summary().from);
}
