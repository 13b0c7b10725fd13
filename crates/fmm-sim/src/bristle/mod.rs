//! The engine for laws with an internal state: Taylor series or other explicit steps where they are cheap, an implicit
//! collocation method where the law is stiff, all ending at every kink.

mod collocation;
mod explicit;
mod field;
mod first_root;
mod guards;
mod hidden;
mod lu;
mod modes;
mod pace;
mod passage;
mod polynomial;
mod prescribed;
mod radau;
mod run;
mod taylor;
#[cfg(test)]
mod tests;

use fmm_friction::BristleLaw;
use fmm_model::Scalar;

use crate::bristle::field::{Field, require_odd};
use crate::bristle::run::Run;
use crate::error::SimulationError;
use crate::mechanics::Forcing;
use crate::scenario::{Sampling, Scenario, State};
use crate::trajectory::{Engine, Recorder, Trajectory};

pub use prescribed::{FrictionPoint, PrescribedMotion, friction_along, friction_from};

/// Integrates laws with internal state, however stiff, from kink to kink of the motion.
///
/// ```text
/// m x″ = f(t) − F_c(x′) − F_k(x) − N μ(u, z, z′),   z′ = r(u, z),   u = x′ − v_b,   z(0) = z₀
/// ```
///
/// with z₀ zero or that of [`Scenario::with_deflection`].
///
/// The rates of bristles depend on |u|: they have a kink wherever the relative velocity u passes zero, and jump where
/// an element of [`MaxwellSlip`](fmm_friction::MaxwellSlip) or [`Gms`](fmm_friction::Gms) begins to slide. Between such
/// events the equations are smooth. While the bristles bend, a step is the Taylor series of the motion of order 24, if
/// damping and spring are linear and the law [expands itself](BristleLaw::expand), as [`Dahl`](fmm_friction::Dahl),
/// [`LuGre`](fmm_friction::LuGre) and [`BoucWen`](fmm_friction::BoucWen) do, except for powers next to their corner.
/// The last terms limit the reach of the series, so that no step is tried twice. Without a series, steps are those of
/// the explicit method of order 8 that [`RungeKutta`](crate::RungeKutta) uses. Once the bristles only follow the
/// sliding speed, and the equations are stiff, each step solves the 8 stages of the Radau IIA method of order 15
/// together, by Newton's method with a Jacobian from differences of the law's own formulas: the method is L-stable, so
/// that the stiffness of the bristles does not limit the step. Rates from differences, or the two last stages of a step
/// of order 8, measure the stiffness, and with it which of the methods is cheaper. A state
/// that has reached a bound which attracts it at any speed ([`Dahl`](fmm_friction::Dahl) and
/// [`BoucWen`](fmm_friction::BoucWen) slide so) stays there until the half cycle ends.
///
/// The polynomial of a step gives the samples, the right-hand side at these the accelerations (good to 4e-10 of the
/// largest at the default tolerance), and its Bernstein coefficients prove that no zero of u lies within the step,
/// or locate it: a series ends there, another step is taken again to end there, by Newton's method on its length. Next
/// to a zero of u the law is looked at between the stages too, so that friction may rise over any part of the speed.
///
/// A law with bristles has no stick: a contact that seems to hold creeps or vibrates on its bristles. At u = 0 all
/// elements hold again ([`EventKind::Reversal`](crate::EventKind::Reversal)), and the direction comes from the load,
/// never from the velocity; [`EventKind::Yield`](crate::EventKind::Yield) says which element begins to slide. Where
/// nothing drives the contact within rounding, it rests ([`Mode::Stick`](crate::Mode::Stick)) until the force changes.
/// The [`static_level`](crate::Event::static_level) of an event is the force that the bristles carry.
///
/// `tolerance` bounds the error of a step, its inside included, relative to the motion since the last reversal or to a
/// third of that before it, whichever is larger. Steps are
/// chosen by values alone: at a dual number they are those of the plain number, values agree to the last bit, and
/// derivatives include the change of event times. Where a power of LuGre or Bouc-Wen is exactly 1 or 2 and a parameter
/// with derivatives, there is no series, and values agree within the tolerance. At rest the derivatives are fixed as
/// well; a start at rest that the inputs would disturb is marked as [`grazing`](crate::Event::grazing).
///
/// A half cycle takes about eight steps of a series, and some fourteen implicit ones on top where bristles are stiff at
/// all speeds (LuGre). What it costs does not grow with the stiffness of the bristles, but a contact that no longer
/// slides goes on vibrating on them, as often as √(N σ/m)/π a second.
///
/// Guaranteed is a typed error instead of an endless run: at most three hundred thousand steps, and a million events.
///
/// ```
/// use fmm_friction::LuGre;
/// use fmm_model::Oscillator;
/// use fmm_sim::{Bristle, Engine, EventKind, Sampling, Scenario};
///
/// // 10 kg on 2 kN/m, released at 10 mm against 1 to 1.5 N on bristles of 100 kN/m.
/// let law = LuGre::new(1.0, 1.5, 0.01, 2.0, 1e5, 300.0, 0.4)?;
/// let scenario = Scenario::new(Oscillator::new(10.0, 2000.0)?, law, 1.0)?.starting_at(0.01, 0.0)?;
/// let motion = Bristle::default().run(&scenario, &Sampling::uniform(1e-3, 500)?.with_work())?;
/// assert_eq!(motion.events()[1].kind, EventKind::Reversal);
/// // Each half cycle loses about 2 F/k = 1 mm.
/// assert!((motion.events()[1].position + 0.009).abs() < 1e-4);
/// assert!(motion.energy_imbalance(&scenario).is_some_and(|imbalance| imbalance < 1e-10));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # References
/// E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, Springer 1996, sections IV.5 and IV.8,
/// doi 10.1007/978-3-642-05221-7; "Stiff differential equations solved by Radau methods", J. Comput. Appl. Math. 111
/// (1999) 93, doi 10.1016/S0377-0427(99)00134-X. E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential
/// Equations I*, 2nd ed., Springer 1993, section II.10 (DOP853), doi 10.1007/978-3-540-78862-1. À. Jorba, M. Zou, "A
/// software package for the numerical integration of ODEs by means of high-order Taylor methods", Experimental
/// Mathematics 14 (2005) 99, doi 10.1080/10586458.2005.10128904.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bristle {
    tolerance: f64,
}

