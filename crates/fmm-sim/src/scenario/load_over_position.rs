//! Normal load over the position of the machine.

use fmm_model::Scalar;

/// Normal load over that in the force-free position, 1 + β x², not below zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LoadOverPosition<D> {
    /// β (1/m²); `None` for a load that is the same at all positions.
    curvature: Option<D>,
}

impl<D> Default for LoadOverPosition<D> {
    fn default() -> Self {
        Self { curvature: None }
    }
}

impl<D: Scalar> LoadOverPosition<D> {
    /// A load of this `curvature` (1/m²).
    pub(crate) fn curved(curvature: D) -> Self {
        Self { curvature: Some(curvature) }
    }

    /// True if the load does not depend on the position, not in a derivative either.
    pub(crate) fn is_constant(&self) -> bool {
        self.curvature.is_none()
    }

    /// The load at `position` (m) over that in the force-free position (1).
    #[inline]
    pub(crate) fn factor(&self, position: D) -> D {
        let one = D::from(1.0);
        match self.curvature {
            None => one,
            Some(curvature) => {
                let factor = one + curvature * position * position;
                if factor.value() > 0.0 { factor } else { D::from(0.0) }
            }
        }
    }

    /// Its slope at `position` (1/m).
    pub(crate) fn slope(&self, position: D) -> D {
        match self.curvature {
            Some(curvature) if self.factor(position).value() > 0.0 => curvature * position * 2.0,
            _ => D::from(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use fmm_friction::{AccelerationCoulomb, Coulomb, CoulombStatic};
    use fmm_model::{Dual, Oscillator, Scalar};

    use crate::error::SimulationError;
    use crate::scenario::{EventKind, Excitation, Sampling, Scenario};
    use crate::simulate::simulate;
    use crate::trajectory::Trajectory;

    const COEFFICIENT: f64 = 0.2;
    const LOAD: f64 = 15.0;
    const STIFFNESS: f64 = 2000.0;

    /// A release at 10 mm under a load of this curvature.
    fn release<D: Scalar>(curvature: D) -> Trajectory<D> {
        let machine = Oscillator::new(D::from(10.0), D::from(STIFFNESS)).unwrap();
        let law = CoulombStatic::new(D::from(COEFFICIENT), D::from(1.2 * COEFFICIENT)).unwrap();
        let scenario = Scenario::new(machine, law, D::from(LOAD)).unwrap().under_curved_load(curvature).unwrap();
        let scenario = scenario.starting_at(D::from(0.01), D::from(0.0)).unwrap();
        simulate(&scenario, &Sampling::uniform(0.02, 200).unwrap()).unwrap()
    }

    /// k (x₁² − x₂²)/2 = μ N |x₁ − x₂ + β (x₁³ − x₂³)/3| from one reversal to the next, and at rest k x within μ_s N (1 + β x²).
    #[test]
    fn each_half_swing_loses_the_work_of_the_curved_load() {
        for curvature in [-8e3, -2e3, 2e3, 2e4] {
            let motion = release(curvature);
            let turns: Vec<f64> = motion.events().iter().map(|event| event.position).collect();
            assert!(turns.len() > 3, "{curvature}: {} half swings", turns.len());
            for pair in turns.windows(2) {
                let lost = 0.5 * STIFFNESS * (pair[0] * pair[0] - pair[1] * pair[1]);
                let path = pair[0] - pair[1] + curvature * (pair[0].powi(3) - pair[1].powi(3)) / 3.0;
                assert!((lost / (COEFFICIENT * LOAD * path.abs()) - 1.0).abs() < 1e-10, "{curvature}: {pair:?}");
            }
            let last = motion.events().last().unwrap();
            let held = 1.2 * COEFFICIENT * LOAD * (1.0 + curvature * last.position * last.position);
            assert_eq!(last.kind, EventKind::Stop, "{curvature}");
            assert!(STIFFNESS * last.position.abs() < held && motion.rest().is_some(), "{curvature}");
        }
    }

    /// A contact that its load leaves at 5 mm has lost nothing before.
    #[test]
    fn a_contact_that_has_lifted_has_no_friction() {
        let motion = release(-4e4);
        let first = motion.events()[1].position;
        let work = 2.0 * (0.005 - 4e4 * 0.005f64.powi(3) / 3.0);
        let lost = 0.5 * STIFFNESS * (1e-4 - first * first);
        assert!((lost / (COEFFICIENT * LOAD * work) - 1.0).abs() < 1e-7, "{lost} J");
    }

    #[test]
    fn derivatives_by_the_curvature_are_those_of_differences() {
        let exact = release(Dual::<1>::variable(3e3, 0));
        let step = 1.0;
        let [above, below] = [3e3 + step, 3e3 - step].map(release);
        for index in (0..60).step_by(7) {
            let difference = (above.position().values()[index] - below.position().values()[index]) / (2.0 * step);
            let partial = exact.position().partial(0).unwrap()[index];
            assert!((partial - difference).abs() < 1e-6 * 1e-6, "sample {index}: {partial}, {difference}");
        }
    }

    #[test]
    fn what_the_engine_cannot_follow_is_refused() {
        let machine = Oscillator::new(1.0, 100.0).unwrap();
        let sampling = Sampling::uniform(0.01, 10).unwrap();
        let branches = Scenario::new(machine, AccelerationCoulomb::new(0.2, 0.1).unwrap(), 1.0).unwrap();
        let refused = simulate(&branches.under_curved_load(1.0).unwrap(), &sampling);
        assert!(matches!(refused, Err(SimulationError::NotSupported { .. })), "{refused:?}");
        let belt = Scenario::new(machine, Coulomb::new(0.2).unwrap(), 1.0).unwrap();
        let belt = belt.under_curved_load(1.0).unwrap().driven_by(Excitation::belt(0.1).unwrap());
        assert!(matches!(simulate(&belt, &sampling), Err(SimulationError::NotSupported { .. })));
        let scenario = Scenario::new(machine, Coulomb::new(0.2).unwrap(), 1.0).unwrap();
        assert!(scenario.under_curved_load(f64::NAN).is_err());
    }
}
