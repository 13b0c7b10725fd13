//! Which engine simulates a family of laws when nobody chooses one.

use fmm_friction::{
    AccelerationCoulomb, Berger, BoucWen, BristleLaw, Coulomb, CoulombStatic, CoulombViscous, Dahl, ExponentialPair,
    FamilyMember, Hyperbolic, Karnopp, LawFamily, LuGre, MakkarDixon, PiecewiseLinearLaw, PowerLaw,
    RegularisedStribeck, Shifted, SlidingLaw, Stribeck, StribeckLorentzian, Viscous,
};
use fmm_model::Scalar;

use crate::{Bristle, Engine, Exact, RungeKutta, Sampling, Scenario, SimulationError, Trajectory};

/// A family of laws together with the engine that suits it, at every number type: what [`simulate`] takes.
///
/// | law | machine and force | engine |
/// |---|---|---|
/// | a level plus a slope, also with two levels | linear | [`Exact`](crate::Exact) |
/// | the same | not linear, driven at the resonance of an undamped machine, or hardly a spring | [`RungeKutta`](crate::RungeKutta) |
/// | any other of the sliding speed | any | [`RungeKutta`](crate::RungeKutta) |
/// | with internal state | any | [`Bristle`](crate::Bristle) |
///
/// [`Trajectory::engine`] says which was taken.
///
/// An identification is generic in the law and needs the motion at plain and at dual numbers; a bound on
/// [`Engine`] for *all* number types cannot be written, so the family names its engine here once.
///
/// ```
/// # use fmm_friction::{Affine, PiecewiseLinearLaw, LawError, LawFamily, LawParameter, Role, SlidingLaw};
/// # use fmm_model::{Bounds, Parameter, Scalar};
/// # use fmm_sim::{Engine, Exact, Sampling, Scenario, SimulationError, Simulated, Trajectory};
/// // A law of one's own, with a static level half as high again as the sliding level.
/// #[derive(Debug, Clone, Copy)]
/// struct Sticky<D = f64>(D);
///
/// impl LawFamily for Sticky {
///     const NAME: &'static str = "sticky";
///     const PARAMETERS: &'static [LawParameter] =
///         &[LawParameter::new(Parameter::new("coefficient", "μ", "1").bounded(Bounds::NOT_NEGATIVE), Role::Level)];
///     type At<D: Scalar> = Sticky<D>;
///     fn at<D: Scalar>(values: &[D]) -> Result<Sticky<D>, LawError> {
///         let [coefficient] = Self::checked(values)?;
///         Ok(Sticky(coefficient))
///     }
/// }
/// impl<D: Scalar> SlidingLaw<D> for Sticky<D> {
///     fn coefficient(&self, speed: D) -> D {
///         self.affine().coefficient(speed)
///     }
///     fn breakaway(&self) -> D {
///         self.affine().breakaway
///     }
/// }
/// impl<D: Scalar> PiecewiseLinearLaw<D> for Sticky<D> {
///     fn affine(&self) -> Affine<D> {
///         Affine { level: self.0, slope: D::from(0.0), breakaway: self.0 * 1.5 }
///     }
/// }
/// impl Simulated for Sticky {
///     fn simulate_into<D: Scalar>(
///         scenario: &Scenario<D, Sticky<D>>,
///         sampling: &Sampling,
///         trajectory: &mut Trajectory<D>,
///     ) -> Result<(), SimulationError> {
///         Exact.run_into(scenario, sampling, trajectory)
///     }
/// }
/// ```
pub trait Simulated: LawFamily {
    /// Simulates `scenario` into `trajectory` with the engine of this family.
    ///
    /// # Errors
    /// As [`Engine::run_into`].
    fn simulate_into<D: Scalar>(
        scenario: &Scenario<D, Self::At<D>>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), SimulationError>;

    /// Simulates to a relative `tolerance` (1) instead of the engine's own, if it has one: a Runge-Kutta run to 1e-10
    /// takes half as long. Unless a family says otherwise its engine has none.
    ///
    /// # Errors
    /// As [`simulate_into`](Self::simulate_into), and [`SimulationError::Tolerance`] for one outside
    /// 1e-15 to 1e-2, whether the engine has a tolerance or not.
    fn simulate_within<D: Scalar>(
        scenario: &Scenario<D, Self::At<D>>,
        sampling: &Sampling,
        tolerance: f64,
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), SimulationError> {
        SimulationError::require_tolerance(tolerance)?;
        Self::simulate_into(scenario, sampling, trajectory)
    }

    /// Friction coefficient (1) of steady sliding at `speed` ≥ 0 (m/s), in the limit of a speed that grows slowly or, if it is
    /// `losing`, falls; none unless the family says so. A search among laws begins a fit by one where another has ended by it.
    fn steady_coefficient<D: Scalar>(law: &Self::At<D>, speed: D, losing: bool) -> Option<D> {
        let _ = (law, speed, losing);
        None
    }
}

/// Simulates `scenario` with the engine that suits its law ([`Simulated`]).
///
/// ```
/// use fmm_friction::Stribeck;
/// use fmm_model::{Dual, Oscillator, Scalar};
/// use fmm_sim::{Sampling, Scenario, simulate};
///
/// // The derivative in the static coefficient; all other numbers follow from the one that is said to have two directions.
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
/// As [`Engine::run_into`].
pub fn simulate<L>(
    scenario: &Scenario<L::Number, L>,
    sampling: &Sampling,
) -> Result<Trajectory<L::Number>, SimulationError>
where
    L: FamilyMember<Family: Simulated>,
{
    let mut trajectory = Trajectory::new();
    L::Family::simulate_into(scenario, sampling, &mut trajectory)?;
    Ok(trajectory)
}

