//! Limits of a record, found as warnings before anything is fitted.

use crate::experiment::RecordSummary;
use crate::warning::Warning;

/// Fewer half swings than this are few.
const ENOUGH_HALF_SWINGS: usize = 4;
impl Warning {
    /// What limits what a record tells of a machine, whose spring `is_bent` or a straight line.
    pub(crate) fn of_record(summary: &RecordSummary, is_bent: bool, warnings: &mut Vec<Self>) {
        let (first, last) = summary.amplitudes;
        // Two turning points give one amplitude.
        if last >= first && summary.half_swings > 2 && !summary.is_driven {
            warnings.push(Self::NoDecay);
        }
        if summary.half_swings < ENOUGH_HALF_SWINGS && !summary.is_driven {
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

    /// What besides one ring-down of one mode is in a record.
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
}
