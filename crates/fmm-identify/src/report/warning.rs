//! Warnings: limits of the results that a reader has to know.

use std::fmt;

use fmm_fit::Fit;
use fmm_frf::Channel;
use fmm_model::Restoring;

use crate::machine::Scale;
use crate::machine::terms::{LINEAR, QUADRATIC};
use crate::{Experiment, FittedMotion, Identification, RecordSummary};

/// Something that limits what the record can tell, or that was done to it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// Neither mass nor stiffness is known, so everything is per unit mass.
    ScaleUnknown {
        /// Whether a normal load was given all the same.
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
    /// The amplitude does not fall.
    NoDecay,
    /// Few half swings: friction and damping rest on little.
    FewHalfSwings {
        /// How many extrema there are.
        count: usize,
    },
    /// Samples lie on the end of the range of the instrument.
    Saturated {
        /// How many.
        count: usize,
    },
    /// The baseline jumps.
    OffsetStep {
        /// When (s).
        time: f64,
        /// By how much, in the unit of the record.
        height: f64,
        /// That unit.
        unit: String,
    },
    /// Something else than the machine, such as a hand, takes the motion; only the part before was used.
    Interrupted {
        /// The last turning point before it (s).
        time: f64,
        /// How often as much as those before it the next half swing loses (1).
        ratio: f64,
    },
    /// Samples are held, or interpolated between others; only the measured ones were used.
    Upsampled {
        /// Samples for each measured one.
        factor: usize,
        /// Whether those between lie on straight lines; otherwise they repeat the one before.
        is_interpolated: bool,
    },
    /// The machine was released or pushed again; only the part before that was used.
    FurtherRelease {
        /// When (s).
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
        /// How many.
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
        /// Which ones, as a sentence.
        sentence: String,
    },
    /// A parameter has no influence on this record at all.
    NoInfluence {
        /// Name of the parameter.
        parameter: String,
    },
    /// The search did not end at a minimum.
    NotConverged {
        /// What happened, as a sentence of advice.
        sentence: String,
    },
    /// Whether the contact stops or turns back once more was decided narrowly.
    NarrowStop {
        /// (|load| − static level)/static level at that turning point.
        margin: f64,
        /// When (s).
        time: f64,
    },
    /// A static level was asked for, which a motion that is not driven through the breakaway does not determine.
    StaticLevelHeld {
        /// Name of the parameter of the law.
        parameter: String,
    },
    /// A more general law, which the record does not exclude, finds something else for a parameter or knows it less well;
    /// its uncertainty was widened for that.
    DependsOnLaw {
        /// Name of the parameter.
        parameter: String,
        /// Name of the more general law.
        law: String,
        /// What it finds, as text with its uncertainty and unit.
        finding: String,
    },
    /// Another law was not fitted to its minimum, so that the comparison does not count it in full.
    OtherLaw {
        /// Name of that law.
        law: String,
        /// What happened.
        sentence: String,
    },
    /// Laws that the search tried, but could not fit to the end, and that were then far from what others reach.
    NotFitted {
        /// Their names.
        laws: String,
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
        /// By what factor its residuals are larger (1).
        residuals: f64,
    },
    /// The models are too close to prefer one.
    Undecided,
    /// A line of constant amplitude lies over the record and was fitted with it.
    Hum {
        /// Its frequency (Hz).
        frequency: f64,
        /// Its amplitude, in the unit of the record.
        amplitude: f64,
        /// That unit.
        unit: String,
    },
    /// The steps of the converter exceed the noise.
    Rounded {
        /// The step, in the unit of the record.
        step: f64,
        /// That unit.
        unit: String,
    },
    /// The zero of the instrument drifts, and a slow polynomial was fitted beside the motion.
    Drift,
    /// The noise grows with the signal.
    GrowingNoise {
        /// Standard deviation of the noise without a signal, in the unit of the record.
        floor: f64,
        /// By how much of the signal it grows (1).
        share: f64,
        /// Unit of the record.
        unit: String,
    },
    /// Neighbouring residuals are alike, though not larger than the noise.
    ColouredNoise {
        /// Autocorrelation time (samples).
        time: f64,
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
        /// How long the beginning lasts that was left out (s).
        time: f64,
    },
    /// The record is in a unit of which no mass and no load makes a force or a coefficient.
    NotSi {
        /// Unit of the record.
        unit: String,
    },
    /// The time that was given ended before all laws were tried.
    TimeLimit,
    /// The hammer hit again.
    FurtherHit {
        /// Number of the trial, from 1.
        trial: usize,
        /// When (s).
        time: f64,
        /// How high, by the pulse (1).
        share: f64,
    },
    /// Samples of a trial lie on the end of the range of the instrument.
    Overload {
        /// Number of the trial, from 1.
        trial: usize,
        /// Of which channel.
        channel: Channel,
        /// How many.
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
        /// How many.
        samples: usize,
    },
    /// The record of a trial ends before the motion.
    NotAtRest {
        /// Number of the trial, from 1.
        trial: usize,
        /// How long the motion was recorded (s).
        recorded: f64,
        /// By what share a peak of the receptance is too low for that (1).
        lost: f64,
    },
    /// Uncertainty of fixed inputs that could not be propagated to the findings.
    InputsNotPropagated {
        /// Why, as a sentence.
        reason: String,
    },
}

