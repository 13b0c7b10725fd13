//! Friction against velocity from the rate at which the machine loses energy.

use fmm_model::Oscillator;
use fmm_record::{Quantity, Record, Smoothing, noise};

use crate::Found;

/// Energy rate and friction at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EnergyRate {
    /// v, velocity (m/s).
    pub(super) velocity: f64,
    /// dE/dt, rate of the stored energy (W).
    pub(super) rate: f64,
    /// F, friction force (N): positive if it opposes a positive velocity, as in the thesis' Fig. 16 and 17.
    pub(super) friction: f64,
}

/// The energy method of the thesis' chapter 6: friction as what is missing in the balance of energy rates.
///
/// ```text
/// dE/dt = m v a + k x v,     without contact = −F_c(v) v,     F = (without contact − dE/dt)/v      (thesis ch. 6)
/// ```
///
/// F_c is the damping force of the machine. Sorted by velocity, F is a friction curve. The velocity is smoothed and
/// differentiated for a, and integrated as it is from the initial position for x; it must have no offset, as 0.1 mm/s
/// of it is 0.1 mm of drift per second. Samples within 20 ms of either end of the record are left out.
///
/// The acceleration makes it noisy: white noise σ of the velocity becomes m σ/(√2 h) in each F, 7 N for 1 mm/s at 10 kg
/// and 1 kHz. The mean over all samples is as good as any other, but a pointwise F(v) needs smoothing, and long windows
/// are wrong near reversals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EnergyMethod {
    oscillator: Oscillator,
    initial_position: f64,
    smoothing: Smoothing,
    slowest: f64,
}

/// Energy rates of a record, sorted by velocity.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct EnergyRates {
    rates: Vec<EnergyRate>,
    noise: f64,
}

/// Time at either end of the record that is left out, as windows of a smoothing are one-sided there (s).
const MARGIN: f64 = 0.02;

impl EnergyMethod {
    /// For a machine that is at `initial_position` (m) at the first sample, for samples faster than `slowest` (m/s): F
    /// is a power divided by a speed.
    pub(super) fn new(oscillator: Oscillator, initial_position: f64, slowest: f64) -> Self {
        Self { oscillator, initial_position, smoothing: Smoothing::None, slowest }
    }

    /// Smooths the velocity before it is differentiated.
    pub(super) fn smoothed_by(self, smoothing: Smoothing) -> Self {
        Self { smoothing, ..self }
    }

    /// The energy rates in a velocity `record` that has no offset and ends with the motion.
    pub(super) fn rates(&self, record: &Record) -> Found<EnergyRates> {
        let acceleration = record.differentiate_smoothed_by(&self.smoothing)?;
        let position = record.integrate(self.initial_position)?;
        // Noise of F is that of m a; what reaches it through x is smaller by (ω h)².
        let gain = self.smoothing.slope_noise_gain()? / record.interval();
        let noise = noise(record.values()) * gain * self.oscillator.mass();
        Ok(EnergyRates { noise, ..self.rates_of_motion(record, position.values(), acceleration.values())? })
    }

    /// The energy rates of a motion whose position (m) and acceleration (m/s²) are known at each sample of `velocity`,
    /// such as a simulated one; neither smoothed nor differentiated.
    pub(super) fn rates_of_motion(
        &self,
        velocity: &Record,
        position: &[f64],
        acceleration: &[f64],
    ) -> Found<EnergyRates> {
        if velocity.quantity() != Quantity::Velocity {
            return Err(format!("the energy method needs a velocity, not: {}", velocity.quantity()).into());
        }
        if position.len().min(acceleration.len()) < velocity.len() {
            return Err("position and acceleration must have as many samples as the velocity".into());
        }
        let (from, to) = (velocity.start() + MARGIN, velocity.end() - MARGIN);
        let damping = self.oscillator.damping();
        let motion = velocity.times().zip(velocity.values()).zip(position).zip(acceleration);
        let mut rates: Vec<EnergyRate> = motion
            .filter(|(((time, v), _), _)| v.abs() > self.slowest && *time >= from && *time <= to)
            .map(|(((_, &v), &x), &a)| {
                let rate = v * (self.oscillator.mass() * a + self.oscillator.restoring_force(x));
                let without_contact = -v * damping.force(v);
                EnergyRate { velocity: v, rate, friction: (without_contact - rate) / v }
            })
            .collect();
        if rates.is_empty() {
            return Err(format!("no sample is faster than {} m/s", self.slowest).into());
        }
        rates.sort_by(|a, b| a.velocity.total_cmp(&b.velocity));
        Ok(EnergyRates { rates, noise: 0.0 })
    }
}

