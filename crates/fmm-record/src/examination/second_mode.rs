//! A second mode that vibrates beside the first.

use std::borrow::Cow;
use std::f64::consts::TAU;

use crate::examination::Examination;
use crate::examination::hum::MOST_SAMPLES;
use crate::examination::swings::Swings;
use crate::numerics::least_squares::LeastSquares;
use crate::numerics::line_search::lines;
use crate::numerics::spectrum::component;

/// A second vibration beside the one that moves most.
///
/// There are two signs. A mode far from the first has a line of its own in the spectrum of the motion, or of its
/// first half, quarter or eighth. The line must stand above the noise as in `hum` and have 1 % of
/// the motion at least. At multiples of the first frequency friction and nonlinear restoring forces have harmonics;
/// there it must be larger than harmonics of friction are. (If the period changes with the amplitude, time is
/// measured in half cycles.)
///
/// A mode near to the first makes the half cycles larger and smaller by turns. A cubic in their number k for
/// their heights, the logarithms or the inverses of them describes a decay by dry friction, viscous or quadratic
/// damping. About the nearest of these, h, a modulation is fitted:
///
/// ```text
/// h (1 + c₀ + c₁ k + c₂ k² + c₃ k³ + a cos 2πνk + b sin 2πνk)
/// ```
///
/// The beat counts if there are ten half cycles or more, if √(a² + b²) exceeds 2 %, and the sum of squared
/// residuals falls by so much that noise does the same in one record of a hundred (by Fisher's F). Beats of fewer
/// cycles than 1.8 count if half cycles rise by a tenth. The frequency is that of n f (1 ± 2ν/n), n odd, where
/// the spectrum is largest.
///
/// In 4000 simulated decays with friction and damping of many kinds, two showed one of the signs. Of modes with a
/// share of a tenth or more, 25 % and more away from the first, nineteen of twenty were found in 16 half cycles or
/// more; in fewer, a mode near to the first is mostly missed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SecondMode {
    /// Its frequency (Hz). Where it shows as a beat of few cycles only, it may lie as far on the other side of the
    /// frequency of the motion.
    pub frequency: f64,
    /// Its amplitude over that of the motion (1), about, where it shows best.
    pub share: f64,
}

// Limits "by judgement" are pinned by the tests: 4000 simulated decays raised two alarms (documentation of the type).

/// Least share of a second mode that shows as a beat (1), by judgement.
const BEAT: f64 = 0.02;
/// Least share of a second mode that shows as a line (1), by judgement.
const LINE: f64 = 0.01;
/// Largest harmonic of friction (1): 4/(π (n² − 1)) d/A of a velocity, with d/A = 1/6 for three half cycles.
const HARMONIC: f64 = 0.06;
/// Fewest half cycles that show a beat: six coefficients are fitted.
const FEWEST: usize = 10;
/// Most half cycles that are looked at for a beat: the time grows with their square.
const MOST: usize = 400;
/// Least height over the first (1), by judgement: below it, friction that depends on speed changes the loss.
const SMALL: f64 = 0.15;
/// Fewest cycles of a beat in the record, by judgement: slower ones look like the decay of some friction.
const CYCLES: f64 = 1.8;
/// Largest part of the squared residuals that a beat leaves (1): two modes leave 0.1, a push in motion 0.33.
const EXPLAINED: f64 = 0.2;
/// Probability that noise alone makes a beat (1).
const FALSE_RATE: f64 = 1e-2;
/// Relative rise of the half cycles that no decay has (1), by judgement.
const RISE: f64 = 0.1;
/// Highest frequency that is looked at (cycles per sample, or per half cycle): half a cycle cannot be told from its
/// mirror.
const HIGHEST: f64 = 0.45;

/// True if the half cycles rise and fall like those of two modes: a modulation leaves less than a fifth of the
/// squares. (Of two modes it left up to a tenth, after a push in motion more than a third.)
pub(crate) fn beats(examination: &Examination) -> bool {
    let beats = |Modulation { residuals: (with, without), .. }| with < EXPLAINED * without;
    Motion::of(examination).and_then(|motion| Modulation::of(motion.large())).is_some_and(beats)
}

impl Examination<'_> {
    /// A second mode beside the first.
    pub fn second_mode(&self) -> Option<SecondMode> {
        let motion = match self.record().in_at_most(MOST_SAMPLES) {
            Cow::Borrowed(_) => Motion::of(self)?,
            Cow::Owned(survey) => Motion::of(&Examination::of(survey))?,
        };
        motion.line().or_else(|| motion.beat())
    }
}

