//! A sudden change of the offset while the record oscillates.

use crate::examination::Examination;
use crate::examination::swings::Swings;
use crate::numerics::median;

/// A jump of the centre of an oscillation.
///
/// The centre of each four peaks in a row (weights 1, 3, 3, 1) is independent of amplitudes that change at a
/// steady rate. The median of four centres before is compared with that of four after. A jump counts if
/// it exceeds 5 % of the amplitude there, eight times the usual change from centre to centre, four times the
/// usual change over the same distance (which is what a drift makes), and noise and resolution. At least
/// fourteen peaks are needed. Rest does not take part: a displacement that comes to rest off its centre is no
/// step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct OffsetStep {
    /// Time of the step (s): to the sample if the jump stands out of the noise, otherwise within about a swing.
    pub time: f64,
    /// Shift of the centre, in the unit of the record.
    pub height: f64,
}

impl Examination<'_> {
    /// The largest jump of the offset during the oscillation, if it is significant.
    pub fn offset_step(&self) -> Option<OffsetStep> {
        const SIDE: usize = 4;
        /// A large jump makes half cycles of its own, or swallows one.
        const IRREGULAR: usize = 3;
        /// Centres that have peaks of both sides in them.
        const MIXED: usize = 3;
        let swings = Swings::bridging(self, IRREGULAR);
        let peaks = swings.peaks();
        let centres: Vec<f64> =
            peaks.windows(4).map(|p| (p[0].value + 3.0 * (p[1].value + p[2].value) + p[3].value) / 8.0).collect();
        let jumps: Vec<f64> = centres
            .windows(2 * SIDE + MIXED)
            .map(|window| centre(&window[SIDE + MIXED..]) - centre(&window[..SIDE]))
            .collect();
        let (at, height) = jumps.iter().copied().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        // The last clean centre before ends with this peak, but medians still see the same jump some peaks away.
        let before = at + SIDE + MIXED - 1;
        let (from, to) = (before - 3, before + 4);
        let around = peaks.get(from..=to)?;
        let record = self.record();
        let values = record.values();
        let width = (around[7].index - around[0].index) / (7 * 16);
        let index = sharpest(values, around[0].index, around[7].index, width.max(1), height.signum());

        let amplitude = (around[0].value - around[1].value).abs() / 2.0;
        let usual_change = median(&mut centres.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect::<Vec<_>>());
        let usual_jump = median(&mut jumps.iter().map(|jump| jump.abs()).collect::<Vec<_>>());
        let resolution = self.noise().max(self.step());
        let limit = (0.05 * amplitude).max(8.0 * usual_change).max(4.0 * usual_jump).max(2.0 * resolution);
        if height.abs() <= limit {
            return None;
        }

        // Once its place is known, the height follows from centres that have no part in it; one is left out
        // for a turning point that the jump made.
        let end = peaks.windows(4).rposition(|p| (p[3].index as f64) < index)?;
        let begin = peaks.windows(4).position(|p| p[0].index as f64 > index)? + 1;
        let before = centres.get(end.saturating_sub(SIDE)..end).filter(|clean| clean.len() == SIDE);
        let after = centres.get(begin..begin + SIDE);
        let height = before.zip(after).map_or(height, |(before, after)| centre(after) - centre(before));
        Some(OffsetStep { time: record.time_at(index), height })
    }
}

/// Median of neighbouring centres, the mean of two for an even number of them.
fn centre(centres: &[f64]) -> f64 {
    let mut sorted = centres.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let n = sorted.len();
    if n == 0 { 0.0 } else { 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]) }
}

/// Place between samples `first` and `last` at which the means of `width` samples before and after differ most,
/// towards `side`, compared with one width earlier and later.
fn sharpest(values: &[f64], first: usize, last: usize, width: usize, side: f64) -> f64 {
    let begin = first.max(2 * width);
    let end = last.min(values.len().saturating_sub(2 * width));
    if begin >= end {
        return (first + last) as f64 / 2.0;
    }
    // Sums from the first sample looked at, about its value: differences of two of them are the sums wanted.
    let origin = begin - 2 * width;
    let mut sums = vec![0.0];
    sums.extend(values[origin..end + 2 * width].iter().scan(0.0, |sum, value| {
        *sum += value - values[origin];
        Some(*sum)
    }));
    let sum = |from: usize| sums[from + width - origin] - sums[from - origin];
    (begin..end)
        .map(|i| {
            let [a, b, c, d] = [sum(i - 2 * width), sum(i - width), sum(i), sum(i + width)];
            (i, side * ((c - b) - f64::midpoint(b - a, d - c)))
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(begin as f64, |(i, _)| i as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::synthetic::{CoulombDecay, pendulum, pendulum_velocity, sampled, wheel};
    use crate::units::Quantity;

    #[test]
    fn sound_records_have_none() {
        #[cfg(feature = "mat")]
        assert_eq!(Examination::of(crate::tests::synthetic::fork()).offset_step(), None);
        for record in [wheel(), pendulum(), pendulum_velocity()] {
            assert_eq!(Examination::of(&record).offset_step(), None);
        }
    }

    #[test]
    fn decay_that_stops_off_centre_and_drift_are_no_steps() {
        for deadband in [0.11, 0.23, 0.37] {
            let decay = CoulombDecay { frequency: 2.2, amplitude: 10.0, deadband, release: 0.3 };
            for noise in [0.0, 0.05] {
                let position = sampled(1000.0, 20.0, Quantity::Displacement, noise, |t| decay.state(t).0);
                assert_eq!(Examination::of(&position).offset_step(), None, "deadband {deadband}, noise {noise}");
                let drifting =
                    sampled(1000.0, 20.0, Quantity::Velocity, noise, |t| 5.0 + 0.2 * t + decay.state(t).1 / 13.8);
                assert_eq!(Examination::of(&drifting).offset_step(), None, "deadband {deadband}, noise {noise}");
            }
        }
    }

    #[test]
    fn a_step_is_found_with_its_height_and_time() {
        let decay = CoulombDecay { frequency: 2.2, amplitude: 10.0, deadband: 0.1, release: 0.3 };
        for noise in [0.0, 0.02] {
            for (height, time) in [(1.0, 3.3215), (-0.6, 5.1005), (3.0, 4.0005)] {
                let jump = |t: f64| if t > time { height } else { 0.0 };
                let record = sampled(1000.0, 12.0, Quantity::Velocity, noise, |t| decay.state(t).1 / 13.8 + jump(t));
                let found = Examination::of(&record)
                    .offset_step()
                    .unwrap_or_else(|| panic!("{height} at {time} s, noise {noise}"));
                assert!((found.height - height).abs() < 0.1 * height.abs(), "{} against {height}", found.height);
                assert!((found.time - time).abs() < 0.01, "{} s against {time} s", found.time);
            }
        }
    }
}
