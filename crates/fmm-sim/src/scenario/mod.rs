//! Scenario of a simulation: machine, contact and beginning of the motion.

mod event;
mod excitation;
mod load_over_position;
mod sampling;

use std::sync::Arc;

use fmm_friction::BristleLaw;
use fmm_model::{ModelError, Oscillator, Scalar};

use crate::error::SimulationError;

pub use event::{Direction, Event, EventKind, Mode};
pub use excitation::Excitation;
pub(crate) use excitation::Source;
pub(crate) use load_over_position::LoadOverPosition;
pub use sampling::{Channels, Sampling};

/// Position and velocity at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<D = f64> {
    /// x, distance from the position in which the spring is free of force (m).
    pub position: D,
    /// v, velocity (m/s).
    pub velocity: D,
}

/// A machine with a sliding contact, and its state at t = 0.
///
/// ```text
/// m x″ + c₁ x′ + c₂ |x′| x′ + … + k x + N μ(|u|) sgn(u) = f(t),   u = x′ − v_b         (thesis Eq. 5.2, 8.1)
/// |L| ≤ N μ_s in stick,   L = f(t) − k x − c₁ v_b − …
/// ```
///
/// with v_b the velocity of the counterface. The load L is the thesis' k x if nothing else acts. With k x under a force
/// too, as in its Eq. 8.1, a machine at rest would neither start nor stop.
///
/// With a normal load of 1 the law's coefficient is the friction force (N); per unit mass it is the friction
/// force per mass (m/s²). A scenario begins at rest in the force-free position unless
/// [`starting_at`](Self::starting_at) is called.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario<D, L: ?Sized> {
    oscillator: Oscillator<D>,
    normal_load: D,
    sampled_load: Option<SampledLoad<D>>,
    load_over_position: LoadOverPosition<D>,
    initial: State<D>,
    /// States of the law at t = 0, up to the last that is not zero.
    deflections: Vec<D>,
    excitations: Vec<Excitation<D>>,
    /// Last, so that a scenario of any law is also one of `dyn SlidingLaw`.
    law: L,
}

