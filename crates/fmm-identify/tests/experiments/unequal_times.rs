//! Records whose samples are unequally spaced: jitter, lost samples, a gap, two rates.

use fmm_friction::CoulombViscous;
use fmm_identify::{Candidate, Experiment, Preparation, Sensor, compare};
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Channels, Engine, Exact, Sampling, Scenario};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::simulated::{LOAD, MASS, STIFFNESS, machine};

const MU: f64 = 0.25;

/// Noise over the first amplitude (1).
const NOISE: f64 = 1e-3;

/// A decay seen at these `times` (s), with noise.
fn decay(times: &[f64], quantity: Quantity) -> Record {
    let damping = Damping::linear(0.5).unwrap();
    let machine = Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(damping);
    let scenario = Scenario::new(machine, CoulombViscous::new(MU, 0.0).unwrap(), LOAD).unwrap();
    let elapsed: Vec<f64> = times.iter().map(|time| time - times[0]).collect();
    let sampling = Sampling::at(elapsed).unwrap().keeping(Channels::All);
    let motion = Exact.run(&scenario.starting_at(0.04, 0.0).unwrap(), &sampling).unwrap();
    let (samples, unit) = match quantity {
        Quantity::Displacement => (motion.position(), "m"),
        Quantity::Velocity => (motion.velocity(), "m/s"),
        _ => (motion.acceleration(), "m/s²"),
    };
    let mut random = ChaCha8Rng::seed_from_u64(times.len() as u64);
    let largest = samples.values().iter().fold(0.0f64, |most, value| most.max(value.abs()));
    let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
    let values = samples.values().iter().map(|value| value + NOISE * largest * draw()).collect();
    Record::at_times(times, values, quantity, unit).unwrap()
}

/// 3 s at about 500 Hz, from 10 s on: the stamp `late` by a part of a step, and some samples lost.
fn times(late: impl Fn(u32) -> f64, is_there: impl Fn(&u32) -> bool) -> Vec<f64> {
    (0..1500).filter(is_there).map(|i| 10.0 + 2e-3 * (f64::from(i) + late(i))).collect()
}

fn jitter(index: u32) -> f64 {
    0.45 * (f64::from(index) * 77.7).sin()
}

#[test]
fn friction_is_found_at_any_times() {
    let all = times(|_| 0.0, |_| true);
    let u = |times: &[f64], quantity: Quantity, what: &str| {
        let record = decay(times, quantity);
        let experiment = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        let noise = experiment.summary().noise / (NOISE * experiment.summary().amplitudes.0);
        assert!((0.7..1.4).contains(&noise), "{what}, {quantity}: noise {noise}");
        let found = compare(&machine(), &[experiment], &[Candidate::of::<CoulombViscous>()]).unwrap();
        let mu = found.preferred().finding("mu").unwrap();
        let u = mu.uncertainty().unwrap();
        assert!((mu.value() - MU).abs() < 3.0 * u, "{what}, {quantity}: {} ± {u}", mu.value());
        u
    };
    for quantity in [Quantity::Displacement, Quantity::Velocity, Quantity::Acceleration] {
        let least = u(&all, quantity, "equal");
        for (what, times) in [
            ("jitter", times(jitter, |_| true)),
            ("lost samples", times(|_| 0.0, |i| !i.is_multiple_of(17))),
            ("a gap of 20 samples", times(|_| 0.0, |i| !(300..320).contains(i))),
            ("a gap of a fifth of a period", times(jitter, |i| !(300..345).contains(i))),
            ("two rates", times(|_| 0.0, |i| *i < 500 || i.is_multiple_of(3))),
        ] {
            let u = u(&times, quantity, what);
            assert!(u < 3.0 * least, "{what}, {quantity}: {u}, at equal times {least}");
        }
    }
}

#[test]
fn a_filter_needs_equal_times() {
    let record = decay(&times(jitter, |_| true), Quantity::Velocity);
    let experiment = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    assert_eq!(experiment.record().len(), 1500);
    let error = experiment.seen_by(Sensor::default().with_low_pass(2, 100.0).unwrap()).unwrap_err();
    assert!(error.to_string().contains("equal intervals"), "{error}");
}

#[test]
fn a_gap_that_hides_swings_is_refused_with_its_ends() {
    let record = decay(&times(|_| 0.0, |i| !(300..530).contains(i)), Quantity::Displacement);
    let error = Experiment::ring_down(&record, &Preparation::default()).unwrap_err().to_string();
    assert!(error.contains("up to 10.598 s or from 11.06 s on"), "{error}");
    assert!(Experiment::ring_down(&record, &Preparation::default().from(11.06)).is_ok());
}
