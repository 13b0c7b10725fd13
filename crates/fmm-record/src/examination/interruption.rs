//! Interruption of a ring-down: a hand, a touch or a stop takes more than the machine's own friction.

use crate::examination::Examination;
use crate::numerics::{median, range};

/// Point of a ring-down at which something other than the machine's own friction and damping takes its motion.
///
/// The half cycles of a free decay lose about as much as those before them: friction takes the same from each,
/// damping less and less, and friction that rises as the speed falls some more. One that loses four times the
/// median loss of the eight before it, 8 % of its height at least, while the machine would have gone on for six
/// half cycles more, has been taken hold of. So has a motion that ends at once, in a record that goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Interruption {
    /// The last turning point before it (s): up to here the decay is free.
    pub sound_until: f64,
    /// Loss of the next half cycle over that of the half cycles before it (1).
    pub ratio: f64,
}

// Limits "by judgement" have no derivation: they were set on measured and simulated records, and the tests pin them.

/// Half cycles that show the usual loss: fewest and most, by judgement.
const KNOWN: (usize, usize) = (4, 8);
/// Least loss over the usual one (1), by judgement: friction that rises towards rest takes some more.
const FACTOR: f64 = 4.0;
/// Least excess over the usual loss, in its standard deviations (1), by judgement.
const DEVIATIONS: f64 = 6.0;
/// Least excess over the usual loss, in standard deviations of the noise (1): a loss p₀ − 2p₁ + p₂ of three peaks
/// has at most √6 of them, so that noise alone stays within 3.3 of its own.
const NOISES: f64 = 8.0;
/// Least loss over the height (1), by judgement.
const SHARE: f64 = 0.08;
/// Least share of the loss that the half cycle after it does not bring back (1), by judgement: a step of the offset
/// does.
const LASTING: f64 = 0.8;
/// Largest share of the loss that comes back later (1), by judgement: a beat brings back all.
const RETURNED: f64 = 0.5;
/// Half cycles that the usual loss would leave, by judgement: with fewer, friction that rises towards rest may do this.
const LEFT: f64 = 6.0;
/// Standard deviation over the median of the deviations of normal values (1).
const DEVIATION: f64 = 1.4826;

