//! The thesis' own integrator, kept to reproduce its numbers.

use fmm_friction::SlidingLaw;

use crate::error::{NOT_UNIFORM, SimulationError};
use crate::fixed_step::Grid;
use crate::mechanics::Forcing;
use crate::scenario::{Direction, EventKind, Mode, Sampling, Scenario};
use crate::trajectory::{Engine, Trajectory};

/// Semi-implicit Euler with the branch order of the thesis' appendix (A3 to A6), for reproduction only.
///
/// ```text
/// x″ = (f − s μ(|x′|) N − F_c(x′) − F_k(x))/m,   x′ ← x′ + x″ Δt,   x ← x + x′ Δt         (thesis Eq. 7.1, 8.1)
/// ```
///
/// While the velocity keeps its sign, s is that sign. In the step after a change of sign the velocity is set to
/// zero if the load is below the static level, and otherwise s is the sign of the load. One step is one sampling
/// interval; a force is constant over it. For a law that depends on the acceleration, that of the step before decides
/// (thesis Eq. 7.3).
///
/// The method is of first order, its stops and reversals snap to the sampling grid, and a least-squares
/// objective built on it jumps whenever one of them moves by a sample. It therefore offers no derivatives. It offers no
/// accelerations either, as it sets the velocity to zero without one. [`Exact`](crate::Exact) is faster and free of
/// these errors.
///
/// The load is f − F_k(x). The thesis' Eq. 8.1 takes F_k(x) alone, which would never let a hammer move a machine at
/// rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Thesis {
    level: StaticLevel,
}

/// Level with which the load is compared after a change of sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum StaticLevel {
    #[default]
    Breakaway,
    AtSpeed,
}

impl Thesis {
    /// Rule of A3, A4 and A5: the machine stops if |x| < μ_s N/k.
    pub const A3: Self = Self { level: StaticLevel::Breakaway };

    /// Rule of A6: the machine stops if k |x| < μ(|x′|) N, at the speed of its overshoot. With a law that vanishes at
    /// zero speed it hardly ever stops.
    pub const A6: Self = Self { level: StaticLevel::AtSpeed };
}

impl<L: SlidingLaw<f64> + ?Sized> Engine<f64, L> for Thesis {
    fn run_into(
        &self,
        scenario: &Scenario<f64, L>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<f64>,
    ) -> Result<(), SimulationError> {
        let step = sampling.interval().ok_or(SimulationError::NotSupported { engine: "thesis", what: NOT_UNIFORM })?;
        if sampling.channels().acceleration() {
            return Err(SimulationError::NotSupported { engine: "thesis", what: "samples of the acceleration" });
        }
        scenario.require_constant_load("thesis")?;
        trajectory.reset("thesis", 0, false, sampling)?;
        let (oscillator, law, load) = (scenario.oscillator(), scenario.law(), scenario.normal_load());
        let drive = Forcing::of(scenario);
        if drive.has_belt() {
            return Err(SimulationError::NotSupported { engine: "thesis", what: "a moving counterface" });
        }
        let (mass, damping) = (oscillator.mass(), oscillator.damping());
        let static_level = law.breakaway() * load;
        let hold = static_level / oscillator.stiffness();
        let sprung = oscillator.stiffness() > 0.0;
        if !(static_level.is_finite() && (hold.is_finite() || !sprung)) {
            return Err(SimulationError::NotFinite { time: 0.0 });
        }
        let literal = sprung && oscillator.is_linear() && scenario.excitations().is_empty();
        // The appendix compares positions in A3 to A5, which rounds differently from comparing forces.
        let holds = |x: f64, v: f64, balance: f64| match self.level {
            StaticLevel::Breakaway if literal => x < hold && x > -hold,
            StaticLevel::Breakaway => balance.abs() < static_level,
            StaticLevel::AtSpeed => balance.abs() < law.coefficient(v.abs()) * load,
        };
        let (mut x, mut v) = (scenario.initial().position, scenario.initial().velocity);
        let mut grid = Grid::new(step, static_level, &drive);
        // The appendix starts every run as if the motion before had been in the positive direction.
        let (mut before, mut acceleration) = (1.0, 0.0);
        let balance = grid.force(0) - oscillator.restoring_force(x);
        let mut mode = if v == 0.0 && holds(x, v, balance) {
            Mode::Stick
        } else {
            Mode::Slip(Direction::of(if v == 0.0 { balance } else { v }))
        };
        trajectory.events.push(grid.event(EventKind::Start, 0, (x, v), mode, balance));
        for index in 0..sampling.first() + sampling.count() {
            if let Some(sample) = index.checked_sub(sampling.first()) {
                trajectory.set(sample, sampling.channels(), x, v);
                if sample + 1 == sampling.count() {
                    break;
                }
            }
            let sliding = v * before > 0.0;
            before = v;
            let balance = grid.force(index) - oscillator.restoring_force(x);
            if !sliding && holds(x, v, balance) {
                v = 0.0;
                acceleration = 0.0;
                if mode != Mode::Stick {
                    mode = Mode::Stick;
                    trajectory.events.push(grid.event(EventKind::Stop, index + 1, (x, v), mode, balance));
                }
                continue;
            }
            let sign = if sliding {
                v.signum()
            } else if balance < 0.0 {
                -1.0
            } else {
                1.0
            };
            let coefficient = if law.depends_on_acceleration() && v * acceleration < 0.0 {
                law.coefficient_losing_speed(v.abs())
            } else {
                law.coefficient(v.abs())
            };
            // In the step after a change of sign the appendix turns the quadratic part round with the friction.
            let drag = if sliding {
                damping.force(v)
            } else {
                against(damping.force(v), damping.linear_coefficient() * v, sign)
            };
            acceleration = (balance - sign * (coefficient * load) - drag) / mass;
            v += acceleration * step;
            x += v * step;
            let next = Mode::Slip(Direction::of(v));
            if v != 0.0 && next != mode {
                let kind = if mode == Mode::Stick { EventKind::Breakaway } else { EventKind::Reversal };
                mode = next;
                trajectory.events.push(grid.event(kind, index + 1, (x, v), mode, balance));
            }
            if !((oscillator.stiffness() * x).is_finite() && x.is_finite() && v.is_finite()) {
                return Err(SimulationError::NotFinite { time: (index + 1) as f64 * step });
            }
        }
        let breakaway = match self.level {
            StaticLevel::Breakaway => law.breakaway(),
            StaticLevel::AtSpeed => law.coefficient(0.0),
        };
        trajectory.rests = mode == Mode::Stick && grid.holds_for_good(oscillator, sampling.end(), (x, v), breakaway);
        Ok(())
    }
}

/// Damping force `force` whose part beyond the `linear` one has the given sign.
fn against(force: f64, linear: f64, sign: f64) -> f64 {
    linear + sign * (force - linear).abs()
}
