//! Friction against velocity from the rate at which the machine loses energy.

use fmm_model::{ModelError, Oscillator};
use fmm_record::{Quantity, Record, RecordError, Smoothing, noise};

use crate::error::IdentifyError;

/// Energy rate and friction at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EnergyRate {
    /// Time (s).
    pub time: f64,
    /// v, velocity (m/s).
    pub velocity: f64,
    /// dE/dt, rate of the stored energy (W).
    pub rate: f64,
    /// What it would be at this velocity without the contact (W).
    pub rate_without_contact: f64,
    /// F, friction force (N): positive if it opposes a positive velocity, as in the thesis' Fig. 16 and 17.
    pub friction: f64,
}

/// The energy method of the thesis' chapter 6: friction as what is missing in the balance of energy rates.
///
/// ```text
/// dE/dt = m v a + k x v,     without contact = −F_c(v) v,     F = (without contact − dE/dt)/v      (thesis ch. 6)
/// ```
///
/// with F_c the damping force of the machine. Sorted by velocity, F is a friction curve. Everything about the machine
/// must be known; per unit mass ([`Oscillator::per_unit_mass`]) F is F/m. The velocity is smoothed and differentiated
/// for a, and integrated as it is from the initial position for x; it must have no offset, as 0.1 mm/s of it is 0.1 mm
/// of drift per second.
///
/// The acceleration makes it noisy: white noise σ of the velocity becomes m σ/(√2 h) in each F, 7 N for 1 mm/s at 10 kg
/// and 1 kHz. The mean over all samples is as good as any other, but a pointwise F(v) needs smoothing, and long windows
/// are wrong near reversals. [`WeakForm`](crate::WeakForm) has neither trouble.
///
/// ```
/// use fmm_friction::Coulomb;
/// use fmm_identify::EnergyMethod;
/// use fmm_model::{Damping, Oscillator};
/// use fmm_record::{Quantity, Record};
/// use fmm_sim::{Engine, Exact, Sampling, Scenario};
///
/// let machine = Oscillator::new(10.391, 1982.0)?.with_damping(Damping::linear(0.275)?);
/// let scenario = Scenario::new(machine, Coulomb::new(0.25)?, 7.0)?.starting_at(0.01, 0.0)?;
/// let motion = Exact.run(&scenario, &Sampling::uniform(1e-3, 1365)?)?;
/// let record = Record::new(0.0, 1e-3, motion.velocity().values().to_vec(), Quantity::Velocity, "m/s")?;
///
/// let rates = EnergyMethod::new(machine, 0.01)?.above(0.02)?.rates(&record)?;
/// assert!((rates.mean_friction() - 1.75).abs() < 1e-3);
/// assert!(rates.scatter() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct EnergyMethod {
    oscillator: Oscillator,
    initial_position: f64,
    smoothing: Smoothing,
    slowest: f64,
    margin: f64,
}

/// Energy rates of a record, sorted by velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct EnergyRates {
    rates: Vec<EnergyRate>,
    noise: f64,
}

impl EnergyMethod {
    /// For a machine that is at `initial_position` (m) at the first sample. Nothing is smoothed, samples below a tenth
    /// of the highest speed are left out, and those within 20 ms of either end of the record.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`].
    pub fn new(oscillator: Oscillator, initial_position: f64) -> Result<Self, ModelError> {
        let initial_position = ModelError::require_finite("initial position", initial_position, "m")?;
        Ok(Self { oscillator, initial_position, smoothing: Smoothing::None, slowest: f64::NAN, margin: 0.02 })
    }

    /// Smooths the velocity before it is differentiated.
    #[must_use]
    pub fn smoothed_by(mut self, smoothing: Smoothing) -> Self {
        self.smoothing = smoothing;
        self
    }

    /// Leaves out samples not faster than this (m/s): F is a power divided by a speed.
    ///
    /// # Errors
    /// [`ModelError::Negative`].
    pub fn above(mut self, speed: f64) -> Result<Self, ModelError> {
        self.slowest = ModelError::require_not_negative("slowest speed", speed, "m/s")?;
        Ok(self)
    }

    /// Leaves out what lies within this time (s) of an end of the record, where windows are one-sided.
    ///
    /// # Errors
    /// [`ModelError::Negative`].
    pub fn with_margin(mut self, time: f64) -> Result<Self, ModelError> {
        self.margin = ModelError::require_not_negative("margin", time, "s")?;
        Ok(self)
    }

