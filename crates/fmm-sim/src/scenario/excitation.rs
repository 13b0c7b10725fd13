//! Excitation from outside: forces over time, a shaking base, a moving counterface.

use std::sync::Arc;

use fmm_model::{ModelError, Scalar};

use crate::error::SimulationError;

/// One cause of motion. Several can act on a [`Scenario`](crate::Scenario) together; their forces add up.
///
/// A release or a push is none of these: it is an initial state
/// ([`Scenario::starting_at`](crate::Scenario::starting_at)).
#[derive(Debug, Clone, PartialEq)]
pub struct Excitation<D = f64> {
    pub(crate) source: Source<D>,
    /// Delay of its start (s); zero for a source without a beginning.
    pub(crate) delay: D,
}

/// The mathematics of an excitation.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Source<D> {
    SampledForce { interval: f64, values: Arc<[D]> },
    HalfSine { peak: D, duration: D },
    Ramp { force: D, rate: D },
    Harmonic { amplitude: D, angular: D, phase: D },
    Base { amplitude: D, angular: D, phase: D },
    Belt { velocity: D },
}

impl<D: Scalar> Excitation<D> {
    fn of(source: Source<D>) -> Self {
        Self { source, delay: D::from(0.0) }
    }

    /// A measured force: `values` (N), one every `interval` (s) from t = 0 on, straight lines between them
    /// (first-order hold), and no force after the last.
    ///
    /// Values that are dual numbers carry their derivatives into the motion.
    ///
    /// Holding each value until the next instead would shift a hammer pulse by half an interval and lose part of its
    /// impulse.
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the interval is not positive or a value is not finite.
    pub fn sampled_force(interval: f64, values: impl Into<Arc<[D]>>) -> Result<Self, SimulationError> {
        let values = values.into();
        ModelError::require_positive("interval of the sampled force", interval, "s")?;
        for value in values.iter() {
            ModelError::require_finite("sampled force", value.value(), "N")?;
        }
        Ok(Self::of(Source::SampledForce { interval, values }))
    }

    /// A hammer impact, `peak` · sin(π t/`duration`) (N) for 0 ≤ t ≤ `duration` (s); its impulse is 2/π · peak ·
    /// duration.
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the peak is not finite or the duration not positive.
    pub fn half_sine(peak: D, duration: D) -> Result<Self, SimulationError> {
        ModelError::require_finite("peak force", peak.value(), "N")?;
        ModelError::require_positive("pulse duration", duration.value(), "s")?;
        Ok(Self::of(Source::HalfSine { peak, duration }))
    }

    /// A constant `force` (N): a weight on an incline, a bias, a spring that is prestressed.
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the force is not finite.
    pub fn constant(force: D) -> Result<Self, SimulationError> {
        ModelError::require_finite("constant force", force.value(), "N")?;
        Ok(Self::of(Source::Ramp { force, rate: D::from(0.0) }))
    }

    /// A force as a function of time. `force` gives it (N) at t = 0, `interval`, 2 `interval`, … up to `duration` (s).
    /// Between these times it is a straight line, with an error of up to `interval`²/8 times the curvature of the
    /// force; after the last there is no force.
    ///
    /// ```
    /// use fmm_friction::Coulomb;
    /// use fmm_model::Oscillator;
    /// use fmm_sim::{Excitation, Sampling, Scenario, simulate};
    ///
    /// // A sweep from 1 Hz upwards over 2 s.
    /// let sweep = Excitation::function(1e-4, 2.0, |t| 5.0 * (6.283 * t * (1.0 + t)).sin())?;
    /// let scenario = Scenario::new(Oscillator::new(1.0, 400.0)?, Coulomb::new(0.1)?, 10.0)?.driven_by(sweep);
    /// let motion = simulate(&scenario, &Sampling::uniform(1e-3, 2000)?)?;
    /// assert!(motion.half_cycles() > 5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] for an interval or a duration that is not positive or a value that is not finite,
    /// [`SimulationError::OutOfRange`] for more times than fit into memory.
    pub fn function(interval: f64, duration: f64, force: impl FnMut(f64) -> D) -> Result<Self, SimulationError> {
        ModelError::require_positive("interval of the force", interval, "s")?;
        ModelError::require_positive("duration of the force", duration, "s")?;
        let count = (duration / interval).round() as usize;
        let mut values = Vec::new();
        if values.try_reserve_exact(count.saturating_add(1)).is_err() {
            return Err(SimulationError::sampling(count, interval));
        }
        values.extend((0..=count).map(|index| index as f64 * interval).map(force));
        Self::sampled_force(interval, values)
    }

    /// A force that grows from zero by `rate` (N/s).
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the rate is not finite.
    pub fn ramp(rate: D) -> Result<Self, SimulationError> {
        ModelError::require_finite("rate of the force", rate.value(), "N/s")?;
        Ok(Self::of(Source::Ramp { force: D::from(0.0), rate }))
    }

    /// A harmonic force, `amplitude` · cos(`angular_frequency` t + `phase`) (N, rad/s, rad).
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if amplitude or phase is not finite or the frequency is negative.
    pub fn harmonic(amplitude: D, angular_frequency: D, phase: D) -> Result<Self, SimulationError> {
        ModelError::require_finite("force amplitude", amplitude.value(), "N")?;
        ModelError::require_not_negative("angular frequency", angular_frequency.value(), "rad/s")?;
        ModelError::require_finite("phase", phase.value(), "rad")?;
        Ok(Self::of(Source::Harmonic { amplitude, angular: angular_frequency, phase }))
    }

    /// A shaking base, displaced by `amplitude` · cos(`angular_frequency` t + `phase`) (m, rad/s, rad), to which both
    /// the spring and the counterface are fixed. Position and velocity of the scenario are then relative to the base,
    /// and the base acts through the inertial force −m b″.
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] in the cases of [`harmonic`](Self::harmonic).
    pub fn base(amplitude: D, angular_frequency: D, phase: D) -> Result<Self, SimulationError> {
        ModelError::require_finite("base amplitude", amplitude.value(), "m")?;
        ModelError::require_not_negative("angular frequency", angular_frequency.value(), "rad/s")?;
        ModelError::require_finite("phase", phase.value(), "rad")?;
        Ok(Self::of(Source::Base { amplitude, angular: angular_frequency, phase }))
    }

    /// A counterface that moves with `velocity` (m/s), such as a belt or a disc: friction opposes the motion relative
    /// to it.
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the velocity is not finite.
    pub fn belt(velocity: D) -> Result<Self, SimulationError> {
        ModelError::require_finite("belt velocity", velocity.value(), "m/s")?;
        Ok(Self::of(Source::Belt { velocity }))
    }

    /// This sampled or constant force, function, half sine or ramp, begun `delay` (s) later, with the derivatives of
    /// the delay. Harmonic motion and a belt have no beginning and stay unchanged.
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the delay is negative or not finite.
    pub fn delayed(mut self, delay: D) -> Result<Self, SimulationError> {
        ModelError::require_not_negative("delay", delay.value(), "s")?;
        self.delay = delay;
        Ok(self)
    }
}
