//! The exact engine: closed form between events, events in closed form or proven, derivatives through both.

mod closed_form;
mod elements;
mod powers;
mod swing;
#[cfg(test)]
mod tests;

use fmm_friction::{Affine, PiecewiseLinearLaw};
use fmm_model::{Restoring, Scalar};

use crate::automaton::Contact;
use crate::error::SimulationError;
use crate::exact::elements::Yielding;
use crate::exact::swing::{Flows, Swing};
use crate::mechanics::{Branches, Forcing};
use crate::scenario::{Sampling, Scenario};
use crate::trajectory::{Engine, Recorder, Trajectory};

/// Simulates piecewise linear laws without any integration error.
///
/// While the contact slips in one direction, friction only shifts the centre of a damped harmonic motion, and the
/// force is a line plus waves:
///
/// ```text
/// m x″ + (c₁ + N β) x′ + k x = f₀ + f₁ t + Σ fⱼ cos(Ωⱼ t + φⱼ) − s N μ,   s = sgn(x′ − v_b)
/// x = p₀ + p₁ t + Σ waves + e^(−at) (A cos ω_d t + B sin ω_d t)
/// ```
///
/// Free of force, position, velocity and the time of the next zero velocity have closed forms, and every further half
/// cycle lasts π/ω_d. Under a force the first zero is found by steps that provably do not reach over one. At zero
/// relative velocity the contact sticks if |L| ≤ N μ_s, the comparison being made on the numbers as they are; otherwise
/// it slips in the direction of the load, never in that of a velocity that has just vanished. A contact that holds lets
/// go where the load, a line plus waves, leaves the static level. Under-, over- and critically damped machines are all
/// covered; without oscillation the motion creeps towards the edge of the stick zone and has no stop.
///
/// A law whose level is higher while the speed grows than while it falls (thesis Eq. 7.3) has no solution between its
/// levels but constant speed: such phases are part of the motion. In the reverse case both branches are possible, and
/// the contact keeps its branch until its own acceleration changes sign.
///
/// On a spring that does not turn the motion round the closed form is a small difference of large numbers; where it
/// would lose more than nine digits, and without a spring, the run ends in [`SimulationError::NoClosedForm`].
///
/// Guaranteed: no event is missed, events are in order, and their number is at most one million (a typed error
/// otherwise). Samples within a half cycle come from a table of powers of exp((−a + iω_d)Δt), anew from the closed
/// form every 256 samples, so that rounding does not grow along the record. Accelerations are linear in position and
/// velocity, or the second derivative of the closed form where elements yield.
///
/// At dual numbers the derivatives are exact, including those of the event times; a derivative does not see
/// that the *number* of half cycles may change; see [`Event::margin`](crate::Event::margin).
///
/// # References
/// J. P. den Hartog, "Forced vibrations with combined Coulomb and viscous friction", Trans. ASME 53 (1931) 107.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Exact;

impl<D: Scalar, L: PiecewiseLinearLaw<D>> Engine<D, L> for Exact {
    fn run_into(
        &self,
        scenario: &Scenario<D, L>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), SimulationError> {
        let oscillator = scenario.oscillator();
        if !oscillator.damping().is_linear() {
            return Err(SimulationError::not_linear("nonlinear damping"));
        }
        if !matches!(oscillator.restoring(), Restoring::Linear) {
            return Err(SimulationError::not_linear("a nonlinear restoring force"));
        }
        if !scenario.has_constant_load() {
            return Err(SimulationError::not_linear("a normal load that varies"));
        }
        if oscillator.stiffness().value() == 0.0 {
            return Err(SimulationError::weak_spring(0.0));
        }
        let drive = Forcing::of(scenario);
        let elements = scenario.law().elements().len();
        if elements > 0 {
            let Affine { level, slope, breakaway } = scenario.law().affine();
            if [level, slope, breakaway].iter().any(|number| number.value() != 0.0) {
                return Err(SimulationError::NotSupported { engine: "exact", what: "elements beside a sliding level" });
            }
            let mut recorder = Recorder::new("exact", elements, sampling, trajectory)?;
            return Yielding::new(scenario, &drive).run(&mut recorder);
        }
        let (gaining, losing) = (scenario.law().affine(), scenario.law().affine_losing_speed());
        let branches = Branches { gaining, losing: losing.unwrap_or(gaining), differ: losing.is_some() };
        let contact = Contact::new(scenario, branches, &drive)?;
        let flows = Flows::new(scenario, branches, sampling)?;
        let mut swing = Swing::new(scenario, &flows, &drive, sampling);
        let mut recorder = Recorder::new("exact", 0, sampling, trajectory)?;
        contact.run(scenario.initial(), &drive, &mut swing, &mut recorder)?;
        let held = scenario.normal_load() * branches.gaining.breakaway;
        swing.digits().check(oscillator, held, sampling.end())
    }
}
