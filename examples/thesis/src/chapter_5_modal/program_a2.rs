//! Program A2: the logarithmic decrement as the thesis' appendix codes it.

use fmm_record::{EndRule, Record, Smoothing};

use crate::Found;

/// One cycle of the decrement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cycle {
    /// V, the peak with which the cycle begins (m/s).
    pub(super) peak_velocity: f64,
    /// c = 2ζ √(k m) (N s/m).
    pub(super) damping: f64,
}

/// Stiffness (N/m) and mass (kg) in A2; they are not those of the thesis' Table 2.
const STIFFNESS: f64 = 1982.17;
const MASS: f64 = 10.415;
/// Samples of the moving mean.
const SPAN: usize = 15;
/// Maxima that are dropped.
const DROPPED: usize = 2;
/// Samples between two maxima, at least.
const GAP: usize = 400;

/// The cycles of a velocity record without offset (m/s).
///
/// ```text
/// δ = ln(p_{i−1}/p_i),   ζ = δ/√(4π² + δ²),   c = 2ζ √(k m)                         (thesis A2)
/// ```
///
/// The record is cut at its largest sample and smoothed by a moving mean (`movmean`). Of its local maxima the first are
/// dropped, then those that are not positive, then those that follow the one before too soon. Of a noisy cluster this
/// keeps the first maximum and not the highest, and nothing is interpolated: below 0.03 mm/s of noise the result is
/// good, at 0.5 mm/s many a damping is negative. No uncertainty is stated, as the code has none.
pub(super) fn cycles(record: &Record) -> Found<Vec<Cycle>> {
    let values = record.values();
    // MATLAB's `find(v == max(v))` gives the first of equal maxima.
    let first = values.iter().enumerate().fold(0, |best, (i, value)| if *value > values[best] { i } else { best });
    let smooth = Smoothing::MovingAverage { span: SPAN, ends: EndRule::Truncated }.apply(&values[first..])?;
    let maxima = local_maxima(&smooth).into_iter().skip(DROPPED).filter(|index| smooth[*index] > 0.0);
    let mut previous: Option<usize> = None;
    let peaks: Vec<f64> = maxima
        // The gap is to the maximum before, kept or not; the first has none before it and is left out.
        .filter(|index| previous.replace(*index).is_some_and(|before| index - before > GAP))
        .map(|index| smooth[index])
        .collect();
    let cycle = |pair: &[f64]| {
        let decrement = (pair[0] / pair[1]).ln();
        let ratio = decrement / (2.0 * std::f64::consts::PI).hypot(decrement);
        Cycle { peak_velocity: pair[0], damping: 2.0 * ratio * (STIFFNESS * MASS).sqrt() }
    };
    Ok(peaks.windows(2).map(cycle).collect())
}

/// Indices of the local maxima as MATLAB's `findpeaks` gives them: larger than both neighbours, the first sample of a
/// plateau, no end.
fn local_maxima(values: &[f64]) -> Vec<usize> {
    let mut maxima = Vec::new();
    let mut rise = None;
    for (i, pair) in values.windows(2).enumerate() {
        if pair[1] > pair[0] {
            rise = Some(i + 1);
        } else if pair[1] < pair[0] {
            maxima.extend(rise.take());
        }
    }
    maxima
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chapter_5_modal::simulated::{machine, motion, record};
    use crate::printed::INSTANTANEOUS_SLOPE;

    #[test]
    fn plateaus_count_once_and_ends_never() {
        assert_eq!(local_maxima(&[3.0, 1.0, 2.0, 2.0, 1.0, 4.0, 0.0, 5.0]), [2, 5]);
        assert_eq!(local_maxima(&[0.0, 1.0, 1.0, 2.0, 1.0]), [3]);
        assert_eq!(local_maxima(&[]), Vec::<usize>::new());
    }

    /// 80 s from 10 mm: the scatter about c(V) = 0.2005 + 8/(3π) c₂ V that an independent recomputation found at three
    /// noises, within 40 %.
    #[test]
    fn damping_scatters_with_the_noise() {
        let motion = motion(machine(INSTANTANEOUS_SLOPE).unwrap(), (0.01, 0.0), 80.0).unwrap();
        let slope = 8.0 / (3.0 * std::f64::consts::PI) * INSTANTANEOUS_SLOPE;
        for (noise, expected) in [(1e-5, 2e-3), (1e-4, 0.022), (5e-4, 0.15)] {
            let cycles = cycles(&record(motion.velocity().values(), noise, 1).unwrap()).unwrap();
            // Of 175 cycles it leaves out the first few.
            assert!((165..=174).contains(&cycles.len()), "{} cycles at {noise} m/s", cycles.len());
            let squares: f64 =
                cycles.iter().map(|cycle| (cycle.damping - 0.2005 - slope * cycle.peak_velocity).powi(2)).sum();
            let scatter = (squares / cycles.len() as f64).sqrt();
            assert!((scatter / expected - 1.0).abs() <= 0.4, "{scatter} N s/m at {noise} m/s");
        }
    }
}
