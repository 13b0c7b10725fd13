//! Warnings about what is in a record besides the free vibration of one mode in white noise, and about what it leaves
//! open.

use std::fmt;

use fmm_model::Rounded;

use crate::experiment::{Experiment, RecordSummary};
use crate::fit::Identification;
use crate::report::Warning;
use crate::residuals::correlation::are_correlated;

/// A factor of the uncertainties that is worth a word.
const NOTABLE: f64 = 1.1;

impl Warning {
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

    /// What the noise of the records is like, as the residuals of `identification` show it, and whether a slow drift
    /// was fitted.
    pub(crate) fn of_noise(identification: &Identification, decays: &[Experiment]) -> Vec<Self> {
        let mut warnings = Vec::new();
        let unit = || decays.first().map_or_else(String::new, |decay| decay.record().unit().to_owned());
        if decays.iter().any(Experiment::drifts) {
            warnings.push(Self::Drift);
        }
        let structure = identification.structure();
        if !structure.is_noisy() {
            return warnings;
        }
        if let Some(growth) = identification.noise().growth() {
            let share = growth.instantaneous.hypot(growth.by_amplitude);
            warnings.push(Self::GrowingNoise { floor: growth.floor, share, unit: unit() });
        }
        warnings.extend(structure.coloured_noise(identification.inflation()));
        warnings
    }

    /// The sentences of these warnings; nothing for others.
    pub(crate) fn write_of_disturbances(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FurtherRelease { time } => write!(
                f,
                "a second release at {time:.2} s: only the part before it was used; give --from for the part after it"
            ),
            Self::Upsampled { factor, is_interpolated } => {
                let what =
                    if *is_interpolated { "lie on straight lines between others" } else { "repeat the one before" };
                write!(
                    f,
                    "of {factor} samples {} {what}: only each {factor}th, as it was measured, was used",
                    factor - 1
                )
            }
            Self::Interrupted { time, ratio } => write!(
                f,
                "something else than the machine takes its motion after {time:.3} s: the next half swing loses {ratio:.0} times as much as \
                 those before it; only the part before was used; give --to to say otherwise"
            ),
            Self::SecondMode { frequency, share } => write!(
                f,
                "a second mode vibrates at {frequency:.3} Hz with about {:.0} % of the amplitude; the fit knows one mode only: use a \
                 part in which one is left, or isolate one (`--mode` of `fmm identify`, `IsolatedMode` of fmm-frf)",
                100.0 * share
            ),
            Self::Hum { frequency, amplitude, unit } => write!(
                f,
                "a hum of {amplitude:.2e} {unit} at {frequency:.3} Hz goes on through the record; it was fitted beside the motion"
            ),
            Self::Rounded { step, unit } => write!(
                f,
                "the values are rounded to steps of {step:.2e} {unit}, which is more than their noise; what follows the last turning \
                 point was left out, as what swings within a step is rounded to another motion"
            ),
            Self::Drift => {
                write!(
                    f,
                    "the zero of the instrument drifts slowly; a polynomial of degree 3 was fitted beside the motion"
                )
            }
            Self::GrowingNoise { floor, share, unit } => write!(
                f,
                "the noise grows with the signal, from {floor:.1e} {unit} by {:.1} % of it; the standard uncertainties take that into \
                 account",
                100.0 * share
            ),
            Self::ColouredNoise { time, ratio, inflation } => {
                if are_correlated(*time) {
                    write!(f, "neighbouring residuals are alike over some {time:.0} samples")?;
                } else {
                    write!(f, "the residuals are {ratio:.1} times the noise that neighbouring samples show")?;
                }
                write!(
                    f,
                    ": the noise is not white (a filter in the instrument, rounding, a fast vibration), or the law leaves a little out; \
                     the standard uncertainties take that into account"
                )?;
                if *inflation > NOTABLE { write!(f, " (by up to a factor of {inflation:.1})") } else { Ok(()) }
            }
            Self::FilteringSensor { law, corner, uncertainty } => write!(
                f,
                "a sensor that filters explains the record as well: by {law} with a low-pass filter of second order at {} Hz, which rounds \
                 the motion where it reverses and looks like friction; state the filter of the sensor, or let it be fitted",
                Rounded::new(*corner, Some(*uncertainty))
            ),
            Self::Beginning { law, time } => write!(
                f,
                "the beginning of the record is not described: without its first {time:.2} s {law} explains the rest; a sensor that \
                 filters or is late, or a release that is not free, makes such a beginning: state the sensor, or begin later"
            ),
            Self::NotSi { unit } => write!(
                f,
                "the record is in {unit}, of which no mass in kg makes a friction force in N, and no normal load a coefficient mu; give \
                 the scale of the instrument in metres"
            ),
            Self::DependsOnLaw { parameter, law, finding } => {
                write!(
                    f,
                    "{parameter} depends on the law: {law}, which the record cannot exclude, gives {finding}; the standard \
                 uncertainty was widened for that"
                )
            }
            Self::TimeLimit => write!(
                f,
                "the time that was given ended before all laws were tried; what is reported is the best of those that were"
            ),
            Self::Undecided => write!(
                f,
                "the record does not decide between the laws that are left; the simplest of those that agree well with it is shown as preferred"
            ),
            _ => Ok(()),
        }
    }
}
