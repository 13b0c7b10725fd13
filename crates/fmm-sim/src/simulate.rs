//! Simulation by the engine that suits a law.

use fmm_friction::{BristleLaw, FamilyMember, LawFamily, LawVisitor, PiecewiseLinearLaw, SlidingLaw};
use fmm_model::Scalar;

use crate::bristle::Bristle;
use crate::error::SimulationError;
use crate::exact::Exact;
use crate::mechanics::WEAK_SPRING;
use crate::runge_kutta::RungeKutta;
use crate::scenario::{Sampling, Scenario};
use crate::trajectory::{Engine, Trajectory};

/// Simulates `scenario` with the engine that suits its law.
///
/// | law | machine and force | engine |
/// |---|---|---|
/// | a level plus a slope, also with two levels; elements | linear | [`Exact`](crate::Exact) |
/// | a level plus a slope, also with two levels | not linear, at the resonance of an undamped machine, under a load that varies, or with hardly a spring | [`RungeKutta`](crate::RungeKutta) |
/// | any other of the sliding speed | any | [`RungeKutta`](crate::RungeKutta) |
/// | with internal state, elements on a machine that is not linear among them | any | [`Bristle`](crate::Bristle) |
///
/// [`Trajectory::engine`] is the name of the engine. A user's law needs [`LawFamily`] and [`FamilyMember`], which state
/// its kind, beside its formula. A law that is only a [`SlidingLaw`] or a [`BristleLaw`] is simulated by
/// [`RungeKutta`](crate::RungeKutta) or [`Bristle`](crate::Bristle) directly.
///
/// ```
/// use fmm_friction::Stribeck;
/// use fmm_model::{Dual, Oscillator, Scalar};
/// use fmm_sim::{Sampling, Scenario, simulate};
///
/// // The derivative in the static coefficient; the number type of the others follows from the first.
/// let machine = Oscillator::new(Dual::<2>::from(10.0), Dual::from(2000.0))?;
/// let law = Stribeck::new(Dual::from(0.1), Dual::variable(0.15, 0), Dual::from(0.02), Dual::from(1.0), Dual::from(0.0))?;
/// let scenario = Scenario::new(machine, law, Dual::from(10.0))?.starting_at(Dual::from(0.01), Dual::from(0.0))?;
/// let motion = simulate(&scenario, &Sampling::uniform(1e-3, 3000)?)?;
/// assert_eq!(motion.engine(), "runge_kutta");
/// let rest = motion.rest().expect("friction stops it");
/// assert!(rest.position.partial(0).abs() > 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SimulationError`] in the cases of [`Engine::run_into`].
pub fn simulate<L>(
    scenario: &Scenario<L::Number, L>,
    sampling: &Sampling,
) -> Result<Trajectory<L::Number>, SimulationError>
where
    L: FamilyMember,
{
    let mut trajectory = Trajectory::new();
    simulate_into::<L::Family, _>(scenario, sampling, None, &mut trajectory)?;
    Ok(trajectory)
}

/// Simulates `scenario` with the engine that suits the laws of family `F`, as [`simulate`] does, into `trajectory`. A
/// relative `tolerance` (1) replaces that of the engine, if the engine has one: a Runge-Kutta run to 1e-10 takes half
/// as long.
///
/// # Errors
/// [`SimulationError`] in the cases of [`Engine::run_into`], and [`SimulationError::OutOfRange`] for a tolerance
/// outside 1e-15 to 1e-2, even for an engine without one.
pub fn simulate_into<F: LawFamily, D: Scalar>(
    scenario: &Scenario<D, F::At<D>>,
    sampling: &Sampling,
    tolerance: Option<f64>,
    trajectory: &mut Trajectory<D>,
) -> Result<(), SimulationError> {
    if let Some(tolerance) = tolerance {
        SimulationError::require_tolerance(tolerance)?;
    }
    F::visit(Simulation { scenario, sampling, tolerance, trajectory })
}

/// A scenario to be simulated by the kind of its law.
struct Simulation<'a, D: Scalar, L> {
    scenario: &'a Scenario<D, L>,
    sampling: &'a Sampling,
    tolerance: Option<f64>,
    trajectory: &'a mut Trajectory<D>,
}

