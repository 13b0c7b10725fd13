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

/// Simulations of the laws of one family, and friction of theirs along measured motions.
pub(crate) trait Members: Debug + Sync {
    /// Simulates a motion.
    fn plain(&self, motion: &Motion<f64>, sampling: &Sampling, trajectory: &mut Trajectory) -> Done;

    /// Simulates a motion with derivatives in few directions.
    fn few(&self, motion: &Motion<Dual<FEW>>, sampling: &Sampling, trajectory: &mut Trajectory<Dual<FEW>>) -> Done;

    /// Simulates a motion with derivatives.
    fn with_derivatives(
        &self,
        motion: &Motion<Dual<DIRECTIONS>>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<Dual<DIRECTIONS>>,
    ) -> Done;

    /// Friction coefficient (1) of the law of these `values` at the sample of each location; of a law of the speed that
    /// leaps at rest none, 0, where the contact may not slide.
    fn along(&self, values: &[f64], alignment: Alignment<'_, f64>, friction: &mut Vec<f64>) -> Done;

    /// The same with derivatives.
    fn along_with_derivatives(
        &self,
        values: &[Dual<DIRECTIONS>],
        alignment: Alignment<'_, Dual<DIRECTIONS>>,
        friction: &mut Vec<Dual<DIRECTIONS>>,
    ) -> Done;

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

/// Simulates a motion by family `F`.
fn simulate<F: LawFamily, D: Scalar>(motion: &Motion<D>, sampling: &Sampling, trajectory: &mut Trajectory<D>) -> Done {
    let scenario = motion.scenario(F::at(&motion.law)?)?;
    Ok(simulate_into::<F, _>(&scenario, sampling, motion.tolerance, trajectory)?)
}

/// Simulates a motion by a law that is known at run time only.
fn slide<D: Scalar>(law: &OwnLaw, motion: &Motion<D>, sampling: &Sampling, trajectory: &mut Trajectory<D>) -> Done {
    let engine = motion.tolerance.map_or_else(|| Ok(RungeKutta::default()), RungeKutta::new)?;
    Ok(engine.run_into(&motion.scenario(law.at(&motion.law)?)?, sampling, trajectory)?)
}

impl<F: LawFamily> Members for Of<F> {
    fn plain(&self, motion: &Motion<f64>, sampling: &Sampling, trajectory: &mut Trajectory) -> Done {
        simulate::<F, _>(motion, sampling, trajectory)
    }

    fn few(&self, motion: &Motion<Dual<FEW>>, sampling: &Sampling, trajectory: &mut Trajectory<Dual<FEW>>) -> Done {
        simulate::<F, _>(motion, sampling, trajectory)
    }

    fn with_derivatives(
        &self,
        motion: &Motion<Dual<DIRECTIONS>>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<Dual<DIRECTIONS>>,
    ) -> Done {
        simulate::<F, _>(motion, sampling, trajectory)
    }

    fn along(&self, values: &[f64], alignment: Alignment<'_, f64>, friction: &mut Vec<f64>) -> Done {
        along::<F, _>(values, alignment, friction)
    }

    fn along_with_derivatives(
        &self,
        values: &[Dual<DIRECTIONS>],
        alignment: Alignment<'_, Dual<DIRECTIONS>>,
        friction: &mut Vec<Dual<DIRECTIONS>>,
    ) -> Done {
        along::<F, _>(values, alignment, friction)
    }

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

impl Members for OwnLaw {
    fn plain(&self, motion: &Motion<f64>, sampling: &Sampling, trajectory: &mut Trajectory) -> Done {
        slide(self, motion, sampling, trajectory)
    }

    fn few(&self, motion: &Motion<Dual<FEW>>, sampling: &Sampling, trajectory: &mut Trajectory<Dual<FEW>>) -> Done {
        slide(self, motion, sampling, trajectory)
    }

    fn with_derivatives(
        &self,
        motion: &Motion<Dual<DIRECTIONS>>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<Dual<DIRECTIONS>>,
    ) -> Done {
        slide(self, motion, sampling, trajectory)
    }

    fn along(&self, values: &[f64], alignment: Alignment<'_, f64>, friction: &mut Vec<f64>) -> Done {
        along_sliding(&self.at(values)?, alignment, friction);
        Ok(())
    }

    fn along_with_derivatives(
        &self,
        values: &[Dual<DIRECTIONS>],
        alignment: Alignment<'_, Dual<DIRECTIONS>>,
        friction: &mut Vec<Dual<DIRECTIONS>>,
    ) -> Done {
        along_sliding(&self.at(values)?, alignment, friction);
        Ok(())
    }

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
