//! Samples cut off at the limits of the converter.

use crate::examination::noise::{SINGLE_ROUNDING, noise, quantisation_step};
use crate::numerics::range;

/// Samples that lie on a limit of the measuring range, with the motion beyond it lost.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Saturation {
    /// Number of samples that are cut off.
    pub samples: usize,
    /// The upper limit, in the unit of the values, if samples lie on it.
    pub upper: Option<f64>,
    /// The lower limit, in the unit of the values, if samples lie on it.
    pub lower: Option<f64>,
}

/// Finds samples cut off at the largest or smallest value; `None` if there are none.
///
/// A run of three or more samples at the extreme, equal but for the rounding of single precision, is cut off if the
/// motion arrives and leaves as a cut sine does. At half the length of the run from its ends, the motion must be
/// farther away than the flat top of a parabola in the resolution of the converter could be, and a good part of that
/// distance must lie in the half next to the run. A quantised peak, a motion that comes to rest at its extreme, and
/// rest at either end of the record do not satisfy this. The loss must be more than 0.1 % of the range of the record.
///
/// Tops of one or two samples occur in fast motion. They are cut off if three or more of them lie exactly on the
/// extreme, and the distances of their neighbours from it differ by more than noise, resolution and 1 % of the range
/// explain. In a steady motion, equal tops have equal neighbours.
///
/// ```
/// use fmm_record::saturation;
///
/// let sine = |i: u32| (f64::from(i) * 0.01).sin();
/// assert_eq!(saturation(&(0..3000).map(sine).collect::<Vec<_>>()), None);
///
/// let cut: Vec<f64> = (0..3000).map(|i| sine(i).clamp(-2.0, 0.9)).collect();
/// let found = saturation(&cut).unwrap();
/// assert_eq!((found.upper, found.lower), (Some(0.9), None));
/// // Five tops of 2 acos 0.9/0.01 = 90.2 samples each.
/// assert_eq!(found.samples, 452);
/// ```
pub fn saturation(values: &[f64]) -> Option<Saturation> {
    limits(values, noise(values), quantisation_step(values).unwrap_or(0.0))
}

/// Saturation of values of this noise and step of the converter.
pub(crate) fn limits(values: &[f64], noise: f64, step: f64) -> Option<Saturation> {
    let (low, high) = range(values);
    let tolerance = 6.0 * (step + noise);
    let visible = 1e-3 * (high - low);
    let upper = cut_off(values, high, tolerance, visible);
    let lower = cut_off(values, low, tolerance, visible);
    (upper + lower > 0).then(|| Saturation {
        samples: upper + lower,
        upper: (upper > 0).then_some(high),
        lower: (lower > 0).then_some(low),
    })
}

