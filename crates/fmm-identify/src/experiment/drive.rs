//! Drive of an experiment: the force or the motion of the base that was measured with the response.

use std::sync::Arc;

use fmm_fit::EvaluationError;
use fmm_model::Scalar;
use fmm_record::{Quantity, Record};
use fmm_sim::Excitation;

use crate::IdentifyError;

/// What drives a machine during a record, measured on the same time axis.
///
/// Between its samples it is taken to be straight: sample it at ten times the highest frequency in it or more (an error of
/// (ωh)²/12 of a sine of ω rad/s with samples every h seconds).
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    record: Record,
    kind: Kind,
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
        Ok(Self { record: record.clone(), kind: Kind::Force })
    }

    /// The measured motion of a base to which spring and counterface are fixed; best its acceleration. A velocity is differentiated
    /// once, a displacement twice, by central differences. The response is the motion relative to the base, in the same unit of length.
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`] for a record that is no motion, [`IdentifyError::Record`] for one too short to differentiate.
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
        Ok(Self { record, kind: Kind::Base })
    }

    /// The record of the drive: of a base its acceleration.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Whether it is a force, which moves a mass according to how heavy it is.
    pub(crate) fn is_force(&self) -> bool {
        self.kind == Kind::Force
    }

    /// That the drive is known from `start` to `end` (s).
    pub(crate) fn require_within(&self, start: f64, end: f64) -> Result<(), IdentifyError> {
        let slack = 1e-6 * self.record.interval();
        if self.record.start() > start + slack || self.record.end() < end - slack {
            let (known_from, known_to) = (self.record.start(), self.record.end());
            return Err(IdentifyError::not_seen(format!(
                "the drive is known from {known_from} s to {known_to} s, but the response lasts from {start} s to {end} s; crop the response"
            )));
        }
        Ok(())
    }

    /// Its values from `start` (s) on, one every interval of its record: forces in N, or the acceleration of the base with its sign
    /// reversed, which is the force on a unit of mass.
    pub(crate) fn values_from(&self, start: f64) -> Vec<f64> {
        let values = self.record.values();
        let place = ((start - self.record.start()) / self.record.interval()).max(0.0);
        let (first, mut share) = (place.floor() as usize, place.fract());
        // Samples on one grid differ by rounding.
        if share < 1e-6 {
            share = 0.0;
        }
        let (first, share) = if share > 1.0 - 1e-6 { (first + 1, 0.0) } else { (first, share) };
        let sign = if self.is_force() { 1.0 } else { -1.0 };
        let at = |index: usize| {
            let after = values.get(index + 1).copied().unwrap_or(values[index]);
            sign * (values[index] + share * (after - values[index]))
        };
        (first.min(values.len() - 1)..values.len()).map(at).collect()
    }

    /// The excitation of a motion that begins with the first of `values`, each times `factor`.
    pub(crate) fn excitation<D: Scalar>(&self, values: &[f64], factor: D) -> Result<Excitation<D>, EvaluationError> {
        let values: Arc<[D]> = values.iter().map(|value| factor * *value).collect();
        Ok(Excitation::sampled_force(self.record.interval(), values)?)
    }
}
