//! Preparation of a record for identification, and a summary of what it shows.

use std::fmt;

use fmm_model::Rounded;
use fmm_record::{Hum, Interruption, OffsetStep, Quantity, Record, Saturation, SecondMode, Upsampling};

/// Choices in preparing a record. The default uses the record from the release to the next, and fits its offset.
///
/// ```
/// use fmm_identify::{Offset, Preparation};
///
/// let preparation = Preparation::default().from(35.0).to(55.0).offset(Offset::Fixed(0.0));
/// assert_eq!(preparation, Preparation::default().to(55.0).offset(Offset::Fixed(0.0)).from(35.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Preparation {
    pub(crate) from: Option<f64>,
    pub(crate) to: Option<f64>,
    pub(crate) offset: Offset,
    pub(crate) gain_uncertainty: f64,
    pub(crate) clock_uncertainty: f64,
}

/// Treatment of the offset of a record.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Offset {
    /// It is found together with the other parameters. For a displacement it is the position in which the spring
    /// is free of force; the mean of a part in which the contact sticks would be wrong for it.
    #[default]
    Fitted,
    /// It is the mean of the record while it rests before the release.
    Rest,
    /// It is known, in the unit of the record.
    Fixed(f64),
}

impl Preparation {
    /// Leave out what lies before this time (s).
    #[must_use]
    pub fn from(mut self, time: f64) -> Self {
        self.from = Some(time);
        self
    }

    /// Leave out what lies after this time (s).
    #[must_use]
    pub fn to(mut self, time: f64) -> Self {
        self.to = Some(time);
        self
    }

    /// Treatment of the offset.
    #[must_use]
    pub fn offset(mut self, offset: Offset) -> Self {
        self.offset = offset;
        self
    }

    /// Relative standard uncertainty of the instrument's gain (1), 0 unless it is stated.
    ///
    /// A gain that is wrong by a factor turns up in friction, initial position and initial velocity as that factor,
    /// since position, velocity and friction may be scaled together without changing the equation of motion;
    /// frequency and damping do not see it.
    #[must_use]
    pub fn gain_uncertainty(mut self, relative: f64) -> Self {
        self.gain_uncertainty = relative;
        self
    }

    /// Relative standard uncertainty of the sampling rate (1), 0 unless it is stated.
    ///
    /// A clock that runs slow by a factor turns up in frequency and damping as that factor, and in friction per mass as
    /// its square for a displacement, itself for a velocity, and not at all for an acceleration.
    #[must_use]
    pub fn clock_uncertainty(mut self, relative: f64) -> Self {
        self.clock_uncertainty = relative;
        self
    }
}

/// Description of a prepared record and of everything seen in it. `Display` gives one sentence.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RecordSummary {
    /// Time of the first sample used (s).
    pub from: f64,
    /// Time of the last sample used (s).
    pub to: f64,
    /// Number of fitted samples.
    pub samples: usize,
    /// Sampling rate (Hz).
    pub rate: f64,
    /// Measured quantity.
    pub quantity: Quantity,
    /// Its unit.
    pub unit: String,
    /// The offset that is held, in the unit of the record; `None` if it is fitted.
    pub held_offset: Option<f64>,
    /// Relative standard uncertainty of the instrument's gain (1).
    pub gain_uncertainty: f64,
    /// Relative standard uncertainty of the sampling rate (1).
    pub clock_uncertainty: f64,
    /// Time of the release (s), if the record begins at rest or in a slow motion.
    pub release: Option<f64>,
    /// Half swings that stand out of the noise, by their peaks; the first one may be where the record begins.
    pub half_swings: usize,
    /// First and last amplitude, in the unit of the record.
    pub amplitudes: (f64, f64),
    /// Mean frequency between zero crossings (Hz).
    pub frequency: f64,
    /// Standard deviation of the white noise, in the unit of the record.
    pub noise: f64,
    /// Step of the converter, in the unit of the record, if the values lie on a lattice.
    pub resolution: Option<f64>,
    /// Time from which on the values rest within their noise (s), without any law; `None` if the record ends before.
    pub rest_from: Option<f64>,
    /// Isolated samples that were left out.
    pub spikes: usize,
    /// Samples cut off at the range of the instrument.
    pub saturation: Option<Saturation>,
    /// A jump of the offset.
    pub offset_step: Option<OffsetStep>,
    /// Relative change of the period (1) from the first sixth of the half swings to the last, if it is significant.
    pub period_change: Option<f64>,
    /// Steady lines in the record, such as hum of the mains, the largest first. They are still in the record that is
    /// fitted.
    pub hum: Vec<Hum>,
    /// Times at which the machine was released or pushed again (s). The record is used until shortly before the first of them.
    pub further_releases: Vec<f64>,
    /// Time at which something else than the machine itself took the motion, after which the record was not used unless
    /// it was asked for.
    pub interruption: Option<Interruption>,
    /// Upsampling that was done before the record was written; only the measured samples are used.
    pub upsampling: Option<Upsampling>,
    /// Another mode that vibrates beside the one that is fitted.
    pub second_mode: Option<SecondMode>,
    /// True if the motion is driven; what is seen in a free vibration is then none.
    pub is_driven: bool,
    /// True if the motion has no spring: the machine runs down from the first to the last amplitude.
    pub is_run_down: bool,
}

