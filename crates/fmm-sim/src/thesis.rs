//! The thesis' own integrator, kept to reproduce its numbers.

use fmm_friction::SlidingLaw;

use crate::{Direction, Engine, Event, EventKind, Mode, Sampling, Scenario, SimulationError, Trajectory};

/// Semi-implicit Euler with the branch order of the thesis' appendix (A3, A4), for reproduction only.
///
/// ```text
/// x″ = (−s μ(|x′|) N − c₁ x′ − s c₂ x′² − k x)/m,   x′ ← x′ + x″ Δt,   x ← x + x′ Δt         (thesis Eq. 7.1)
/// ```
///
/// While the velocity keeps its sign, s is that sign. In the step after a change of sign the velocity is set to
/// zero if |x| < μ_s N/k, and otherwise s is minus the sign of x. One step is one sampling interval.
///
/// The method is of first order, its stops and reversals snap to the sampling grid, and a least-squares
/// objective built on it jumps whenever one of them moves by a sample. It therefore offers no derivatives;
/// [`Exact`](crate::Exact) is both faster and free of these errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Thesis;

impl<L: SlidingLaw<f64>> Engine<f64, L> for Thesis {
    fn run_into(
        &self,
        scenario: &Scenario<f64, L>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<f64>,
    ) -> Result<(), SimulationError> {
        trajectory.reset(sampling);
        let (oscillator, law, load) = (scenario.oscillator(), scenario.law(), scenario.normal_load());
        let (mass, stiffness) = (oscillator.mass(), oscillator.stiffness());
        let linear = oscillator.damping().linear_coefficient();
        let quadratic = oscillator.damping().quadratic_coefficient();
        let step = sampling.interval();
        let static_level = law.breakaway() * load;
        let hold = static_level / stiffness;
        if !hold.is_finite() {
            return Err(SimulationError::NotFinite { time: 0.0 });
        }
        let (mut x, mut v) = (scenario.initial().position, scenario.initial().velocity);
        let event = |kind, index: usize, x: f64, v: f64, next| Event {
            kind,
            time: index as f64 * step,
            position: x,
            velocity: v,
            next,
            load: (stiffness * x).abs(),
            static_level,
        };
        // The appendix starts every run as if the motion before had been in the positive direction.
        let mut before = 1.0;
        let mut mode = if v == 0.0 && x.abs() < hold {
            Mode::Stick
        } else {
            Mode::Slip(Direction::of(if v == 0.0 { -x } else { v }))
        };
        trajectory.push(event(EventKind::Start, 0, x, v, mode));
        for index in 0..sampling.first() + sampling.count() {
            if let Some(sample) = index.checked_sub(sampling.first()) {
                trajectory.set(sample, sampling.channels(), x, v);
                if sample + 1 == sampling.count() {
                    break;
                }
            }
            let sliding = v * before > 0.0;
            before = v;
            if !sliding && x < hold && x > -hold {
                v = 0.0;
                if mode != Mode::Stick {
                    mode = Mode::Stick;
                    trajectory.push(event(EventKind::Stop, index + 1, x, v, mode));
                }
                continue;
            }
            let sign = if sliding {
                v.signum()
            } else if x > 0.0 {
                -1.0
            } else {
                1.0
            };
            let acceleration =
                (-sign * (law.coefficient(v.abs()) * load) - linear * v - sign * quadratic * v * v - stiffness * x)
                    / mass;
            v += acceleration * step;
            x += v * step;
            let next = Mode::Slip(Direction::of(v));
            if v != 0.0 && next != mode {
                mode = next;
                trajectory.push(event(EventKind::Reversal, index + 1, x, v, mode));
            }
            if !((stiffness * x).is_finite() && x.is_finite() && v.is_finite()) {
                return Err(SimulationError::NotFinite { time: (index + 1) as f64 * step });
            }
        }
        Ok(())
    }
}
