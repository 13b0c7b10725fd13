//! What is simulated: machine, contact and how the motion begins.

use fmm_model::{ModelError, Oscillator, Scalar};

use crate::{Excitation, SimulationError};

/// Position and velocity at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<D = f64> {
    /// x, distance from the position in which the spring is free of force (m).
    pub position: D,
    /// v, velocity (m/s).
    pub velocity: D,
}

/// A machine with a sliding contact, and the state in which it is let go at t = 0.
///
/// ```text
/// m x″ + c₁ x′ + c₂ |x′| x′ + … + k x + N μ(|u|) sgn(u) = f(t),   u = x′ − v_b         (thesis Eq. 5.2, 8.1)
/// |L| ≤ N μ_s in stick,   L = f(t) − k x − c₁ v_b − …
/// ```
///
/// with v_b the velocity of the counterface. The load L is the thesis' k x where nothing else acts; taking k x also
/// under a force, as its Eq. 8.1 does, would let a machine at rest neither start nor stop.
///
/// With a normal load of 1 the law's coefficient is the friction force (N); per unit mass it is the friction
/// force per mass (m/s²). A scenario begins at rest in the force-free position until
/// [`starting_at`](Self::starting_at) says otherwise.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario<D, L> {
    oscillator: Oscillator<D>,
    law: L,
    normal_load: D,
    initial: State<D>,
    excitations: Vec<Excitation<D>>,
}

impl<D: Scalar, L> Scenario<D, L> {
    /// `oscillator` with a contact of the given `law` under `normal_load` (N).
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the load is negative or not finite.
    pub fn new(oscillator: Oscillator<D>, law: L, normal_load: D) -> Result<Self, SimulationError> {
        ModelError::require_not_negative("normal load", normal_load.value(), "N")?;
        let zero = D::from(0.0);
        let initial = State { position: zero, velocity: zero };
        Ok(Self { oscillator, law, normal_load, initial, excitations: Vec::new() })
    }

    /// The same machine, let go at `position` (m) with `velocity` (m/s).
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if either is not finite.
    pub fn starting_at(mut self, position: D, velocity: D) -> Result<Self, SimulationError> {
        ModelError::require_finite("initial position", position.value(), "m")?;
        ModelError::require_finite("initial velocity", velocity.value(), "m/s")?;
        self.initial = State { position, velocity };
        Ok(self)
    }

    /// The same machine with one more `excitation` acting on it.
    #[must_use]
    pub fn driven_by(mut self, excitation: Excitation<D>) -> Self {
        self.excitations.push(excitation);
        self
    }

    /// What acts on the machine from outside.
    pub fn excitations(&self) -> &[Excitation<D>] {
        &self.excitations
    }

    /// The machine.
    pub fn oscillator(&self) -> &Oscillator<D> {
        &self.oscillator
    }

    /// The contact's law.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// N, normal load (N).
    pub fn normal_load(&self) -> D {
        self.normal_load
    }

    /// The state at t = 0.
    pub fn initial(&self) -> State<D> {
        self.initial
    }
}