/// All laws share one copy of an engine that integrates. A copy for each law was a third of the compile time of a
/// program with all laws; a run through a pointer to the law takes 1 to 5 % longer.
impl<D: Scalar, L> LawVisitor<D, L> for Simulation<'_, D, L> {
    type Output = Result<(), SimulationError>;

    fn sliding(self) -> Self::Output
    where
        L: SlidingLaw<D>,
    {
        let engine = self.tolerance.map_or_else(|| Ok(RungeKutta::default()), RungeKutta::new)?;
        let scenario: &Scenario<D, dyn SlidingLaw<D> + '_> = self.scenario;
        engine.run_into(scenario, self.sampling, self.trajectory)
    }

    fn piecewise_linear(self) -> Self::Output
    where
        L: PiecewiseLinearLaw<D> + SlidingLaw<D>,
    {
        // On a spring that does not turn the motion round within the sampled time, the closed form is a small
        // difference of large numbers.
        let turns = self.scenario.oscillator().natural_angular_frequency().value() * self.sampling.end();
        if turns < WEAK_SPRING {
            return self.sliding();
        }
        match Exact.run_into(self.scenario, self.sampling, self.trajectory) {
            Err(SimulationError::NoClosedForm { .. }) => self.sliding(),
            other => other,
        }
    }

    fn bristle(self) -> Self::Output
    where
        L: BristleLaw<D>,
    {
        let engine = self.tolerance.map_or_else(|| Ok(Bristle::default()), Bristle::new)?;
        let scenario: &Scenario<D, dyn BristleLaw<D> + '_> = self.scenario;
        engine.run_into(scenario, self.sampling, self.trajectory)
    }

    fn elements(self) -> Self::Output
    where
        L: PiecewiseLinearLaw<D> + BristleLaw<D>,
    {
        match Exact.run_into(self.scenario, self.sampling, self.trajectory) {
            Err(SimulationError::NoClosedForm { .. }) => self.bristle(),
            other => other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_friction::{Berger, Coulomb, MaxwellSlipOf};
    use fmm_model::{Damping, Oscillator};

    fn velocity<F: LawFamily>(values: &[f64], tolerance: Option<f64>) -> Result<Vec<f64>, SimulationError> {
        let law = F::at(values).expect("a law");
        let scenario = Scenario::new(Oscillator::new(10.0, 2000.0)?, law, 10.0)?.starting_at(0.01, 0.0)?;
        let (sampling, mut trajectory) = (Sampling::uniform(1e-3, 800)?, Trajectory::<f64>::new());
        simulate_into::<F, _>(&scenario, &sampling, tolerance, &mut trajectory)?;
        Ok(trajectory.velocity().values().to_vec())
    }

    /// Elements move a linear machine in closed form. With other damping they are integrated; they do not take a load
    /// that varies.
    #[test]
    fn elements_go_to_the_engine_that_takes_them() {
        let law = || MaxwellSlipOf::<2>::at(&[0.1, 4e3, 0.1, 1e3]).unwrap();
        let sampling = Sampling::uniform(1e-3, 500).unwrap();
        let run = |machine: Oscillator, load: &[f64]| {
            let scenario = Scenario::new(machine, law(), 1.0)?.under_sampled_load(1.0, load)?.starting_at(0.01, 0.0)?;
            let mut motion = Trajectory::new();
            simulate_into::<MaxwellSlipOf<2>, _>(&scenario, &sampling, None, &mut motion)?;
            Ok::<_, SimulationError>(motion.engine())
        };
        let linear = Oscillator::new(10.0, 2000.0).unwrap();
        let damped = linear.with_damping(Damping::new(0.0, 1.0).unwrap());
        assert_eq!((run(linear, &[10.0]), run(damped, &[10.0])), (Ok("exact"), Ok("bristle")));
        assert!(matches!(run(linear, &[10.0, 20.0]), Err(SimulationError::NotSupported { engine: "bristle", .. })));
    }

    /// The tolerance reaches the engines that have one, and no other.
    #[test]
    fn tolerances_reach_the_engines_that_have_one() {
        let largest = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let berger = velocity::<Berger>(&[0.1, 0.1, 5.0], None).unwrap();
        for (tolerance, bounds) in [(1e-6, 1e-10..1e-5), (1e-9, 1e-13..1e-8)] {
            let off = largest(&velocity::<Berger>(&[0.1, 0.1, 5.0], Some(tolerance)).unwrap(), &berger);
            assert!(bounds.contains(&off), "{off} m/s at {tolerance}");
        }
        let coulomb = velocity::<Coulomb>(&[0.1], None).unwrap();
        assert_eq!(velocity::<Coulomb>(&[0.1], Some(1e-3)).unwrap(), coulomb);
        for tolerance in [0.0, -1e-9, 0.1, f64::NAN] {
            for refused in
                [velocity::<Berger>(&[0.1, 0.1, 5.0], Some(tolerance)), velocity::<Coulomb>(&[0.1], Some(tolerance))]
            {
                assert!(matches!(refused, Err(SimulationError::OutOfRange { .. })), "{tolerance}");
            }
        }
    }
}
