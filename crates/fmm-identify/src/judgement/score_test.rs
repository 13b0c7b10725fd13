//! Score tests: the residuals of a simple law ask for small extensions of it, without a further fit.

use std::f64::consts::PI;
use std::fmt;

use fmm_fit::{Estimate, EvaluationError, Residuals};
use fmm_friction::{Berger, Coulomb, CoulombViscous, Dahl, LawFamily};
use fmm_model::{ModelError, Restoring};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::{Experiment, reference};
use crate::identification::Identification;
use crate::judgement::rules::{FALLS, LEAST_CHANGE, STEP};
use crate::law::naming::LINEAR;
use crate::machine::Terms;
use crate::machine::term::Term;
use crate::problem::Problem;
use crate::problem::tangent::Tangent;
use crate::quantities::rows::Place;
use crate::residuals::rules::{SIGNIFICANT, SIGNIFICANT_FALL, SIGNIFICANT_PRESLIDING};
use crate::warning::Warning;

/// An extension of Coulomb and viscous friction on a linear spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Extension {
    /// Friction that falls with the speed, by 1/e over this share of the largest speed (1).
    FallsWithSpeed(f64),
    /// Damping that grows with the square of the speed.
    QuadraticDamping,
    /// Presliding: the contact yields before it slides.
    Presliding,
    /// A restoring force that softens with the displacement.
    SofteningSpring,
}

impl fmt::Display for Extension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FallsWithSpeed(share) => {
                write!(f, "friction that falls within {:.0} % of the largest speed", 100.0 * share)
            }
            Self::QuadraticDamping => write!(f, "damping with the square of the speed"),
            Self::Presliding => write!(f, "presliding of the contact"),
            Self::SofteningSpring => write!(f, "a spring that softens"),
        }
    }
}

/// Score test of one extension: its size by the residuals, with its uncertainty. `Display` names the extension.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ScoreTest {
    pub(crate) extension: Extension,
    /// Size that the residuals ask for, as a share of the friction, of the amplitude or of the stiffness (1). Negative:
    /// its opposite.
    pub size: f64,
    /// Standard uncertainty of the size (1).
    pub uncertainty: f64,
}

impl fmt::Display for ScoreTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "sign of {}: {:.1} standard uncertainties", self.extension, self.significance())
    }
}

impl ScoreTest {
    /// The size in standard uncertainties (1).
    pub fn significance(&self) -> f64 {
        self.size / self.uncertainty
    }

    /// Chance alone gives a size as large in one test of a hundred or fewer.
    pub fn is_significant(&self) -> bool {
        match self.extension {
            Extension::FallsWithSpeed(_) if self.size > 0.0 => self.significance() > SIGNIFICANT_FALL,
            Extension::Presliding if self.size > 0.0 => self.significance() > SIGNIFICANT_PRESLIDING,
            _ => self.significance().abs() > SIGNIFICANT,
        }
    }
}

