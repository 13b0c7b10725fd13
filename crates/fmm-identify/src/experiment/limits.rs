//! Limits of a record, found as warnings before anything is fitted.

use std::f64::consts::PI;

use fmm_frf::{Channel, coulomb_impact_duration};

use crate::experiment::{ImpactSummary, RecordSummary};
use crate::warning::Warning;

/// Fewer half swings than this are few.
const ENOUGH_HALF_SWINGS: usize = 4;
/// Relative error of an impulse from which on a pulse is coarse (1).
const COARSE: f64 = 5e-3;

impl Warning {
    /// Limits of a record of a machine with a linear spring, or with another one if `is_bent`.
    pub(crate) fn of_record(summary: &RecordSummary, is_bent: bool, warnings: &mut Vec<Self>) {
        let (first, last) = summary.amplitudes;
        // Two turning points give one amplitude.
        if last >= first && summary.half_swings > 2 && summary.is_ring_down() {
            warnings.push(Self::NoDecay);
        }
        if summary.half_swings < ENOUGH_HALF_SWINGS && summary.is_ring_down() {
            warnings.push(Self::FewHalfSwings { count: summary.half_swings });
        }
        // A pendulum that is taken for one, or a spring that is fitted, has such a period.
        let period_change = summary.period_change.filter(|_| !is_bent);
        warnings.extend(period_change.map(|change| Self::PeriodDependsOnAmplitude { change }));
        warnings.extend(summary.saturation.map(|saturation| Self::Saturated { count: saturation.samples }));
        warnings.extend(summary.offset_step.map(|step| Self::OffsetStep {
            time: step.time,
            height: step.height,
            unit: summary.unit.clone(),
        }));
        warnings.extend(Self::of_disturbances(summary));
        if summary.spikes > 0 {
            warnings.push(Self::Spikes { count: summary.spikes });
        }
    }

    /// Disturbances of a record besides one ring-down of one mode.
    pub(crate) fn of_disturbances(summary: &RecordSummary) -> impl Iterator<Item = Self> {
        let further = summary.further_releases.first().map(|time| Self::FurtherRelease { time: *time });
        let second = summary.second_mode.map(|mode| Self::SecondMode { frequency: mode.frequency, share: mode.share });
        let hum = summary.hum.iter().map(|line| Self::Hum {
            frequency: line.frequency,
            amplitude: line.amplitude,
            unit: summary.unit.clone(),
        });
        let rounded = summary.resolution.filter(|_| summary.is_rounded());
        let rounded = rounded.map(|step| Self::Rounded { step, unit: summary.unit.clone() });
        let taken = summary.interruption.map(|taken| Self::Interrupted { time: taken.sound_until, ratio: taken.ratio });
        let upsampled = summary.upsampling.map(|upsampling| Self::Upsampled {
            factor: upsampling.factor,
            is_interpolated: upsampling.is_interpolated,
        });
        upsampled.into_iter().chain(further).chain(taken).chain(second).chain(hum).chain(rounded)
    }

    /// Limits of record number `number`, an impact of which the record lasts `recorded` (s) from its beginning on, with
    /// friction of about `friction` (N).
    pub(crate) fn of_impact(
        number: usize,
        summary: &ImpactSummary,
        recorded: f64,
        friction: Option<f64>,
        warnings: &mut Vec<Self>,
    ) {
        warnings.extend(summary.further_hits.iter().map(|hit| Self::FurtherHit {
            trial: number,
            time: hit.time,
            share: hit.level / summary.level,
        }));
        let (force, response) = summary.overloads;
        for (channel, samples) in [(Channel::Force, force), (Channel::Response, response)] {
            if samples > 0 {
                warnings.push(Self::Overload { trial: number, channel, samples });
            }
        }
        // Of a half sine that is joined by straight lines.
        let error = (PI / summary.intervals as f64).powi(2) / 12.0;
        if error > COARSE {
            warnings.push(Self::CoarsePulse { trial: number, intervals: summary.intervals, error });
        }
        if summary.spikes > 0 {
            warnings.push(Self::SpikesBridged { trial: number, samples: summary.spikes });
        }
        if summary.rest.is_none() {
            let whole =
                friction.and_then(|friction| coulomb_impact_duration(summary.impulse.value.abs(), friction).ok());
            // Half the area under a ramp that is cut off, which is the height of its peak in the spectrum.
            let lost = whole.map_or(0.0, |whole| (1.0 - recorded / whole).max(0.0).powi(2));
            warnings.push(Self::NotAtRest { trial: number, recorded, lost });
        }
    }
}
