//! Which engine simulates a family of laws when nobody chooses one.

use fmm_friction::{Coulomb, CoulombStatic, CoulombViscous, LawFamily, Viscous};
use fmm_model::Scalar;

use crate::{Engine, Exact, Sampling, Scenario, SimulationError, Trajectory};

/// A family of laws together with the engine that suits it, at every number type.
///
/// An identification is generic in the law and needs the motion at plain and at dual numbers; a bound on
/// [`Engine`] for *all* number types cannot be written, so the family names its engine here once.
///
/// ```
/// # use fmm_friction::{Affine, AffineLaw, LawError, LawFamily, LawParameter, Role, SlidingLaw};
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
///         match values {
///             [coefficient] => Ok(Sticky(Self::PARAMETERS[0].check(*coefficient)?)),
///             _ => Err(LawError::WrongCount { law: Self::NAME, expected: 1, got: values.len() }),
///         }
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
/// impl<D: Scalar> AffineLaw<D> for Sticky<D> {
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
}

/// Laws with a closed-form motion.
macro_rules! simulated_by_the_exact_engine {
    ($($law:ident),+) => {$(
        impl Simulated for $law {
            fn simulate_into<D: Scalar>(
                scenario: &Scenario<D, $law<D>>,
                sampling: &Sampling,
                trajectory: &mut Trajectory<D>,
            ) -> Result<(), SimulationError> {
                Exact.run_into(scenario, sampling, trajectory)
            }
        }
    )+};
}

simulated_by_the_exact_engine!(Viscous, Coulomb, CoulombStatic, CoulombViscous);
