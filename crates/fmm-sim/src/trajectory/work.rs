//! Work and energy of a motion, and the balance that they must close.

use fmm_model::Scalar;

use crate::error::SimulationError;
use crate::scenario::{Scenario, State};
use crate::trajectory::Trajectory;

/// Powers (W) of friction, damping and excitation at one instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Power<D> {
    pub(crate) friction: D,
    pub(crate) viscous: D,
    pub(crate) external: D,
}

impl<D: Scalar> Power<D> {
    /// Powers of a contact under this `friction` force (N) at a `velocity` (m/s) beside a counterface of velocity
    /// `belt` (m/s), with the force of the `damping` (N) and that from outside, `force` (N).
    pub(crate) fn of(friction: D, damping: D, force: D, velocity: D, belt: D) -> Self {
        Self {
            friction: friction * (velocity - belt),
            viscous: damping * velocity,
            external: force * velocity - friction * belt,
        }
    }
}

/// Work done since the start of a motion.
///
/// ```text
/// W_friction = ∫ F_f (x′ − v_b) dt,   W_viscous = ∫ F_c x′ dt,   W_external = ∫ (f x′ − F_f v_b) dt
/// E_kinetic + E_potential + W_friction + W_viscous − W_external = constant
/// ```
///
/// With v_b the velocity of the counterface. Friction of a bristle law also stores energy, so that its work may fall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work<D = f64> {
    /// Dissipated by friction (J).
    pub friction: D,
    /// Dissipated by the damping of the machine (J).
    pub viscous: D,
    /// Done by forces from outside, the counterface included (J).
    pub external: D,
}

/// Gauss-Legendre nodes on (0, 1) and weights, order 14.
const NODES: [(f64, f64); 7] = [
    (0.025_446_043_828_620_757, 0.064_742_483_084_434_85),
    (0.129_234_407_200_302_77, 0.139_852_695_744_638_32),
    (0.297_077_424_311_301_4, 0.190_915_025_252_559_46),
    (0.5, 0.208_979_591_836_734_7),
    (0.702_922_575_688_698_5, 0.190_915_025_252_559_46),
    (0.870_765_592_799_697_2, 0.139_852_695_744_638_32),
    (0.974_553_956_171_379_2, 0.064_742_483_084_434_85),
];

/// Greatest number of pieces in one run; the samples of a motion that needs more do not resolve it.
pub(crate) const PIECE_BUDGET: usize = 2_000_000;

impl<D: Scalar> Work<D> {
    pub(crate) fn none() -> Self {
        let zero = D::from(0.0);
        Self { friction: zero, viscous: zero, external: zero }
    }

    /// Adds the integral of `power` from `begin` to `end` (s), in pieces no longer than `scale`; `budget` is the number
    /// of pieces left.
    ///
    /// # Errors
    /// [`SimulationError::Exhausted`] if there are more pieces.
    pub(crate) fn add(
        &mut self,
        begin: f64,
        end: f64,
        scale: f64,
        budget: &mut usize,
        power: &mut impl FnMut(f64) -> Power<D>,
    ) -> Result<(), SimulationError> {
        if !(end > begin) {
            return Ok(());
        }
        let pieces = ((end - begin) / scale).ceil().max(1.0);
        *budget =
            budget.checked_sub(pieces as usize).ok_or_else(|| SimulationError::piece_budget(PIECE_BUDGET, end))?;
        let step = (end - begin) / pieces;
        for piece in 0..pieces as usize {
            let start = begin + piece as f64 * step;
            for (node, weight) in NODES {
                let power = power(start + node * step);
                self.friction += power.friction * (weight * step);
                self.viscous += power.viscous * (weight * step);
                self.external += power.external * (weight * step);
            }
        }
        Ok(())
    }

    /// True if all works are within the range of the number type.
    pub(crate) fn is_finite(&self) -> bool {
        [self.friction, self.viscous, self.external].into_iter().all(|work| work.value().is_finite())
    }
}

/// Energy stored in a machine and the work that has changed it since the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy {
    /// m x′²/2 (J).
    pub kinetic: f64,
    /// Energy in the spring, zero at the origin (J).
    pub potential: f64,
    /// Work of friction, damping and excitation since t = 0.
    pub work: Work,
}

