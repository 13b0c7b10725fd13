//! Rest before a release, and the instant at which motion begins.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::examination::Examination;
use crate::examination::noise::noise;
use crate::numerics::least_squares::LeastSquares;
use crate::numerics::{mean, range};
use crate::units::Quantity;

/// Rest at the beginning of a record, and the instant at which motion begins. A record that begins in motion, never
/// moves, or rests for fewer than twelve samples has none.
///
/// Motion has begun where four samples in a row lie off the mean of the rest on the same side, by more than a
/// band: five standard deviations of its white noise, four of all its noise, 1.5 steps of the converter, 0.5 % of
/// half the record's range. A motion near its turning point stays within such a band for a while too. A rest
/// must therefore last longer than a sine stays there that reaches the first extremum of the record in the same
/// time as the record.
///
/// The instant is fitted to the rest and the first quarter of the way to that extremum, with the motion of an
/// oscillator that is let go: a velocity follows sin φ, a displacement 1 − cos φ, with φ running to the extremum;
/// an acceleration jumps. (Force and other quantities are taken like a velocity.)
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Release {
    /// The instant at which motion begins, between samples (s).
    pub rest_end: f64,
    /// Mean of the record while at rest, in its unit.
    pub offset: f64,
    /// Standard deviation of the record while at rest, in its unit; 0 if it is constant to the last bit.
    pub noise: f64,
    /// Number of samples of rest that both were taken from.
    pub samples: usize,
}

/// Fewest samples of rest that count as rest.
const SHORTEST: usize = 12;
/// Number of samples in a row that must leave the level of rest on the same side, so that no spike is a release.
const PERSISTENT: usize = 4;

impl Examination<'_> {
    /// Rest at the beginning, and the instant at which it ends.
    pub fn release(&self) -> Option<Release> {
        let clean = self.bridged();
        let record = clean.record();
        let values = record.values();
        let (low, high) = range(values);
        let beginning = values.get(..SHORTEST)?;
        let half_range = (high - low) / 2.0;
        let floor = (1.5 * clean.step()).max(0.005 * half_range);
        let mut rest = Rest::of(beginning, floor);
        let mut departure = rest.departure(values)?;
        // A longer rest knows its level and its noise better.
        if departure.0 >= SHORTEST {
            rest = Rest::of(&values[..departure.0 / 5 * 4], floor);
            departure = rest.departure(values)?;
        }
        let extremum = rest.extremum(values, departure, 0.1 * half_range);
        if departure.0 < SHORTEST || !rest.outlasts_a_sine(departure.0, extremum) {
            return None;
        }
        let onset = rest.onset(values, departure, extremum, record.quantity());
        let guard = 1 + departure.0 / 50;
        let samples = (onset.floor().max(0.0) as usize).min(departure.0).saturating_sub(guard).max(SHORTEST - 4);
        let quiet = &values[..samples];
        let offset = mean(quiet);
        let squares: f64 = quiet.iter().map(|value| (value - offset).powi(2)).sum();
        let noise = (squares / samples.saturating_sub(1).max(1) as f64).sqrt();
        Some(Release { rest_end: record.time_at(onset), offset, noise, samples })
    }
}

/// The level of the rest and the band around it that motion leaves.
struct Rest {
    level: f64,
    band: f64,
}

impl Rest {
    /// The level and band of values that are at rest.
    fn of(quiet: &[f64], floor: f64) -> Self {
        let scatter = (5.0 * noise(quiet)).max(4.0 * scatter_about_line(quiet));
        Self { level: mean(quiet), band: floor.max(scatter) }
    }

    /// Distance from the level, towards `side`.
    fn off(&self, value: f64, side: f64) -> f64 {
        side * (value - self.level)
    }

    /// Place and side at which the band is left.
    fn departure(&self, values: &[f64]) -> Option<(usize, f64)> {
        let side =
            |value: f64| if (value - self.level).abs() > self.band { (value - self.level).signum() } else { 0.0 };
        values
            .windows(PERSISTENT)
            .position(|window| {
                let first = side(window[0]);
                first != 0.0 && window.iter().all(|value| side(*value) == first)
            })
            .map(|index| (index, side(values[index])))
    }

    /// The first extremum after the departure and its distance from the level, from which the values return by more
    /// than the band, a tenth of the way there, and `ripple`.
    fn extremum(&self, values: &[f64], (left, side): (usize, f64), ripple: f64) -> (usize, f64) {
        let (mut place, mut height) = (left, 0.0);
        for (index, value) in values.iter().enumerate().skip(left) {
            let off = self.off(*value, side);
            if off > height {
                (place, height) = (index, off);
            } else if height - off > self.band.max(0.1 * height).max(ripple) {
                break;
            }
        }
        (place, height)
    }

