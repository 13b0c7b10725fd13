//! The change of a period with the amplitude of an oscillation.

use std::f64::consts::PI;

use crate::numerics::least_squares::LeastSquares;
use crate::{Quantity, Swings};

/// Fewest turning points: four of them determine the curve.
const FEWEST: usize = 7;
/// Change of the period that a good spring does not show (1).
const LARGE: f64 = 5e-3;
/// The periods of one part in so many are averaged at either end.
const PARTS: usize = 6;
/// Quantiles of Student's t for a two-sided probability of 0.001, by degrees of freedom from 1 on.
const STUDENT: [f64; 12] = [636.6, 31.6, 12.92, 8.61, 6.87, 5.96, 5.41, 5.04, 4.78, 4.59, 4.44, 4.32];

/// Relative change of the period (1) from the first sixth of the turning points to the last; `None` if it is not
/// significant, or less than half a percent, which is more than a good spring shows, and (Λ/π)². A pendulum, a spring
/// that stiffens, and a contact that creeps before it slides have one. (Λ is the logarithm of the ratio of the first
/// two swings. Viscous damping makes periods longer by (Λ/π)²/2; if it grows with the speed, that changes during the
/// decay.)
///
/// `times` (s) are those at which the velocity changes its sign: neither viscous damping nor dry friction changes the
/// time between two of them. `swings` are the heights of the half swings there, in the unit of the record: noise shifts
/// a turn in inverse proportion. [`Swings::turns`](crate::Swings::turns) gives both. With s from −1 at the first turn k
/// = 0 to 1 at the last,
///
/// ```text
/// t = c₀ + c₁ s + c₂ s² + c₃ (−1)ᵏ
/// ```
///
/// is fitted by least squares with the weights swing². The term c₃ takes up a wrong offset, by which half periods
/// are long and short by turns. The change is significant if the one that c₂ gives, less the quantile of Student's t
/// that noise exceeds in one record of a thousand times its standard uncertainty, still exceeds these limits: so a
/// record without a change raises an alarm less than once in a thousand. (Of 6400 simulated decays with dry friction,
/// damping, white noise, drift and hum none did.) The last turn, after which the motion may stop, is left out, and
/// eight are needed.
///
/// ```
/// use fmm_record::period_change;
///
/// // The half period rises from 0.201 s between the first two turns to 0.219 s.
/// let turns = |curve: f64| (0..12).map(|k| f64::from(k) * (0.2 + curve * f64::from(k))).collect::<Vec<_>>();
/// let swings = [1.0; 12];
/// assert_eq!(period_change(&turns(0.0), &swings), None);
/// let change = period_change(&turns(1e-3), &swings).unwrap();
/// assert!((change - 0.079).abs() < 0.001);
/// ```
pub fn period_change(times: &[f64], swings: &[f64]) -> Option<f64> {
    let count = times.len().min(swings.len()).saturating_sub(1);
    if count < FEWEST {
        return None;
    }
    let middle = (count - 1) as f64 / 2.0;
    let points: Vec<_> = (0..count)
        .map(|k| {
            let s = (k as f64 - middle) / middle;
            let side = if k % 2 == 0 { 1.0 } else { -1.0 };
            (swings[k] * swings[k], times[k] - times[0], [1.0, s, s * s, side])
        })
        .collect();
    let fit = LeastSquares::of(&points)?;
    let curve = fit.coefficients[2];
    let freedom = fit.freedom as usize;
    // From thirteen degrees of freedom on by the first terms of the expansion about the quantile of the normal
    // distribution.
    let student = STUDENT.get(freedom - 1).copied().unwrap_or(3.29 * (1.0 + 3.0 / fit.freedom));
    let loss = 0.5 * (swings[0] / swings[2]).ln() / PI;
    let least = LARGE + loss * loss;
    // From each turn to the next but one, so that an offset does not make periods alternate.
    let some = ((count - 2) / PARTS).max(1);
    let between_means = 2.0 - 2.0 * (some + 1) as f64 / (count - 1) as f64;
    let sure = 2.0 * between_means * (curve.abs() - student * fit.scatter(2)) / fit.coefficients[1];
    if !(sure > least) {
        return None;
    }
    let mean = |turns: &[f64]| (turns[some + 1] + turns[some] - turns[1] - turns[0]) / (2 * some) as f64;
    let (early, late) = (mean(times), mean(&times[count - 2 - some..count]));
    let change = (late - early) / early;
    (early > 0.0 && change * curve > 0.0 && change.abs() > least).then_some(change)
}

