//! The turning points of an oscillation, to the sample.

use crate::calculus::{EndRule, averaged};
use crate::numerics::{median, range};

/// Least height of a swing from turning point to turning point, in standard deviations of the noise. The extremes of
/// noise alone lie within ±5 in ten million samples.
const ABOVE_NOISE: f64 = 10.0;
/// Least height of a swing, in steps of the converter.
const ABOVE_STEP: f64 = 2.0;
/// Largest height that rounding alone makes, relative to the range of the values.
const ABOVE_ROUNDING: f64 = 1e-9;
/// Neighbouring half cycles of one oscillation differ in length by no more than this factor.
const REGULARITY: f64 = 2.0;
/// Largest ripple on a swing, relative to the swings around it.
const RIPPLE: f64 = 0.2;

/// The alternating turning points of the longest regular oscillation in `values`, by index.
///
/// First the length of a half cycle is found, from the largest swings: with a threshold that sinks from a quarter
/// of the range until six regular turning points appear, and with more smoothing if none do. Then all swings
/// are found, after smoothing over an eighth of that length, with the threshold that noise, resolution and the
/// range of the values near by allow.
/// Up to `bridged` irregular half cycles in a row are taken along if regular ones go on behind them.
pub(crate) fn turning_points(values: &[f64], noise: f64, step: f64, bridged: usize) -> Vec<usize> {
    let (low, high) = range(values);
    let floor = |half: usize| {
        let averaged = (2 * half + 1) as f64;
        (ABOVE_NOISE * noise / averaged.sqrt()).max(ABOVE_STEP * step).max(ABOVE_ROUNDING * (high - low))
    };
    let Some(length) = half_cycle(values, high - low, floor) else { return Vec::new() };
    let half = length / 16;
    let smooth = averaged(values, half, EndRule::Shrinking);
    let local = local_ranges(&smooth, length);
    let floor = floor(half);
    let found = reversals(&smooth, |i| floor.max(RIPPLE * local[i / length]));
    longest_regular(&smooth, &found, bridged)
}

/// Length of a half cycle (samples) of the largest regular oscillation; `None` if nothing oscillates.
///
/// Two turning points show no regularity. They are taken all the same if nothing regular is found and the swing between
/// them spans most of the range: a motion that dry friction stops after two half cycles.
fn half_cycle(values: &[f64], range: f64, floor: impl Fn(usize) -> f64) -> Option<usize> {
    const ENOUGH: usize = 6;
    const FEWEST: usize = 3;
    const NEXT: f64 = 0.4;
    const MOST: f64 = 0.8;
    let mut half = 0;
    let mut single = None;
    loop {
        let smooth = averaged(values, half, EndRule::Shrinking);
        let mut best: Vec<usize> = Vec::new();
        let mut threshold = 0.25 * range;
        while threshold > floor(half) && best.len() < ENOUGH {
            let regular = longest_regular(&smooth, &reversals(&smooth, |_| threshold), 0);
            if regular.len() > best.len() {
                best = regular;
            }
            threshold *= NEXT;
        }
        if best.len() >= FEWEST {
            let mut lengths: Vec<f64> = best.windows(2).map(|pair| (pair[1] - pair[0]) as f64).collect();
            return Some((median(&mut lengths) as usize).max(1));
        }
        if single.is_none() && floor(half) < 0.25 * range {
            let large = |pair: &&[usize]| (smooth[pair[1]] - smooth[pair[0]]).abs() > MOST * range;
            let found = reversals(&smooth, |_| 0.25 * range);
            single = found.windows(2).find(large).map(|pair| pair[1] - pair[0]);
        }
        // Without noise there is nothing to be gained from smoothing.
        half = 5 * half + 2;
        if 16 * half > values.len() || floor(0) <= floor(half) {
            return single;
        }
    }
}

/// The range of `values` in each block of `length` samples together with the blocks before and after.
fn local_ranges(values: &[f64], length: usize) -> Vec<f64> {
    let blocks: Vec<(f64, f64)> = values.chunks(length).map(range).collect();
    (0..blocks.len())
        .map(|i| {
            let near = &blocks[i.saturating_sub(1)..blocks.len().min(i + 2)];
            let (low, high) = near.iter().fold(blocks[i], |(low, high), block| (low.min(block.0), high.max(block.1)));
            high - low
        })
        .collect()
}

/// Indices at which `values` turn and then move back by more than the `threshold` at that place: maxima and minima
/// by turns. The first may be the start of the record.
fn reversals(values: &[f64], threshold: impl Fn(usize) -> f64) -> Vec<usize> {
    let mut found = Vec::new();
    let (mut low, mut high) = (0, 0);
    // Until the first reversal both directions are open.
    let mut rising: Option<bool> = None;
    for (i, &value) in values.iter().enumerate() {
        if value < values[low] {
            low = i;
        }
        if value > values[high] {
            high = i;
        }
        if rising != Some(true) && value - values[low] > threshold(i) {
            found.push(low);
            (rising, high) = (Some(true), i);
        } else if rising != Some(false) && values[high] - value > threshold(i) {
            found.push(high);
            (rising, low) = (Some(false), i);
        }
    }
    found
}

/// The run of turning points with regular distances that covers the greatest sum of swings. Up to `bridged`
/// irregular distances in a row do not end it if one behind them is as long as the last one before.
fn longest_regular(values: &[f64], found: &[usize], bridged: usize) -> Vec<usize> {
    let lengths: Vec<f64> = found.windows(2).map(|pair| (pair[1] - pair[0]) as f64).collect();
    let alike = |a: f64, b: f64| a <= REGULARITY * b && b <= REGULARITY * a;
    let mut best = (0.0, 0..0);
    let mut i = 0;
    while i < lengths.len() {
        let start = i;
        let mut last = lengths[start];
        let mut travelled = 0.0;
        while let Some(next) = (i..lengths.len().min(i + bridged + 1)).find(|next| alike(lengths[*next], last)) {
            travelled += (i..=next).map(|k| (values[found[k + 1]] - values[found[k]]).abs()).sum::<f64>();
            last = lengths[next];
            i = next + 1;
        }
        if travelled > best.0 {
            best = (travelled, start..i + 1);
        }
    }
    found[best.1].to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reversals_alternate_and_need_their_threshold() {
        let values = [0.0, 5.0, 4.5, 6.0, 1.0, 1.4, 0.5, 7.0];
        assert_eq!(reversals(&values, |_| 1.0), [0, 3, 6]);
        assert!(reversals(&values, |_| 10.0).is_empty());
        assert!(reversals(&[], |_| 1.0).is_empty());
    }

    #[test]
    fn local_ranges_look_one_block_ahead_and_back() {
        assert_eq!(local_ranges(&[0.0, 1.0, 5.0, 6.0, 6.0, 6.0, 9.0], 2), [6.0, 6.0, 4.0, 3.0]);
    }

    #[test]
    fn irregular_neighbours_are_not_part_of_the_oscillation() {
        let mut values = vec![0.0; 200];
        for (i, value) in [(3, 1.0), (90, 5.0), (100, -5.0), (110, 4.0), (121, -4.0), (199, 1.0)] {
            values[i] = value;
        }
        assert_eq!(longest_regular(&values, &[3, 90, 100, 110, 121, 199], 0), [90, 100, 110, 121]);
        let interrupted = [90, 100, 110, 112, 121, 131, 199];
        assert_eq!(longest_regular(&values, &interrupted, 0), [90, 100, 110]);
        assert_eq!(longest_regular(&values, &interrupted, 1), [90, 100, 110, 112, 121, 131]);
    }
}