/// A normal load (N) that is given at equal distances in time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SampledLoad<D> {
    /// Distance in time (s).
    pub(crate) interval: f64,
    /// Two values at least (N).
    pub(crate) values: Arc<[D]>,
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
        Ok(Self {
            oscillator,
            normal_load,
            sampled_load: None,
            load_over_position: LoadOverPosition::default(),
            initial,
            deflections: Vec::new(),
            excitations: Vec::new(),
            law,
        })
    }

    /// The scenario with another `law`, whose states are zero at t = 0, whatever those of the one before were.
    ///
    /// ```
    /// use fmm_friction::{Coulomb, Dahl};
    /// use fmm_model::Oscillator;
    /// use fmm_sim::Scenario;
    ///
    /// // 1 kg on 100 N/m under 5 N, let go at 0.1 m.
    /// let dry = Scenario::new(Oscillator::new(1.0, 100.0)?, Coulomb::new(0.2)?, 5.0)?.starting_at(0.1, 0.0)?;
    /// let yielding = dry.clone().with_law(Dahl::new(0.2, 50.0, 1.0)?);
    /// assert_eq!(yielding.initial(), dry.initial());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_law<M>(self, law: M) -> Scenario<D, M> {
        let Self { oscillator, normal_load, sampled_load, load_over_position, initial, excitations, .. } = self;
        let deflections = Vec::new();
        Scenario { oscillator, normal_load, sampled_load, load_over_position, initial, deflections, excitations, law }
    }

    /// The scenario with this initial `position` (m) and `velocity` (m/s).
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if either is not finite.
    pub fn starting_at(mut self, position: D, velocity: D) -> Result<Self, SimulationError> {
        ModelError::require_finite("initial position", position.value(), "m")?;
        ModelError::require_finite("initial velocity", velocity.value(), "m/s")?;
        self.initial = State { position, velocity };
        Ok(self)
    }

    /// The scenario with one more `excitation` of the machine.
    #[must_use]
    pub fn driven_by(mut self, excitation: Excitation<D>) -> Self {
        self.excitations.push(excitation);
        self
    }

    /// The scenario under a normal load that varies in time: `values` (N), one every `interval` (s) from t = 0 on,
    /// straight lines between them, and the last from its time on.
    ///
    /// [`RungeKutta`](crate::RungeKutta) takes such a load with any law of the sliding speed, and
    /// [`simulate`](crate::simulate) takes that engine; laws with internal state cannot have one. Values that are dual
    /// numbers carry their derivatives into the motion.
    ///
    /// ```
    /// use fmm_friction::Coulomb;
    /// use fmm_model::Oscillator;
    /// use fmm_sim::{Sampling, Scenario, simulate};
    ///
    /// // A mass on a rail, at 1 m/s under a load that grows from 0 N by 10 N/s: v = v₀ − μ (10 N/s) t²/(2 m).
    /// let scenario = Scenario::new(Oscillator::new(1.0, 0.0)?, Coulomb::new(0.2)?, 0.0)?;
    /// let scenario = scenario.under_sampled_load(2.0, [0.0, 20.0])?.starting_at(0.0, 1.0)?;
    /// let motion = simulate(&scenario, &Sampling::uniform(0.5, 4)?)?;
    /// assert!((motion.velocity().values()[1] - 0.75).abs() < 1e-12);
    /// assert!((motion.rest().expect("friction stops it").time - 1.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the interval is not positive or a value is negative or not finite,
    /// [`SimulationError::OutOfRange`] without a value.
    pub fn under_sampled_load(mut self, interval: f64, values: impl Into<Arc<[D]>>) -> Result<Self, SimulationError> {
        let values = values.into();
        ModelError::require_positive("interval of the normal load", interval, "s")?;
        for value in values.iter() {
            ModelError::require_not_negative("normal load", value.value(), "N")?;
        }
        self.normal_load = *values.first().ok_or_else(|| SimulationError::sampling(0, interval))?;
        self.sampled_load = (values.len() > 1).then_some(SampledLoad { interval, values });
        Ok(self)
    }

    /// The scenario under a normal load that depends on the position, N (1 + β x²) with this `curvature` β (1/m²), such
    /// as where a flexure comes nearer to the contact as it deflects. Where that is negative, the contact has lifted.
    ///
    /// [`RungeKutta`](crate::RungeKutta) takes such a load with a law of the sliding speed of one branch, on a
    /// counterface that stands, and [`simulate`](crate::simulate) takes that engine.
    ///
    /// ```
    /// use fmm_friction::Coulomb;
    /// use fmm_model::Oscillator;
    /// use fmm_sim::{Sampling, Scenario, simulate};
    ///
    /// // A mass on a rail; the work of friction is that of the motion: m v₀²/2 = μ N (x + β x³/3).
    /// let scenario = Scenario::new(Oscillator::new(1.0, 0.0)?, Coulomb::new(0.2)?, 10.0)?;
    /// let scenario = scenario.under_curved_load(3.0)?.starting_at(0.0, 2.0)?;
    /// let motion = simulate(&scenario, &Sampling::uniform(0.5, 8)?)?;
    /// let x = motion.rest().expect("friction stops it").position;
    /// assert!((2.0 * (x + x.powi(3)) - 2.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the curvature is not finite.
    pub fn under_curved_load(mut self, curvature: D) -> Result<Self, SimulationError> {
        ModelError::require_finite("curvature of the normal load", curvature.value(), "1/m²")?;
        self.load_over_position = LoadOverPosition::curved(curvature);
        Ok(self)
    }
}

impl<D: Scalar, L: ?Sized> Scenario<D, L> {
    /// Begins anew in the state `initial`, under no other excitation than `force` (N), which grows by `rate` (N/s).
    pub(crate) fn begin(&mut self, initial: State<D>, force: D, rate: D) {
        self.initial = initial;
        self.excitations.clear();
        self.excitations.push(Excitation { source: Source::Ramp { force, rate }, delay: D::from(0.0) });
    }

    /// The normal load at its samples, if it varies.
    pub(crate) fn sampled_load(&self) -> Option<&SampledLoad<D>> {
        self.sampled_load.as_ref()
    }

