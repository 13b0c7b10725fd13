//! Noise and resolution of values.

use crate::numerics::median;

/// Standard deviation of the white noise in `values`, whatever the motion below it; 0 for fewer than five samples.
///
/// Differences of order p suppress a motion that is well sampled and keep white noise of standard deviation σ:
///
/// ```text
/// Δᵖx_i = Σ_k (−1)ᵏ C(p,k) x_{i+k},        var Δᵖx = C(2p,p) σ²
/// ```
///
/// The mean square of third differences is taken in blocks of up to 128, and the median over the blocks, so that
/// spikes, steps and a short violent beginning do not count. A motion with few samples per period leaks into third
/// differences; the order is therefore raised, up to ten, as long as that halves the result, which it does not
/// for noise. Six samples per period or more leave no more than noise.
///
/// The noise must be white: low-pass filtered noise is estimated too low. Where most of the record is at rest and
/// constant to the last bit of a converter, the result is 0; [`quantisation_step`](crate::quantisation_step)
/// tells the resolution then.
///
/// ```
/// use fmm_record::noise;
///
/// // A smooth motion of amplitude 1 with samples alternately 0.001 too high and too low.
/// let values: Vec<f64> =
///     (0..2000).map(|i| (f64::from(i) * 0.01).sin() + if i % 2 == 0 { 1e-3 } else { -1e-3 }).collect();
/// // All of it lies at the highest frequency, where third differences weigh it with 64/20 in power.
/// assert!((noise(&values) - 1e-3 * 3.2f64.sqrt()).abs() < 2e-5);
/// ```
pub fn noise(values: &[f64]) -> f64 {
    const FIRST: usize = 3;
    const LAST: usize = 10;
    /// White noise gives the same at every order; motion that falls by less per order would need too many orders.
    const WORTHWHILE: f64 = 0.5;
    let mut estimate = noise_by_differences(values, FIRST);
    for order in FIRST + 1..=LAST {
        if values.len() < 4 * order {
            break;
        }
        let next = noise_by_differences(values, order);
        let worthwhile = next < WORTHWHILE * estimate;
        estimate = estimate.min(next);
        if !worthwhile {
            break;
        }
    }
    estimate
}