    /// True if the rest is longer than a sine in motion stays within the band around a turning point.
    ///
    /// ```text
    /// e = (H + band)/2 (1 − cos φ),        φ = π t/T
    /// ```
    ///
    /// A sine that enters the band on the far side, turns at its near side and leaves it again makes an excursion
    /// e of two bands (some more is allowed for noise), before and after turning. H is the distance to its other
    /// extremum, which it reaches after T.
    fn outlasts_a_sine(&self, left: usize, (turn, height): (usize, f64)) -> bool {
        const EXCURSION: f64 = 2.5;
        let part = EXCURSION * self.band / (height + self.band);
        if part >= 0.5 {
            return false;
        }
        let phase = (1.0 - 2.0 * part).acos() / PI;
        let half_cycle = (turn - left) as f64 / (1.0 - phase);
        left as f64 > 2.0 * phase * half_cycle
    }

    /// Start of the motion (samples): the onset of the sine that fits the rest and the first part of the way to the
    /// first extremum best.
    fn onset(
        &self,
        values: &[f64],
        (left, side): (usize, f64),
        (extremum, height): (usize, f64),
        quantity: Quantity,
    ) -> f64 {
        const PART: f64 = 0.25;
        if quantity == Quantity::Acceleration {
            return left as f64 - 0.5;
        }
        let way = values[left..extremum]
            .iter()
            .take_while(|value| self.off(**value, side) < PART * height)
            .count()
            .max(PERSISTENT);
        let end = (left + way).min(values.len());
        // As much rest again as it may take to leave the band, with a margin.
        let begin = left.saturating_sub(2 * way + SHORTEST);
        let off: Vec<f64> = values[begin..end].iter().map(|value| self.off(*value, side)).collect();
        let turn = (extremum.max(end) - begin) as f64;
        let shape = |onset: f64, i: usize| {
            let part = (i as f64 - onset).max(0.0) / (turn - onset);
            if quantity == Quantity::Displacement { 1.0 - (PI * part).cos() } else { (FRAC_PI_2 * part).sin() }
        };
        // What the best factor leaves of the squares; its own value is not needed.
        let misfit = |onset: f64| {
            let (mut ff, mut fy) = (0.0, 0.0);
            for (i, y) in off.iter().enumerate() {
                let f = shape(onset, i);
                ff += f * f;
                fy += f * y;
            }
            -fy * fy.abs() / ff
        };
        begin as f64 + least(misfit, 0.0, (end - begin) as f64 - 2.0)
    }
}

/// Place of the least value of `f` between `low` and `high`, to a thousandth of a sample (golden section); `f` has one
/// minimum there.
fn least(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    const RESOLUTION: f64 = 1e-3;
    let inner = |low: f64, high: f64| (high - RATIO * (high - low), low + RATIO * (high - low));
    let (mut a, mut b) = inner(low, high);
    let (mut at_a, mut at_b) = (f(a), f(b));
    while high - low > RESOLUTION {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = inner(low, high).0;
            at_a = f(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = inner(low, high).1;
            at_b = f(b);
        }
    }
    0.5 * (low + high)
}

