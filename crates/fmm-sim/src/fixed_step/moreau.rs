//! Time stepping of the set-valued friction law, as a cross-check.

use fmm_friction::SlidingLaw;
use fmm_model::Rounded;

use crate::error::{NOT_UNIFORM, SimulationError};
use crate::fixed_step::Grid;
use crate::mechanics::Forcing;
use crate::scenario::{Direction, Event, EventKind, Mode, Sampling, Scenario};
use crate::trajectory::{Engine, Trajectory};

/// The Moreau-Jean θ-method: friction is an impulse in each step, as large as its level allows and as small as it must
/// be for the contact to hold.
///
/// ```text
/// M (u⁺ − u_free) ∈ −h F Sgn(u⁺),   M = m + h θ c₁ + h² θ² k,   u = x′ − v_b
/// u⁺ = 0 if M |u_free| ≤ h F,   else u_free − h F/M sgn(u_free)
/// ```
///
/// with u_free the velocity after a step without friction. Where the static level is above the sliding one, F is the
/// static level in stick, and a contact whose u would change sign in a step stops if the load does not exceed it. It
/// needs no event location, and it is the method of contact mechanics with many contacts; but it is of first order
/// wherever the motion turns or stops, and its events lie on the sampling grid. One step is one sampling interval.
/// Accelerations are those of the state at a sample, not those of the impulses. The level of a law is that at the
/// speed before the step; nonlinear parts of the machine are taken at the beginning of the step. It offers no
/// derivatives.
///
/// # References
/// J. J. Moreau, "Unilateral contact and dry friction in finite freedom dynamics", in *Nonsmooth Mechanics and
/// Applications*, Springer 1988, doi 10.1007/978-3-7091-2624-0_1. M. Jean, "The non-smooth contact dynamics method",
/// Comput. Methods Appl. Mech. Eng. 177 (1999) 235.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moreau {
    theta: f64,
}

impl Default for Moreau {
    /// θ = 1/2, the trapezoidal rule, which neither feeds nor damps the free vibration.
    fn default() -> Self {
        Self { theta: 0.5 }
    }
}

impl Moreau {
    /// The method with another `theta` in [1/2, 1]; 1 is the implicit Euler rule.
    ///
    /// # Errors
    /// [`SimulationError::OutOfRange`] if it lies outside.
    pub fn new(theta: f64) -> Result<Self, SimulationError> {
        if (0.5..=1.0).contains(&theta) {
            return Ok(Self { theta });
        }
        let what = format!("theta must lie between 1/2 and 1, but is {}", Rounded::every_digit(theta));
        Err(SimulationError::OutOfRange { what, value: theta })
    }
}

