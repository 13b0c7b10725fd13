//! A synthetic vibrometer: what a measurement adds to an exact motion.

use std::f64::consts::TAU;

use fmm_friction::Coulomb;
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, Sampling, Scenario};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// The thesis machine with a contact of known friction.
pub(crate) const MASS: f64 = 10.391;
pub(crate) const STIFFNESS: f64 = 1982.0;
pub(crate) const DAMPING: f64 = 0.275;
pub(crate) const LOAD: f64 = 14.0;
pub(crate) const MU: f64 = 0.25;

/// Sampling interval (s), rest before the release (s), and length of the record after it (s).
const INTERVAL: f64 = 1e-3;
const REST: f64 = 1.0;
const AFTER: f64 = 2.0;

/// White noise of standard deviation `deviation`.
pub(crate) fn white(deviation: f64, seed: u64, count: usize) -> Vec<f64> {
    let normal = Normal::new(0.0, deviation).unwrap();
    normal.sample_iter(ChaCha8Rng::seed_from_u64(seed)).take(count).collect()
}

/// A velocity record of a release at `position` (m), with white noise of standard deviation `noise` (m/s).
///
/// The rest of the measurement is as it would be in the laboratory, drawn from `seed`: a 16-bit converter over
/// ±1.25 m/s, an offset within ±5 mm/s and its drift, hum, the trigger's jitter, a release that is off by up to
/// 0.05 mm, a spike of the electromagnet as it lets go, the table ringing, and up to two drop-outs. The gain is
/// left at 1: a gain that is off by a factor makes μ wrong by that factor, whatever the fit.
pub(crate) fn release(position: f64, noise: f64, seed: u64) -> Record {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let release = REST + random.random_range(-0.05..0.05);
    let position = position + random.random_range(-5e-5..5e-5);
    let first = (release / INTERVAL).ceil() as usize;
    let count = ((REST + AFTER) / INTERVAL) as usize;
    let motion = motion(position, first as f64 * INTERVAL - release, count - first);

    let (offset, drift) = (random.random_range(-5e-3..5e-3), random.random_range(-1.0..1.0) * 1e-4 / 45.0);
    let hum = random.random_range(0.0..TAU);
    let (ringing, ringing_phase) = (random.random_range(30.0..60.0), random.random_range(0.0..TAU));
    let white = Normal::new(0.0, noise).unwrap();
    let mut values: Vec<f64> = (0..count)
        .map(|i| {
            let time = i as f64 * INTERVAL;
            let since = time - release;
            let table = if since > 0.0 {
                2e-4 * (-since / 0.3).exp() * (TAU * ringing * since + ringing_phase).sin()
            } else {
                0.0
            };
            let velocity = i.checked_sub(first).map_or(0.0, |sample| motion[sample]);
            let hum = 5e-5 * (TAU * 50.0 * time + hum).sin();
            velocity + offset + drift * time + hum + table + white.sample(&mut random)
        })
        .collect();
    for value in &mut values[first..first + random.random_range(1..=3)] {
        *value += random.random_range(5e-3..2e-2);
    }
    for _ in 0..random.random_range(0..=2) {
        let start = random.random_range(10..count - 10);
        let height = if random.random_bool(0.5) { 0.1 } else { -0.1 };
        for value in &mut values[start..start + random.random_range(1..=3)] {
            *value += height;
        }
    }
    let step = 2.5 / 65536.0;
    let quantised = values.iter().map(|value| (value / step).round() * step).collect();
    Record::new(0.0, INTERVAL, quantised, Quantity::Velocity, "m/s").unwrap()
}

/// Exact velocity (m/s) at `count` samples, the first of which is `delay` (s) after the release from rest.
fn motion(position: f64, delay: f64, count: usize) -> Vec<f64> {
    let machine = Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(Damping::linear(DAMPING).unwrap());
    let scenario = Scenario::new(machine, Coulomb::new(MU).unwrap(), LOAD).unwrap();
    let released = scenario.clone().starting_at(position, 0.0).unwrap();
    // Position and velocity at the first sample, from where the sampling can be uniform.
    let to_first = Exact.run(&released, &Sampling::uniform(delay.max(1e-12), 2).unwrap()).unwrap();
    let state = (to_first.position().values()[1], to_first.velocity().values()[1]);
    let moving = scenario.starting_at(state.0, state.1).unwrap();
    Exact.run(&moving, &Sampling::uniform(INTERVAL, count).unwrap()).unwrap().velocity().values().to_vec()
}
