//! Planned test: an experiment that may be made.

use fmm_model::ModelError;
use fmm_record::{Quantity, Record};

use crate::error::IdentifyError;
use crate::machine::Known;

/// A test that may be made: its motion, its load, added mass or stiffness, and its sensor.
///
/// ```
/// use fmm_identify::design::{PlannedSensor, PlannedTest};
/// use fmm_identify::Known;
/// use fmm_record::Quantity;
///
/// let sensor = PlannedSensor::new(Quantity::Velocity, 1e-4)?;
/// let test = PlannedTest::release(0.022, sensor, 1000.0, 2.0)?.under_load(Known::exact(7.0)?)?.costing(3.0)?;
/// assert_eq!((test.cost(), test.samples()), (3.0, 2000));
/// # Ok::<(), fmm_identify::IdentifyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedTest {
    name: String,
    pub(crate) motion: Motion,
    pub(crate) sensor: PlannedSensor,
    rate: f64,
    samples: usize,
    pub(crate) load: Load,
    pub(crate) added_mass: Option<Known>,
    pub(crate) added_stiffness: Option<Known>,
    pub(crate) fits_offset: bool,
    cost: f64,
}

/// Motion of the machine in a test.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Motion {
    /// Let go at this position.
    Released(f64),
    /// Pushed by this force from rest on, with a force channel of this relative uncertainty.
    Pushed(Record, f64),
    /// Hit by this force at rest, at a time that is known to a sample.
    Impact(Record),
    /// Carried by this motion of the base from rest on.
    Carried(Record),
}

/// The load on the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Load {
    /// The load of the machine.
    OfMachine,
    /// Another, with an error of its setup.
    Other(Known),
    /// The contact is lifted.
    None,
}

/// Sensor of a test: its quantity, the standard deviation of its white noise, and the uncertainty of its gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannedSensor {
    quantity: Quantity,
    noise: f64,
    gain_uncertainty: f64,
}

/// Least noise of a sensor, in its unit: information grows with the square of its inverse and must stay finite.
const LEAST_NOISE: f64 = 1e-100;
/// Most samples of a test (1).
const MOST_SAMPLES: f64 = 1e7;