/// The part of a record that swings.
struct Motion {
    /// Values from the first peak to the last.
    values: Vec<f64>,
    /// Periods per sample.
    frequency: f64,
    /// Periods per second, on average.
    rate: f64,
    /// Heights of the half cycles.
    heights: Vec<f64>,
}

impl Motion {
    fn of(examination: &Examination) -> Option<Self> {
        let (record, swings) = (examination.record(), examination.swings());
        let peaks = swings.peaks();
        let (first, last) = (peaks.first()?, peaks.last()?);
        let values = examination.bridged().record().values().get(first.index..=last.index)?.to_vec();
        let heights = swings.heights();
        let rate = 0.5 * heights.len() as f64 / (last.time - first.time);
        let (times, around) = swings.turns(record.quantity());
        let warped = Swings::period_change(&times, &around).map(|_| {
            let knots: Vec<f64> = times.iter().map(|time| (time - first.time) * record.rate()).collect();
            in_half_cycles(&values, &knots)
        });
        let (values, frequency) = match warped {
            Some(warped) => warped,
            None => (values, swings.frequency().unwrap_or(rate) * record.interval()),
        };
        (values.len() > 16 && frequency > 0.0 && rate.is_finite()).then_some(Self { values, frequency, rate, heights })
    }

    /// A line of the spectrum that does not belong to the motion.
    fn line(&self) -> Option<SecondMode> {
        const MULTIPLES: u32 = 12;
        const ODD_MULTIPLES: u32 = 99;
        let multiples = (0..=ODD_MULTIPLES).filter(|n| *n <= MULTIPLES || n % 2 == 1);
        let multiples: Vec<f64> = multiples.map(|n| f64::from(n) * self.frequency).collect();
        let count = self.values.len();
        let largest = (0..4).flat_map(|halvings| {
            let part = count >> halvings;
            let main = self.amplitude(part, self.frequency);
            let first = |known: &[f64], least: f64| {
                let line = *lines(&self.values, 0..part, self.frequency, known).first()?;
                Some(self.second(line.frequency, line.amplitude / main)).filter(|mode| mode.share > least)
            };
            [first(&multiples, LINE), first(&multiples[..2], HARMONIC)]
        });
        largest.flatten().max_by(|a, b| a.share.total_cmp(&b.share))
    }

    fn second(&self, frequency: f64, share: f64) -> SecondMode {
        SecondMode { frequency: frequency / self.frequency * self.rate, share }
    }

    /// Amplitude at a frequency (cycles per sample) in the first `count` values, with a window of raised cosine.
    fn amplitude(&self, count: usize, frequency: f64) -> f64 {
        let values = &self.values[..count];
        let mean = values.iter().sum::<f64>() / count as f64;
        let phase = |i: usize| TAU * (i as f64 + 0.5) / count as f64;
        let windowed: Vec<f64> =
            values.iter().enumerate().map(|(i, y)| (y - mean) * (1.0 - phase(i).cos()) / count as f64).collect();
        let (cosine, sine) = component(&windowed, frequency);
        cosine.hypot(sine)
    }

    /// A modulation of the half cycles.
    fn beat(&self) -> Option<SecondMode> {
        let heights = self.large();
        let found = Modulation::of(heights).map(|Modulation { nu, share, .. }| (nu, share)).or_else(|| rise(heights));
        found.map(|(nu, share)| self.beside(nu, share))
    }

    /// Heights of the half cycles that friction changes at a steady rate. The last one may end where it stops them.
    fn large(&self) -> &[f64] {
        let all = &self.heights[..self.heights.len().saturating_sub(1)];
        let count = all.iter().take(MOST).rposition(|height| *height > SMALL * all[0]).map_or(0, |last| last + 1);
        &all[..count]
    }

    /// The mode that beats with the first in `nu` cycles per half cycle.
    fn beside(&self, nu: f64, share: f64) -> SecondMode {
        // Half cycles do not tell modes apart whose frequencies differ by two of the motion.
        const LAST: u32 = 9;
        let factors = (1..=LAST).step_by(2).flat_map(|n| [f64::from(n) + 2.0 * nu, (f64::from(n) - 2.0 * nu).abs()]);
        let shown = factors
            .map(|factor| factor * self.frequency)
            .filter(|frequency| *frequency < HIGHEST)
            .map(|frequency| (frequency, self.amplitude(self.values.len(), frequency)))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        self.second(shown.map_or(self.frequency, |(frequency, _)| frequency), share)
    }
}

