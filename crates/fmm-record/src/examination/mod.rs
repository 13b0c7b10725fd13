//! Examination of a record before a fit: noise and resolution, rest and release, swings, disturbances.

pub(crate) mod further_release;
pub(crate) mod harmonic;
pub(crate) mod hum;
pub(crate) mod interruption;
pub(crate) mod noise;
pub(crate) mod offset_step;
pub(crate) mod release;
pub(crate) mod saturation;
pub(crate) mod second_mode;
pub(crate) mod spikes;
pub(crate) mod steadiness;
pub(crate) mod swings;
pub(crate) mod turning;
pub(crate) mod upsampling;

use std::borrow::Cow;
use std::sync::OnceLock;

use crate::error::RecordError;
use crate::examination::hum::{Hum, hum, without_lines};
use crate::examination::noise::{noise, quantisation_step};
use crate::examination::saturation::{Saturation, limits};
use crate::examination::spikes::{Spike, spikes, without_spikes};
use crate::examination::swings::Swings;
use crate::record::Record;

/// Examination of a record, made once and asked by all.
///
/// Noise, resolution, spikes, swings and hum are worked out when they are first needed, and kept: the other findings
/// need them too.
///
/// ```
/// use fmm_record::{Crossing, Examination, Quantity, Record, Spike};
///
/// // 2.2 Hz, released at 0.5 s; a converter of 1 mm/s, an offset of 20 mm/s, and a knock at 3 s.
/// let motion = |t: f64| (-0.3 * t).exp() * (std::f64::consts::TAU * 2.2 * t).sin();
/// let velocity = |t: f64| 0.02 + if t > 0.5 { motion(t - 0.5) } else { 0.0 } + if t == 3.0 { 0.4 } else { 0.0 };
/// let values = (0..6000).map(|i| (1e3 * velocity(f64::from(i) * 1e-3)).round() / 1e3).collect();
/// let examination = Examination::of(Record::sampled(1000.0, values, Quantity::Velocity, "m/s")?);
///
/// let release = examination.release().expect("a record that begins at rest");
/// assert!((release.rest_end - 0.5).abs() < 2e-3 && (release.offset - 0.02).abs() < 1e-12);
/// assert!(matches!(examination.spikes(), [Spike { index: 3000, count: 1, .. }]));
/// let Crossing { time, is_rising, .. } = examination.swings().crossings()[0];
/// assert!((time - 0.5 - 0.5 / 2.2).abs() < 2e-3 && !is_rising);
/// assert!((examination.resolution().unwrap() - 1e-3).abs() < 1e-12);
/// assert!(examination.hum().is_empty() && examination.further_releases().is_empty());
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Examination<'a> {
    record: Cow<'a, Record>,
    noise: OnceLock<f64>,
    resolution: OnceLock<Option<f64>>,
    spikes: OnceLock<Vec<Spike>>,
    /// The record without its spikes, if it has some.
    bridged: OnceLock<Box<Examination<'static>>>,
    swings: OnceLock<Swings>,
    hum: OnceLock<Vec<Hum>>,
}

impl<'a> Examination<'a> {
    /// Examination of `record`, owned or borrowed, or of its motion at equal intervals
    /// ([`Record::equally_spaced`]).
    pub fn of(record: impl Into<Cow<'a, Record>>) -> Self {
        let record = record.into();
        let record = if record.is_equally_spaced() { record } else { Cow::Owned(record.resampled()) };
        Self {
            record,
            noise: OnceLock::new(),
            resolution: OnceLock::new(),
            spikes: OnceLock::new(),
            bridged: OnceLock::new(),
            swings: OnceLock::new(),
            hum: OnceLock::new(),
        }
    }

    /// The record.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The record without its examination.
    pub fn into_record(self) -> Record {
        self.record.into_owned()
    }

    /// Examination of the samples from `from` to `to` (s), as [`Record::crop`] takes them; this one if they are all.
    ///
    /// # Errors
    /// [`RecordError::Options`] if no sample lies there.
    pub fn crop(self, from: f64, to: f64) -> Result<Self, RecordError> {
        // Without a copy: a long record is held once.
        let is_whole = self.record.samples_within(from, to)?.len() == self.record.len();
        Ok(if is_whole { self } else { Self::of(self.record.crop(from, to)?) })
    }

    /// Standard deviation of the white noise, in the unit of the record ([`noise`]).
    pub fn noise(&self) -> f64 {
        *self.noise.get_or_init(|| noise(self.record.values()))
    }

    /// Step of the converter, in the unit of the record, if the values lie on a lattice ([`quantisation_step`]).
    pub fn resolution(&self) -> Option<f64> {
        *self.resolution.get_or_init(|| quantisation_step(self.record.values()))
    }

    /// Samples at the limits of the converter.
    pub fn saturation(&self) -> Option<Saturation> {
        limits(self.record.values(), self.noise(), self.step())
    }

    /// Spikes and drop-outs of one to three samples.
    pub fn spikes(&self) -> &[Spike] {
        self.spikes.get_or_init(|| spikes(self))
    }

    /// Half cycles: peaks, crossings, frequency.
    pub fn swings(&self) -> &Swings {
        self.swings.get_or_init(|| Swings::bridging(self, 0))
    }

    /// Lines of constant amplitude, the largest first.
    pub fn hum(&self) -> &[Hum] {
        self.hum.get_or_init(|| hum(self))
    }

    /// The record less its [`hum`](Self::hum): for looking at its motion. A fit is better served by the record as it
    /// was measured, with the lines among its parameters.
    pub fn without_hum(&self) -> Record {
        without_lines(&self.record, self.hum())
    }

    /// Relative change of the period (1) during the oscillation, if it is significant ([`Swings::period_change`]).
    pub fn period_change(&self) -> Option<f64> {
        let (times, heights) = self.swings().turns(self.record.quantity());
        Swings::period_change(&times, &heights)
    }

    /// Step of the converter, 0 if there is none.
    pub(crate) fn step(&self) -> f64 {
        self.resolution().unwrap_or(0.0)
    }

    /// This examination, or that of the record with its spikes bridged.
    pub(crate) fn bridged(&self) -> &Examination<'a> {
        if self.spikes().is_empty() {
            return self;
        }
        self.bridged.get_or_init(|| Box::new(Examination::of(without_spikes(self))))
    }
}
