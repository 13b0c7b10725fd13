//! The swings of an oscillation: its peaks and the crossings of its centre, with sub-sample resolution.

use crate::harmonic::Harmonic;
use crate::spikes::without_spikes;
use crate::turning::turning_points;
use crate::{Record, noise, quantisation_step};

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
    /// Whether it is a maximum.
    pub is_maximum: bool,
}

/// The passage of an oscillation through its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Crossing {
    /// Time of the passage, between samples (s).
    pub time: f64,
    /// The centre there, in the unit of the record.
    pub centre: f64,
    /// Whether the values rise.
    pub is_rising: bool,
}

/// The half swings of an oscillation about a centre that is unknown and may vary slowly.
///
/// The record may have noise, few bits, spikes, an offset of any size, rest before and after, and from four samples
/// per half swing upwards. What is found is the one regular oscillation that moves most; neighbouring half swings
/// differ in length by less than a factor of two in it. It begins with the first turning point in the record and
/// ends with the last that stands out of the noise, so that rest after a stop has none.
///
/// Peaks and crossings are fitted: a piece of a sine with the length of the local half swing, to the samples
/// within ±1/12 period (±1 sample at least). That averages noise, and has no bias for a sine however few samples
/// there are. The centre at a crossing comes from the four peaks around it (weights 1, 3, 3, 1), which no
/// linear change of amplitude disturbs.
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
        Self::bridging(record, 0)
    }

    /// The swings of `record`, with up to `bridged` irregular ones in a row taken along.
    pub(crate) fn bridging(record: &Record, bridged: usize) -> Self {
        let values = without_spikes(record);
        let step = quantisation_step(&values).unwrap_or(0.0);
        let turning = turning_points(&values, noise(&values), step, bridged);
        let mut fitted = fitted(&values, &turning);
        if fitted.len() > 1 && !begins_moving(&fitted) {
            fitted.remove(0);
        }
        if !fitted.last().is_some_and(Fitted::turns) {
            fitted.pop();
        }
        if fitted.len() < 2 {
            return Self::default();
        }
        let peaks: Vec<Peak> = fitted.iter().map(|fit| fit.peak(record)).collect();
        let crossings = crossings(record, &values, &fitted);
        Self { peaks, crossings }
    }

    /// The turning points, maxima and minima by turns, one per half swing.
    pub fn peaks(&self) -> &[Peak] {
        &self.peaks
    }

    /// The passages through the centre, one between each two peaks.
    pub fn crossings(&self) -> &[Crossing] {
        &self.crossings
    }

    /// Mean frequency from the first crossing to the last (Hz); none with fewer than two crossings.
    pub fn frequency(&self) -> Option<f64> {
        let (first, last) = (self.crossings.first()?, self.crossings.last()?);
        let half_swings = (self.crossings.len() - 1) as f64;
        (half_swings > 0.0).then(|| half_swings / (2.0 * (last.time - first.time)))
    }
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
    /// Whether the values really turn here as in a swing, instead of resting.
    fn turns(&self) -> bool {
        (0.3..3.0).contains(&self.curvature)
    }

    fn peak(&self, record: &Record) -> Peak {
        let index = (self.at.round().max(0.0) as usize).min(record.len() - 1);
        Peak { time: record.time_at(self.at), value: self.value, index, is_maximum: self.is_maximum }
    }
}

/// Samples to either side of a point that a fit uses, for a half swing of `half` samples.
fn reach(half: f64) -> usize {
    ((half / 6.0).round() as usize).max(1)
}

/// The samples within reach of `at`.
fn around(at: f64, half: f64, length: usize) -> std::ops::Range<usize> {
    let centre = at.round().max(0.0) as usize;
    centre.saturating_sub(reach(half))..(centre + reach(half) + 1).min(length)
}

/// Fits every turning point.
fn fitted(values: &[f64], turning: &[usize]) -> Vec<Fitted> {
    let swing = |i: usize, j: usize| (values[turning[j]] - values[turning[i]]).abs();
    let last = turning.len().saturating_sub(1);
    (0..turning.len())
        .filter(|_| last > 0)
        .map(|k| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
            let half = (turning[after] - turning[before]) as f64 / (after - before) as f64;
            let other = if k == last { before } else { after };
            let is_maximum = values[turning[k]] > values[turning[other]];
            let smaller = match k {
                0 => swing(0, 1),
                _ if k == last => swing(before, k),
                _ => swing(before, k).min(swing(k, after)),
            };
            fit_peak(values, turning[k], is_maximum, half, smaller / 2.0)
        })
        .collect()
}

/// Fits one turning point near sample `index`; what cannot be fitted stays at its sample.
fn fit_peak(values: &[f64], index: usize, is_maximum: bool, half: f64, amplitude: f64) -> Fitted {
    let mut found = Fitted { at: index as f64, value: values[index], is_maximum, curvature: 0.0 };
    // The second fit is centred where the first one found the peak, which noise may have moved from the sample.
    for _ in 0..2 {
        let range = around(found.at, half, values.len());
        let Some(fit) = Harmonic::fit(values, range.clone(), found.at, half) else { break };
        let at = fit.extremum();
        // Half a sample of play: a record may begin or end at its peak.
        let inside = at >= range.start as f64 - 0.5 && at <= range.end as f64 - 0.5;
        if !inside || (fit.height() > 0.0) != is_maximum {
            break;
        }
        found = Fitted { at, value: fit.peak(), curvature: fit.height().abs() / amplitude, ..found };
    }
    found
}

/// Whether the first turning point belongs to the oscillation: its values turn there, and it lies as far from the
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
        (value(k) + value(k + 1)) / 2.0
    }
}

/// The crossings between neighbouring peaks.
fn crossings(record: &Record, values: &[f64], fitted: &[Fitted]) -> Vec<Crossing> {
    fitted
        .windows(2)
        .enumerate()
        .map(|(k, pair)| {
            let [from, to] = [pair[0], pair[1]];
            let centre = centre(fitted, k);
            let half = to.at - from.at;
            let mut at = passage(values, &from, &to, centre);
            for _ in 0..2 {
                let range = around(at, half, values.len());
                let Some(fit) = Harmonic::fit_about(values, range, at, half, centre) else { break };
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

/// Where the values pass `centre` on their way between two peaks (samples), between the two samples nearest to the
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