/// Heights of half cycles k with functions of k and of s from −1 to 1.
fn points<const P: usize>(heights: &[f64], functions: impl Fn(f64, f64) -> [f64; P]) -> Vec<(f64, f64, [f64; P])> {
    let middle = (heights.len() - 1) as f64 / 2.0;
    let at = |(k, height): (usize, &f64)| (1.0, *height, functions(k as f64, (k as f64 - middle) / middle));
    heights.iter().enumerate().map(at).collect()
}

/// Half cycles that become larger and smaller by turns.
#[derive(Debug, Clone, Copy)]
struct Modulation {
    /// Cycles per half cycle.
    nu: f64,
    /// Depth of the modulation, as a share of the height (1).
    share: f64,
    /// Sum of the squared residuals, and without the modulation.
    residuals: (f64, f64),
}

impl Modulation {
    /// The modulation that leaves the least residual about a cubic, if noise alone would seldom do this: F of two
    /// coefficients exceeds x with the probability (1 + 2x/ν)^(−ν/2).
    fn of(heights: &[f64]) -> Option<Self> {
        const STEPS: f64 = 8.0;
        let count = heights.len();
        if count < FEWEST {
            return None;
        }
        let trend = trend(heights)?;
        let cubic = |k: f64, s: f64| [1.0, s, s * s, s * s * s].map(|power| power * trend[k as usize]);
        let without = LeastSquares::of(&points(heights, cubic))?.residual;
        let fit = |nu: f64| {
            let fit = LeastSquares::of(&points(heights, |k, s| {
                let [one, s1, s2, s3] = cubic(k, s);
                let (sin, cos) = (TAU * nu * k).sin_cos();
                // Both modes decay.
                [one, s1, s2, s3, one * cos, one * sin]
            }))?;
            let share = fit.coefficients[4].hypot(fit.coefficients[5]);
            Some((Self { nu, share, residuals: (fit.residual, without) }, fit.freedom))
        };
        let (best, freedom) = (0..8 * MOST as u32)
            .map(|i| (CYCLES + f64::from(i) / STEPS) / count as f64)
            .take_while(|nu| *nu < HIGHEST)
            .filter_map(fit)
            .min_by(|a, b| a.0.residuals.0.total_cmp(&b.0.residuals.0))?;
        let with = best.residuals.0;
        let f = 0.5 * (without - with) / (with / freedom);
        let limit = 0.5 * freedom * ((count as f64 / FALSE_RATE).powf(2.0 / freedom) - 1.0);
        (f > limit && best.share > BEAT).then_some(best)
    }
}

/// Heights of half cycles without a beat: a cubic for themselves, their logarithms or their inverses, whichever is
/// nearest. Dry friction, viscous and quadratic damping make one of them a straight line.
fn trend(heights: &[f64]) -> Option<Vec<f64>> {
    /// Form of a height, its slope there, and the height of a form.
    type Form = (fn(f64) -> f64, fn(f64) -> f64, fn(f64) -> f64);
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    let forms: [Form; 3] =
        [(|h| h, |_| 1.0, |g| g), (f64::ln, f64::recip, f64::exp), (f64::recip, |h| h.powi(-2), f64::recip)];
    let curve = |(form, slope, back): Form| {
        let at = |(weight, height, functions): (f64, f64, [f64; 4])| {
            (weight * slope(height).powi(-2), form(height), functions)
        };
        let points: Vec<_> = points(heights, |_, s| [1.0, s, s * s, s * s * s]).into_iter().map(at).collect();
        let fit = LeastSquares::of(&points)?;
        let curve: Vec<f64> = points.iter().map(|(_, _, functions)| back(fit.at(functions))).collect();
        let misfit: f64 = curve.iter().zip(heights).map(|(level, height)| (level - height).powi(2)).sum();
        (misfit.is_finite() && curve.iter().all(|level| *level > 0.02 * mean)).then_some((misfit, curve))
    };
    let best = forms.into_iter().filter_map(curve).min_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, curve)| curve)
}

/// Cycles per half cycle and share of a beat that makes the half cycles, in pairs, larger again, if one does: half a
/// cycle from the smallest to the largest after it.
fn rise(heights: &[f64]) -> Option<(f64, f64)> {
    let pairs: Vec<f64> = heights.windows(2).map(|pair| pair[0] + pair[1]).collect();
    let mut least = 0;
    let mut best = None;
    for (k, pair) in pairs.iter().enumerate() {
        if *pair < pairs[least] {
            least = k;
        }
        let share = (pair - pairs[least]) / (pair + pairs[least]);
        if heights.len() >= FEWEST && share > 0.5 * RISE && best.is_none_or(|(_, most)| share > most) {
            best = Some((0.5 / (k - least) as f64, share));
        }
    }
    best
}

