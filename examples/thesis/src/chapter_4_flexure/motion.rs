//! A free vibration of the machine and the motion across it.

use fmm_friction::Coulomb;
use fmm_model::{Damping, Flexure, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, RungeKutta, Sampling, Scenario};

use crate::{Found, printed};

/// Sampling frequency of the thesis (Hz).
const RATE: f64 = 1000.0;

/// Velocity that the vibrometer would record after a release, and what the flexure makes of it.
pub(super) struct FreeVibration {
    /// Velocity along x (m/s).
    pub(super) velocity: Record,
    /// Position along x (m), the integral of the velocity.
    pub(super) position: Record,
    /// Position along y (m) by Eq. 4.3.
    pub(super) parasitic: Record,
    /// Velocity along y (m/s), the derivative of that.
    pub(super) parasitic_velocity: Record,
    /// Speed along the path (m/s), with the sign of the velocity along x.
    pub(super) resultant: Record,
    /// The largest difference between the derivative above and the formula for the parasitic velocity (m/s).
    pub(super) worst_derivative: f64,
}

impl FreeVibration {
    /// The machine of Table 2 with the damping of Eq. 5.5, let go at `displacement` (m) and recorded for `duration`
    /// (s); the record is integrated and differentiated as section 4.2 does it.
    pub(super) fn of(flexure: &Flexure, displacement: f64, duration: f64) -> Found<Self> {
        let [mass, stiffness, _] = printed::MACHINE;
        let [slope, intercept, _] = printed::EQUATION_5_5;
        let damping = Damping::from_peak_velocity_line(intercept, slope)?;
        let machine = Oscillator::new(mass, stiffness)?.with_damping(damping);
        let scenario = Scenario::new(machine, Coulomb::new(0.0)?, 0.0)?.starting_at(displacement, 0.0)?;
        let sampling = Sampling::uniform(RATE.recip(), (duration * RATE) as usize + 1)?;
        let motion = RungeKutta::default().run(&scenario, &sampling)?;

        let record = |values, quantity, unit| Record::sampled(RATE, values, quantity, unit);
        let velocity = record(motion.velocity().values().to_vec(), Quantity::Velocity, "m/s")?;
        let position = velocity.integrate(displacement)?;
        let across = position.values().iter().map(|&x| flexure.parasitic_motion(x)).collect();
        let parasitic = record(across, Quantity::Displacement, "m")?;
        let parasitic_velocity = parasitic.differentiate()?;
        let resultant = velocity.values().iter().zip(position.values());
        let resultant = resultant.map(|(&v, &x)| flexure.resultant_speed(x, v).copysign(v)).collect();
        let resultant = record(resultant, Quantity::Velocity, "m/s")?;

        let states = position.values().iter().zip(velocity.values()).zip(parasitic_velocity.values());
        let worst_derivative =
            states.map(|((&x, &v), &across)| (across - flexure.parasitic_velocity(x, v)).abs()).fold(0.0, f64::max);
        Ok(Self { velocity, position, parasitic, parasitic_velocity, resultant, worst_derivative })
    }

    /// How much the resultant exceeds the velocity along x (m/s), sample by sample.
    pub(super) fn excess(&self) -> Vec<f64> {
        let both = self.resultant.values().iter().zip(self.velocity.values());
        both.map(|(resultant, velocity)| resultant.abs() - velocity.abs()).collect()
    }

    /// The excess (m/s) at the largest velocity along x.
    pub(super) fn excess_at_peak(&self) -> f64 {
        let fastest = self.velocity.values().iter().zip(self.excess()).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        fastest.map_or(f64::NAN, |(_, excess)| excess)
    }
}

/// The largest magnitude of `values`.
pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
}