    /// The normal load over the position.
    pub(crate) fn load_over_position(&self) -> LoadOverPosition<D> {
        self.load_over_position
    }

    /// The largest normal load in the force-free position (N).
    pub(crate) fn largest_load(&self) -> D {
        let samples = self.sampled_load.iter().flat_map(|load| load.values.iter().copied());
        samples.fold(self.normal_load, |most, load| if load.value() > most.value() { load } else { most })
    }

    /// True if the normal load is the same at all times and positions.
    pub(crate) fn has_constant_load(&self) -> bool {
        self.sampled_load.is_none() && self.load_over_position.is_constant()
    }

    /// Checks that the normal load is constant, which `engine` needs.
    pub(crate) fn require_constant_load(&self, engine: &'static str) -> Result<(), SimulationError> {
        if self.has_constant_load() {
            return Ok(());
        }
        Err(SimulationError::NotSupported { engine, what: "a normal load that varies" })
    }

    /// External actions on the machine.
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

    /// N, normal load (N), at t = 0 in the force-free position if it varies.
    pub fn normal_load(&self) -> D {
        self.normal_load
    }

    /// The state at t = 0.
    pub fn initial(&self) -> State<D> {
        self.initial
    }

    /// The state of this `index` of a law with internal states at t = 0, in the law's unit; zero unless
    /// [`with_deflection`](Self::with_deflection) is called.
    pub fn deflection(&self, index: usize) -> D {
        self.deflections.get(index).copied().unwrap_or(D::from(0.0))
    }
}

