//! The energy of a motion along its samples, and how well it balances.

use crate::{Scenario, State, Trajectory, Work};

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
    /// // 0.5 J at the release; what is left is in the spring, the rest went into friction.
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
    /// It checks a simulation from outside: states and works are found independently of each other.
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
