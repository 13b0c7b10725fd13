//! Parts of an experiment: up to a time, between its reversals, or with few of its samples.

use std::ops::Range;

use fmm_record::Quantity;

use crate::experiment::preparation::RecordSummary;
use crate::experiment::{Experiment, FEWEST_SAMPLES};

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
}