impl Swings {
    /// Times (s) at which the velocity changes its sign, in a record of `quantity`, and the height of the half swing
    /// around each, in the unit of the record: peaks of a displacement, crossings of anything else.
    pub fn turns(&self, quantity: Quantity) -> (Vec<f64>, Vec<f64>) {
        let heights = self.peaks().windows(2).map(|pair| (pair[1].value - pair[0].value).abs());
        if quantity != Quantity::Displacement {
            return (self.crossings().iter().map(|crossing| crossing.time).collect(), heights.collect());
        }
        let heights: Vec<f64> = heights.collect();
        let around = |k: usize| heights[k.saturating_sub(1)..heights.len().min(k + 1)].iter().copied();
        let heights = (0..self.peaks().len()).map(|k| around(k).fold(f64::INFINITY, f64::min)).collect();
        (self.peaks().iter().map(|peak| peak.time).collect(), heights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Record;
    use crate::synthetic::{Decay, Noise, Recorded, measured_records};

    fn of(record: &Record) -> Option<f64> {
        let (times, heights) = Swings::of(record).turns(record.quantity());
        period_change(&times, &heights)
    }

    #[test]
    fn pendulums_have_one_and_others_have_none() {
        let all: Vec<Option<f64>> = measured_records().iter().map(of).collect();
        let [wheel, angle, velocity, small, ..] = all[..] else { panic!("{} records", all.len()) };
        // The half period of the small one falls from 0.391 s to 0.343 s, most of it in the last swings.
        let small = small.unwrap();
        assert!((-0.12..-0.04).contains(&small), "{small}");
        // Averages over 9 s each; the first period is 18 % longer than that of small swings.
        for change in [angle.unwrap(), velocity.unwrap()] {
            assert!((-0.18..-0.1).contains(&change), "{change}");
        }
        assert_eq!(wheel, None);
        assert!(all[4..].iter().all(Option::is_none), "the fork");
    }

    #[test]
    fn decays_with_friction_and_noise_have_none() {
        let recorded = (0..600).map(Recorded::random).filter(|recorded| recorded.decay.creep.is_none());
        let alarms = recorded.filter(|recorded| of(&recorded.record).is_some()).count();
        assert_eq!(alarms, 0);
    }

    /// A half period that falls by 12 % over 8 to 15 half swings, whose times have noise.
    #[test]
    fn a_fall_is_found_in_few_half_swings() {
        for count in [9, 12, 16] {
            for seed in 0..20 {
                let random = &mut Noise::new(seed);
                let mut time = 0.0;
                let (mut times, mut swings) = (Vec::new(), Vec::new());
                for k in 0..count {
                    let part = f64::from(k) / f64::from(count);
                    let swing = 1.05 - part;
                    // Noise of 1 % of the largest swing, averaged over some fifty samples.
                    times.push(time + 0.4 / 3.1 * 0.003 * random.normal() / swing);
                    swings.push(swing);
                    time += 0.4 * (1.0 - 0.12 * part);
                }
                let change = period_change(&times, &swings);
                assert!(change.is_some_and(|change| (-0.14..-0.05).contains(&change)), "{count}: {change:?}");
            }
        }
    }

    /// A decay of constant period with noise, and with drift, a walk of the offset or hum beside it.
    fn disturbed(seed: u64) -> Record {
        let random = &mut Noise::new(seed);
        let half_swings = 8.0 + 30.0 * random.uniform();
        let decay = Decay { creep: None, ..Decay::random(random, half_swings) };
        let noise = 1e-3 * 20f64.powf(random.uniform());
        let rate = 100.0 * 10f64.powf(random.uniform());
        let count = (half_swings / 4.4 * (0.4 + 1.5 * random.uniform()) * rate) as usize;
        let (is_displacement, kind) = (random.uniform() < 0.5, random.next() % 4);
        let (mut drift, slowness, phase) = (0.0, 1.0 - 2.0 / rate, random.uniform());
        let values = decay.states(rate.recip(), count).into_iter().enumerate().map(|(i, (x, v))| {
            let beside = match kind {
                0 => 0.0,
                1 => {
                    drift = slowness * drift + (1.0 - slowness * slowness).sqrt() * random.normal();
                    drift
                }
                2 => {
                    drift += random.normal() / rate.sqrt();
                    drift
                }
                _ => (2.0 * PI * (50.0 * i as f64 / rate + phase)).sin(),
            };
            0.3 + if is_displacement { x } else { v } + noise * (beside + random.normal())
        });
        let quantity = if is_displacement { Quantity::Displacement } else { Quantity::Velocity };
        Record::sampled(rate, values.collect(), quantity, "1").unwrap()
    }

    /// At most one alarm in a thousand. A curve that merely differs from zero, with ends that are apart by chance,
    /// raised seven here.
    #[test]
    fn records_without_a_change_raise_no_alarm() {
        let alarms = (0..2000).filter(|seed| of(&disturbed(*seed)).is_some()).count();
        assert!(alarms <= 2, "{alarms} alarms in 2000 records");
    }

    #[test]
    fn few_turns_or_nonsense_have_none() {
        assert_eq!(period_change(&[], &[]), None);
        assert_eq!(period_change(&[1.0; 20], &[1.0; 20]), None);
        assert_eq!(period_change(&[f64::NAN; 20], &[0.0; 20]), None);
        let times: Vec<f64> = (0..7).map(|k| f64::from(k * k)).collect();
        assert_eq!(period_change(&times, &[1.0; 7]), None);
    }
}
