//! Swings of an oscillation: peaks, crossings of the centre and change of the period, with sub-sample resolution.

use std::f64::consts::PI;

use crate::examination::Examination;
use crate::examination::harmonic::Harmonic;
use crate::examination::noise::noise;
use crate::examination::turning::turning_points;
use crate::numerics::least_squares::LeastSquares;
use crate::numerics::mean;
use crate::record::Record;
use crate::units::Quantity;

/// A turning point of an oscillation.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Peak {
    /// Time of the extremum, between samples (s).
    pub time: f64,
    /// Value of the extremum, in the unit of the record.
    pub value: f64,
    /// The sample nearest to it.
    pub index: usize,
    /// True for a maximum.
    pub is_maximum: bool,
}

impl Peak {
    /// u, standard uncertainty of the value of a fitted turning point by white noise of this deviation, in its unit, at
    /// `samples_per_period`: a sine of unknown height, phase and centre scatters by 1.5 σ/√n at its extremum,
    /// as a parabola does.
    pub fn standard_uncertainty(noise: f64, samples_per_period: f64) -> f64 {
        1.5 * noise / Swings::samples_per_point(samples_per_period).sqrt()
    }
}

/// The passage of an oscillation through its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Crossing {
    /// Time of the passage, between samples (s).
    pub time: f64,
    /// The centre there, in the unit of the record.
    pub centre: f64,
    /// True if the values rise.
    pub is_rising: bool,
}

/// The half cycles of an oscillation about a centre that is unknown and may vary slowly.
///
/// The record may have noise, few bits, spikes, an offset of any size, rest before and after, and from four samples
/// per half cycle upwards. The result is the regular oscillation with the largest motion; its neighbouring half cycles
/// differ in length by less than a factor of two. It begins with the first turning point of the record and
/// ends with the last one that stands out of the noise; rest after a stop has no turning points.
///
/// Peaks and crossings are fitted: a piece of a sine with the length of the local half cycle, to the samples
/// within ±1/12 period (±1 sample at least). This averages noise and has no bias for a sine, whatever the number of
/// samples. Dry friction makes a kink where a velocity changes sign; crossings are fitted with one, except those
/// of a displacement. (The peaks of a displacement have a jump of curvature there, which makes them late by
/// 0.2 d/A rad for an amplitude A that loses 2d per half cycle.) The centre at a crossing comes from the four peaks
/// around it (weights 1, 3, 3, 1), which no linear change of amplitude disturbs.
///
/// ```
/// use fmm_record::{Quantity, Record, Swings};
///
/// // 2 Hz about 1.5, losing amplitude at a constant rate as dry friction makes it.
/// let at = |t: f64| 1.5 + (1.0 - 0.05 * t) * (std::f64::consts::TAU * 2.0 * t).sin();
/// let record = Record::sampled(100.0, (0..1000).map(|i| at(f64::from(i) / 100.0)).collect(), Quantity::Velocity, "V")?;
///
/// let swings = Swings::of(&record);
/// assert_eq!((swings.peaks().len(), swings.crossings().len()), (40, 39));
/// assert!((swings.frequency().unwrap() - 2.0).abs() < 1e-4);
/// assert!((swings.peaks()[0].value - 2.49375).abs() < 1e-4);
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Swings {
    peaks: Vec<Peak>,
    crossings: Vec<Crossing>,
}

impl Swings {
    /// The swings of `record`; empty if nothing in it oscillates, and never just one peak.
    pub fn of(record: &Record) -> Self {
        Self::bridging(&Examination::of(record), 0)
    }