impl<D: Scalar, L: BristleLaw<D>> Scenario<D, L> {
    /// The scenario with this initial `deflection` of the law's state of this `index`, in the law's unit (m for
    /// bristles and elements): the result of an earlier motion.
    ///
    /// If a state begins at its bound and the motion drives it there, [`Bristle`](crate::Bristle) replaces it by the
    /// bound, with the derivatives of the bound.
    ///
    /// ```
    /// use fmm_friction::Dahl;
    /// use fmm_model::Oscillator;
    /// use fmm_sim::{Sampling, Scenario, simulate};
    ///
    /// // Bristles of 1 kN/m under 10 N, bent by 0.1 mm against a machine without other forces.
    /// let scenario = Scenario::new(Oscillator::new(1.0, 0.0)?, Dahl::new(0.1, 100.0, 1.0)?, 10.0)?.with_deflection(0, 1e-4)?;
    /// let motion = simulate(&scenario, &Sampling::uniform(1e-4, 10)?)?;
    /// // They push it back with 0.1 N.
    /// assert!((motion.velocity().values()[1] + 0.1 * 1e-4).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SimulationError::OutOfRange`] if the law has no such state, or its bound is exceeded.
    pub fn with_deflection(mut self, index: usize, deflection: D) -> Result<Self, SimulationError> {
        let bound = if index < self.law.states() { self.law.bound(index).value() } else { 0.0 };
        if !(index < self.law.states() && deflection.value().is_finite() && deflection.value().abs() <= bound) {
            return Err(SimulationError::deflection(index, deflection.value(), bound));
        }
        if self.deflections.len() <= index {
            self.deflections.resize(index + 1, D::from(0.0));
        }
        self.deflections[index] = deflection;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_friction::{Dahl, MaxwellSlip};
    use fmm_model::Dual;

    use crate::bristle::Bristle;
    use crate::exact::Exact;
    use crate::scenario::{EventKind, Sampling};
    use crate::trajectory::Engine;

    /// Dahl's law with exponent 1 as long as the motion goes on: σ z/μ = 1 − (1 − σ z₀/μ) exp(−σ (x − x₀)/μ).
    #[test]
    fn a_deflected_bristle_follows_its_closed_form() {
        let [coefficient, stiffness] = [0.2, 50.0].map(Dual::<1>::from);
        let machine = Oscillator::new(Dual::from(1.0), Dual::from(100.0)).unwrap();
        let law = Dahl::new(coefficient, stiffness, Dual::from(1.0)).unwrap();
        for begin in [-0.004, -0.001, 0.003, 0.0039] {
            let begin = Dual::variable(begin, 0);
            let scenario = Scenario::new(machine, law, Dual::from(5.0)).unwrap();
            let scenario = scenario.starting_at(Dual::from(-0.05), Dual::from(0.1)).unwrap();
            let scenario = scenario.with_deflection(0, begin).unwrap();
            let sampling = Sampling::uniform(1e-3, 1000).unwrap();
            let motion = Bristle::default().run(&scenario, &sampling).unwrap();
            let end = motion.events()[1].time.value();
            let mut compared = 0;
            for index in (0..1000).take_while(|index| sampling.time(*index) < end) {
                let (x, z) = (motion.position(), &motion.states()[0]);
                let partials = |samples: &crate::trajectory::Samples<Dual<1>>| samples.partial(0).unwrap()[index];
                let left = (-(x.values()[index] + 0.05) * 250.0).exp();
                let expected = 0.004 * (1.0 - (1.0 - begin.value() * 250.0) * left);
                assert!((z.values()[index] - expected).abs() < 1e-9 * 0.004, "{begin:?}, sample {index}");
                // ∂z/∂z₀ + ∂z/∂x · ∂x/∂z₀
                let along = (1.0 - begin.value() * 250.0) * left * partials(x);
                assert!((partials(z) - left - along).abs() < 1e-8, "{begin:?}: {} at {index}", partials(z));
                compared += 1;
            }
            assert!(compared > 100, "{compared} samples");
        }
    }

    /// Elements that begin bent, one of them at its bound so that it slides at once.
    #[test]
    fn deflected_elements_move_alike_on_both_engines() {
        let machine = Oscillator::new(1.0, 100.0).unwrap();
        let law = MaxwellSlip::new(&[(50.0, 0.1), (15.0, 0.1)]).unwrap();
        for deflections in [[0.002, -0.005], [-0.001, 0.004], [0.0, 0.1 / 15.0], [-0.002, 0.0]] {
            for velocity in [0.0, 0.3] {
                let mut scenario =
                    Scenario::new(machine, law.clone(), 4.0).unwrap().starting_at(0.0, velocity).unwrap();
                for (index, deflection) in deflections.into_iter().enumerate() {
                    scenario = scenario.with_deflection(index, deflection).unwrap();
                }
                let sampling = Sampling::uniform(1e-3, 1000).unwrap();
                let exact = Exact.run(&scenario, &sampling).unwrap();
                let stepped = Bristle::default().run(&scenario, &sampling).unwrap();
                assert_eq!(exact.events()[0].kind, EventKind::Start);
                let size = exact.velocity().values().iter().fold(0.0f64, |size, v| size.max(v.abs()));
                assert!(size > 1e-3, "nothing moves");
                for (one, other) in exact.velocity().values().iter().zip(stepped.velocity().values()) {
                    assert!((one - other).abs() < 1e-8 * size, "{deflections:?} m, {velocity} m/s: {one}, {other} m/s");
                }
            }
        }
    }

    #[test]
    fn another_law_changes_the_law_and_its_states_alone() {
        let of = |law| Scenario::new(Oscillator::new(1.0, 100.0).unwrap(), law, 5.0).unwrap();
        let begin =
            |scenario: Scenario<f64, Dahl>| scenario.under_curved_load(2.0).unwrap().starting_at(0.1, 0.2).unwrap();
        let (one, other) = (Dahl::new(0.2, 50.0, 1.0).unwrap(), Dahl::new(0.3, 60.0, 1.0).unwrap());
        let bent = begin(of(one)).with_deflection(0, 1e-4).unwrap();
        assert_eq!(bent.with_law(other), begin(of(other)));
    }

    #[test]
    fn deflections_that_cannot_be_are_refused() {
        let law = Dahl::new(0.2, 50.0, 1.0).unwrap();
        for (index, deflection) in [(0, 0.005), (0, f64::NAN), (0, f64::NEG_INFINITY), (1, 0.0)] {
            let scenario = Scenario::new(Oscillator::new(1.0, 100.0).unwrap(), law, 5.0).unwrap();
            let refused = scenario.with_deflection(index, deflection);
            assert!(matches!(refused, Err(SimulationError::OutOfRange { .. })), "{index}: {deflection} m");
        }
    }
}
