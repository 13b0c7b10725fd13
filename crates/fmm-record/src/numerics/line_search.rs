//! Frequencies at which a spectrum has a line that is neither noise nor one of the harmonics of a motion.

use std::f64::consts::LN_2;
use std::ops::Range;

use crate::numerics::median;
use crate::numerics::spectrum::{LOBE, Spectrum};

/// A line as a part of a record shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Candidate {
    /// Frequency, in cycles per sample.
    pub(crate) frequency: f64,
    /// Amplitude, in the unit of the values.
    pub(crate) amplitude: f64,
}

/// Probability that noise alone makes a candidate in one part of a record (1).
const FALSE_RATE: f64 = 1e-3;
/// Fewest samples of a part.
const SHORTEST: usize = 64;
/// Lowest frequency, in cycles per part: drift and the end of a motion stay below.
const LOWEST: f64 = 8.0;
/// Least square of a line, as a multiple of the squares of all harmonics nearby.
const ABOVE_HARMONICS: f64 = 4.0;
/// Harmonics of dry friction are odd, two fundamental frequencies apart.
const NEARBY: f64 = 2.6;
/// The background is taken from this many widths of a lobe to either side.
const SIDE: usize = 20;

/// The lines in samples `part` of `values`, the largest first. `fundamental` (cycles per sample) is the frequency of
/// the motion; what lies near the `known` frequencies is left out.
///
/// A line is a maximum P of the squared amplitudes that exceeds their mean b nearby, which follows from the median
/// of m values at distances of 1.5 to 11 lobes. Noise has such a maximum at one of n frequencies with the probability
///
/// ```text
/// n (1 + x/ν)^(−ν),        x = P/b,        ν = m ln²2
/// ```
///
/// (an exponential variable over the mean of ν others; the variance of the median is that of the mean over ln²2), and
/// x is such that this is one in a thousand. Harmonics of a motion fall as their order rises. A line must therefore
/// exceed all that lies within 2.6 fundamental frequencies as well, by a factor of two.
pub(crate) fn lines(values: &[f64], part: Range<usize>, fundamental: f64, known: &[f64]) -> Vec<Candidate> {
    let values = &values[part];
    if values.len() < SHORTEST {
        return Vec::new();
    }
    let duration = values.len() as f64;
    let spectrum = Spectrum::of(values);
    let index = |cycles: f64| (cycles / spectrum.spacing).round().max(0.0) as usize;
    let squares = &spectrum.squares;
    let (lowest, highest) = (index(LOWEST), squares.len().saturating_sub(1 + index(LOBE)));
    let lobe = index(LOBE);
    let is_known = |k: usize| {
        let cycles = k as f64 * spectrum.spacing;
        known.iter().any(|frequency| (frequency * duration - cycles).abs() < 1.2 * LOBE)
    };
    let is_maximum = |k: usize| {
        let around = &squares[k.saturating_sub(lobe)..(k + lobe + 1).min(squares.len())];
        around.iter().all(|square| *square <= squares[k])
    };
    let mut found: Vec<Candidate> = (lowest..highest)
        .filter(|k| squares[*k] > 0.0 && !is_known(*k) && is_maximum(*k))
        .filter(|k| {
            let sides = (0..SIDE).flat_map(|i| {
                let distance = index(1.5 * LOBE + i as f64 * 0.5 * LOBE);
                [k.checked_sub(distance).filter(|k| *k >= lobe), Some(k + distance).filter(|k| *k < squares.len())]
            });
            let mut sides: Vec<f64> = sides.flatten().filter(|k| !is_known(*k)).map(|k| squares[k]).collect();
            let freedom = sides.len() as f64 * LN_2 * LN_2;
            let frequencies = squares.len() as f64 * spectrum.spacing;
            let limit = freedom * ((frequencies / FALSE_RATE).powf(1.0 / freedom) - 1.0);
            sides.len() >= SIDE && squares[*k] > limit * median(&mut sides) / LN_2
        })
        .filter(|k| {
            let reach = index((NEARBY * fundamental * duration).max(3.0 * LOBE));
            let near = k.saturating_sub(reach).max(lobe)..(k + reach + 1).min(squares.len());
            let own = index(1.2 * LOBE);
            near.filter(|other| other.abs_diff(*k) > own && !is_known(*other))
                .all(|other| ABOVE_HARMONICS * squares[other] < squares[*k])
        })
        .map(|k| Candidate { frequency: spectrum.refined(k) / duration, amplitude: squares[k].sqrt() })
        .collect();
    found.sort_unstable_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    found
}

/// The frequency that changes most from the start of a record to its end (cycles per sample): that of its motion.
///
/// Two windows that mirror each other weigh the start and the end; a steady line has the same square in both. The
/// squares are weighted by the frequency, so that drift does not count as motion.
pub(crate) fn fundamental(values: &[f64]) -> f64 {
    let duration = values.len() as f64;
    let falling: Vec<f64> =
        (0..values.len()).map(|i| (0.5 * std::f64::consts::PI * (i as f64 + 0.5) / duration).cos().powi(2)).collect();
    let rising: Vec<f64> = falling.iter().rev().copied().collect();
    let (early, late) = (Spectrum::under(&falling, values), Spectrum::under(&rising, values));
    let change = |k: &usize| (early.squares[*k] - late.squares[*k]).abs() * *k as f64;
    let most = (0..early.squares.len()).max_by(|a, b| change(a).total_cmp(&change(b)));
    most.unwrap_or(0) as f64 * early.spacing / duration
}