    /// The swings of a record, with up to `bridged` irregular ones in a row taken along.
    pub(crate) fn bridging(examination: &Examination, bridged: usize) -> Self {
        let clean = examination.bridged();
        let record = clean.record();
        let values = record.values();
        let turning = turning_points(values, noise_in_motion(values, clean.noise()), clean.step(), bridged);
        let mut turning = &turning[..];
        let mut fitted = fit_peaks(values, turning);
        // The length of a half cycle beside a rest, where noise may turn more than once, is none: all is fitted again.
        while fitted.len() > 1 && (!begins_moving(&fitted) || begins_held(values, &fitted)) {
            turning = &turning[1..];
            fitted = fit_peaks(values, turning);
        }
        if fitted.len() > 1 && !fitted.last().is_some_and(Fitted::turns) {
            turning = &turning[..turning.len() - 1];
            fitted = fit_peaks(values, turning);
        }
        if fitted.len() < 2 {
            return Self::default();
        }
        let peak = |&Fitted { at, value, is_maximum, .. }: &Fitted| {
            let index = (at.round().max(0.0) as usize).min(record.len() - 1);
            Peak { time: record.time_at(at), value, index, is_maximum }
        };
        let crossings = crossings(record, values, &fitted);
        Self { peaks: fitted.iter().map(peak).collect(), crossings }
    }

    /// The turning points, maxima and minima by turns, one per half cycle.
    pub fn peaks(&self) -> &[Peak] {
        &self.peaks
    }

    /// The passages through the centre, one between each two peaks.
    pub fn crossings(&self) -> &[Crossing] {
        &self.crossings
    }

    /// Heights of the half cycles: from each peak to the next, in the unit of the record.
    pub(crate) fn heights(&self) -> Vec<f64> {
        self.peaks.windows(2).map(|pair| (pair[1].value - pair[0].value).abs()).collect()
    }

    /// n, samples to which a turning point or a passage is fitted: those within ±1/12 period, three at least.
    pub fn samples_per_point(samples_per_period: f64) -> f64 {
        (2 * reach(0.5 * samples_per_period) + 1) as f64
    }

    /// Mean frequency (Hz): half of the inverse slope of the times of the crossings against their number, by least
    /// squares. None with fewer than two crossings.
    ///
    /// Crossings are weighted by the square of the swing they belong to, as noise shifts those of small swings
    /// more. Where the frequency depends on the amplitude, as that of a pendulum, this is the frequency of the large
    /// swings.
    pub fn frequency(&self) -> Option<f64> {
        let first = self.crossings.first()?.time;
        let points = self.crossings.iter().zip(self.heights()).enumerate();
        let points = points.map(|(k, (crossing, height))| (height * height, crossing.time - first, [1.0, k as f64]));
        let [_, half_period] = LeastSquares::of(&points.collect::<Vec<_>>())?.coefficients;
        (half_period > 0.0).then(|| 0.5 / half_period)
    }
}

/// Standard deviation of the white noise where it is loud, but not loudest: a noise that grows with the motion is
/// larger in the motion than in the rest, and a shock in one part is none.
fn noise_in_motion(values: &[f64], all: f64) -> f64 {
    const PARTS: usize = 8;
    const FEWEST: usize = 100;
    if values.len() < PARTS * FEWEST {
        return all;
    }
    let mut parts: Vec<f64> = values.chunks_exact(values.len() / PARTS).map(noise).collect();
    parts.sort_unstable_by(f64::total_cmp);
    parts[parts.len() - 2].max(all)
}

/// A turning point as fitted, in samples.
#[derive(Debug, Clone, Copy)]
struct Fitted {
    at: f64,
    value: f64,
    is_maximum: bool,
    /// Height above the centre as the fit sees it, against half of the smaller neighbouring swing.
    curvature: f64,
}

impl Fitted {
    /// True if the values turn here as in a swing, instead of resting.
    fn turns(&self) -> bool {
        (0.3..3.0).contains(&self.curvature)
    }
}

/// Samples to either side of a point that a fit uses, for a half cycle of `half` samples.
fn reach(half: f64) -> usize {
    ((half / 6.0).round() as usize).max(1)
}