/// Friction coefficient (1) of a law of the sliding `speed` (m/s).
fn of_speed<D: Scalar>(law: &impl SlidingLaw<D>, speed: D, losing: bool) -> impl Into<Option<D>> {
    if losing { law.coefficient_losing_speed(speed) } else { law.coefficient(speed) }
}

/// Friction coefficient (1) of a law with internal state in steady sliding at `speed` (m/s).
fn of_state<D: Scalar>(law: &impl BristleLaw<D>, speed: D, _losing: bool) -> impl Into<Option<D>> {
    law.steady_coefficient(speed)
}

/// Below this ω₀ t the closed form has lost four digits.
const WEAK_SPRING: f64 = 1e-2;

/// Runs the exact engine, or the Runge-Kutta engine if the machine or the force has no closed form.
fn exact_where_possible<D: Scalar, L: PiecewiseLinearLaw<D> + SlidingLaw<D>>(
    scenario: &Scenario<D, L>,
    sampling: &Sampling,
    tolerance: Option<f64>,
    trajectory: &mut Trajectory<D>,
) -> Result<(), SimulationError> {
    // On a spring that does not turn the motion round within the sampled time, the closed form is a small difference of
    // large numbers.
    let turns = scenario.oscillator().natural_angular_frequency().value() * sampling.end();
    if turns < WEAK_SPRING {
        return integrated(scenario, sampling, tolerance, trajectory);
    }
    match Exact.run_into(scenario, sampling, trajectory) {
        Err(
            SimulationError::NotLinear { .. } | SimulationError::Resonance { .. } | SimulationError::WeakSpring { .. },
        ) => integrated(scenario, sampling, tolerance, trajectory),
        other => other,
    }
}

/// Runs the Runge-Kutta engine.
fn integrated<D: Scalar, L: SlidingLaw<D>>(
    scenario: &Scenario<D, L>,
    sampling: &Sampling,
    tolerance: Option<f64>,
    trajectory: &mut Trajectory<D>,
) -> Result<(), SimulationError> {
    let engine = tolerance.map_or_else(|| Ok(RungeKutta::default()), RungeKutta::new)?;
    engine.run_into(scenario, sampling, trajectory)
}

/// Runs the engine for laws with internal state.
fn with_bristles<D: Scalar, L: BristleLaw<D>>(
    scenario: &Scenario<D, L>,
    sampling: &Sampling,
    tolerance: Option<f64>,
    trajectory: &mut Trajectory<D>,
) -> Result<(), SimulationError> {
    let engine = tolerance.map_or_else(|| Ok(Bristle::default()), Bristle::new)?;
    engine.run_into(scenario, sampling, trajectory)
}

macro_rules! simulated {
    ($run:ident, $steady:ident: $($law:ty),+) => {$(
        impl Simulated for $law {
            fn simulate_into<D: Scalar>(
                scenario: &Scenario<D, Self::At<D>>,
                sampling: &Sampling,
                trajectory: &mut Trajectory<D>,
            ) -> Result<(), SimulationError> {
                $run(scenario, sampling, None, trajectory)
            }
            fn simulate_within<D: Scalar>(
                scenario: &Scenario<D, Self::At<D>>,
                sampling: &Sampling,
                tolerance: f64,
                trajectory: &mut Trajectory<D>,
            ) -> Result<(), SimulationError> {
                SimulationError::require_tolerance(tolerance)?;
                $run(scenario, sampling, Some(tolerance), trajectory)
            }
            fn steady_coefficient<D: Scalar>(law: &Self::At<D>, speed: D, losing: bool) -> Option<D> {
                $steady(law, speed, losing).into()
            }
        }
    )+};
}

simulated!(exact_where_possible, of_speed: Viscous, Coulomb, CoulombStatic, CoulombViscous, AccelerationCoulomb);
simulated!(integrated, of_speed: Stribeck, StribeckLorentzian, Hyperbolic, Berger, PowerLaw, ExponentialPair, Karnopp);
simulated!(integrated, of_speed: MakkarDixon, Shifted<MakkarDixon>, RegularisedStribeck);
simulated!(with_bristles, of_state: Dahl, LuGre, BoucWen);

#[cfg(test)]
mod tests {
    use fmm_model::Oscillator;

    use super::*;

    fn velocity<F: Simulated>(values: &[f64], tolerance: Option<f64>) -> Result<Vec<f64>, SimulationError> {
        let law = F::at(values).expect("a law");
        let scenario = Scenario::new(Oscillator::new(10.0, 2000.0)?, law, 10.0)?.starting_at(0.01, 0.0)?;
        let (sampling, mut trajectory) = (Sampling::uniform(1e-3, 800)?, Trajectory::<f64>::new());
        match tolerance {
            Some(tolerance) => F::simulate_within(&scenario, &sampling, tolerance, &mut trajectory)?,
            None => F::simulate_into(&scenario, &sampling, &mut trajectory)?,
        }
        Ok(trajectory.velocity().values().to_vec())
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
                assert!(matches!(refused, Err(SimulationError::Tolerance { .. })), "{tolerance}");
            }
        }
    }
}
