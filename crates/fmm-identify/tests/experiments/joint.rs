//! Several kinds together: what no single experiment tells apart.

use fmm_fit::{Residuals, check_jacobian};
use fmm_friction::CoulombStatic;
use fmm_identify::{
    Candidate, Drive, Experiment, Identification, IdentifyError, Inquiry, Preparation, Problem, Sensor, Terms, identify,
};
use fmm_record::{Quantity, Record};

use crate::simulated::{INTERVAL, LOAD, MASS, Motion, machine, record, share_inside};

const SAMPLES: usize = 2000;
const DAMPING: f64 = 0.8;
const SLIDING: f64 = 0.25;
const STATIC: f64 = 0.32;
const SEEDS: u64 = 60;

/// A slow force (N) through the static level of 4.5 N.
fn ramp() -> Vec<f64> {
    (0..SAMPLES).map(|i| 7.0 * i as f64 / SAMPLES as f64).collect()
}

struct Motions {
    lifted: Vec<f64>,
    sliding: Vec<f64>,
    pushed: Vec<f64>,
}

fn motions() -> Motions {
    let force = ramp();
    let of = |load: f64, release: f64, force: Option<&[f64]>| {
        let law = [SLIDING, STATIC];
        let initial = (release, 0.0);
        Motion { damping: DAMPING, law: &law, load, initial, force, samples: SAMPLES, interval: INTERVAL }
            .of::<CoulombStatic>()
    };
    Motions {
        lifted: of(0.0, 0.022, None).velocity().values().to_vec(),
        sliding: of(LOAD, 0.022, None).velocity().values().to_vec(),
        pushed: of(LOAD, 0.0, Some(&force)).position().values().to_vec(),
    }
}

fn experiments(motions: &Motions, seed: u64) -> [Experiment; 3] {
    let velocity = |values: &[f64], seed| record(values, 1e-3, seed, Quantity::Velocity, "m/s");
    let decay = |values: &[f64], seed| Experiment::ring_down(&velocity(values, seed), &Preparation::default()).unwrap();
    let force = Record::new(0.0, INTERVAL, ramp(), Quantity::Force, "N").unwrap();
    let response = record(&motions.pushed, 5e-6, 3 * seed, Quantity::Displacement, "m");
    [
        decay(&motions.lifted, 3 * seed + 1).without_contact(),
        decay(&motions.sliding, 3 * seed + 2),
        Experiment::driven(&response, Drive::force(&force).unwrap(), &Preparation::default()).unwrap(),
    ]
}

fn found(experiments: &[Experiment]) -> Result<Identification, IdentifyError> {
    Inquiry::of(&machine(), experiments)
        .candidate(&Candidate::of::<CoulombStatic>().with(Terms::default().with_linear_damping()))
}

/// A ring-down without contact, one with contact and a slow ramp tell damping, sliding and static level apart; single
/// ones do not.
#[test]
fn three_experiments_tell_what_no_one_does() {
    let motions = motions();
    let mut others = [0.0; 2];
    let truths = [("static_mu", STATIC), ("damping_per_mass", DAMPING / MASS)];
    let share = share_inside(SLIDING, SEEDS, |seed| {
        let found = found(&experiments(&motions, seed)).unwrap();
        for ((name, truth), inside) in truths.iter().zip(&mut others) {
            let finding = found.finding(name).unwrap_or_else(|| panic!("{found}"));
            assert!(finding.uncertainty().is_some_and(|u| u < 0.02 * truth), "{found}");
            let (low, high) = finding.interval(0.95).unwrap_or_else(|| panic!("{found}"));
            *inside += f64::from(u8::from((low..=high).contains(truth))) / SEEDS as f64;
        }
        found.interval("sliding_mu", 0.95).unwrap_or_else(|| panic!("{found}"))
    });
    println!("mu {share}, {others:?}");
    // Of 60 intervals 95 ± 2.8 % contain the truth by chance alone.
    assert!(share >= 0.88 && others.iter().all(|share| *share >= 0.88), "{share} {others:?}");

    let [lifted, sliding, pushed] = experiments(&motions, 1);
    // Alone, the ring-down holds its static level, and the ramp leaves the damping open.
    let alone = found(&[sliding]).unwrap();
    assert!(alone.finding("static_mu").is_none(), "{alone}");
    let alone = found(&[pushed]).unwrap();
    let loose = alone.finding("damping_per_mass").unwrap();
    assert!(loose.uncertainty().is_none_or(|u| u > 0.2 * DAMPING / MASS), "{alone}");
    let alone = found(&[lifted]).unwrap();
    assert!(alone.finding("sliding_mu").is_none_or(|mu| mu.uncertainty().is_none()), "{alone}");
}