impl PlannedSensor {
    /// A sensor of displacement, velocity or acceleration, with white `noise` of this standard deviation (m, m/s, m/s²,
    /// or in the length of the [`Guess`](super::Guess)).
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`] for another quantity, [`IdentifyError::InvalidInput`] for a noise that is not
    /// positive, [`IdentifyError::OutOfRange`] for one below 1e-100.
    pub fn new(quantity: Quantity, noise: f64) -> Result<Self, IdentifyError> {
        if !matches!(quantity, Quantity::Displacement | Quantity::Velocity | Quantity::Acceleration) {
            let needed = "displacement, velocity or acceleration";
            return Err(IdentifyError::wrong_quantity("the quantity of a planned sensor", needed, quantity));
        }
        let noise = ModelError::require_positive("noise of a planned sensor", noise, "(in the unit of its quantity)")?;
        if noise < LEAST_NOISE {
            return Err(IdentifyError::not_allowed("noise of a planned sensor", noise, "1e-100 or more"));
        }
        Ok(Self { quantity, noise, gain_uncertainty: 0.0 })
    }

    /// The same with a gain of this relative standard uncertainty (1). All tests by equal sensors have the same error
    /// of the gain.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] for one that is negative or not finite.
    pub fn with_gain_uncertainty(self, relative: f64) -> Result<Self, IdentifyError> {
        let gain_uncertainty = ModelError::require_not_negative("gain uncertainty", relative, "")?;
        Ok(Self { gain_uncertainty, ..self })
    }

    /// Its quantity.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// Standard deviation of its white noise, in the unit of the quantity.
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// Relative standard uncertainty of its gain (1).
    pub fn gain_uncertainty(&self) -> f64 {
        self.gain_uncertainty
    }
}

impl PlannedTest {
    /// The machine is let go at rest at `position` (m, or the length of the [`Guess`](super::Guess)) and recorded
    /// `rate` times a second for `duration` (s).
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] and [`IdentifyError::OutOfRange`] for numbers that cannot be.
    pub fn release(position: f64, sensor: PlannedSensor, rate: f64, duration: f64) -> Result<Self, IdentifyError> {
        let position = ModelError::require_finite("position of a release", position, "m")?;
        Self::of(format!("release at {position} m"), Motion::Released(position), sensor, rate, duration)
    }

    /// An impact of half a sine, `peak` (N) high and `pulse` (s) long, on the machine at rest, and the response from
    /// its beginning on.
    ///
    /// # Errors
    /// Those of [`release`](Self::release), and for a pulse of fewer than four samples.
    pub fn impact(
        peak: f64,
        pulse: f64,
        sensor: PlannedSensor,
        rate: f64,
        duration: f64,
    ) -> Result<Self, IdentifyError> {
        let peak = ModelError::require_finite("peak of an impact", peak, "N")?;
        let pulse = ModelError::require_positive("duration of an impact", pulse, "s")?;
        if !(pulse * rate >= 4.0) {
            return Err(IdentifyError::not_allowed("samples in an impact", pulse * rate, "4 or more"));
        }
        let half_sine = |time: f64| if time < pulse { peak * (std::f64::consts::PI * time / pulse).sin() } else { 0.0 };
        let force = sampled(rate, duration, half_sine)?;
        Self::of(format!("impact of {peak} N"), Motion::Impact(force), sensor, rate, duration)
    }

    /// A `force` (N) that is measured with a channel of this relative standard `uncertainty` (1) pushes the machine at
    /// rest; the response is recorded `rate` times a second from its beginning to its end.
    ///
    /// # Errors
    /// Those of [`release`](Self::release), and [`IdentifyError::WrongRecord`] unless it is a force in N.
    pub fn pushed(force: &Record, uncertainty: f64, sensor: PlannedSensor, rate: f64) -> Result<Self, IdentifyError> {
        crate::experiment::Drive::force(force)?.with_gain_uncertainty(uncertainty)?;
        let duration = force.duration();
        let name = format!("force for {duration} s");
        Self::of(name, Motion::Pushed(force.clone(), uncertainty), sensor, rate, duration)
    }

    /// A measured motion of the `base` carries the machine, which is at rest in the beginning; the response is recorded
    /// `rate` times a second from its beginning to its end.
    ///
    /// # Errors
    /// Those of [`release`](Self::release), and [`IdentifyError::WrongRecord`] for a record that is no motion.
    pub fn carried(base: &Record, sensor: PlannedSensor, rate: f64) -> Result<Self, IdentifyError> {
        crate::experiment::Drive::base(base)?;
        let duration = base.duration();
        Self::of(format!("moving base for {duration} s"), Motion::Carried(base.clone()), sensor, rate, duration)
    }

    fn of(
        name: String,
        motion: Motion,
        sensor: PlannedSensor,
        rate: f64,
        duration: f64,
    ) -> Result<Self, IdentifyError> {
        ModelError::require_positive("sampling rate", rate, "Hz")?;
        ModelError::require_positive("duration of a test", duration, "s")?;
        let samples = (rate * duration * (1.0 + 1e-9)).floor();
        if !(16.0..=MOST_SAMPLES).contains(&samples) {
            return Err(IdentifyError::not_allowed("samples of a test", samples, "16 to 10 million"));
        }
        Ok(Self {
            name,
            motion,
            sensor,
            rate,
            samples: samples as usize,
            load: Load::OfMachine,
            added_mass: None,
            added_stiffness: None,
            fits_offset: true,
            cost: 1.0,
        })
    }

    /// Puts it under another normal load (N) than that of the machine. All tests under equal loads have the same
    /// error, beside that of the machine's load, which all tests have; tests under different loads have errors of their
    /// own.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] unless the load is positive.
    pub fn under_load(self, load: Known) -> Result<Self, IdentifyError> {
        ModelError::require_positive("normal load of a test", load.value(), "N")?;
        Ok(Self { load: Load::Other(load), ..self })
    }

    /// Lifts the contact.
    #[must_use]
    pub fn without_contact(self) -> Self {
        Self { load: Load::None, ..self }
    }

    /// Adds a `mass` (kg) to the machine. All tests with equal masses have the same error.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] for a mass that is negative.
    pub fn with_added_mass(self, mass: Known) -> Result<Self, IdentifyError> {
        ModelError::require_not_negative("added mass", mass.value(), "kg")?;
        Ok(Self { added_mass: Some(mass).filter(|mass| *mass != Known::NOTHING), ..self })
    }

    /// Adds a linear spring of this `stiffness` (N/m) beside that of the machine. All tests with equal springs
    /// have the same error.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] for a stiffness that is negative.
    pub fn with_added_stiffness(self, stiffness: Known) -> Result<Self, IdentifyError> {
        ModelError::require_not_negative("added stiffness", stiffness.value(), "N/m")?;
        Ok(Self { added_stiffness: Some(stiffness).filter(|stiffness| *stiffness != Known::NOTHING), ..self })
    }

    /// Declares the offset of the record as zero; otherwise it is fitted.
    #[must_use]
    pub fn without_offset(self) -> Self {
        Self { fits_offset: false, ..self }
    }

    /// Sets the cost, in any unit; 1 by default.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] unless it is positive.
    pub fn costing(self, cost: f64) -> Result<Self, IdentifyError> {
        Ok(Self { cost: ModelError::require_positive("cost of a test", cost, "")?, ..self })
    }

    /// Sets the name.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// Its name; by default its motion with the size.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its cost.
    pub fn cost(&self) -> f64 {
        self.cost
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Its sampling rate (Hz).
    pub fn rate(&self) -> f64 {
        self.rate
    }
}

/// A force in N, sampled `rate` times a second.
fn sampled(rate: f64, duration: f64, force: impl Fn(f64) -> f64) -> Result<Record, IdentifyError> {
    ModelError::require_positive("sampling rate", rate, "Hz")?;
    let count = rate * duration;
    if !(count <= MOST_SAMPLES) {
        return Err(IdentifyError::not_allowed("samples of a test", count, "16 to 10 million"));
    }
    let values = (0..=count.ceil() as usize).map(|i| force(i as f64 / rate)).collect();
    Ok(Record::sampled(rate, values, Quantity::Force, "N")?)
}
