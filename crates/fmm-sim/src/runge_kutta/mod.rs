//! The Runge-Kutta engine: any law of the sliding speed, any machine, any force, to a tolerance.

mod by_speed;
mod corner;
mod field;
mod slide;
mod step;
#[cfg(test)]
mod tests;

use fmm_friction::SlidingLaw;
use fmm_model::{Restoring, Scalar};

use crate::automaton::Contact;
use crate::error::SimulationError;
use crate::mechanics::{Forcing, Sliding};
use crate::runge_kutta::slide::Integrator;
use crate::scenario::{Sampling, Scenario};
use crate::trajectory::{Engine, Recorder, Trajectory};

/// Integrates each stretch of sliding with the Dormand-Prince method of order 8, stops included to full accuracy.
///
/// ```text
/// m x″ = f(t) − F_c(x′) − F_k(x) − s N μ(|x′ − v_b|),   s constant from event to event
/// ```
///
/// Within a stretch the right-hand side is smooth, so the method keeps its order; it never steps over a change of sign.
/// A step whose polynomial reaches zero relative velocity anywhere, turning points within the step included, is taken
/// again to end there, by Newton's method on its length: the landing is as accurate as a step and not as the
/// interpolant. In stick nothing is integrated; breakaway is found on the load itself, without missing a peak.
///
/// Samples come from the interpolant of order 7. The steps do not depend on them, so that more samples change nothing.
/// Accelerations are the right-hand side at these samples: good to 3e-13 of the largest where the law is smooth, to
/// 2e-12 with a slope that is infinite at rest (1e-9 at a tolerance of 1e-10).
///
/// `tolerance` bounds the local error of a step relative to the amplitude of the motion. An acceleration within
/// rounding of the forces counts as zero where its sign decides the branch of the law.
///
/// At a dual number the steps are those of the plain number, and derivatives include the change of event times. Their
/// own error is watched: in a step in which a steep law parts neighbouring motions, they are found with the speed as
/// the independent variable, so that an infinite slope at rest costs nothing. Where friction jumps at the speed of a
/// dead zone ([`Karnopp`](fmm_friction::Karnopp)), a step ends and the derivatives jump with it. The measured relative
/// error of derivatives is 1e-8 (1e-6 at a tolerance of 1e-10). It is 1e-5 (1e-3) where a contact breaks away while
/// friction falls with the root of the speed (Stribeck with an exponent of ½), as the speed cannot replace the time
/// there.
///
/// A law need only be a formula; where it has kinks or an infinite slope (power laws at zero speed) the steps become
/// short there. Where friction without a static level balances a weak force at a speed near rest, the slope of such a
/// law limits them for as long as the contact creeps: 10 kg on a power law of exponent ½ and 5 N at 1 m/s, driven by 10
/// mN, end in [`SimulationError::Exhausted`] at any tolerance. A law with two branches
/// ([`SlidingLaw::depends_on_acceleration`]) slides at constant speed where neither is consistent, as in
/// [`Exact`](crate::Exact).
///
/// # References
/// E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., Springer 1993, section
/// II.10 (DOP853). M. Hénon, "On the numerical computation of Poincaré maps", Physica D 5 (1982) 412 (landing on an
/// event by a step of its own).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RungeKutta {
    tolerance: f64,
}

impl Default for RungeKutta {
    /// A relative tolerance of 3e-14: the motion is good to about 1e-13 of its amplitude. A run to 1e-10 takes half as
    /// long.
    fn default() -> Self {
        Self { tolerance: 3e-14 }
    }
}

impl RungeKutta {
    /// The engine with a relative `tolerance` (1) between 1e-15 and 1e-2.
    ///
    /// # Errors
    /// [`SimulationError::OutOfRange`] if it lies outside.
    pub fn new(tolerance: f64) -> Result<Self, SimulationError> {
        SimulationError::require_tolerance(tolerance)?;
        Ok(Self { tolerance })
    }

    /// The relative tolerance (1).
    pub const fn tolerance(&self) -> f64 {
        self.tolerance
    }
}

impl<D: Scalar, L: SlidingLaw<D> + ?Sized> Engine<D, L> for RungeKutta {
    fn run_into(
        &self,
        scenario: &Scenario<D, L>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), SimulationError> {
        let drive = Forcing::of(scenario);
        let restoring = scenario.oscillator().restoring();
        if drive.has_belt() && !matches!(restoring, Restoring::Linear | Restoring::Sine { .. }) {
            let what = "a spring that hardens or softens, or has a corner, on a moving counterface: \
                        what holds the mass is no line in time";
            return Err(SimulationError::NotSupported { engine: "runge_kutta", what });
        }
        let contact = Contact::new(scenario, Sliding(scenario.law()), &drive)?;
        let mut integrator = Integrator::new(scenario, &drive, self.tolerance, sampling.end());
        let mut recorder = Recorder::new("runge_kutta", 0, sampling, trajectory)?;
        contact.run(scenario.initial(), &drive, &mut integrator, &mut recorder)
    }
}