/// Fewer half swings than this are few.
const ENOUGH_HALF_SWINGS: usize = 4;
/// A decision between stop and reversal closer than this is narrow.
const NARROW: f64 = 5e-3;

impl Warning {
    /// Everything that limits `identification` of `decays`.
    pub(crate) fn of(identification: &Identification, decays: &[Experiment]) -> Vec<Self> {
        let mut warnings = Vec::new();
        let machine = identification.machine();
        match (machine.scale(), machine.normal_load()) {
            (Scale::PerUnitMass, load) => warnings.push(Self::ScaleUnknown { load_known: load.is_some() }),
            (Scale::Mass(_) | Scale::Stiffness(_), None) => warnings.push(Self::NormalLoadUnknown),
            _ => {}
        }
        for decay in decays {
            let is_bent = machine.restoring() != Restoring::Linear || identification.terms().has_spring();
            Self::of_record(decay.summary(), is_bent, &mut warnings);
        }
        Self::of_fit(identification.fit(), &mut warnings);
        Self::of_damping(identification, &mut warnings);
        Self::of_residuals(identification, decays, &mut warnings);
        warnings.extend(Self::of_noise(identification, decays));
        let unit = decays.first().map_or("", |decay| decay.record().unit());
        let is_scaled = matches!(machine.scale(), Scale::Mass(_) | Scale::Stiffness(_));
        if is_scaled && !matches!(unit, "m" | "m/s" | "m/s²") {
            warnings.push(Self::NotSi { unit: unit.to_owned() });
        }
        warnings.extend(Self::of_narrow_stop(identification.motions()));
        warnings
    }

    /// That a turning point of `motions` was decided narrowly.
    pub(crate) fn of_narrow_stop(motions: &[FittedMotion]) -> Option<Self> {
        let narrowest = FittedMotion::narrowest_decision(motions).filter(|(margin, _)| margin.abs() < NARROW);
        narrowest.map(|(margin, time)| Self::NarrowStop { margin, time })
    }

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

    /// What limits any `fit`.
    pub(crate) fn of_fit(fit: &Fit, warnings: &mut Vec<Self>) {
        if !fit.outcome().is_success() {
            warnings.push(Self::NotConverged { sentence: format!("the fit {}", fit.outcome()) });
        }
        for direction in fit.null_directions() {
            let mut participants = direction.participants();
            match (participants.next(), participants.next()) {
                (Some((parameter, _)), None) => warnings.push(Self::NoInfluence { parameter: parameter.to_owned() }),
                _ => warnings.push(Self::Inseparable { sentence: direction.to_string() }),
            }
        }
        warnings.extend(Self::of_correlations(fit));
        for estimate in fit.estimates().iter().filter(|estimate| estimate.status().is_at_bound()) {
            warnings.push(Self::AtBound { parameter: estimate.name().to_owned(), value: estimate.value() });
        }
    }

    /// Parameters that a rank does not show to be inseparable, as errors of an integrated motion tell them apart.
    fn of_correlations(fit: &Fit) -> Option<Self> {
        /// Correlation from which on two parameters are one.
        const ONE: f64 = 1.0 - 1e-9;
        let count = fit.estimates().len();
        let as_one = |i: usize, j: usize| i != j && fit.correlation(i, j).is_some_and(|r| r.abs() > ONE);
        let together = (0..count).filter(|i| (0..count).any(|j| as_one(*i, j)));
        let names: Vec<&str> = together.map(|i| fit.estimates()[i].name()).collect();
        (!names.is_empty()).then(|| Self::Inseparable {
            sentence: format!(
                "{} change together without an effect on this record, with correlations of ±1: hold one of them",
                names.join(", ")
            ),
        })
    }