/// Standard deviation about the line of least squares: slow noise counts, a motion that passes through does not.
fn scatter_about_line(values: &[f64]) -> f64 {
    let level = mean(values);
    let points = values.iter().enumerate().map(|(i, value)| (1.0, value - level, [1.0, i as f64]));
    let fit = LeastSquares::of(&points.collect::<Vec<_>>());
    fit.map_or(0.0, |fit| (fit.residual / fit.freedom).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Record;
    use crate::tests::synthetic::{CoulombDecay, Recorded, pendulum, pendulum_velocity, quantised, sampled, wheel};

    fn decay(release: f64) -> CoulombDecay {
        CoulombDecay { frequency: 2.2, amplitude: 10.0, deadband: 0.5, release }
    }

    #[test]
    fn release_is_found_in_velocity_and_displacement() {
        for noise in [0.0, 1e-3, 0.01, 0.03] {
            for rest in [0.1, 1.0, 5.0] {
                let decay = decay(rest + 0.000_37);
                let scale = 13.8 * 9.5;
                let velocity = sampled(1000.0, 12.0, Quantity::Velocity, noise * scale, |t| 20.0 + decay.state(t).1);
                // A tenth of a second near a turning point looks the same within so much noise.
                let hopeless = rest < 0.5 && noise >= 0.01;
                let Some(found) = Examination::of(&velocity).release() else {
                    assert!(hopeless, "noise {noise}, rest {rest} s");
                    continue;
                };
                // The sample grid gives 0.1 ms or so; noise the scatter of a line through some 15 samples.
                let error = (found.rest_end - decay.release).abs();
                assert!(error < 2e-4 + noise * 0.1, "noise {noise}, rest {rest} s: {error} s");
                let allowed = 4.0 * noise * scale / (found.samples as f64).sqrt() + 1e-12;
                assert!((found.offset - 20.0).abs() <= allowed, "{} against 20", found.offset);
                if noise > 0.0 && rest >= 1.0 {
                    assert!((found.noise / (noise * scale) - 1.0).abs() < 0.1, "{}", found.noise);
                }
                let position = sampled(1000.0, 12.0, Quantity::Displacement, noise * 10.0, |t| decay.state(t).0);
                let Some(found) = Examination::of(&position).release() else {
                    assert!(hopeless, "noise {noise}, rest {rest} s");
                    continue;
                };
                let error = (found.rest_end - decay.release).abs();
                assert!(error < 2e-4 + noise * 0.3, "noise {noise}, rest {rest} s: {error} s");
            }
        }
    }

    #[test]
    fn a_short_rest_and_a_constant_rest_count() {
        let decay = decay(0.025);
        let velocity = sampled(1000.0, 12.0, Quantity::Velocity, 0.0, |t| decay.state(t).1);
        let found = Examination::of(&velocity).release().unwrap();
        assert!((found.rest_end - 0.025).abs() < 2e-4, "{} s", found.rest_end);
        let coarse =
            quantised(&sampled(1000.0, 12.0, Quantity::Velocity, 0.02, |t| 3.0 + decay.state(t - 1.0).1), 0.61);
        let found = Examination::of(&coarse).release().unwrap();
        assert!((found.rest_end - 1.025).abs() < 1e-3 && found.noise == 0.0, "{found:?}");
        assert!((found.offset - 3.0).abs() < 0.305);
    }

    #[test]
    fn records_that_begin_in_motion_have_no_release() {
        #[cfg(feature = "mat")]
        assert_eq!(Examination::of(crate::tests::synthetic::fork()).release(), None);
        for record in [wheel(), pendulum(), pendulum_velocity()] {
            assert_eq!(Examination::of(&record).release(), None);
        }
        for phase in 0..24 {
            for rate in [50.0, 1000.0, 100_000.0] {
                for noise in [0.0, 0.01, 0.1] {
                    let phase = f64::from(phase) * 0.27;
                    let record = sampled(rate, 5.0, Quantity::Velocity, noise, |t| (13.8 * t + phase).cos());
                    let found = Examination::of(&record).release();
                    assert_eq!(found, None, "phase {phase}, {rate} Hz, noise {noise}");
                }
            }
        }
    }

    #[test]
    fn records_without_motion_have_no_release() {
        let rest = sampled(1000.0, 10.0, Quantity::Velocity, 0.1, |_| 1.0);
        assert_eq!(Examination::of(&rest).release(), None);
        let constant = sampled(1000.0, 1.0, Quantity::Velocity, 0.0, |_| 1.0);
        assert_eq!(Examination::of(&constant).release(), None);
        let short = sampled(1000.0, 0.01, Quantity::Velocity, 0.0, |t| t);
        assert_eq!(Examination::of(&short).release(), None);
    }

    /// A magnet whose force dies away lets go of the machine after a rest of fifteen samples with noise.
    #[test]
    fn a_rest_of_fifteen_samples_counts() {
        let decay = decay(0.045);
        let velocity = sampled(333.0, 3.0, Quantity::Velocity, 0.3, |t| decay.state(t).1);
        let found = Examination::of(&velocity).release().unwrap();
        assert!((found.rest_end - 0.045).abs() < 3e-3, "{} s", found.rest_end);
    }

    #[test]
    fn a_spike_in_the_rest_is_no_release() {
        let decay = decay(1.0);
        let record = sampled(1000.0, 8.0, Quantity::Velocity, 0.1, |t| decay.state(t).1);
        let mut values = record.into_values();
        for value in &mut values[400..403] {
            *value += 30.0;
        }
        let record = Record::sampled(1000.0, values, Quantity::Velocity, "mm/s").unwrap();
        let found = Examination::of(&record).release().unwrap();
        assert!((found.rest_end - 1.0).abs() < 1e-3, "{} s", found.rest_end);
    }

    #[test]
    fn swings_begin_after_the_rest_before_a_release() {
        // A displacement is at its extremum while it is held.
        let is_velocity = |recorded: &Recorded| recorded.record.quantity() == Quantity::Velocity;
        for recorded in (0..600).map(Recorded::random).filter(is_velocity) {
            let swings = crate::examination::swings::Swings::of(&recorded.record);
            let early = swings.peaks().first().filter(|peak| peak.time < recorded.rest - 0.06);
            assert_eq!(early, None, "released at {} s", recorded.rest);
        }
    }
}