impl<L: SlidingLaw<f64> + ?Sized> Engine<f64, L> for Moreau {
    fn run_into(
        &self,
        scenario: &Scenario<f64, L>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<f64>,
    ) -> Result<(), SimulationError> {
        let h = sampling.interval().ok_or(SimulationError::NotSupported { engine: "moreau", what: NOT_UNIFORM })?;
        let (oscillator, law, load) = (scenario.oscillator(), scenario.law(), scenario.normal_load());
        if law.depends_on_acceleration() {
            let what = "a law that depends on the acceleration";
            return Err(SimulationError::NotSupported { engine: "moreau", what });
        }
        scenario.require_constant_load("moreau")?;
        trajectory.reset("moreau", 0, false, sampling)?;
        let drive = Forcing::of(scenario);
        let belt = drive.belt();
        let (mass, stiffness) = (oscillator.mass(), oscillator.stiffness());
        let linear = oscillator.damping().linear_coefficient();
        let theta = self.theta;
        let inertia = mass + h * theta * (linear + h * theta * stiffness);
        let static_level = law.breakaway() * load;
        if !(inertia.is_finite() && static_level.is_finite()) {
            return Err(SimulationError::NotFinite { time: 0.0 });
        }

        let (mut x, mut v) = (scenario.initial().position, scenario.initial().velocity);
        let mut grid = Grid::new(h, static_level, &drive);
        let mut force = grid.force(0);
        let balance = force - oscillator.restoring_force(x) - oscillator.damping_force(belt);
        let mut mode = if v != belt {
            Mode::Slip(Direction::of(v - belt))
        } else if balance.abs() <= static_level {
            Mode::Stick
        } else {
            Mode::Slip(Direction::of(balance))
        };
        trajectory.events.push(grid.event(EventKind::Start, 0, (x, v), mode, balance));
        let mut stopped: Option<Event> = None;
        for index in 0..sampling.first() + sampling.count() {
            if let Some(sample) = index.checked_sub(sampling.first()) {
                trajectory.set(sample, sampling.channels(), x, v);
                if sampling.channels().acceleration() {
                    let friction = |direction: Direction| direction.sign() * law.coefficient((v - belt).abs()) * load;
                    let machine = oscillator.restoring_force(x) + oscillator.damping_force(v);
                    let sliding = |direction| (force - machine - friction(direction)) / mass;
                    let acceleration = mode.direction().map_or(0.0, sliding);
                    if !acceleration.is_finite() {
                        return Err(SimulationError::NotFinite { time: index as f64 * h });
                    }
                    trajectory.acceleration.set(sample, acceleration);
                }
                if sample + 1 == sampling.count() {
                    break;
                }
            }
            let next_force = grid.force(index + 1);
            let driving = theta * next_force + (1.0 - theta) * force;
            force = next_force;
            // The linear machine implicitly, other forces at the present state.
            let beyond = oscillator.restoring_force(x) - stiffness * x + oscillator.damping_force(v) - linear * v;
            let pull = linear * (1.0 - theta) * v + stiffness * (x + h * theta * (1.0 - theta) * v) + beyond;
            let free = (mass * v + h * (driving - pull)) / inertia - belt;
            let sticking = mode == Mode::Stick;
            let sliding_level = law.coefficient((v - belt).abs()) * load;
            let level = if sticking { static_level } else { sliding_level };
            let slid = belt + free.signum() * (free.abs() - h * sliding_level.min(level) / inertia);
            // A contact that passes relative rest within the step is decided by the static level.
            let passed = !sticking && (slid - belt) * (v - belt) < 0.0 && {
                let resting = next_force - oscillator.restoring_force(x) - oscillator.damping_force(belt);
                resting.abs() <= static_level
            };
            let next = if free.abs() * inertia <= h * level || passed { belt } else { slid };
            x += h * (theta * next + (1.0 - theta) * v);
            v = next;
            let now = if v == belt { Mode::Stick } else { Mode::Slip(Direction::of(v - belt)) };
            let balance = || force - oscillator.restoring_force(x) - oscillator.damping_force(belt);
            match (stopped.take(), now) {
                // A contact that holds for one step only has turned round.
                (Some(stop), Mode::Slip(_)) => {
                    trajectory.events.push(Event { kind: EventKind::Reversal, next: now, ..stop });
                }
                (Some(stop), _) => trajectory.events.push(stop),
                (None, Mode::Stick) if !sticking => {
                    stopped = Some(grid.event(EventKind::Stop, index + 1, (x, v), now, balance()));
                }
                (None, _) if now != mode => {
                    let kind = if sticking { EventKind::Breakaway } else { EventKind::Reversal };
                    trajectory.events.push(grid.event(kind, index + 1, (x, v), now, balance()));
                }
                (None, _) => {}
            }
            mode = now;
            if !(x.is_finite() && v.is_finite() && (stiffness * x).is_finite()) {
                return Err(SimulationError::NotFinite { time: (index + 1) as f64 * h });
            }
        }
        if let Some(stop) = stopped {
            trajectory.events.push(stop);
        }
        let end = sampling.end();
        trajectory.rests = mode == Mode::Stick && grid.holds_for_good(oscillator, end, (x, v), law.breakaway());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_friction::{AccelerationCoulomb, CoulombStatic};
    use fmm_model::{Damping, Oscillator};

    use crate::exact::Exact;
    use crate::scenario::Excitation;

    /// Free decay, and stick-slip on a belt with a higher static level, against the exact engine: of first order, or
    /// up to the second that the rule has without events where these weigh little.
    #[test]
    fn converges_to_the_exact_motion() {
        let machine = Oscillator::new(1.0, 1.0).unwrap().with_damping(Damping::linear(0.02).unwrap());
        let decay = Scenario::new(machine, CoulombStatic::new(0.1, 0.1).unwrap(), 1.0).unwrap();
        let decay = decay.starting_at(1.0, 0.3).unwrap();
        let belt = Scenario::new(machine, CoulombStatic::new(0.7, 1.0).unwrap(), 1.0).unwrap();
        let belt = belt.starting_at(0.0, 0.2).unwrap().driven_by(Excitation::belt(0.2).unwrap());
        for (name, scenario) in [("decay", decay), ("belt", belt)] {
            let error = |step: f64| {
                let sampling = Sampling::uniform(step, (12.0 / step) as usize).unwrap();
                let stepped = Moreau::default().run(&scenario, &sampling).unwrap();
                let exact = Exact.run(&scenario, &sampling).unwrap();
                assert_eq!(stepped.events().len(), exact.events().len(), "{name}: events at step {step} s");
                let off =
                    stepped.position().values().iter().zip(exact.position().values()).map(|(a, b)| (a - b).powi(2));
                (off.sum::<f64>() / sampling.count() as f64).sqrt()
            };
            let errors = [2e-3, 1e-3, 5e-4].map(error);
            let order = (errors[0] / errors[2]).log2() / 2.0;
            assert!((0.75..2.25).contains(&order), "{name}: order {order}, errors {errors:?} m");
            assert!(errors[2] < 1e-3, "{name}: errors {errors:?} m");
        }
    }

    /// A contact that comes to relative rest between the sliding and the static level holds, whatever the step: at 4.9
    /// mm the spring pulls with 0.49 N against 0.3 N while it slides and 0.5 N at rest.
    #[test]
    fn stops_between_the_levels_are_found() {
        let machine = Oscillator::new(1.0, 100.0).unwrap().with_damping(Damping::linear(0.1).unwrap());
        let law = CoulombStatic::new(0.3, 0.5).unwrap();
        for start in [0.0095, 0.01, 0.0105, 0.0165, 0.0225, 0.0293] {
            let scenario = Scenario::new(machine, law, 1.0).unwrap().starting_at(start, 0.0).unwrap();
            let off = |step: f64| {
                let sampling = Sampling::uniform(step, (4.0 / step) as usize).unwrap();
                let stepped = Moreau::default().run(&scenario, &sampling).unwrap();
                let exact = Exact.run(&scenario, &sampling).unwrap();
                assert_eq!(stepped.half_cycles(), exact.half_cycles(), "from {start} m at step {step} s");
                stepped
                    .position()
                    .values()
                    .iter()
                    .zip(exact.position().values())
                    .map(|(a, b)| (a - b).abs())
                    .fold(0.0, f64::max)
            };
            let offs = [4e-3, 1e-3, 2.5e-4].map(off);
            assert!(offs[2] < 3e-5 && offs[2] < 0.25 * offs[0], "from {start} m: {offs:?} m");
        }
    }

    #[test]
    fn what_it_cannot_do_is_refused() {
        let machine = Oscillator::new(1.0, 1.0).unwrap();
        let two = Scenario::new(machine, AccelerationCoulomb::new(0.3, 0.2).unwrap(), 1.0).unwrap();
        let sampling = Sampling::uniform(0.1, 3).unwrap();
        assert!(matches!(Moreau::default().run(&two, &sampling), Err(SimulationError::NotSupported { .. })));
        let one = Scenario::new(machine, CoulombStatic::new(0.2, 0.3).unwrap(), 1.0).unwrap();
        let times = Sampling::at(vec![0.0, 0.1]).unwrap();
        assert!(matches!(
            Moreau::default().run(&one, &times),
            Err(SimulationError::NotSupported { what: NOT_UNIFORM, .. })
        ));
        assert!(Moreau::new(0.4).is_err() && Moreau::new(1.0).is_ok());
    }
}