/// A load that differs between the experiments scales their friction, not their damping.
#[test]
fn loads_of_their_own_scale_friction() {
    let of = |load: f64| {
        let law = [SLIDING, SLIDING];
        let motion = Motion {
            damping: DAMPING,
            law: &law,
            load,
            initial: (0.022, 0.0),
            force: None,
            samples: SAMPLES,
            interval: INTERVAL,
        };
        let values = motion.of::<CoulombStatic>().velocity().values().to_vec();
        let record = Record::new(0.0, INTERVAL, values, Quantity::Velocity, "m/s").unwrap();
        Experiment::ring_down(&record, &Preparation::default()).unwrap()
    };
    let experiments =
        [of(LOAD), of(0.5 * LOAD).with_load_factor(0.5).unwrap(), of(2.0 * LOAD).with_load_factor(2.0).unwrap()];
    let found = Inquiry::of(&machine(), &experiments)
        .candidate(&Candidate::of::<fmm_friction::Coulomb>().with(Terms::default().with_linear_damping()));
    let found = found.unwrap();
    assert!((found.finding("mu").unwrap().value() - SLIDING).abs() < 1e-9, "{found}");
    assert!((found.finding("damping_per_mass").unwrap().value() - DAMPING / MASS).abs() < 1e-8, "{found}");
    let refused = experiments[0].clone().with_load_factor(-1.0);
    assert!(matches!(refused, Err(IdentifyError::OutOfRange { .. })));
    let mixed = Record::new(0.0, INTERVAL, experiments[0].record().values().to_vec(), Quantity::Velocity, "V").unwrap();
    let volts = Experiment::ring_down(&mixed, &Preparation::default()).unwrap();
    let refused = identify::<fmm_friction::Coulomb>(&machine(), &[experiments[0].clone(), volts]);
    assert!(matches!(refused, Err(IdentifyError::WrongRecord { .. })));
}

/// Rows of different quantities count by their noise, and their derivatives, that by the corner of a sensor among them,
/// are those of differences.
#[test]
fn rows_are_weighed_and_their_derivatives_are_right() {
    let [lifted, sliding, pushed] = experiments(&motions(), 2);
    let sensor = Sensor::default().with_free_low_pass(2).unwrap();
    let mixed = [sliding.seen_by(sensor).unwrap(), lifted, pushed];
    let terms = Terms::default().with_linear_damping();
    let problem = Problem::of(&Candidate::of::<CoulombStatic>().with(terms), machine(), &mixed).unwrap();
    let fit = found(&mixed).unwrap();
    let mut rows = fit.fit().residuals();
    let rms = |rows: &[f64]| (rows.iter().map(|row| row * row).sum::<f64>() / rows.len() as f64).sqrt();
    for experiment in &mixed {
        let (own, others) = rows.split_at(experiment.summary().samples);
        assert!((0.9e-3..1.1e-3).contains(&rms(own)), "{} in {}", rms(own), experiment.record().unit());
        rows = others;
    }
    assert!(rows.is_empty());
    // Off the minimum, where the corner, which an ideal sensor puts far away, rounds the kinks.
    let corner =
        problem.parameters().iter().position(|parameter| parameter.name().starts_with("sensor_corner")).unwrap();
    let mut values = fit.fit().values().to_vec();
    values[corner] = 30.0;
    let mismatches = check_jacobian(&problem, &values).unwrap();
    assert!(mismatches.is_empty(), "{mismatches:?}");
}