/// Number of samples cut off at `level`, the largest or smallest value, where more than `visible` is lost.
fn cut_off(values: &[f64], level: f64, tolerance: f64, visible: f64) -> usize {
    const SHORTEST: usize = 3;
    /// Share of the way to a distance d from the run that lies within d/2, above which the flank is steep: a straight flank
    /// makes half of it, a parabola that touches the level a quarter.
    const STEEP: f64 = 0.35;
    let rounding = SINGLE_ROUNDING * level.abs();
    let on_level = |value: &f64| (value - level).abs() <= rounding;
    let mut count = 0;
    let mut end = 0;
    // Tops of one or two samples that lie exactly on the level: their samples, and the ways from the level to the mean
    // of their two neighbours.
    let (mut in_tops, mut ways) = (0, Vec::new());
    for run in values.chunk_by(|a, b| on_level(a) == on_level(b)) {
        let start = end;
        end += run.len();
        if !on_level(&run[0]) {
            continue;
        }
        if run.len() < SHORTEST {
            if let (Some(before), Some(after)) = (start.checked_sub(1).map(|index| values[index]), values.get(end)) {
                in_tops += run.len();
                ways.push((f64::midpoint(before, *after) - level).abs());
            }
            continue;
        }
        let far = run.len().div_ceil(2).max(2);
        let near = far.div_ceil(2);
        let way = |index: Option<usize>| index.and_then(|i| values.get(i)).map(|value| (value - level).abs());
        let flanks = [
            way(start.checked_sub(near)).zip(way(start.checked_sub(far))),
            way(Some(end + near - 1)).zip(way(Some(end + far - 1))),
        ];
        let [Some(before), Some(after)] = flanks else { continue };
        let is_steep = |(near, far): (f64, f64)| far > tolerance && near >= STEEP * far;
        // A parabola over the run whose slopes at its ends are those of the flanks has this height.
        let lost = (before.0 + after.0) / (2 * near) as f64 * run.len() as f64 / 4.0;
        if is_steep(before) && is_steep(after) && lost > visible {
            count += run.len();
        }
    }
    // Where the motion beside them differs, their equal tops are no coincidence.
    let (least, greatest) = range(&ways);
    let are_cut = ways.len() >= SHORTEST && greatest - least > tolerance.max(10.0 * visible);
    count + if are_cut { in_tops } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::synthetic::{CoulombDecay, pendulum, pendulum_velocity, quantised, sampled, wheel};
    use crate::units::Quantity;

    #[test]
    fn cut_sines_are_found_with_noise_and_converter() {
        for noise in [0.0, 0.002] {
            for step in [0.005, 0.02] {
                let sine = sampled(1000.0, 10.0, Quantity::Velocity, noise, |t| (13.8 * t).sin() + 0.2);
                let values: Vec<f64> = quantised(&sine, step).values().iter().map(|v| v.clamp(-5.0, 0.8)).collect();
                let found = saturation(&values).unwrap();
                let true_count = values.iter().filter(|value| **value == 0.8).count();
                assert_eq!((found.upper, found.lower), (Some(0.8), None));
                // Noise breaks the ends of the runs up.
                assert!(found.samples as f64 > 0.9 * true_count as f64, "{} of {true_count}", found.samples);
                // A gain in single precision.
                let error = |i: usize| 4e-8 * (0.618_033_988_75 * i as f64).fract();
                let rounded = values.iter().enumerate().map(|(i, v)| v * (1.0 + error(i)));
                assert_eq!(saturation(&rounded.collect::<Vec<_>>()).unwrap().samples, found.samples);
            }
        }
    }

    /// Measured responses to hammer blows, of so high frequencies that most tops that are cut have one sample or two.
    #[cfg(feature = "mat")]
    #[test]
    fn cut_responses_to_blows_are_found() {
        for hit in 1..=3 {
            let path = format!("{}/../../examples/data/hammer_{hit}.mat", env!("CARGO_MANIFEST_DIR"));
            let record = crate::open(path).unwrap().channel("acceleration").unwrap().record;
            assert_eq!(saturation(record.values()), None, "hit {hit}");
            let peak = record.values().iter().fold(0.0, |peak: f64, value| peak.max(value.abs()));
            // As measured, and by a converter of 12 bits.
            for values in [record.values().to_vec(), quantised(&record, peak / 2048.0).into_values()] {
                assert_eq!(saturation(&values), None, "hit {hit}");
                for fraction in [0.7, 0.5] {
                    let limit = fraction * peak;
                    let cut: Vec<f64> = values.iter().map(|value| value.clamp(-limit, limit)).collect();
                    let found = saturation(&cut).unwrap_or_else(|| panic!("hit {hit}, {fraction} of its peak"));
                    assert_eq!((found.upper, found.lower), (Some(limit), Some(-limit)), "hit {hit}, {fraction}");
                    let true_count = cut.iter().filter(|value| value.abs() == limit).count();
                    assert!(found.samples as f64 > 0.9 * true_count as f64, "{} of {true_count}", found.samples);
                }
            }
        }
    }

    #[test]
    fn tops_that_are_equal_by_themselves_are_not_cut() {
        use std::f64::consts::TAU;
        // Steady, with whole and with half numbers of samples a period, alone and with a harmonic, and by a converter.
        for period in [5.0, 8.0, 10.5, 20.0, 33.3] {
            let wave = |t: f64| (TAU * t / period).sin() + 0.3 * (2.0 * TAU * t / period + 0.4).sin();
            let decay = |t: f64| (1.0 - 1e-5 * t) * (TAU * t / period).sin();
            for step in [1e-9, 1e-3, 0.02] {
                for noise in [0.0, 0.3 * step] {
                    for motion in [&wave as &dyn Fn(f64) -> f64, &decay] {
                        let record = sampled(1.0, 20_000.0, Quantity::Velocity, noise, motion);
                        let values = quantised(&record, step);
                        assert_eq!(
                            saturation(values.values()),
                            None,
                            "{period} samples a period, step {step}, noise {noise}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn sound_records_are_not_saturated() {
        #[cfg(feature = "mat")]
        assert_eq!(saturation(crate::tests::synthetic::fork().values()), None);
        for record in [wheel(), pendulum(), pendulum_velocity()] {
            assert_eq!(saturation(record.values()), None);
        }
        assert_eq!(saturation(&[1.0; 100]), None);
        assert_eq!(saturation(&[]), None);
    }

    #[test]
    fn quantised_peaks_and_rests_are_not_saturated() {
        for step in [1e-4, 0.01, 0.3, 1.0] {
            let decay = CoulombDecay { frequency: 0.7, amplitude: 10.0, deadband: 0.9, release: 1.0 };
            for noise in [0.0, 0.3 * step] {
                let position = sampled(1000.0, 12.0, Quantity::Displacement, noise, |t| decay.state(t).0);
                let velocity = sampled(1000.0, 12.0, Quantity::Velocity, noise, |t| decay.state(t).1);
                for record in [position, velocity] {
                    assert_eq!(saturation(quantised(&record, step).values()), None, "step {step}, noise {noise}");
                }
            }
        }
    }
}