    /// The energy rates in a velocity `record` that has no offset and ends with the motion.
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`], [`IdentifyError::TooFew`] if no sample is left, [`IdentifyError::Record`] if
    /// the smoothing does not fit the record.
    pub fn rates(&self, record: &Record) -> Result<EnergyRates, IdentifyError> {
        let quantity = record.quantity();
        if quantity != Quantity::Velocity {
            return Err(IdentifyError::velocity_needed("the energy method", quantity));
        }
        let span = self.smoothing.span();
        if span > record.len() {
            let operation = "smoothing of this span";
            return Err(RecordError::TooShort { operation, needed: span, length: record.len() }.into());
        }
        let acceleration = record.differentiate_smoothed_by(&self.smoothing)?;
        let position = record.integrate(self.initial_position)?;
        // Noise of F is that of m a; what reaches it through x is smaller by (ω h)².
        let gain = self.smoothing.slope_noise_gain()? / record.interval();
        let noise = noise(record.values()) * gain * self.oscillator.mass();
        self.rates_of(record, position.values(), acceleration.values(), noise)
    }

    /// The energy rates of a motion whose position (m) and acceleration (m/s²) are known at each sample of `velocity`,
    /// such as a simulated one; neither smoothed nor differentiated.
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`], [`IdentifyError::TooFew`] if no sample is left or the other two have
    /// fewer samples.
    pub fn rates_of_motion(
        &self,
        velocity: &Record,
        position: &[f64],
        acceleration: &[f64],
    ) -> Result<EnergyRates, IdentifyError> {
        let quantity = velocity.quantity();
        if quantity != Quantity::Velocity {
            return Err(IdentifyError::velocity_needed("the energy method", quantity));
        }
        let samples = position.len().min(acceleration.len());
        if samples < velocity.len() {
            return Err(IdentifyError::too_short(samples, velocity.len()));
        }
        self.rates_of(velocity, position, acceleration, 0.0)
    }

    fn rates_of(
        &self,
        velocity: &Record,
        position: &[f64],
        acceleration: &[f64],
        noise: f64,
    ) -> Result<EnergyRates, IdentifyError> {
        const SHARE: f64 = 0.1;
        let fastest = velocity.values().iter().fold(0.0f64, |fastest, v| fastest.max(v.abs()));
        let slowest = if self.slowest.is_nan() { SHARE * fastest } else { self.slowest };
        let (from, to) = (velocity.start() + self.margin, velocity.end() - self.margin);
        let damping = self.oscillator.damping();
        let motion = velocity.times().zip(velocity.values()).zip(position).zip(acceleration);
        let mut rates: Vec<EnergyRate> = motion
            .filter(|(((time, v), _), _)| v.abs() > slowest && *time >= from && *time <= to)
            .map(|(((time, &v), &x), &a)| {
                let rate = v * (self.oscillator.mass() * a + self.oscillator.restoring_force(x));
                let rate_without_contact = -v * damping.force(v);
                EnergyRate {
                    time,
                    velocity: v,
                    rate,
                    rate_without_contact,
                    friction: (rate_without_contact - rate) / v,
                }
            })
            .collect();
        if rates.is_empty() {
            return Err(IdentifyError::too_short(0, 1));
        }
        rates.sort_by(|a, b| a.velocity.total_cmp(&b.velocity));
        Ok(EnergyRates { rates, noise })
    }
}

impl EnergyRates {
    /// One per sample, sorted by velocity.
    pub fn points(&self) -> &[EnergyRate] {
        &self.rates
    }

    /// Mean of the friction force against the motion (N).
    pub fn mean_friction(&self) -> f64 {
        self.rates.iter().map(EnergyRate::opposing).sum::<f64>() / self.rates.len() as f64
    }

    /// Standard deviation of a single friction force about the mean (N); 0 for one sample.
    pub fn scatter(&self) -> f64 {
        let mean = self.mean_friction();
        let squares: f64 = self.rates.iter().map(|rate| (rate.opposing() - mean).powi(2)).sum();
        (squares / (self.rates.len() as f64 - 1.0).max(1.0)).sqrt()
    }

    /// Standard uncertainty of a single friction force (N) from the white noise of the record.
    pub fn uncertainty(&self) -> f64 {
        self.noise
    }
}

impl EnergyRate {
    /// Friction force against the motion (N).
    fn opposing(&self) -> f64 {
        self.friction * self.velocity.signum()
    }
}
