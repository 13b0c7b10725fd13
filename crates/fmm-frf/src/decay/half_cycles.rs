//! Half cycles: the points of a backbone that has too few cycles for windows.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use fmm_model::Estimated;
use fmm_record::{Peak, Quantity, Record, Swings, noise, quantisation_step};

use crate::decay::point::{BackbonePoint, Row};

/// Amplitudes that a point needs: of three half cycles in a row, the first and the last are compared.
const COMPARED: usize = 3;
/// Half cycles that two points need: one more than amplitudes.
pub(crate) const FEWEST_HALF_CYCLES: usize = COMPARED + 2;
/// Deviation of a passage of a displacement and of a velocity, against that of the mean of the samples it is fitted to.
/// The centre comes from four turning points with weights 1, 3, 3, 1, two of which the next passage but one has as
/// well, √(1 + ½ 28/64 · 1.5²). The kink of a velocity is fitted beside, which makes the passage twice as uncertain,
/// √(4 + ½ 28/64 · 1.5²).
const PASSAGE: (f64, f64) = (1.222, 2.12);

/// Rows of a decay from its turning points and passages through the centre, for one of displacement or velocity.
///
/// ```text
/// A_j = |e_{j+1} − e_j|/2          amplitude between two turning points e: no offset
/// c_eq/m = 2 ln(A_j/A_{j+2})/T,    T from passage j to passage j + 2, at the amplitude A_{j+1}
/// ```
///
/// For viscous damping on a straight spring both are exact.
pub(crate) fn half_cycle_points(record: &Record) -> Vec<Row> {
    let orders = match record.quantity() {
        Quantity::Displacement => 0,
        Quantity::Velocity => 1,
        // An acceleration jumps where dry friction reverses, which is where it turns.
        _ => return Vec::new(),
    };
    let passage = if orders == 1 { PASSAGE.1 } else { PASSAGE.0 };
    let swings = Swings::of(record);
    let (peaks, crossings) = (swings.peaks(), swings.crossings());
    let Some(frequency) = swings.frequency() else { return Vec::new() };
    let step = quantisation_step(record.values()).unwrap_or(0.0);
    let white = noise(record.values()).hypot(step / 12f64.sqrt());
    let samples_per_period = record.rate() / frequency;
    let u_amplitude = FRAC_1_SQRT_2 * Peak::standard_uncertainty(white, samples_per_period);
    let mean = white / Swings::samples_per_point(samples_per_period).sqrt();
    let amplitude = |j: usize| 0.5 * (peaks[j + 1].value - peaks[j].value).abs();
    // Beside the first and the last passage lie three turning points, whose centre a changing loss shifts.
    let last = crossings.len().saturating_sub(1);
    let is_end = |j: usize| j == 0 || j == last;
    let inner = |j: usize| crossings[j.max(1).min(last - 1)].centre;
    let u_centre = |j: usize| if is_end(j) { crossings[j].centre - inner(j) } else { 0.0 };
    let count = crossings.len().min(peaks.len().saturating_sub(1));
    (0..(count + 1).saturating_sub(COMPARED))
        .filter_map(|j| {
            let (first, last) = (amplitude(j), amplitude(j + 2));
            let period = crossings[j + 2].time - crossings[j].time;
            if !(first > 0.0 && last > 0.0 && period > 0.0) {
                return None;
            }
            let frequency = 1.0 / period;
            let u_time = |j: usize| (passage * mean).hypot(u_centre(j)) / (TAU * frequency * amplitude(j));
            let of_damping = (u_amplitude / first).hypot(u_amplitude / last);
            let seen = Estimated::new(amplitude(j + 1), u_amplitude);
            let point = BackbonePoint {
                time: f64::midpoint(crossings[j].time, crossings[j + 2].time),
                amplitude: seen.scaled((TAU * frequency).powi(-orders)),
                frequency: Estimated::new(frequency, frequency * frequency * u_time(j).hypot(u_time(j + 2))),
                damping: Estimated::new((first / last).ln(), of_damping).scaled(2.0 * frequency),
            };
            // A velocity passes its centre where the motion turns. The third multiple on a curved spring, 1/24 of its
            // bend in a displacement, is three times as large in a velocity, and has the other sign at its peaks.
            let (lag, harmonic) = if orders == 1 { (1.0, -0.25) } else { (-2.0, 1.0 / 12.0) };
            Some(Row { point, reach: 0.25 * period * period, lag, orders: f64::from(orders), harmonic })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::decay::{Backbone, BackboneOptions};

    /// A release by 1 mm on dry friction that stops it after `halves` half cycles of 0.1 s, at 1 kHz, with noise of
    /// half a micrometre.
    fn stopped(halves: usize) -> Record {
        // Each half cycle loses twice the friction; the rest is less than that.
        let friction = 1.0 / (2 * halves + 1) as f64;
        let at = |i: usize| {
            let time = i as f64 / 1000.0;
            let half = ((time / 0.1) as usize).min(halves);
            let side = if half.is_multiple_of(2) { 1.0 } else { -1.0 };
            let turn = 1.0 - 2.0 * friction * half as f64;
            let swing = if half < halves { (PI * (time / 0.1 - half as f64)).cos() } else { 1.0 };
            let noise = ((i as f64 * 12.9898).sin() * 43_758.545_3).fract();
            1e-3 * (side * (friction + (turn - friction) * swing) + 1e-3 * noise)
        };
        Record::sampled(1000.0, (0..3000).map(at).collect(), Quantity::Displacement, "m").unwrap()
    }

    #[test]
    fn too_few_half_cycles_are_counted() {
        let of = |halves: usize| Backbone::of(&stopped(halves), &BackboneOptions::default());
        let refused = of(2).unwrap_err().to_string();
        assert_eq!(refused, "the record shows 2 half cycles above its noise; a backbone needs at least 5");
        let asked = BackboneOptions::default().over(3.0).unwrap();
        let refused = Backbone::of(&stopped(5), &asked).unwrap_err().to_string();
        assert!(refused.ends_with("shows 5 half cycles above its noise; a backbone needs at least 12"), "{refused}");
        assert!(of(FEWEST_HALF_CYCLES).unwrap().points().len() >= 2);
        assert!(of(FEWEST_HALF_CYCLES - 1).is_err());
    }
}
