//! Noise and disturbances that a measurement adds to a motion.

use std::f64::consts::TAU;

use super::Random;

/// White noise of standard deviation `deviation`.
pub(crate) fn white(values: &mut [f64], deviation: f64, random: &mut Random) {
    for value in values {
        *value += deviation * random.normal();
    }
}

/// Stationary noise of standard deviation `deviation` of which each sample remembers `memory` (1) of the one before it.
pub(crate) fn remembering(values: &mut [f64], memory: f64, deviation: f64, random: &mut Random) {
    let mut noise = random.normal();
    for value in values {
        *value += deviation * noise;
        noise = memory * noise + (1.0 - memory * memory).sqrt() * random.normal();
    }
}

/// White noise that is the greater, the greater the signal: of each sample `floor` and `share` (1) of its `size`.
pub(crate) fn growing(values: &mut [f64], sizes: &[f64], floor: f64, share: f64, random: &mut Random) {
    for (value, size) in values.iter_mut().zip(sizes) {
        *value += (floor + share * size.abs()) * random.normal();
    }
}

/// A random walk that has the standard deviation `deviation` at the end.
pub(crate) fn walk(values: &mut [f64], deviation: f64, random: &mut Random) {
    let step = deviation / (values.len() as f64).sqrt();
    let mut sum = 0.0;
    for value in values {
        *value += sum;
        sum += step * random.normal();
    }
}

/// A slow drift by `reach` from its least to its greatest value: a parabola, or a piece of a sine of one to two record
/// lengths.
pub(crate) fn drift(values: &mut [f64], reach: f64, random: &mut Random) {
    let count = values.len() as f64;
    let curve: Vec<f64> = if random.coin() {
        let summit = random.uniform(-0.5, 1.5);
        (0..values.len()).map(|i| (i as f64 / count - summit).powi(2)).collect()
    } else {
        let (waves, phase) = (random.uniform(0.5, 1.0), random.phase());
        (0..values.len()).map(|i| (TAU * waves * i as f64 / count + phase).sin()).collect()
    };
    let (least, most) = curve.iter().fold((f64::MAX, f64::MIN), |(least, most), y| (y.min(least), y.max(most)));
    let scale = if random.coin() { reach } else { -reach } / (most - least);
    for (value, y) in values.iter_mut().zip(&curve) {
        *value += scale * y;
    }
}

/// A sine of `frequency` (Hz) and `amplitude` in any phase, which dies out over the time constant `lasting` (s).
pub(crate) fn sine(
    values: &mut [f64],
    interval: f64,
    (frequency, amplitude, lasting): (f64, f64, f64),
    random: &mut Random,
) {
    let phase = random.phase();
    for (index, value) in values.iter_mut().enumerate() {
        let time = interval * index as f64;
        *value += amplitude * (-time / lasting).exp() * (TAU * frequency * time + phase).sin();
    }
}

/// Rounding to a lattice of `step` that lies anywhere.
pub(crate) fn rounded(values: &mut [f64], step: f64, random: &mut Random) {
    let shift = random.uniform(0.0, 1.0);
    for value in values {
        *value = step * (*value / step + shift).round();
    }
}