impl Energy {
    /// Stored energy, kinetic and potential (J).
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential
    }
}

impl<L: ?Sized> Scenario<f64, L> {
    /// Kinetic and potential energy (J) at `state`.
    pub fn stored_energy(&self, state: State) -> (f64, f64) {
        (self.oscillator().kinetic_energy(state.velocity), self.oscillator().potential_energy(state.position))
    }
}

impl Trajectory {
    /// The energy at sample `index` of this motion of `scenario`; `None` unless position, velocity and
    /// [work](crate::Sampling::with_work) were sampled.
    ///
    /// ```
    /// use fmm_friction::Coulomb;
    /// use fmm_model::Oscillator;
    /// use fmm_sim::{Engine, Exact, Sampling, Scenario};
    ///
    /// let scenario = Scenario::new(Oscillator::new(2.0, 100.0)?, Coulomb::new(0.3)?, 1.0)?.starting_at(0.1, 0.0)?;
    /// let motion = Exact.run(&scenario, &Sampling::uniform(0.01, 1000)?.with_work())?;
    /// let energy = motion.energy(&scenario, 999).expect("all is sampled");
    /// // 0.5 J at the release: a part is left in the spring, friction has taken the rest.
    /// assert_eq!(energy.kinetic, 0.0);
    /// assert!((energy.total() + energy.work.friction - 0.5).abs() < 1e-14);
    /// assert!(motion.energy_imbalance(&scenario).is_some_and(|imbalance| imbalance < 1e-14));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn energy<L: ?Sized>(&self, scenario: &Scenario<f64, L>, index: usize) -> Option<Energy> {
        let position = *self.position().values().get(index)?;
        let velocity = *self.velocity().values().get(index)?;
        let (kinetic, potential) = scenario.stored_energy(State { position, velocity });
        Some(Energy { kinetic, potential, work: self.work(index)? })
    }

    /// Imbalance of the energy: the greatest |E + W_friction + W_viscous − W_external − E₀| over the samples,
    /// relative to the greatest sum of the magnitudes of these terms; `None` if [`energy`](Self::energy) has none.
    ///
    /// It checks a simulation from outside, as states and works are computed independently of each other.
    pub fn energy_imbalance<L: ?Sized>(&self, scenario: &Scenario<f64, L>) -> Option<f64> {
        let (kinetic, potential) = scenario.stored_energy(scenario.initial());
        let initial = kinetic + potential;
        let (mut imbalance, mut scale) = (0.0f64, initial);
        for index in 0..self.position().values().len() {
            let energy = self.energy(scenario, index)?;
            let Work { friction, viscous, external } = energy.work;
            let residual = energy.total() + friction + viscous - external - initial;
            imbalance = imbalance.max(residual.abs());
            scale = scale.max(energy.total() + friction.abs() + viscous.abs() + external.abs() + initial);
        }
        self.work(0)?;
        Some(if imbalance == 0.0 { 0.0 } else { imbalance / scale })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polynomial of degree 13 is integrated exactly, a sine to rounding.
    #[test]
    fn the_quadrature_is_of_order_14() {
        let mut work = Work::<f64>::none();
        let mut budget = 3;
        work.add(0.0, 2.0, 1.0, &mut budget, &mut |t| Power { friction: t.powi(13), viscous: t.sin(), external: 1.0 })
            .unwrap();
        assert!((work.friction / (2f64.powi(14) / 14.0) - 1.0).abs() < 1e-14, "{}", work.friction);
        assert!((work.viscous - (1.0 - 2f64.cos())).abs() < 1e-15, "{}", work.viscous);
        assert!((work.external - 2.0).abs() < 1e-15, "{}", work.external);
        work.add(3.0, 3.0, 1.0, &mut budget, &mut |_| unreachable!("an empty interval has no work")).unwrap();
        assert_eq!(budget, 1);
        let error = work.add(0.0, 1e9, 1e-9, &mut budget, &mut |_| unreachable!("too many pieces")).unwrap_err();
        assert!(matches!(error, SimulationError::Exhausted { .. }), "{error}");
    }
}