impl Default for Bristle {
    /// A relative tolerance of 1e-10: positions, velocities and event times of ring-downs are good to about 1e-11 of
    /// theirs.
    fn default() -> Self {
        Self { tolerance: 1e-10 }
    }
}

impl Bristle {
    /// The engine with a relative `tolerance` (1) between 1e-15 and 1e-2; below about 1e-13, rounding decides.
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

impl<D: Scalar, L: BristleLaw<D> + ?Sized> Engine<D, L> for Bristle {
    fn run_into(
        &self,
        scenario: &Scenario<D, L>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), SimulationError> {
        scenario.require_constant_load("bristle")?;
        require_odd(scenario.law())?;
        let oscillator = scenario.oscillator();
        let drive = Forcing::of(scenario);
        let field = Field::new(oscillator, scenario.law(), scenario.normal_load(), drive.belt());
        let recorder = Recorder::new("bristle", scenario.law().states(), sampling, trajectory)?;
        Run::new(field, beginning(scenario), self.tolerance, recorder).run(&drive).map(|_| ())
    }
}

/// x, v and the states of the law at t = 0.
fn beginning<D: Scalar, L: BristleLaw<D> + ?Sized>(scenario: &Scenario<D, L>) -> Vec<D> {
    let State { position, velocity } = scenario.initial();
    let deflections = (0..scenario.law().states()).map(|index| scenario.deflection(index));
    [position, velocity].into_iter().chain(deflections).collect()
}