impl EnergyRates {
    /// One per sample, sorted by velocity.
    pub(super) fn points(&self) -> &[EnergyRate] {
        &self.rates
    }

    /// Mean of the friction force against the motion (N).
    pub(super) fn mean_friction(&self) -> f64 {
        self.rates.iter().map(EnergyRate::opposing).sum::<f64>() / self.rates.len() as f64
    }

    /// Standard deviation of a single friction force about the mean (N); 0 for one sample.
    pub(super) fn scatter(&self) -> f64 {
        let mean = self.mean_friction();
        let squares: f64 = self.rates.iter().map(|rate| (rate.opposing() - mean).powi(2)).sum();
        (squares / (self.rates.len() as f64 - 1.0).max(1.0)).sqrt()
    }

    /// Standard uncertainty of a single friction force (N) from the white noise of the record.
    pub(super) fn uncertainty(&self) -> f64 {
        self.noise
    }
}

impl EnergyRate {
    /// Friction force against the motion (N).
    fn opposing(&self) -> f64 {
        self.friction * self.velocity.signum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chapter_6_energy::{Example, SLOWEST, friction};
    use crate::ring_down::tests::close;
    use crate::ring_down::{INTERVAL, velocity_record, with_noise};

    fn method(example: &Example) -> EnergyMethod {
        EnergyMethod::new(*example.scenario.oscillator(), example.scenario.initial().position, SLOWEST)
    }

    /// Without noise 1.7500 N to 1e-4, and the law m σ/(√2 h) of the raw difference.
    #[test]
    fn clean_force_and_the_law_of_its_noise() {
        let example = Example::new().unwrap();
        let values = example.contact.velocity().values();
        let rates = |noise| method(&example).rates(&velocity_record(with_noise(values, noise, 1).unwrap()).unwrap());
        let clean = rates(0.0).unwrap();
        assert!((clean.mean_friction() - friction()).abs() < 1e-4, "{} N", clean.mean_friction());
        let law = example.scenario.oscillator().mass() * 1e-3 / (2f64.sqrt() * INTERVAL);
        close(rates(1e-3).unwrap().uncertainty(), law, 0.05, "m σ/(√2 h) (N)");
        // Sorted by velocity: negative friction for negative velocities, then positive.
        let points = clean.points();
        assert!(points.windows(2).all(|pair| pair[0].velocity <= pair[1].velocity));
        for point in [&points[0], &points[points.len() - 1]] {
            close(point.friction, friction() * point.velocity.signum(), 1e-3, "friction (N)");
        }
    }

    /// With position and acceleration of the model there is nothing to differentiate: 1.75 N to rounding.
    #[test]
    fn a_model_motion_has_its_friction_exactly() {
        let example = Example::new().unwrap();
        let oscillator = example.scenario.oscillator();
        let (x, v) = (example.contact.position().values(), example.contact.velocity().values());
        let force =
            |x: f64, v: f64| -(oscillator.restoring_force(x) + oscillator.damping_force(v) + friction() * v.signum());
        let acceleration: Vec<f64> = x.iter().zip(v).map(|(&x, &v)| force(x, v) / oscillator.mass()).collect();
        let velocity = velocity_record(v.to_vec()).unwrap();
        let rates = method(&example).rates_of_motion(&velocity, x, &acceleration).unwrap();
        assert!((rates.mean_friction() - friction()).abs() < 1e-12 && rates.scatter() < 1e-12, "{}", rates.scatter());
        assert!(method(&example).rates_of_motion(&velocity, x, &acceleration[1..]).is_err());
        let displacement = velocity.with_quantity(Quantity::Displacement);
        assert!(method(&example).rates_of_motion(&displacement, x, &acceleration).is_err());
    }
}
