//! Parts of an experiment: up to a time, between its reversals, with few of its samples, or by means of samples.

use std::borrow::Cow;
use std::f64::consts::PI;
use std::ops::Range;

use fmm_record::Quantity;

use crate::experiment::preparation::RecordSummary;
use crate::experiment::{Experiment, FEWEST_SAMPLES};

/// The experiments, those [by means](Experiment::averaged) of which that loses nothing.
pub(crate) fn averaged(experiments: &[Experiment]) -> Cow<'_, [Experiment]> {
    let averaged: Vec<Option<Experiment>> = experiments.iter().map(Experiment::averaged).collect();
    if averaged.iter().all(Option::is_none) {
        return Cow::Borrowed(experiments);
    }
    let or_whole = |(means, whole): (Option<Experiment>, &Experiment)| means.unwrap_or_else(|| whole.clone());
    averaged.into_iter().zip(experiments).map(or_whole).collect()
}

impl Experiment {
    /// The same ring-down up to its last peak; `None` if that leaves nothing out or too little.
    ///
    /// In the displacement a stop one swing too early or too late shows as a jump, over which no gradient leads.
    /// Without the end of the motion there is no such jump.
    pub(crate) fn up_to_last_peak(&self) -> Option<Self> {
        let (last, _) = *self.peaks.last()?;
        self.up_to(last)
    }

    /// The same acceleration between its reversals; `None` for other quantities, or if that leaves too little.
    ///
    /// A jump that passes a sample is a jump of the sum of squares, over which no gradient leads. Far from the
    /// reversals there is none.
    pub(crate) fn between_reversals(&self) -> Option<Self> {
        /// Part of the way between two peaks of the velocity that is left out (1). Origin: chosen; first guesses of
        /// reversals are a tenth of it off.
        const PART: f64 = 0.5;
        if self.record.quantity() != Quantity::Acceleration || self.driven.is_some() || self.lines.is_some() {
            return None;
        }
        let half_period = 0.5 / self.guess.frequency();
        let first = self.peaks.first()?.0 - half_period;
        let is_far = |index: &usize| {
            let part = (self.record.time(*index) - first) / half_period;
            // Peaks are at whole numbers, reversals half-way between them.
            (part - part.round()).abs() < 0.5 * (1.0 - PART)
        };
        let mut kept: Vec<Range<usize>> = Vec::new();
        for index in self.kept.iter().cloned().flatten().filter(is_far) {
            match kept.last_mut() {
                Some(range) if range.end == index => range.end = index + 1,
                _ => kept.push(index..index + 1),
            }
        }
        let samples = kept.iter().map(Range::len).sum();
        let summary = RecordSummary { samples, ..self.summary.clone() };
        (samples >= FEWEST_SAMPLES).then(|| Self { kept, summary, ..self.clone() })
    }

    /// The first `share` of the ring-down (1), as much of it as can be fitted.
    pub(crate) fn beginning(&self, share: f64) -> Self {
        let end = self.record.start() + share * self.record.duration();
        // Three periods tell a frequency.
        let end = end.max(self.record.start() + 3.0 / self.guess.frequency());
        self.up_to(end).unwrap_or_else(|| self.clone())
    }

    /// The part up to `end` (s); `None` if that leaves nothing out or too little.
    pub(super) fn up_to(&self, end: f64) -> Option<Self> {
        // The lines of a spectrum are those of the whole record.
        if self.lines.is_some() {
            return None;
        }
        let record = self.record.crop(self.record.start(), end).ok()?;
        let count = record.len();
        if count < FEWEST_SAMPLES || count == self.record.len() {
            return None;
        }
        let kept: Vec<Range<usize>> = self.kept.iter().map(|range| range.start..range.end.min(count)).collect();
        let kept: Vec<Range<usize>> = kept.into_iter().filter(|range| !range.is_empty()).collect();
        let summary =
            RecordSummary { to: record.end(), samples: kept.iter().map(Range::len).sum(), ..self.summary.clone() };
        Some(Self { record, kept, summary, ..self.clone() })
    }