/// The samples within reach of `at`; at an end of the record as many on the one side.
fn around(at: f64, half: f64, length: usize) -> std::ops::Range<usize> {
    let (centre, count) = (at.round().max(0.0) as usize, (2 * reach(half) + 1).min(length));
    let start = centre.saturating_sub(reach(half)).min(length - count);
    start..start + count
}

/// Fits every turning point, given to the sample. The lengths of the half cycles come from the turning points as
/// given at first, then from the fitted ones.
fn fit_peaks(values: &[f64], turning: &[usize]) -> Vec<Fitted> {
    let last = turning.len().saturating_sub(1);
    if last == 0 {
        return Vec::new();
    }
    let swing = |i: usize| (values[turning[i + 1]] - values[turning[i]]).abs();
    let fit = |at: &[f64]| -> Vec<Fitted> {
        (0..=last)
            .map(|k| {
                let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
                let half = (at[after] - at[before]) / (after - before) as f64;
                let other = if k == last { before } else { after };
                let is_maximum = values[turning[k]] > values[turning[other]];
                let amplitude = swing(before).min(swing(after - 1)) / 2.0;
                fit_peak(values, turning[k], is_maximum, half, amplitude)
            })
            .collect()
    };
    let first = fit(&turning.iter().map(|index| *index as f64).collect::<Vec<_>>());
    fit(&first.iter().map(|fitted| fitted.at).collect::<Vec<_>>())
}

/// Reach over the way by which noise may move a peak out of the samples around it (1). Origin: a sine of 250 samples a
/// period, with noise of 0.3 % of it, is moved by half a sample at either end, a fiftieth of its reach.
const PLAY: f64 = 8.0;

/// Fits one turning point near sample `index`; what cannot be fitted stays at its sample.
fn fit_peak(values: &[f64], index: usize, is_maximum: bool, half: f64, amplitude: f64) -> Fitted {
    let mut found = Fitted { at: index as f64, value: values[index], is_maximum, curvature: 0.0 };
    // The second fit is centred where the first one found the peak, which noise may have moved from the sample.
    for _ in 0..2 {
        let range = around(found.at, half, values.len());
        let Some(fit) = Harmonic::fit(values, range.clone(), found.at, half) else { break };
        let at = fit.extremum();
        // A record may begin or end at its peak, which noise then moves out of it.
        let play = |is_end: bool| 0.5 + if is_end { reach(half) as f64 / PLAY } else { 0.0 };
        let least = range.start as f64 - play(range.start == 0);
        let most = range.end as f64 - 1.0 + play(range.end == values.len());
        let inside = at >= least && at <= most;
        if !inside || (fit.height() > 0.0) != is_maximum {
            break;
        }
        found = Fitted { at, value: fit.peak(), curvature: fit.height().abs() / amplitude, ..found };
    }
    found
}

/// True if the first turning point belongs to the oscillation: its values turn there, and it lies as far from the
/// centre of the swings that follow as they do. The rest before a release does not.
fn begins_moving(fitted: &[Fitted]) -> bool {
    let first = &fitted[0];
    let far = match fitted {
        [first, a, b, c, ..] => {
            let centre = (a.value + 2.0 * b.value + c.value) / 4.0;
            (first.value - centre).abs() >= 0.5 * (a.value - centre).abs()
        }
        [first, a, b] => (a.value - first.value).abs() >= 0.75 * (b.value - a.value).abs(),
        _ => true,
    };
    first.turns() && far
}