/// A step of the converter that exceeds the noise by this factor rounds it away.
pub(crate) const COARSE: f64 = 2.0;

impl RecordSummary {
    /// Summary of a `record` in which nothing was looked for but a `frequency` (Hz) and the `noise`.
    pub(super) fn unseen(record: &Record, frequency: f64, noise: f64) -> Self {
        Self {
            from: record.start(),
            to: record.end(),
            samples: record.len(),
            rate: record.rate(),
            quantity: record.quantity(),
            unit: record.unit().to_owned(),
            held_offset: None,
            gain_uncertainty: 0.0,
            clock_uncertainty: 0.0,
            release: None,
            half_swings: 0,
            amplitudes: (0.0, 0.0),
            frequency,
            noise,
            resolution: None,
            rest_from: None,
            spikes: 0,
            saturation: None,
            offset_step: None,
            period_change: None,
            hum: Vec::new(),
            further_releases: Vec::new(),
            interruption: None,
            upsampling: None,
            second_mode: None,
            is_driven: false,
            is_run_down: false,
        }
    }

    /// True if the machine vibrates freely, so that peaks are looked for.
    pub(crate) fn is_ring_down(&self) -> bool {
        !self.is_driven && !self.is_run_down
    }

    /// True if the steps of the converter exceed the noise, so that rounding is no noise of its own at every sample.
    pub fn is_rounded(&self) -> bool {
        self.resolution.is_some_and(|step| step > COARSE * self.noise)
    }
}

impl fmt::Display for RecordSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from, to, samples, rate, quantity, unit, half_swings, frequency, noise, .. } = self;
        let rate = Rounded::new(*rate, None);
        write!(f, "{quantity} in {unit}, {samples} samples at {rate} Hz from {from:.3} s to {to:.3} s")?;
        if let Some(time) = self.release {
            write!(f, ", released at {time:.4} s")?;
        }
        match self.held_offset {
            None => write!(f, "; offset fitted")?,
            Some(value) => write!(f, "; offset held at {value:.6} {unit}")?,
        }
        let (first, last) = (Rounded::significant(self.amplitudes.0, 4), Rounded::significant(self.amplitudes.1, 4));
        match (self.is_run_down, quantity) {
            (true, Quantity::Velocity) => write!(f, "; runs down from {first} to {last} {unit}")?,
            (true, _) => write!(f, "; runs down over {first} {unit}")?,
            _ => write!(
                f,
                "; {half_swings} peaks above the noise at {frequency:.4} Hz, amplitude {first} to {last} {unit}"
            )?,
        }
        write!(f, "; noise {} {unit}", Rounded::significant(*noise, 2))?;
        if let Some(step) = self.resolution {
            write!(f, ", resolution {} {unit}", Rounded::significant(step, 3))?;
        }
        Ok(())
    }
}
