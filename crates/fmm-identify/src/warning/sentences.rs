//! Sentences of warnings about friction that varies, about disturbances of a record, impacts and forces along motions.

use std::fmt;

use fmm_model::Rounded;

use crate::warning::Warning;

/// Factor of the uncertainties that is worth a word (1).
const NOTABLE: f64 = 1.1;

/// Reason why a record in this `unit` gives no coefficient of friction.
fn limit_of_unit(unit: &str) -> &'static str {
    if unit.starts_with("rad") {
        "a normal load makes a coefficient mu of the torque over its radius alone"
    } else {
        "no mass in kg makes a friction force in N of it, and no normal load a coefficient mu; give the scale of the \
         instrument in metres"
    }
}

impl Warning {
    /// Writes the sentence of a warning about friction that varies, or of another kind that follows in this file; of
    /// other warnings nothing.
    pub(super) fn write_of_variation(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FrictionChanges { law } => write!(
                f,
                "the residuals of {law} ask for friction that changes during the record (wear, running in, warming, a \
                 load that varies), or for another law: fit the change (law + change, with + linear for a viscous part \
                 that stays), give the damping of the machine, or use a shorter part"
            ),
            Self::FrictionOverPosition { law } => write!(
                f,
                "the residuals of {law} ask for friction that depends on the position (a load that a flexure changes \
                 as it deflects, a track that is not even), or for another law: fit it (law + position, with + linear \
                 for a viscous part), or give the damping of the machine"
            ),
            _ => self.write_of_disturbances(f),
        }
    }

    /// The sentences of warnings about disturbances, about the choice between laws and about forces; nothing for others.
    fn write_of_disturbances(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
                "something else than the machine takes its motion after {time:.3} s: the next half swing loses \
                 {ratio:.0} times as much as those before it; only the part before was used; --to says otherwise"
            ),
            Self::SecondMode { frequency, share } => write!(
                f,
                "a second mode vibrates at {frequency:.3} Hz with about {:.0} % of the amplitude; the fit knows one \
                 mode only: use a part in which one is left, or isolate one (`--mode` of `fmm identify`, \
                 `IsolatedMode` of fmm-frf)",
                100.0 * share
            ),
            Self::Hum { frequency, amplitude, unit } => write!(
                f,
                "a hum of {} {unit} at {frequency:.3} Hz goes on through the record; it was fitted beside the motion",
                Rounded::significant(*amplitude, 3)
            ),
            Self::Rounded { step, unit } => write!(
                f,
                "the values are rounded to steps of {} {unit}, which is more than their noise; what follows the last \
                 turning point of a swing, or the last step of a position that comes to rest, was left out, as what \
                 moves within a step is rounded to another motion",
                Rounded::significant(*step, 3)
            ),
            Self::Drift => write!(
                f,
                "the zero of the instrument drifts slowly; a polynomial of degree 3 was fitted beside the motion"
            ),
            Self::KnowledgeContradicted { parameter, distance } => write!(
                f,
                "the records move {parameter} by {distance:.1} standard uncertainties from the value that was given: \
                 that value, its uncertainty or the law is wrong"
            ),
            Self::GrowingNoise { floor, share, unit } => write!(
                f,
                "the noise grows with the signal, from {} {unit} by {:.1} % of it; the standard uncertainties take \
                 that into account",
                Rounded::significant(*floor, 2),
                100.0 * share
            ),
            Self::ColouredNoise { is_correlated, time, ratio, inflation } => {
                if *is_correlated {
                    write!(f, "neighbouring residuals are alike over some {time:.0} samples")?;
                } else {
                    write!(f, "the residuals are {ratio:.1} times the noise that neighbouring samples show")?;
                }
                write!(
                    f,
                    ": the noise is not white (a filter in the instrument, rounding, a fast vibration), or the law \
                     leaves a little out; the standard uncertainties take that into account"
                )?;
                if *inflation > NOTABLE { write!(f, " (by up to a factor of {inflation:.1})") } else { Ok(()) }
            }
            Self::FilteringSensor { law, corner, uncertainty } => write!(
                f,
                "a sensor that filters explains the record as well: by {law} with a low-pass filter of second order at \
                 {} Hz, which rounds the motion where it reverses and looks like friction; state the filter of the \
                 sensor, or let it be fitted",
                Rounded::new(*corner, Some(*uncertainty))
            ),
            Self::OtherQuantity { quantity, declared, law } => write!(
                f,
                "no law explains the record as {declared}, and {law} explains it as {quantity}: check the quantity \
                 of the channel"
            ),
            Self::Beginning { law, time } => write!(
                f,
                "the beginning of the record is not described: without its first {time:.2} s {law} explains the rest; \
                 a sensor that filters or is late, or a release that is not free, makes such a beginning: state the \
                 sensor, or begin later"
            ),
            Self::NotSi { unit } => write!(f, "the record is in {unit}: {}", limit_of_unit(unit)),
            Self::OneDirection => write!(
                f,
                "by the signs of the velocities all runs go one way: a constant force, such as that of a slope, counts \
                 as friction; runs in both directions, with opposite signs, tell them apart"
            ),
            _ => self.write_of_choice(f),
        }
    }

    /// The sentences of warnings about the choice between laws, and of those about forces along motions; nothing for
    /// others.
    fn write_of_choice(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DependsOnLaw { parameter, law, finding } => write!(
                f,
                "{parameter} depends on the law: {law}, which the record cannot exclude, gives {finding}; the standard \
                 uncertainty was widened for that"
            ),
            Self::TimeLimit => write!(
                f,
                "the time that was given ended before all laws were tried; what is reported is the best of those that \
                 were"
            ),
            Self::Undecided => write!(
                f,
                "the record does not decide between the laws that are left; the simplest of those that agree well with \
                 it is shown as preferred"
            ),
            _ => self.write_of_forces(f),
        }
    }

    /// The sentence of a warning that only forces along motions give; nothing for others.
    fn write_of_forces(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DrivesMotion { friction, unit } => write!(
                f,
                "the force drives the motion: turn its sign (`--turn-sign` of `fmm force`, \
                 `ForceRecord::with_turned_sign`); in the mean of the way friction would be {} {unit}, and no friction \
                 is negative",
                Rounded::significant(*friction, 3)
            ),
            Self::WorseThanNone { law, share, is_fitted } => {
                let (said, remedy) = if *is_fitted {
                    ("fits the force", "look at columns, signs and units, or add what else acts, such as zero")
                } else {
                    ("predicts a record that was not fitted", "the model does not hold there")
                };
                write!(
                    f,
                    "{law} {said} with an error of {} % of the force, which is no better than none: {remedy}",
                    Rounded::significant(100.0 * share, 3)
                )
            }
            Self::NoisyMotion { quantity, share, samples, parameters } => write!(
                f,
                "the measured {quantity} has noise of {} of its deviation, which was averaged over {samples} samples; \
                 what is left of it, and what averaging takes from the motion, is most of the uncertainty of \
                 {parameters}",
                if *share < 1e-4 {
                    format!("{share:.0e}")
                } else {
                    format!("{} %", Rounded::significant(100.0 * share, 3))
                }
            ),
            Self::CoarseMotion { parameters } => write!(
                f,
                "the samples of the motion are too far apart for its slopes, which are most of the uncertainty of \
                 {parameters}: measure faster, or velocity and acceleration as well"
            ),
            Self::OtherPredicts { fits, predicts } => write!(
                f,
                "{fits} fits best, but {predicts} predicts best what was not fitted, and is preferred for that"
            ),
            _ => Ok(()),
        }
    }

    /// The sentence of a warning that only blows give; nothing for others.
    pub(crate) fn write_of_blows(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::FurtherHit { trial, time, share } => write!(
                f,
                "trial {trial}: the hammer hit again at {time:.4} s with {:.0} % of the force; the fit follows both, \
                 but the spectrum of the force has holes, so better repeat the trial",
                100.0 * share
            ),
            Warning::Overload { trial, channel, samples } => write!(
                f,
                "trial {trial}: {samples} samples of the {channel} lie on the end of the range, as if clipped; they \
                 were fitted as they are, which biases the friction"
            ),
            Warning::CoarsePulse { trial, intervals, error } => write!(
                f,
                "trial {trial}: the pulse has {intervals} intervals only; by where its samples lie, straight lines \
                 between them make the impulse of a half sine up to {:.1} % too small, and a closed form with it: \
                 sample faster (the fit takes the impulse from the motion as well)",
                100.0 * error
            ),
            Warning::SpikesBridged { trial, samples } => write!(
                f,
                "trial {trial}: {samples} isolated samples of the velocity far off their neighbours were bridged by \
                 straight lines"
            ),
            Warning::NotAtRest { trial, recorded, lost } => write!(
                f,
                "trial {trial}: the record ends after {recorded:.2} s of motion, before rest: a peak read off the \
                 spectrum is {:.0} % too low, while the fit ends with the record; the offset of the velocity rests on \
                 the samples before the blow alone, and only the friction of that part shows",
                100.0 * lost
            ),
            _ => Ok(()),
        }
    }
}