/// Score tests of the residuals of `base`, an identification by Coulomb and viscous friction that may change during the
/// record, and a warning for each extension that cannot be simulated.
///
/// ```text
/// a = −dᵀr/dᵀd,     u² = dᵀΣd/(dᵀd)²,     d = (1 − J(JᵀJ)⁻¹Jᵀ) (m(a₀) − m(0))/a₀
/// ```
///
/// m(a₀) is the motion with a small extension, d the part of its change that no parameter of the simple law can follow.
pub(crate) fn score_tests(
    base: &Identification,
    decays: &[Experiment],
) -> Result<(Vec<ScoreTest>, Vec<Warning>), IdentifyError> {
    let machine = *base.machine();
    let problem = base.problem(decays)?;
    let is_run_down = reference(decays).is_run_down();
    if problem.table.oscillator != 1 && !is_run_down || !is_simple(base) {
        return Ok((Vec::new(), Vec::new()));
    }
    let value = |name: &str| base.fit().estimate(name).map_or(0.0, Estimate::value);
    let friction = base.fit().values()[problem.table.law];
    let damping = value(LINEAR);
    let (length, speed) = reference(decays).scales();
    // For a machine without friction, the level with the same losses.
    let level = friction.max(0.25 * PI * 0.5 * damping * speed).max(f64::MIN_POSITIVE);
    // The residuals of an extension with these `values` of its law, or a step of quadratic damping.
    let residuals = |problem: &Problem<'_>, of_law: &[f64]| -> Result<Vec<f64>, EvaluationError> {
        let table = &problem.table;
        let mut values = problem.extended(base.fit());
        values[table.law..table.law + of_law.len()].copy_from_slice(of_law);
        if let Some(quadratic) = table.shared(Place::Term(Term::QuadraticDamping)) {
            values[quadratic] = STEP * level / (speed * speed);
        }
        let mut residuals = vec![0.0; problem.len()];
        problem.evaluate(&values, &mut residuals, None)?;
        Ok(residuals)
    };
    let of_base = &base.fit().values()[problem.table.of_law()];
    let mut changes: Vec<(Extension, Result<Vec<f64>, EvaluationError>)> = Vec::new();
    let linear = base.fitted.model.terms.clone().with_linear_damping();
    for share in FALLS {
        let berger = Problem::of(&Candidate::of::<Berger>().with(linear.clone()), machine, decays)?;
        let of_law = [friction, STEP * level, 1.0 / (share * speed)];
        changes.push((Extension::FallsWithSpeed(share), residuals(&berger, &of_law)));
    }
    let quadratic = base.fitted.model.terms.clone().with_quadratic_damping();
    let quadratic = Problem::of(&base.fitted.model.clone().with(quadratic), machine, decays)?;
    changes.push((Extension::QuadraticDamping, residuals(&quadratic, of_base)));
    // A contact with internal state takes no load that changes.
    let terms = &base.fitted.model.terms;
    if friction > 0.0 && !is_run_down && !terms.has(Term::Change) && !terms.has(Term::Position) {
        let dahl = Problem::of(&Candidate::of::<Dahl>().with(linear), machine, decays)?;
        let of_law = [friction, friction / (STEP * length), 1.0];
        changes.push((Extension::Presliding, residuals(&dahl, &of_law)));
    }
    if machine.restoring() == Restoring::Linear && !is_run_down && !base.fitted.model.terms.has_spring() {
        let softened = |length: f64| -> Result<_, ModelError> { Ok(machine.with_restoring(Restoring::sine(length)?)) };
        // The sine of x/L loses x²/6L² of the stiffness.
        let softened = softened(length / (6.0 * STEP).sqrt())?;
        let softened = Problem::of(&base.fitted.model, softened, decays)?;
        changes.push((Extension::SofteningSpring, residuals(&softened, of_base)));
    }
    let no_derivatives = || EvaluationError::message("the fit has no derivatives");
    let tangent = Tangent::of(&problem, base.fit())
        .ok_or_else(|| IdentifyError::simulation(base.family().name, no_derivatives()))?;
    let (mut tests, mut warnings) = (Vec::new(), Vec::new());
    for (extension, changed) in changes {
        match changed {
            Ok(changed) => tests.extend(score_test(base, &tangent, extension, &changed)),
            Err(error) => warnings.push(Warning::left_out(&extension.to_string(), &error.into_boxed())),
        }
    }
    Ok((tests, warnings))
}

/// True for Coulomb and viscous friction, be it steady or not and the spring straight or not.
fn is_simple(base: &Identification) -> bool {
    let terms = &base.fitted.model.terms;
    let further = || terms.iter().filter(|term| !term.is_spring());
    match base.family().name {
        _ if terms.held().next().is_some() => false,
        CoulombViscous::NAME => further().next().is_none(),
        Coulomb::NAME => {
            let linear = Terms::NONE.with_linear_damping();
            let changing = linear.clone().with_change();
            let varied = [linear.with_friction_over_position(), changing.clone().with_curved_change(), changing];
            varied.iter().any(|varied| further().eq(varied.iter()))
        }
        _ => false,
    }
}

/// The test of an `extension` whose small step makes the residuals `changed`; `None` if the parameters can follow it,
/// or if the residuals are rounding.
fn score_test(base: &Identification, tangent: &Tangent, extension: Extension, changed: &[f64]) -> Option<ScoreTest> {
    let residuals = base.fit().residuals();
    let mut direction: Vec<f64> =
        changed.iter().zip(residuals).map(|(changed, residual)| (changed - residual) / STEP).collect();
    let before: f64 = direction.iter().map(|d| d * d).sum();
    tangent.span.take_out(&mut direction);
    let square: f64 = direction.iter().map(|d| d * d).sum();
    let noise = base.covariance.noise.product(&direction, &direction);
    if !(square > LEAST_CHANGE * before && noise > 0.0 && base.structure.is_noisy()) {
        return None;
    }
    let product: f64 = direction.iter().zip(residuals).map(|(d, r)| d * r).sum();
    Some(ScoreTest { extension, size: -product / square, uncertainty: noise.sqrt() / square })
}
