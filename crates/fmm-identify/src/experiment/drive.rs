//! Drive of an experiment: the force or the motion of the base that was measured with the response.

use std::sync::Arc;

use fmm_fit::EvaluationError;
use fmm_model::{ModelError, Scalar};
use fmm_record::{Quantity, Record};
use fmm_sim::Excitation;

use crate::error::IdentifyError;

/// Drive of a machine during a record, measured on the same time axis.
///
/// Between its samples it is taken to be straight: sample it at ten times the highest frequency in it or more (an error
/// of (ωh)²/12 of a sine of ω rad/s with samples every h seconds).
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    record: Record,
    kind: Kind,
    gain_uncertainty: f64,
    pub(crate) calibration_uncertainty: f64,
    longest_delay: f64,
    pub(crate) delay_uncertainty: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Force,
    Base,
}

impl Drive {
    /// A measured force on the mass (N).
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`] unless the record is a force in N.
    pub fn force(record: &Record) -> Result<Self, IdentifyError> {
        if record.quantity() != Quantity::Force || record.unit() != "N" {
            let found = format!("{} in {}", record.quantity(), record.unit());
            return Err(IdentifyError::drive("a force in N", &found));
        }
        Ok(Self { kind: Kind::Force, ..Self::base_of(record) })
    }

    /// The measured motion of a base to which spring and counterface are fixed; best its acceleration. A velocity is
    /// differentiated once, a displacement twice, by central differences. The response is the motion relative to the
    /// base, in the same unit of length.
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`] for a record that is no motion, [`IdentifyError::Record`] for one too short to
    /// differentiate.
    pub fn base(record: &Record) -> Result<Self, IdentifyError> {
        let record = match record.quantity() {
            Quantity::Acceleration => record.clone(),
            Quantity::Velocity => record.differentiate()?,
            Quantity::Displacement => record.differentiate()?.differentiate()?,
            other => {
                let found = format!("{other} in {}", record.unit());
                return Err(IdentifyError::drive("an acceleration, a velocity or a displacement", &found));
            }
        };
        Ok(Self::base_of(&record))
    }

    /// The motion of a base that is read without error.
    fn base_of(record: &Record) -> Self {
        let record = record.equally_spaced().into_owned();
        let (gain_uncertainty, calibration_uncertainty) = (0.0, 0.0);
        let (longest_delay, delay_uncertainty) = (0.0, None);
        Self { record, kind: Kind::Base, gain_uncertainty, calibration_uncertainty, longest_delay, delay_uncertainty }
    }

    /// The same read by a channel of this relative standard uncertainty (1). Its gain, what it reads by what acts, is
    /// fitted with that knowledge: a force beside a mass or a stiffness that is known, and a base always, tell more.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] for one that is negative or not finite.
    pub fn with_gain_uncertainty(self, uncertainty: f64) -> Result<Self, IdentifyError> {
        let gain_uncertainty =
            ModelError::require_not_negative("uncertainty of the gain of a drive", uncertainty, "1")?;
        Ok(Self { gain_uncertainty, ..self })
    }

    /// The same with a calibration of this relative standard uncertainty (1) that it shares with the drives of all
    /// other experiments, as the impacts of one hammer do.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] for one that is negative or not finite.
    pub fn with_calibration_uncertainty(self, uncertainty: f64) -> Result<Self, IdentifyError> {
        let calibration_uncertainty =
            ModelError::require_not_negative("uncertainty of the calibration of a drive", uncertainty, "1")?;
        Ok(Self { calibration_uncertainty, ..self })
    }

    /// The same with a response that is up to `longest` (s) late or early, by a delay that is fitted. One that is known
    /// is that of the [`Sensor`](crate::Sensor).
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] for one that is negative or not finite, [`IdentifyError::OutOfRange`] for one
    /// longer than the record of the drive.
    pub fn with_free_delay(self, longest: f64) -> Result<Self, IdentifyError> {
        let longest_delay = ModelError::require_not_negative("longest delay of a response", longest, "s")?;
        self.require_delay(longest_delay)?;
        Ok(Self { longest_delay, ..self })
    }

    /// The same with a delay of this standard uncertainty (s) about none, where one is fitted.
    pub(crate) fn with_delay_uncertainty(self, uncertainty: f64) -> Self {
        Self { delay_uncertainty: Some(uncertainty).filter(|u| *u > 0.0), ..self }
    }

    /// Refuses a response that is later by `delay` (s) than the drive lasts.
    pub(crate) fn require_delay(&self, delay: f64) -> Result<(), IdentifyError> {
        if delay <= self.record.duration() {
            return Ok(());
        }
        let subject = "the delay (s) of the response to a drive";
        Err(IdentifyError::not_allowed(subject, delay, "no longer than the record of the drive"))
    }

    /// Relative standard uncertainty of the gain of its channel (1), its calibration included.
    pub fn gain_uncertainty(&self) -> f64 {
        self.gain_uncertainty.hypot(self.calibration_uncertainty)
    }

    /// The longest delay (s) that is fitted; 0 if none is.
    pub fn longest_delay(&self) -> f64 {
        self.longest_delay
    }

    /// The record of the drive: of a base its acceleration.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// True if it is a force, which moves a mass according to how heavy it is.
    pub(crate) fn is_force(&self) -> bool {
        self.kind == Kind::Force
    }

    /// Refuses a drive that is not known from `start` to `end` (s).
    pub(crate) fn require_within(&self, start: f64, end: f64) -> Result<(), IdentifyError> {
        let slack = 1e-6 * self.record.interval();
        // A drive that has come to zero stays there.
        let has_ended = self.record.values().last().is_some_and(|value| *value == 0.0);
        if self.record.start() > start + slack || self.record.end() < end - slack && !has_ended {
            let (known_from, known_to) = (self.record.start(), self.record.end());
            return Err(IdentifyError::not_seen(format!(
                "the drive is known from {known_from} s to {known_to} s, but the response lasts from {start} s to \
                 {end} s; crop the response"
            )));
        }
        Ok(())
    }

    /// Its values from `start` (s) on, one every interval of its record, for a response that is `delay` (s) late:
    /// forces in N, or the acceleration of the base with its sign reversed, which is the force on a unit of mass.
    pub(crate) fn values_from<D: Scalar>(&self, start: f64, delay: D) -> Vec<D> {
        /// Samples on one grid differ by rounding.
        const ON_GRID: f64 = 1e-6;
        let values = self.record.values();
        let interval = self.record.interval();
        let place = D::from((start - self.record.start()) / interval) - delay / interval;
        let first = (place.value() + ON_GRID).floor();
        let mut share = place - first;
        if share.value() < ON_GRID {
            share -= share.value();
        }
        let sign = if self.is_force() { 1.0 } else { -1.0 };
        let last = values.len() - 1;
        // Before its first sample and after its last it is what it is there.
        let at = |index: f64| sign * values[index.clamp(0.0, last as f64) as usize];
        let count = (last as f64 - first).max(0.0) as usize;
        let between = |step: usize| {
            let index = first + step as f64;
            share * (at(index + 1.0) - at(index)) + at(index)
        };
        (0..=count).map(between).collect()
    }

    /// The excitation of a motion that begins at `start` (s), in units of `per` times that of the drive.
    pub(crate) fn excitation<D: Scalar>(&self, start: f64, delay: D, per: D) -> Result<Excitation<D>, EvaluationError> {
        let values: Arc<[D]> = self.values_from(start, delay).into_iter().map(|value| value * per).collect();
        Ok(Excitation::sampled_force(self.record.interval(), values)?)
    }
}

#[cfg(test)]
mod tests {
    use fmm_model::Dual;

    use super::*;

    #[test]
    fn a_late_response_is_one_to_a_late_drive() {
        let record = Record::new(2.0, 0.1, vec![0.0, 1.0, 4.0, 9.0, 16.0], Quantity::Force, "N").unwrap();
        let drive = Drive::force(&record).unwrap();
        // Response from 2.2 s on, on the grid of the drive to rounding.
        assert_eq!(drive.values_from(2.2 - 1e-12, 0.0), [4.0, 9.0, 16.0]);
        let late = drive.values_from(2.2, Dual::<1>::variable(0.025, 0));
        for (value, (wanted, slope)) in late.iter().zip([(3.25, -30.0), (7.75, -50.0), (14.25, -70.0), (16.0, 0.0)]) {
            assert!((value.value() - wanted).abs() < 1e-12 && (value.partial(0) - slope).abs() < 1e-9, "{value:?}");
        }
        // Before its beginning a drive is what it was there, and so is it after its end.
        assert_eq!(drive.values_from(1.9, 0.0)[..3], [0.0, 0.0, 1.0]);
        assert_eq!(drive.values_from(2.4, -0.3), [16.0]);
    }
}
