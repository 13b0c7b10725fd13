//! A finding does not depend on the unit of the record.

use fmm_friction::CoulombViscous;
use fmm_identify::{Experiment, Identification, Machine, Preparation, identify};
use fmm_record::{Quantity, Record};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

use crate::records::{RELEASES, machine, velocity};

/// Noise that remembers itself, z_i = 0.9 z_{i−1} + e_i, so that degrees of freedom follow from it (m/s).
fn coloured(velocity: &[f64]) -> Vec<f64> {
    let mut last = 0.0;
    let noise = Normal::new(0.0, 1e-4).unwrap().sample_iter(ChaCha8Rng::seed_from_u64(7));
    let noise = noise.map(|e| {
        last = 0.9 * last + e;
        last
    });
    velocity.iter().zip(noise).map(|(v, noise)| v + noise).collect()
}

fn found(values: &[f64], unit: &str, factor: f64) -> Identification {
    let values = values.iter().map(|value| factor * value).collect();
    let record = Record::new(0.0, 1e-3, values, Quantity::Velocity, unit).unwrap();
    let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    identify::<CoulombViscous>(&Machine::per_unit_mass(), &[decay]).unwrap()
}

/// One record in m/s and in mm/s: values and ends of intervals are the same lengths, and degrees of freedom the same
/// numbers.
#[test]
fn millimetres_give_the_intervals_of_metres() {
    let values = coloured(&velocity::<CoulombViscous>(machine(), &[0.2, 0.1], RELEASES[1], 2000));
    let (metres, millimetres) = (found(&values, "m/s", 1.0), found(&values, "mm/s", 1e3));
    let fewest = metres.findings().iter().map(fmm_identify::Finding::degrees_of_freedom).fold(f64::INFINITY, f64::min);
    assert!(fewest < 1000.0, "the noise counts as white: {fewest} degrees of freedom of 2000 samples");
    for (own, other) in metres.findings().iter().zip(millimetres.findings()) {
        let name = own.parameter().name();
        let is_length = other.parameter().unit().contains("mm");
        let factor = if is_length { 1e3 } else { 1.0 };
        let freedom = other.degrees_of_freedom() / own.degrees_of_freedom() - 1.0;
        assert!(freedom.abs() < 1e-9, "{name}: degrees of freedom {freedom:e}");
        let (Some((low, high)), Some((other_low, other_high))) = (own.interval(0.95), other.interval(0.95)) else {
            panic!("{name} has no interval")
        };
        for (end, other) in [(low, other_low), (high, other_high)] {
            let difference = (other / factor - end) / (high - low);
            assert!(difference.abs() < 1e-9, "{name}: {end} and {other} differ by {difference:e} of the interval");
        }
    }
}