/// The values at equal parts of half cycles, whose ends are at `knots` (samples), and the periods per value.
fn in_half_cycles(values: &[f64], knots: &[f64]) -> (Vec<f64>, f64) {
    let last = knots.len().saturating_sub(1);
    let parts = ((knots[last] - knots[0]) / last as f64).ceil().max(8.0) as usize;
    let at = |k: usize, part: usize| knots[k] + (knots[k + 1] - knots[k]) * part as f64 / parts as f64;
    let places = (0..last).flat_map(|k| (0..parts).map(move |part| at(k, part)));
    let value = |place: f64| {
        let i = (place.max(0.0) as usize).min(values.len().saturating_sub(2));
        values[i] + (place - i as f64).clamp(0.0, 1.0) * (values[i + 1] - values[i])
    };
    (places.map(value).collect(), 0.5 / parts as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examination::further_release::FurtherRelease;
    use crate::record::Record;
    use crate::tests::synthetic::{Noise, Recorded, measured_records, released_twice, sampled, with_hum};
    use crate::units::Quantity;

    fn further_releases(record: &Record) -> Vec<FurtherRelease> {
        Examination::of(record).further_releases()
    }

    /// Two modes that decay, the second of a frequency and amplitude relative to the first.
    fn two_modes(half_cycles: f64, factor: f64, share: f64, noise: f64) -> Record {
        let duration = half_cycles / 4.4;
        sampled(300.0, duration, Quantity::Velocity, noise, |t| {
            (-t / duration).exp() * ((TAU * 2.2 * t + 0.3).cos() + share * (TAU * 2.2 * factor * t + 1.0).cos())
        })
    }

    #[test]
    fn measured_records_have_none() {
        for record in measured_records() {
            assert_eq!(Examination::of(&record).second_mode(), None);
        }
        let record = released_twice();
        let sound = record.crop(0.0, further_releases(&record)[0].sound_until).unwrap();
        assert_eq!(Examination::of(&sound).second_mode(), None);
        let record = with_hum();
        assert_eq!(Examination::of(Examination::of(&record).without_hum()).second_mode(), None);
    }

    #[test]
    fn single_decays_have_none() {
        for seed in 0..300 {
            assert_eq!(Examination::of(&Recorded::random(seed).record).second_mode(), None, "seed {seed}");
        }
    }

    #[test]
    fn second_modes_are_found_with_their_frequency_and_share() {
        for noise in [0.001, 0.01] {
            for factor in [0.6, 0.8, 1.2, 1.4, 1.7, 2.6, 4.3, 7.4] {
                for share in [0.1, 0.2] {
                    let record = two_modes(30.0, factor, share, noise);
                    let found = Examination::of(&record)
                        .second_mode()
                        .unwrap_or_else(|| panic!("{factor}, {share}, noise {noise}"));
                    // A fifth of the resolution of the whole motion, in units of f.
                    assert!((found.frequency / 2.2 - factor).abs() < 0.05, "{factor}, {share}: {found:?}");
                    assert!((found.share / share - 1.0).abs() < 0.4, "{factor}, {share}: {found:?}");
                    assert_eq!(further_releases(&record), [], "{factor}, {share}");
                }
            }
        }
    }

    #[test]
    fn a_slow_beat_is_found_where_half_cycles_rise() {
        let found = Examination::of(two_modes(30.0, 1.1, 0.5, 0.01)).second_mode().unwrap();
        assert!((found.frequency / 2.2 - 1.0).abs() < 0.2 && found.share > 0.1, "{found:?}");
    }

    #[test]
    fn what_does_not_oscillate_has_none() {
        for length in [1, 20, 2000] {
            let record = Record::sampled(100.0, vec![1.0; length], Quantity::Velocity, "1").unwrap();
            assert_eq!(Examination::of(&record).second_mode(), None);
        }
    }

    #[test]
    fn strong_beats_are_no_releases() {
        let alarms = (0..200).filter(|seed| {
            let random = &mut Noise::new(*seed);
            let factor = 0.5 * 3f64.powf(random.uniform());
            !further_releases(&two_modes(12.0 + 25.0 * random.uniform(), factor, 0.3 + 0.5 * random.uniform(), 0.01))
                .is_empty()
        });
        let alarms = alarms.count();
        assert!(alarms <= 4, "{alarms} of 200");
    }
}
