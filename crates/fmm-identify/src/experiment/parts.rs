//! Parts of an experiment: up to a time or its rest, between its reversals, with few samples, or by means of samples.

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

    /// The part of a free motion before its rest, of a run-down with the offset that the rest shows; `None` without a
    /// rest that is seen, and for a driven motion.
    pub(crate) fn before_rest(&self) -> Option<Self> {
        let Some(run_down) = &self.run_down else { return self.up_to(self.seen_rest()?) };
        let (time, level) = run_down.rest?;
        let mut moving = self.up_to(time)?;
        if self.record.quantity() == Quantity::Velocity && moving.summary.held_offset.is_none() {
            moving.summary.held_offset = Some(level);
        }
        Some(moving)
    }

    /// Time at which a ring-down or the motion after an impact comes to rest (s); `None` where more of its swings lie
    /// below the noise than one.
    fn seen_rest(&self) -> Option<f64> {
        /// Speed or deflection below which a motion is lost in the noise, in standard deviations. Origin: a rest is a
        /// range of eight.
        const LOST: f64 = 4.0;
        if let Some(impact) = &self.impact {
            return impact.rest;
        }
        let (first, last) = self.summary.amplitudes;
        let losses = self.summary.half_swings.checked_sub(1)?;
        self.summary.rest_from.filter(|_| LOST * self.summary.noise * losses as f64 <= (first - last).abs())
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
        // Friction takes Δa/ω from the velocity with each half cycle; one half cycle does not show it.
        let losses = self.summary.half_swings.checked_sub(1).filter(|losses| *losses > 0)?;
        let (first, last) = self.summary.amplitudes;
        let loss = (first - last).abs() / losses as f64;
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

#[cfg(test)]
mod tests {
    use fmm_friction::CoulombViscous;
    use fmm_model::Oscillator;
    use fmm_record::Record;
    use fmm_sim::{Engine, Exact, Sampling, Scenario};
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Normal};

    use super::*;
    use crate::experiment::Preparation;

    const INTERVAL: f64 = 2.5e-5;

    /// Velocity (m/s) of 2 Hz at these times after the release, with this friction per mass (m/s²) and c/m = 0.001 1/s.
    fn motion(friction: f64, sampling: &Sampling) -> Vec<f64> {
        let law = CoulombViscous::new(friction, 0.001).unwrap();
        let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
        Exact.run(&scenario.starting_at(0.02, 0.0).unwrap(), sampling).unwrap().velocity().values().to_vec()
    }

    /// The motion in 100 000 samples with `noise` (m/s).
    fn ring_down(friction: f64, noise: f64) -> Experiment {
        let mut values = motion(friction, &Sampling::uniform(INTERVAL, 100_000).unwrap());
        if noise > 0.0 {
            let mut random = ChaCha8Rng::seed_from_u64(3);
            let normal = Normal::new(0.0, noise).unwrap();
            for value in &mut values {
                *value += normal.sample(&mut random);
            }
        }
        let record = Record::new(0.0, INTERVAL, values, Quantity::Velocity, "m/s").unwrap();
        Experiment::ring_down(&record, &Preparation::default()).unwrap()
    }

    /// Means of twenty samples of a sine are 1.6e-6 smaller than it is in their middle.
    #[test]
    fn means_are_the_motion_in_their_middle() {
        let means = ring_down(1e-4, 1e-5).averaged().unwrap();
        let (record, noise) = (means.record(), means.summary().noise);
        let count = (record.interval() / INTERVAL).round();
        assert!((19.0..=20.0).contains(&count) && record.len() == means.summary().samples, "{count}");
        assert!((noise / (1e-5 / count.sqrt()) - 1.0).abs() < 0.1, "{noise}");
        let times: Vec<f64> = record.times().collect();
        let truth = motion(1e-4, &Sampling::at(times).unwrap());
        let product: f64 = truth.iter().zip(record.values()).map(|(truth, mean)| truth * mean).sum();
        let square: f64 = truth.iter().map(|truth| truth * truth).sum();
        assert!((product / square - 1.0).abs() < 4e-7, "{:e}", product / square - 1.0);
    }

    /// Where a mean would show the jump of the acceleration, samples are taken one by one.
    #[test]
    fn means_hide_no_reversal() {
        let longest = |noise: f64| ring_down(0.3, noise).averaged().map(|means| means.record().interval() / INTERVAL);
        assert_eq!(longest(0.0), None);
        assert_eq!(longest(1e-6), None);
        let (few, many) = (longest(5e-5).unwrap(), longest(1e-3).unwrap());
        // Δa h/8 = 0.3 σ/√n with Δa = 0.6 m/s² gives n = 4 and less than 30, and a thousand in a period are 20.
        assert!((3.0..5.0).contains(&few) && (18.5..20.5).contains(&many), "{few}, {many}");
    }

    /// A motion is taken up to its rest, unless noise hides more than its last swing: 0.024 m/s are lost in each half
    /// cycle.
    #[test]
    fn a_rest_is_left_out_where_it_is_seen() {
        let rest = |noise: f64| ring_down(0.3, noise).before_rest().map(|moving| moving.record().end());
        let seen = rest(1e-3).unwrap();
        let values = motion(0.3, &Sampling::uniform(INTERVAL, 100_000).unwrap());
        let stop = INTERVAL * values.iter().rposition(|speed| *speed != 0.0).unwrap() as f64;
        assert!(seen <= stop + 0.01 && seen > stop - 0.25, "{seen} beside {stop}");
        assert_eq!(rest(0.02), None);
    }
}
