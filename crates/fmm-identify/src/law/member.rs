//! Laws of given parameter values, of a family or known at run time only: what is compiled once for each family.

use std::fmt::{self, Debug};
use std::marker::PhantomData;

use fmm_fit::EvaluationError;
use fmm_friction::{FamilyVisitor, LawFamily, LawKind, OwnLaw, Reparametrisation, SlidingLaw};
use fmm_model::{Dual, Scalar};
use fmm_sim::{Engine, RungeKutta, Sampling, Trajectory, simulate_into};

use super::along::{Alignment, along, along_sliding};
use super::{DIRECTIONS, FEW, Law, Motion};

/// Result of a simulation, or of a law that is followed.
type Done = Result<(), EvaluationError>;

/// Laws whose motions are simulated in numbers of kind `D`.
pub(crate) trait Simulated<D: Scalar> {
    /// Simulates a motion.
    fn simulate(&self, motion: &Motion<D>, sampling: &Sampling, trajectory: &mut Trajectory<D>) -> Done;
}

/// Laws that are followed along measured motions in numbers of kind `D`.
pub(crate) trait Followed<D: Scalar> {
    /// Friction coefficient (1) of the law of these `values` at the sample of each location; of a law of the speed that
    /// leaps at rest none, 0, where the contact may not slide.
    fn along(&self, values: &[D], alignment: Alignment<'_, D>, friction: &mut Vec<D>) -> Done;
}

/// Laws of one family, or one law that is known at run time only, in plain numbers and with derivatives.
pub(crate) trait Members:
    Simulated<f64>
    + Simulated<Dual<FEW>>
    + Simulated<Dual<DIRECTIONS>>
    + Followed<f64>
    + Followed<Dual<DIRECTIONS>>
    + Debug
    + Sync
{
    /// Friction coefficient (1) of steady sliding by these `values` at a speed (m/s) that grows or, if it is `losing`,
    /// falls.
    fn steady(&self, values: &[f64], speed: f64, losing: bool) -> Option<f64>;

    /// Kind of the laws.
    fn kind(&self) -> LawKind;

    /// The same laws by parameters that a fit finds in fewer steps.
    fn recast(&self) -> Option<Reparametrisation<Law>>;
}

/// Members of family `F`.
pub(crate) struct Of<F>(pub(crate) PhantomData<fn() -> F>);

impl<F: LawFamily> Debug for Of<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(F::NAME)
    }
}

/// Makes values of families.
struct Laws;

impl FamilyVisitor for Laws {
    type Output = Law;

    fn visit<F: LawFamily>(&mut self) -> Law {
        Law::of::<F>()
    }
}

impl<F: LawFamily, D: Scalar> Simulated<D> for Of<F> {
    fn simulate(&self, motion: &Motion<D>, sampling: &Sampling, trajectory: &mut Trajectory<D>) -> Done {
        let scenario = motion.scenario(F::at(&motion.law)?)?;
        Ok(simulate_into::<F, _>(&scenario, sampling, motion.tolerance, trajectory)?)
    }
}

impl<F: LawFamily, D: Scalar> Followed<D> for Of<F> {
    fn along(&self, values: &[D], alignment: Alignment<'_, D>, friction: &mut Vec<D>) -> Done {
        along::<F, _>(values, alignment, friction)
    }
}

impl<F: LawFamily> Members for Of<F> {
    fn steady(&self, values: &[f64], speed: f64, losing: bool) -> Option<f64> {
        F::steady_coefficient(&F::at::<f64>(values).ok()?, speed, losing)
    }

    fn kind(&self) -> LawKind {
        F::kind()
    }

    fn recast(&self) -> Option<Reparametrisation<Law>> {
        F::reparametrisation(&mut Laws)
    }
}

impl<D: Scalar> Simulated<D> for OwnLaw {
    fn simulate(&self, motion: &Motion<D>, sampling: &Sampling, trajectory: &mut Trajectory<D>) -> Done {
        let engine = motion.tolerance.map_or_else(|| Ok(RungeKutta::default()), RungeKutta::new)?;
        Ok(engine.run_into(&motion.scenario(self.at(&motion.law)?)?, sampling, trajectory)?)
    }
}

impl<D: Scalar> Followed<D> for OwnLaw {
    fn along(&self, values: &[D], alignment: Alignment<'_, D>, friction: &mut Vec<D>) -> Done {
        along_sliding(&self.at(values)?, alignment, friction);
        Ok(())
    }
}

impl Members for OwnLaw {
    fn steady(&self, values: &[f64], speed: f64, _losing: bool) -> Option<f64> {
        self.at(values).ok().map(|member| member.coefficient(speed)).filter(|coefficient| coefficient.is_finite())
    }

    fn kind(&self) -> LawKind {
        LawKind::Sliding
    }

    fn recast(&self) -> Option<Reparametrisation<Law>> {
        None
    }
}