    /// Every `stride`-th sample, for a search that need not see them all.
    pub(crate) fn thinned(&self, stride: usize) -> Option<Self> {
        if self.lines.is_some() {
            return None;
        }
        let record = self.record.every(stride).ok()?;
        let thin = |range: &Range<usize>| range.start.div_ceil(stride)..range.end.div_ceil(stride);
        let kept: Vec<Range<usize>> = self.kept.iter().map(thin).filter(|range| !range.is_empty()).collect();
        let summary = RecordSummary { samples: kept.iter().map(Range::len).sum(), ..self.summary.clone() };
        let shapes = self.shapes.iter().map(|shape| shape.iter().copied().step_by(stride).collect()).collect();
        Some(Self { record, kept, shapes, summary, ..self.clone() })
    }

    /// The same ring-down by means of as many samples in a row as tell no less of the motion; `None` where that is one,
    /// and for what is no free vibration of a spring.
    ///
    /// The mean of a sine is that in the middle of its row times sin(nφ)/(n sin φ), 2φ the phase from sample to sample:
    /// the means are divided by it. At a reversal or stop, where the acceleration jumps by Δa, one mean is off by at
    /// most Δa h/8 of a velocity and Δa h²/48 of a displacement over a length of time h.
    pub(crate) fn averaged(&self) -> Option<Self> {
        /// Means in a period (1), at least. Origin: where the period changes by a tenth, sines are off by 3e-7.
        const FEWEST: f64 = 1000.0;
        /// Largest error by a jump of the acceleration over the noise of a mean (1). Origin: chosen; one mean in each
        /// half cycle has it, and levels of a curve then move by a hundredth of their uncertainty.
        const UNSEEN: f64 = 0.3;
        let is_plain = self.driven.is_none() && self.run_down.is_none() && self.lines.is_none();
        let is_white = self.sensor.low_pass().is_none() && !self.summary.is_rounded();
        if !(is_plain && is_white && self.record.is_equally_spaced()) {
            return None;
        }
        let (interval, angular) = (self.record.interval(), 2.0 * PI * self.guess.frequency());
        // Friction takes Δa/ω from the velocity with each half cycle.
        let (first, last) = self.summary.amplitudes;
        let loss = (first - last) / self.summary.half_swings.saturating_sub(1).max(1) as f64;
        // Δa h/8 < UNSEEN σ/√n with h = n Δt, and the same with Δa h²/48.
        let most = match self.record.quantity() {
            Quantity::Velocity => (8.0 * UNSEEN * self.white_noise() / (angular * loss * interval)).powf(2.0 / 3.0),
            Quantity::Displacement => {
                (48.0 * UNSEEN * self.white_noise() / (angular * angular * loss * interval * interval)).powf(0.4)
            }
            _ => return None,
        };
        let count = most.min(1.0 / (self.guess.frequency() * interval * FEWEST));
        if !(count >= 2.0) {
            return None;
        }
        let count = count as usize;
        let half_phase = 0.5 * angular * interval;
        let of_sine = (count as f64 * half_phase).sin() / (count as f64 * half_phase.sin());
        let record = self.record.means(count).ok()?.scaled(of_sine.recip(), self.record.unit()).ok()?;
        let whole = |range: &Range<usize>| range.start.div_ceil(count)..range.end / count;
        let kept: Vec<Range<usize>> = self.kept.iter().map(whole).filter(|range| !range.is_empty()).collect();
        let means =
            |shape: &Vec<f64>| shape.chunks_exact(count).map(|row| row.iter().sum::<f64>() / count as f64).collect();
        let shapes = self.shapes.iter().map(means).collect();
        let summary = RecordSummary {
            samples: kept.iter().map(Range::len).sum(),
            noise: record.noise(),
            resolution: None,
            held_offset: self.summary.held_offset.map(|offset| offset / of_sine),
            ..self.summary.clone()
        };
        (summary.samples >= FEWEST_SAMPLES).then(|| Self { record, kept, shapes, summary, ..self.clone() })
    }
}