/// True if the machine is still held at the first turning point. While it is held, noise alone makes turning points.
///
/// Then the values before the point are near it; in a swing they come from the other side, and after an impact from the
/// centre. Or the values behind it stay near it; in a swing they leave it by a half to the whole of its height.
fn begins_held(values: &[f64], fitted: &[Fitted]) -> bool {
    let [first, second, ..] = fitted else { return false };
    let half = second.at - first.at;
    let centre = centre(fitted, 0);
    // Height of the mean over a part of the way from one half cycle before to the next turning point.
    let height = |from: f64, to: f64| {
        let (from, to) = ((first.at + from * half).max(0.0), first.at + to * half);
        let is_enough = to - from >= (0.25 * half).max(1.0);
        let inside = from.ceil() as usize..(to.floor() as usize + 1).min(values.len());
        is_enough.then(|| (mean(&values[inside]) - centre) / (first.value - centre))
    };
    height(-1.0, -0.25).is_some_and(|before| (before - 1.0).abs() < 0.5)
        || height(0.25, 0.5).is_some_and(|after| after > 0.75)
}

/// Centre of the oscillation between peaks `k` and `k + 1`.
fn centre(fitted: &[Fitted], k: usize) -> f64 {
    let value = |i: usize| fitted[i].value;
    if k > 0 && k + 2 < fitted.len() {
        (value(k - 1) + 3.0 * (value(k) + value(k + 1)) + value(k + 2)) / 8.0
    } else if k + 2 < fitted.len() {
        (value(k) + 2.0 * value(k + 1) + value(k + 2)) / 4.0
    } else if k > 0 {
        (value(k - 1) + 2.0 * value(k) + value(k + 1)) / 4.0
    } else {
        f64::midpoint(value(k), value(k + 1))
    }
}

/// The crossings between neighbouring peaks.
fn crossings(record: &Record, values: &[f64], fitted: &[Fitted]) -> Vec<Crossing> {
    const ENOUGH_FOR_A_KINK: usize = 8;
    // Friction changes its sign with the velocity; a displacement passes its centre smoothly.
    let has_kinks = record.quantity() != Quantity::Displacement;
    fitted
        .windows(2)
        .enumerate()
        .map(|(k, pair)| {
            let [from, to] = [pair[0], pair[1]];
            let centre = centre(fitted, k);
            let half = to.at - from.at;
            let mut at = passage(values, &from, &to, centre);
            for _ in 0..4 {
                let range = around(at, half, values.len());
                let kink = has_kinks && range.len() >= ENOUGH_FOR_A_KINK;
                let Some(fit) = Harmonic::fit_about(values, range, at, half, centre, kink) else { break };
                let moved = fit.crossing();
                if (moved - at).abs() > half / 4.0 {
                    break;
                }
                at = moved;
            }
            Crossing { time: record.time_at(at), centre, is_rising: to.is_maximum }
        })
        .collect()
}

/// Place of the passage through `centre` between two peaks (samples), between the two samples nearest to the
/// middle of the way that lie on either side of it; the middle itself if there are none.
fn passage(values: &[f64], from: &Fitted, to: &Fitted, centre: f64) -> f64 {
    let middle = 0.5 * (from.at + to.at);
    let rising = if to.is_maximum { 1.0 } else { -1.0 };
    let above = |i: usize| rising * (values[i] - centre);
    let (first, last) = (from.at.floor().max(0.0) as usize, (to.at.ceil() as usize).min(values.len() - 1));
    (first..last)
        .filter(|i| above(*i) <= 0.0 && above(*i + 1) > 0.0)
        .map(|i| i as f64 + above(i) / (above(i) - above(i + 1)))
        .min_by(|a, b| (a - middle).abs().total_cmp(&(b - middle).abs()))
        .unwrap_or(middle)
}

/// Fewest turning points: four of them determine the curve.
const FEWEST: usize = 7;
/// Change of the period that a good spring does not show (1), by judgement.
const LARGE: f64 = 5e-3;
/// Parts of the turning points; the periods of the first and the last part are averaged (1).
const PARTS: usize = 6;
/// Quantiles of Student's t for a two-sided probability of 0.001, by degrees of freedom from 1 on (1). A table, as
/// statrs would be the only dependency of the crate for one quantile.
const STUDENT: [f64; 12] = [636.6, 31.6, 12.92, 8.61, 6.87, 5.96, 5.41, 5.04, 4.78, 4.59, 4.44, 4.32];