/// The estimate from differences of one order.
fn noise_by_differences(values: &[f64], order: usize) -> f64 {
    const BLOCK: usize = 128;
    const FEWEST_BLOCKS: usize = 3;
    let Some(count) = values.len().checked_sub(order).filter(|count| *count >= 2) else { return 0.0 };
    let coefficients: Vec<f64> =
        (0..=order).map(|k| if k % 2 == 0 { binomial(order, k) } else { -binomial(order, k) }).collect();
    let block = match count {
        0..48 => count,
        48..384 => count / FEWEST_BLOCKS,
        _ => BLOCK,
    };
    let gain = binomial(2 * order, order);
    let mut squares: Vec<f64> = (0..count / block)
        .map(|k| {
            let samples = &values[k * block..(k + 1) * block + order];
            let sum: f64 = samples
                .windows(order + 1)
                .map(|window| {
                    let difference: f64 = window.iter().zip(&coefficients).map(|(x, c)| x * c).sum();
                    difference * difference
                })
                .sum();
            sum / (block as f64 * gain)
        })
        .collect();
    if squares.len() < FEWEST_BLOCKS {
        return (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    }
    // Neighbouring differences are correlated, which leaves fewer degrees of freedom than differences; the median of
    // a chi-square variable lies below its mean by the Wilson-Hilferty factor.
    let freedom = block as f64 * gain * gain / binomial(4 * order, 2 * order);
    let factor = (1.0 - 2.0 / (9.0 * freedom)).powi(3);
    (median(&mut squares) / factor).sqrt()
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

/// Relative difference of equal values that single precision has rounded somewhere on their way (1).
pub(crate) const SINGLE_ROUNDING: f64 = f32::EPSILON as f64;

/// The step of the lattice on which all of `values` lie, in their unit; `None` if they lie on none.
///
/// The step is the smallest difference between values that occur, or a whole fraction of it down to an eighth,
/// such that all differences are multiples of it within 5 % (so that a lattice printed with few digits is still
/// one). Values that differ by the rounding of single precision, 1.2e-7 of the largest, count as one. Evidence is
/// needed: at least eight different values, or every value occurring twice on average. A constant record has none.
///
/// Of more than 131 072 samples, as many are looked at, evenly spread.
///
/// ```
/// use fmm_record::quantisation_step;
///
/// // A converter of 12 bits over ±10 V.
/// let lsb = 20.0 / 4096.0;
/// let volts: Vec<f64> = (0..1000).map(|i| 0.3 + ((f64::from(i) * 0.01).sin() / lsb).round() * lsb).collect();
/// assert!((quantisation_step(&volts).unwrap() - lsb).abs() < 1e-12);
///
/// let smooth: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.01).sin()).collect();
/// assert_eq!(quantisation_step(&smooth), None);
/// ```
pub fn quantisation_step(values: &[f64]) -> Option<f64> {
    const MOST: usize = 1 << 17;
    const ENOUGH: usize = 8;
    const FRACTIONS: usize = 8;
    let mut sorted: Vec<f64> = values.iter().step_by(values.len().div_ceil(MOST).max(1)).copied().collect();
    let samples = sorted.len();
    sorted.sort_unstable_by(f64::total_cmp);
    let largest = sorted.first()?.abs().max(sorted.last()?.abs());
    // Values that differ by rounding only are the same: in double precision, or in single somewhere on their way.
    [16.0 * f64::EPSILON, SINGLE_ROUNDING].into_iter().find_map(|precision| {
        let rounding = precision * largest;
        sorted.dedup_by(|next, kept| *next - *kept <= rounding);
        if sorted.len() < 2 || (sorted.len() < ENOUGH && 2 * sorted.len() > samples) {
            return None;
        }
        let smallest = sorted.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        (1..=FRACTIONS).find_map(|fraction| lattice(&sorted, smallest / fraction as f64, rounding))
    })
}

/// The step of the lattice through `sorted` that is near `step`, refined on the way as the distances grow; `None` if
/// a value misses the lattice.
fn lattice(sorted: &[f64], step: f64, rounding: f64) -> Option<f64> {
    const TOLERANCE: f64 = 0.05;
    let first = *sorted.first()?;
    let (mut step, mut index) = (step, 0.0);
    for pair in sorted.windows(2) {
        let difference = pair[1] - pair[0];
        let steps = (difference / step).round();
        if (difference - steps * step).abs() > TOLERANCE * step + rounding || step <= 4.0 * rounding {
            return None;
        }
        index += steps;
        step = (pair[1] - first) / index;
    }
    Some(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::synthetic::{Noise, pendulum};

    #[test]
    fn white_noise_is_found_below_motion_spikes_and_quantisation() {
        for (rate, sigma) in [(1000.0, 1e-3), (60.0, 1e-3), (1000.0, 0.1), (1000.0, 1e-9)] {
            let mut random = Noise::new(1);
            let mut values: Vec<f64> =
                (0..20_000).map(|i| 5.0 + (6.0 * f64::from(i) / rate).sin() + sigma * random.normal()).collect();
            for i in (0..20_000).step_by(4000) {
                values[i] += 100.0 * sigma;
            }
            // The median of 156 blocks of 55 degrees of freedom is good to about 1.3/√(2·156·55), 1 %.
            let ratio = noise(&values) / sigma;
            assert!((ratio - 1.0).abs() < 0.04, "{rate} Hz, {sigma}: ratio {ratio}");
        }
    }

    #[test]
    fn coarsely_sampled_motion_is_not_noise() {
        for per_period in [8.0, 12.0, 40.0, 1000.0] {
            let values: Vec<f64> =
                (0..4000).map(|i| (std::f64::consts::TAU * f64::from(i) / per_period).sin()).collect();
            assert!(noise(&values) < 2e-4, "{per_period} samples per period: {}", noise(&values));
        }
    }

    #[cfg(feature = "mat")]
    #[test]
    fn fork_has_the_noise_that_others_found() {
        // 3.5 mV is the scatter of its samples about a smooth curve, which contains slow errors as well.
        let volts = noise(crate::tests::synthetic::fork().values());
        assert!((2.5e-3..3.7e-3).contains(&volts), "{volts} V");
    }

    #[test]
    fn pendulum_is_nearly_free_of_noise() {
        let radians = noise(pendulum().values());
        assert!(radians < 1e-4, "{radians} rad");
    }

    #[test]
    fn few_or_constant_samples_have_none() {
        assert_eq!(noise(&[]), 0.0);
        assert_eq!(noise(&[1.0, 2.0, 4.0, 8.0]), 0.0);
        assert_eq!(noise(&[3.0; 1000]), 0.0);
    }

    #[cfg(feature = "mat")]
    #[test]
    fn fork_has_the_step_of_its_converter() {
        let step = quantisation_step(crate::tests::synthetic::fork().values()).unwrap();
        assert!((step - 5.083_2e-3).abs() < 1e-7, "{step} V");
    }

    #[test]
    fn lattice_is_found_from_multiples_and_from_rounded_print() {
        // Only even and threefold multiples of 0.1 occur next to each other.
        let sparse: Vec<f64> = (0..40).flat_map(|i| [0.5 * f64::from(i), 0.5 * f64::from(i) + 0.2]).collect();
        assert!((quantisation_step(&sparse).unwrap() - 0.1).abs() < 1e-12);
        let printed: Vec<f64> = (0..500).map(|i| (f64::from(i % 200) * 5.0832e-3 * 1e4).round() / 1e4).collect();
        let step = quantisation_step(&printed).unwrap();
        assert!((step - 5.0832e-3).abs() < 1e-6, "{step}");
    }

    #[test]
    fn lattice_is_found_behind_a_gain_in_single_precision() {
        // 16 bits over ±1, whose gain was applied with errors of single precision that are not alike for equal counts.
        let step = 2f64.powi(-15);
        let count = |i: u32| (30_000.0 * (f64::from(i) * 0.01).sin()).round();
        let error = |i: u32| 4e-8 * (0.618_033_988_75 * f64::from(i)).fract();
        let rounded = |i: u32| step * count(i) * (1.0 + error(i));
        let found = quantisation_step(&(0..5000).map(rounded).collect::<Vec<_>>()).unwrap();
        assert!((found / step - 1.0).abs() < 1e-6, "{found}");
    }

    #[test]
    fn arbitrary_numbers_lie_on_no_lattice() {
        for count in [0, 1, 2, 3, 7, 8, 20, 1000, 200_000] {
            let mut random = Noise::new(count as u64);
            let values: Vec<f64> = (0..count).map(|_| random.normal()).collect();
            assert_eq!(quantisation_step(&values), None, "{count} values");
        }
        assert_eq!(quantisation_step(&[1.0; 100]), None);
    }

    #[test]
    fn two_levels_at_rest_are_a_lattice() {
        let values: Vec<f64> = (0..100).map(|i| if i % 3 == 0 { 1.25 } else { 1.5 }).collect();
        assert_eq!(quantisation_step(&values), Some(0.25));
    }
}