impl Examination<'_> {
    /// Interruption of a ring-down; `None` if it is free to its end.
    pub fn interruption(&self) -> Option<Interruption> {
        let (record, peaks) = (self.record(), self.swings().peaks());
        let mut heights = self.swings().heights();
        // What is left of the motion after its last turning point, if the record goes on for a period.
        let (first, last) = (peaks.first()?, peaks.last()?);
        let half_cycle = (last.index - first.index) as f64 / (peaks.len() - 1).max(1) as f64;
        let (from, to) = (last.index + half_cycle as usize, last.index + (3.0 * half_cycle) as usize);
        if to < record.len() && half_cycle > 0.0 {
            let (low, high) = range(&record.values()[from..to]);
            heights.push(high - low);
        }
        let begin = (0..heights.len()).max_by(|a, b| heights[*a].total_cmp(&heights[*b]))?;
        let noise = self.noise();
        let losses: Vec<f64> = heights[begin..].windows(2).map(|pair| pair[0] - pair[1]).collect();
        (KNOWN.0..losses.len()).find_map(|k| {
            let known = &losses[k.saturating_sub(KNOWN.1)..k];
            let usual = median(&mut known.to_vec());
            let deviation =
                DEVIATION * median(&mut known.iter().map(|loss| (loss - usual).abs()).collect::<Vec<f64>>());
            let usual = usual.max(0.0);
            let (height, loss) = (heights[begin + k], losses[k]);
            let is_large = height > LEFT * (usual + deviation + noise);
            let is_lost = loss > FACTOR * usual
                && loss > usual + DEVIATIONS * deviation + NOISES * noise
                && loss > SHARE * height;
            // An offset that steps makes one half cycle smaller or larger, and the next as large as it would have been.
            let is_lasting = heights.get(begin + k + 2).is_none_or(|later| height - later > LASTING * loss)
                && losses[k - 1] > -(DEVIATIONS * deviation + NOISES * noise);
            // The beat of a second mode comes back, and what a hand took does not.
            let is_gone = || {
                let after = peaks[begin + k + 1].index + (2.0 * half_cycle) as usize;
                let (low, high) = range(record.values().get(after..).unwrap_or(&[]));
                !(high - low > height - RETURNED * loss)
            };
            (is_large && is_lost && is_lasting && is_gone()).then(|| Interruption {
                sound_until: peaks[begin + k + 1].time,
                ratio: loss / usual.max(noise).max(f64::MIN_POSITIVE),
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::record::Record;
    use crate::tests::synthetic::Noise;
    use crate::units::Quantity;

    fn record(values: impl Fn(f64) -> f64, noise: f64) -> Record {
        let mut random = Noise::new(4);
        let values = (0..8000).map(|i| values(f64::from(i) * 1e-3) + noise * random.normal()).collect();
        Record::sampled(1000.0, values, Quantity::Displacement, "m").unwrap()
    }

    fn decay(t: f64) -> f64 {
        (-0.15 * t).exp() * (TAU * 3.0 * t).cos()
    }

    /// Two modes beat: what one half cycle loses, later ones have again.
    #[test]
    fn beats_are_no_hand() {
        for (frequency, share) in [(33.0, 0.3), (21.0, 0.3), (23.0, 0.6), (150.0, 0.3)] {
            let both = |t: f64| {
                (-0.5 * t).exp() * (TAU * 20.0 * t).cos()
                    + share * (-0.8 * t).exp() * (TAU * frequency * t).cos()
                    + 0.1 * (TAU * 50.0 * t).cos()
            };
            let found = Examination::of(record(both, 1e-3)).interruption();
            assert_eq!(found, None, "{frequency} Hz, {share}");
        }
    }

    #[test]
    fn hands_and_touches_are_found_where_they_are() {
        let held = |t: f64| if t < 4.03 { 1.0 } else { (1.0 - (t - 4.03) / 0.4).max(0.0) };
        let touched = |t: f64| if t < 4.0 { 1.0 } else { 0.6 };
        let fixed = |t: f64| if t < 4.03 { decay(t) } else { decay(4.03) * (-20.0 * (t - 4.03)).exp() };
        let cases: [&dyn Fn(f64) -> f64; 3] = [&|t| held(t) * decay(t), &|t| touched(t) * decay(t), &fixed];
        for (index, values) in cases.into_iter().enumerate() {
            for noise in [0.0, 2e-3] {
                let found = Examination::of(record(values, noise)).interruption().unwrap();
                assert!((3.6..=4.04).contains(&found.sound_until), "{index}: {found:?}");
            }
        }
    }

    /// Neither a stop within a few half cycles of that by friction, nor a touch that takes little, is an interruption.
    #[test]
    fn what_may_be_the_machine_is_none() {
        let sticky = |t: f64| if t < 4.17 { (1.0 - t / 5.0) * (TAU * 3.0 * t).cos() } else { -0.16 };
        let light = |t: f64| (-0.002 * t).exp() * (TAU * 3.0 * t).cos() * if t < 4.03 { 1.0 } else { 0.97 };
        let cases: [&dyn Fn(f64) -> f64; 2] = [&sticky, &light];
        for (index, values) in cases.into_iter().enumerate() {
            assert_eq!(Examination::of(record(values, 1e-5)).interruption(), None, "{index}");
        }
    }

    /// Dry friction to its stop, damping of three kinds, friction that doubles towards rest, a beat, offsets that step
    /// up and down.
    #[test]
    fn free_decays_are_free() {
        let line = |t: f64| (1.0 - t / 5.0).max(0.0) * (TAU * 3.0 * t).cos();
        let quadratic = |t: f64| (TAU * 3.0 * t).cos() / (1.0 + t);
        let strong = |t: f64| (-2.0 * t).exp() * (TAU * 3.0 * t).cos();
        let rising = |t: f64| (1.0 - (t / 5.0).powi(3)).max(0.0) * (TAU * 3.0 * t).cos();
        let beat = |t: f64| decay(t) + 0.3 * (-0.15 * t).exp() * (TAU * 3.4 * t).cos();
        let stepped = |t: f64, height: f64| decay(t) + if t > 3.05 { height } else { 0.0 };
        let (up, down) = (|t: f64| stepped(t, 0.2), |t: f64| stepped(t, -0.2));
        let cases: [&dyn Fn(f64) -> f64; 8] = [&decay, &line, &quadratic, &strong, &rising, &beat, &up, &down];
        for (index, values) in cases.into_iter().enumerate() {
            for noise in [0.0, 5e-3] {
                assert_eq!(Examination::of(record(values, noise)).interruption(), None, "{index} with {noise}");
            }
        }
    }
}