impl Swings {
    /// Relative change of the period (1) from the first sixth of the turning points to the last; `None` if it is not
    /// significant, or less than half a percent, which is more than a good spring shows, and (Λ/π)². A pendulum, a
    /// spring that stiffens, and a contact that creeps before it slides have one. (Λ is the logarithm of the ratio of
    /// the first two swings. Viscous damping makes periods longer by (Λ/π)²/2; if it grows with the speed, that changes
    /// during the decay.)
    ///
    /// `times` t (s) and `heights` are those of [`turns`](Self::turns): neither viscous damping nor dry friction
    /// changes the time between two of them. Noise shifts a turn in inverse proportion to the height. With s from −1 at
    /// the first turn k = 0 to 1 at the last,
    ///
    /// ```text
    /// t = c₀ + c₁ s + c₂ s² + c₃ (−1)ᵏ
    /// ```
    ///
    /// is fitted by least squares with the weights height². The term c₃ takes up a wrong offset, by which half periods
    /// are long and short by turns. The change is significant if the one that c₂ gives, less the quantile of Student's
    /// t that noise exceeds in one record of a thousand times its standard uncertainty, still exceeds these limits: so
    /// a record without a change raises an alarm less than once in a thousand. (Of 6400 simulated decays with dry
    /// friction, damping, white noise, drift and hum none did.) The last turn, after which the motion may stop, is left
    /// out, and eight are needed.
    ///
    /// ```
    /// use fmm_record::Swings;
    ///
    /// // The half period rises from 0.201 s between the first two turns to 0.219 s.
    /// let turns = |curve: f64| (0..12).map(|k| f64::from(k) * (0.2 + curve * f64::from(k))).collect::<Vec<_>>();
    /// assert_eq!(Swings::period_change(&turns(0.0), &[1.0; 12]), None);
    /// let change = Swings::period_change(&turns(1e-3), &[1.0; 12]).unwrap();
    /// assert!((change - 0.079).abs() < 0.001);
    /// ```
    pub fn period_change(times: &[f64], heights: &[f64]) -> Option<f64> {
        let count = times.len().min(heights.len()).saturating_sub(1);
        if count < FEWEST {
            return None;
        }
        let middle = (count - 1) as f64 / 2.0;
        let points: Vec<_> = (0..count)
            .map(|k| {
                let s = (k as f64 - middle) / middle;
                let side = if k % 2 == 0 { 1.0 } else { -1.0 };
                (heights[k] * heights[k], times[k] - times[0], [1.0, s, s * s, side])
            })
            .collect();
        let fit = LeastSquares::of(&points)?;
        let curve = fit.coefficients[2];
        let freedom = fit.freedom as usize;
        // From thirteen degrees of freedom on by the first terms of the expansion about the quantile of the normal
        // distribution.
        let student = STUDENT.get(freedom - 1).copied().unwrap_or(3.29 * (1.0 + 3.0 / fit.freedom));
        let loss = 0.5 * (heights[0] / heights[2]).ln() / PI;
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

    /// Times (s) at which the velocity changes its sign, in a record of `quantity`, and the height of the half cycle
    /// around each, in the unit of the record: peaks of a displacement, crossings of anything else.
    pub fn turns(&self, quantity: Quantity) -> (Vec<f64>, Vec<f64>) {
        let heights = self.heights();
        if quantity != Quantity::Displacement {
            return (self.crossings().iter().map(|crossing| crossing.time).collect(), heights);
        }
        let around = |k: usize| heights[k.saturating_sub(1)..heights.len().min(k + 1)].iter().copied();
        let heights = (0..self.peaks().len()).map(|k| around(k).fold(f64::INFINITY, f64::min)).collect();
        (self.peaks().iter().map(|peak| peak.time).collect(), heights)
    }
}

#[cfg(test)]
mod tests;