    fn of_damping(identification: &Identification, warnings: &mut Vec<Self>) {
        for estimate in identification.fit().estimates() {
            if matches!(estimate.name(), LINEAR | QUADRATIC) && estimate.value() < 0.0 {
                let (parameter, unit) = (estimate.name().to_owned(), estimate.parameter().unit().to_owned());
                let law = identification.law().to_owned();
                warnings.push(Self::NegativeDamping { law, parameter, value: estimate.value(), unit });
            }
        }
    }

    fn of_residuals(identification: &Identification, decays: &[Experiment], warnings: &mut Vec<Self>) {
        let structure = identification.structure();
        if structure.is_structured() {
            warnings.push(Self::StructuredResiduals {
                residual: structure.residual,
                noise: structure.noise,
                unit: decays.first().map_or_else(String::new, |decay| decay.record().unit().to_owned()),
                inflation: identification.inflation(),
            });
        }
    }
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
                "the residuals are structured, not noise: {residual:.3e} {unit} rms against {noise:.1e} {unit} of noise \
                 between samples, and neighbours are alike; the law leaves something out, and the standard \
                 uncertainties take it for noise{}",
                if *inflation > 1.05 {
                    format!(", {inflation:.1} times as large as if it were white")
                } else {
                    String::new()
                }
            ),
            Self::PeriodDependsOnAmplitude { change } => write!(
                f,
                "the period changes by {:+.2} % as the amplitude falls: the amplitude is too large for a linear spring \
                 (a pendulum, whose restoring force is a sine, or a spring that hardens, softens or meets a stop); take it for a pendulum, or fit \
                 the spring (law + cubic spring, or law + stop), or use a part of smaller amplitude",
                100.0 * change
            ),
            Self::NoDecay => write!(f, "the amplitude does not fall: there is no dissipation to identify"),
            Self::FewHalfSwings { count } => write!(
                f,
                "there are only {count} half swings: damping and friction are told apart by the shape of few swings, \
                 not by a decay"
            ),
            Self::Saturated { count } => write!(
                f,
                "{count} samples lie on the end of the range, as if clipped; they were fitted as they are, which biases the amplitude"
            ),
            Self::OffsetStep { time, height, unit } => {
                write!(
                    f,
                    "the offset jumps by {height:.3e} {unit} near {time:.3} s; fit the parts before and after apart"
                )
            }
            Self::Spikes { count } => write!(f, "{count} isolated samples far off their neighbours were left out"),
            Self::AtBound { parameter, value } => {
                // A bound that excludes zero lies just beside it.
                let value = if value.abs() <= f64::MIN_POSITIVE { 0.0 } else { *value };
                write!(
                    f,
                    "{parameter} ended on its bound {value}; it has no standard uncertainty, and the others hold for that value"
                )
            }
            Self::Inseparable { sentence } | Self::NotConverged { sentence } => f.write_str(sentence),
            Self::NoInfluence { parameter } => {
                write!(f, "{parameter} has no influence on this record, which therefore says nothing about it")
            }
            Self::NarrowStop { margin, time } => write!(
                f,
                "at {time:.3} s the load is within {:.2} % of the static level: a small change would add or remove a half swing, \
                 which the uncertainties do not see",
                100.0 * margin.abs()
            ),
            Self::StaticLevelHeld { parameter } => {
                write!(f, "{parameter} was held at the sliding level: a motion depends on it only in where it stops")
            }
            Self::OtherLaw { law, sentence } => write!(f, "{law}: {sentence}"),
            Self::NotFitted { laws } => {
                write!(f, "{laws}: tried, but not fitted to the end; so far other laws describe the record better")
            }
            Self::NegativeDamping { law, parameter, value, unit } => write!(
                f,
                "{law}: {parameter} is negative, {value:.4} {unit}: no damper feeds the motion; it stands for friction that falls with \
                 speed, so try a law that does (berger, stribeck) in its place"
            ),
            Self::Misled { law, friction, preferred, residuals } => write!(
                f,
                "{law} alone would have put the friction at rest at {friction:.3} in place of the {preferred:.3} of the \
                 preferred law: with friction that changes with speed, a level and a straight line share the losses of large \
                 swings and miss those of small ones (its residuals are {residuals:.1} times larger)"
            ),
            Self::FurtherHit { .. }
            | Self::Overload { .. }
            | Self::CoarsePulse { .. }
            | Self::SpikesBridged { .. }
            | Self::NotAtRest { .. }
            | Self::InputsNotPropagated { .. } => self.write_of_blows(f),
            _ => self.write_of_disturbances(f),
        }
    }
}
