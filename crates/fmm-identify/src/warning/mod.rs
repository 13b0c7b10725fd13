//! Warnings: limits of the results that a reader has to know.

mod plausible;
mod sentences;
mod severity;

use std::fmt;

pub use severity::Severity;

use fmm_frf::Channel;
use fmm_model::Rounded;
use fmm_record::Quantity;

/// Something that limits what the record can tell, or that was done to it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// Neither mass nor stiffness is known, so everything is per unit mass.
    ScaleUnknown {
        /// True if a normal load was given all the same.
        load_known: bool,
    },
    /// A scale is known but the normal load is not, so there is no friction coefficient.
    NormalLoadUnknown,
    /// The residuals are not noise: the model misses something.
    StructuredResiduals {
        /// Root mean square of the residuals, in the unit of the record.
        residual: f64,
        /// Standard deviation of the noise seen between neighbouring samples, in the same unit.
        noise: f64,
        /// Unit of both.
        unit: String,
        /// Largest factor by which a standard uncertainty was widened over that of independent residuals.
        inflation: f64,
    },
    /// The period changes with the amplitude: the restoring force is not a linear spring.
    PeriodDependsOnAmplitude {
        /// Relative change of the period from the first sixth of the oscillation to the last.
        change: f64,
    },
    /// A number that no machine has: a unit is likely to be wrong.
    Implausible {
        /// The number with its unit.
        number: String,
        /// The unit that would make it plausible, as a sentence.
        remedy: String,
    },
    /// The records are explained to their noise if they are of another quantity.
    OtherQuantity {
        /// The quantity that explains them.
        quantity: Quantity,
        /// The declared one.
        declared: Quantity,
        /// The law that explains them.
        law: String,
    },
    /// A force along a motion drives it: friction would be negative.
    DrivesMotion {
        /// Friction in the mean of the way, in the unit of the force.
        friction: f64,
        /// Unit of the force.
        unit: String,
    },
    /// A model of a force is off by as much as the force itself, or more.
    WorseThanNone {
        /// Name of the law.
        law: String,
        /// Residual over the force (1).
        share: f64,
        /// True for the records that were fitted, false for one that was predicted.
        is_fitted: bool,
    },
    /// Noise of a measured motion makes findings more uncertain than the residuals of the force do.
    NoisyMotion {
        /// The quantity with the largest noise, in a word.
        quantity: &'static str,
        /// Noise over the standard deviation of the quantity (1).
        share: f64,
        /// Samples over which it was averaged.
        samples: usize,
        /// Names of the parameters, separated by commas.
        parameters: String,
    },
    /// Samples of a measured motion are so far apart that its slopes make findings more uncertain than the residuals
    /// do.
    CoarseMotion {
        /// Names of the parameters, separated by commas.
        parameters: String,
    },
    /// Another law predicts the records that were not fitted better than the one that fits best.
    OtherPredicts {
        /// Name of the law that fits best.
        fits: String,
        /// Name of the law that predicts best, which is preferred.
        predicts: String,
    },
    /// The amplitude does not fall.
    NoDecay,
    /// Few half swings: friction and damping rest on little.
    FewHalfSwings {
        /// Number of extrema.
        count: usize,
    },
    /// Samples lie on the end of the range of the instrument.
    Saturated {
        /// Number of samples.
        count: usize,
    },
    /// The baseline jumps.
    OffsetStep {
        /// Time (s).
        time: f64,
        /// Height of the step, in the unit of the record.
        height: f64,
        /// Unit of the record.
        unit: String,
    },
    /// Something else than the machine, such as a hand, takes the motion; only the part before was used.
    Interrupted {
        /// The last turning point before it (s).
        time: f64,
        /// Loss of the next half cycle over the usual loss (1).
        ratio: f64,
    },
    /// Samples are held, or interpolated between others; only the measured ones were used.
    Upsampled {
        /// Samples for each measured one.
        factor: usize,
        /// True if those between lie on straight lines; otherwise they repeat the one before.
        is_interpolated: bool,
    },
    /// The machine was released or pushed again; only the part before that was used.
    FurtherRelease {
        /// Time (s).
        time: f64,
    },
    /// Another mode vibrates beside the one that is fitted.
    SecondMode {
        /// Its frequency (Hz).
        frequency: f64,
        /// Its amplitude over that of the mode that is fitted (1).
        share: f64,
    },
    /// Isolated samples were left out.
    Spikes {
        /// Number of samples.
        count: usize,
    },
    /// A parameter ended on its bound.
    AtBound {
        /// Name of the parameter.
        parameter: String,
        /// Its value.
        value: f64,
    },
    /// Some parameters cannot be told apart; in words.
    Inseparable {
        /// Names of the parameters, as a sentence.
        sentence: String,
    },
    /// A parameter has no influence on this record at all.
    NoInfluence {
        /// Name of the parameter.
        parameter: String,
    },
    /// The search did not end at a minimum.
    NotConverged {
        /// Sentence of advice.
        sentence: String,
    },
    /// True if the contact stops or turns back once more was decided narrowly.
    NarrowStop {
        /// (|load| − static level)/static level at that turning point.
        margin: f64,
        /// Time (s).
        time: f64,
    },
    /// The records move a quantity far from what was known of it.
    KnowledgeContradicted {
        /// Name of the quantity.
        parameter: String,
        /// Distance in standard uncertainties of what was known (1).
        distance: f64,
    },
    /// A static level was asked for, which a motion that is not driven through the breakaway does not determine.
    StaticLevelHeld {
        /// Name of the parameter of the law.
        parameter: String,
    },
    /// A more general law, which the record does not exclude, finds something else for a parameter or knows it less
    /// well; its uncertainty was widened for that.
    DependsOnLaw {
        /// Name of the parameter.
        parameter: String,
        /// Name of the more general law.
        law: String,
        /// Its finding, as text with uncertainty and unit.
        finding: String,
    },
    /// Another law was not fitted to its minimum, so that the comparison does not count it in full.
    OtherLaw {
        /// Name of that law.
        law: String,
        /// Sentence about it.
        sentence: String,
    },
    /// Laws that the search tried, but could not fit to the end, and that were then far from what others reach.
    NotFitted {
        /// Their names.
        laws: String,
    },
    /// A law, a score test or a filter could not be computed, and took no part in the judgement.
    LeftOut {
        /// The law, the extension or the filter.
        subject: String,
        /// The error.
        reason: String,
    },
    /// A damper came out negative.
    NegativeDamping {
        /// Name of the law.
        law: String,
        /// Name of the parameter.
        parameter: String,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// Another law, which misses the record, states much less friction at rest than the preferred one.
    Misled {
        /// Name of that law.
        law: String,
        /// F/m at rest that it states, in the unit of the friction per mass.
        friction: f64,
        /// F/m at rest that the preferred law states.
        preferred: f64,
        /// Factor by which its residuals are larger (1).
        residuals: f64,
    },
    /// The residuals ask for friction that changes during the record.
    FrictionChanges {
        /// Name of the law that has none.
        law: String,
    },
    /// The residuals ask for friction that depends on the position.
    FrictionOverPosition {
        /// Name of the law that has none.
        law: String,
    },
    /// The models are too close to prefer one.
    Undecided,
    /// A line of constant amplitude lies over the record and was fitted with it.
    Hum {
        /// Its frequency (Hz).
        frequency: f64,
        /// Its amplitude, in the unit of the record.
        amplitude: f64,
        /// Unit of the record.
        unit: String,
    },
    /// The steps of the converter exceed the noise.
    Rounded {
        /// The step, in the unit of the record.
        step: f64,
        /// Unit of the record.
        unit: String,
    },
    /// The zero of the instrument drifts, and a slow polynomial was fitted beside the motion.
    Drift,
    /// The noise grows with the signal.
    GrowingNoise {
        /// Standard deviation of the noise without a signal, in the unit of the record.
        floor: f64,
        /// Share of the signal by which it grows (1).
        share: f64,
        /// Unit of the record.
        unit: String,
    },
    /// Neighbouring residuals are alike, though not larger than the noise; or they are larger, though hardly alike.
    ColouredNoise {
        /// True if neighbouring residuals are correlated.
        is_correlated: bool,
        /// Autocorrelation time (samples).
        time: f64,
        /// Root mean square of the residuals beside the noise that neighbouring samples show (1).
        ratio: f64,
        /// Largest factor by which a standard uncertainty exceeds that of white noise (1).
        inflation: f64,
    },
    /// A low-pass filter in the sensor, of which nothing was said, explains the record as well.
    FilteringSensor {
        /// The simple law that explains it with the filter.
        law: String,
        /// Corner frequency of the filter (Hz).
        corner: f64,
        /// Its standard uncertainty (Hz).
        uncertainty: f64,
    },
    /// The beginning of the record is not described; without it a simple law explains the rest.
    Beginning {
        /// The simple law that explains the rest.
        law: String,
        /// Duration of the beginning that was left out (s).
        time: f64,
    },
    /// The record is in a unit of which no mass and no load makes a force or a coefficient.
    NotSi {
        /// Unit of the record.
        unit: String,
    },
    /// All run-downs go one way, so that a constant force counts as friction.
    OneDirection,
    /// The time that was given ended before all laws were tried.
    TimeLimit,
    /// The hammer hit again.
    FurtherHit {
        /// Number of the trial, from 1.
        trial: usize,
        /// Time (s).
        time: f64,
        /// Height over that of the pulse (1).
        share: f64,
    },
    /// Samples of a trial lie on the end of the range of the instrument.
    Overload {
        /// Number of the trial, from 1.
        trial: usize,
        /// Channel that is meant.
        channel: Channel,
        /// Number of samples.
        samples: usize,
    },
    /// A pulse has few samples.
    CoarsePulse {
        /// Number of the trial, from 1.
        trial: usize,
        /// Intervals between samples in it.
        intervals: usize,
        /// Relative error (1) that straight lines between the samples make of the impulse of a half sine.
        error: f64,
    },
    /// Isolated samples of the velocity of a trial were bridged by straight lines.
    SpikesBridged {
        /// Number of the trial, from 1.
        trial: usize,
        /// Number of samples.
        samples: usize,
    },
    /// The record of a trial ends before the motion.
    NotAtRest {
        /// Number of the trial, from 1.
        trial: usize,
        /// Recorded duration of the motion (s).
        recorded: f64,
        /// Share by which a peak of the receptance is too low (1).
        lost: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ScaleUnknown { load_known } => {
                let missing =
                    if *load_known { "mass and stiffness are unknown" } else { "mass and normal load are unknown" };
                write!(
                    f,
                    "{missing}: a free vibration shows friction and damping per unit mass only, hence no friction \
                     force and no coefficient mu; give a mass or a stiffness, and the normal load"
                )
            }
            Self::NormalLoadUnknown => {
                write!(f, "the normal load is unknown: the friction force is found, but no coefficient mu")
            }
            Self::StructuredResiduals { residual, noise, unit, inflation } => write!(
                f,
                "the residuals are structured, not noise: {} {unit} rms against {} {unit} of noise between samples, \
                 and neighbours are alike; the law leaves something out, and the standard uncertainties take it for \
                 noise{}",
                Rounded::significant(*residual, 4),
                Rounded::significant(*noise, 2),
                if *inflation > 1.05 {
                    format!(", {inflation:.1} times as large as if it were white")
                } else {
                    String::new()
                }
            ),
            Self::PeriodDependsOnAmplitude { change } => write!(
                f,
                "the period changes by {:+.2} % as the amplitude falls: the amplitude is too large for a linear spring \
                 (a pendulum, whose restoring force is a sine, or a spring that hardens, softens or meets a stop); \
                 take it for a pendulum, or fit the spring (law + cubic spring, or law + stop), or use a part of \
                 smaller amplitude",
                100.0 * change
            ),
            Self::Implausible { number, remedy } => write!(f, "no machine has {number}: {remedy}"),
            Self::NoDecay => write!(f, "the amplitude does not fall: there is no dissipation to identify"),
            Self::FewHalfSwings { count } => write!(
                f,
                "there are only {count} half swings: damping and friction are told apart by the shape of few swings, \
                 not by a decay"
            ),
            Self::Saturated { count } => write!(
                f,
                "{count} samples lie on the end of the range, as if clipped; they were fitted as they are, which \
                 biases the amplitude"
            ),
            Self::OffsetStep { time, height, unit } => {
                write!(
                    f,
                    "the offset jumps by {} {unit} near {time:.3} s; fit the parts before and after apart",
                    Rounded::significant(*height, 4)
                )
            }
            Self::Spikes { count } => write!(f, "{count} isolated samples far off their neighbours were left out"),
            Self::AtBound { parameter, value } => {
                let value = Rounded::new(*value, None);
                write!(
                    f,
                    "{parameter} ended on its bound {value}; it has no standard uncertainty, and the others hold for \
                     that value"
                )
            }
            Self::Inseparable { sentence } | Self::NotConverged { sentence } => f.write_str(sentence),
            Self::NoInfluence { parameter } => {
                write!(f, "{parameter} has no influence on this record, which therefore says nothing about it")
            }
            Self::NarrowStop { margin, time } => write!(
                f,
                "at {time:.3} s the load is within {:.2} % of the static level: a small change would add or remove a \
                 half swing, which the uncertainties do not see",
                100.0 * margin.abs()
            ),
            Self::StaticLevelHeld { parameter } => {
                write!(f, "{parameter} was held at the sliding level: a motion depends on it only in where it stops")
            }
            Self::OtherLaw { law, sentence } => write!(f, "{law}: {sentence}"),
            Self::NotFitted { laws } => {
                write!(f, "{laws}: tried, but not fitted to the end; so far other laws describe the record better")
            }
            Self::LeftOut { subject, reason } => write!(f, "{subject} took no part in the judgement: {reason}"),
            Self::NegativeDamping { law, parameter, value, unit } => write!(
                f,
                "{law}: {parameter} is negative, {value:.4} {unit}: no damper feeds the motion; it stands for friction \
                 that falls with speed, so try a law that does (berger, stribeck) in its place"
            ),
            Self::Misled { law, friction, preferred, residuals } => write!(
                f,
                "{law} alone would have put the friction at rest at {} in place of the {} of the preferred law: with \
                 friction that changes with speed, a level and a straight line share the losses of large swings and \
                 miss those of small ones (its residuals are {residuals:.1} times larger)",
                Rounded::significant(*friction, 3),
                Rounded::significant(*preferred, 3)
            ),
            Self::FurtherHit { .. }
            | Self::Overload { .. }
            | Self::CoarsePulse { .. }
            | Self::SpikesBridged { .. }
            | Self::NotAtRest { .. } => self.write_of_blows(f),
            _ => self.write_of_variation(f),
        }
    }
}

impl Warning {
    /// The warning about a `subject` that an error kept from the judgement.
    pub(crate) fn left_out(subject: &str, reason: &impl fmt::Display) -> Self {
        Self::LeftOut { subject: subject.to_owned(), reason: reason.to_string() }
    }
}

/// Writes the section of the `warnings`.
pub(crate) fn write_warnings(f: &mut fmt::Formatter<'_>, warnings: &[Warning]) -> fmt::Result {
    if !warnings.is_empty() {
        writeln!(f, "\nWarnings")?;
    }
    warnings.iter().try_for_each(|warning| writeln!(f, "  - {warning}"))
}
