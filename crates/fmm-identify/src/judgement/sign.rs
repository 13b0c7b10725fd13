//! Signs that a simple law leaves something out: what its residuals say of small additions to it, without a fit.

use std::f64::consts::PI;
use std::fmt;

use fmm_fit::{EvaluationError, Residuals};
use fmm_friction::{Berger, CoulombViscous, Dahl};
use fmm_model::{ModelError, Restoring};

use crate::error::IdentifyError;
use crate::experiment::Experiment;
use crate::experiment::reference;
use crate::identification::Identification;
use crate::law::Law;
use crate::machine::Terms;
use crate::problem::Problem;
use crate::problem::fitted::Fall;
use crate::problem::tangent::Tangent;

/// An addition to Coulomb and viscous friction on a linear spring.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Addition {
    /// Friction that falls with the speed, by 1/e over this share of the largest speed (1).
    FallsWithSpeed(f64),
    /// Damping that grows with the square of the speed.
    QuadraticDamping,
    /// Presliding: the contact yields before it slides.
    Presliding,
    /// A restoring force that softens with the displacement.
    SofteningSpring,
}

impl fmt::Display for Addition {
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

/// How plainly the residuals ask for one addition.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Sign {
    /// What would be added.
    pub addition: Addition,
    /// How much of it the residuals ask for, as a share of the friction, of the amplitude or of the stiffness (1).
    /// Negative: its opposite.
    pub size: f64,
    /// Standard uncertainty of the size (1).
    pub uncertainty: f64,
}

impl Sign {
    /// The size in standard uncertainties (1).
    pub fn significance(&self) -> f64 {
        self.size / self.uncertainty
    }

    /// Friction that falls with the speed, if it is of that kind.
    pub(crate) fn fall(&self) -> Option<Fall> {
        match self.addition {
            Addition::FallsWithSpeed(speed) => Some(Fall { speed, size: self.size, significance: self.significance() }),
            _ => None,
        }
    }

    /// Whether chance alone gives so much for one such sign in fifty or fewer.
    pub fn is_plain(&self) -> bool {
        self.significance().abs() > PLAIN
    }
}

/// Standard uncertainties that chance seldom reaches.
const PLAIN: f64 = 2.33;
/// Shares of the largest speed over which friction may fall.
const FALLS: [f64; 4] = [0.02, 0.06, 0.2, 0.5];
/// Size of an addition that is simulated: small enough to be proportional, large enough not to be rounding.
const STEP: f64 = 0.01;

/// The signs in the residuals of `base`, an identification by Coulomb and viscous friction.
///
/// ```text
/// a = −dᵀr/dᵀd,     u² = dᵀΣd/(dᵀd)²,     d = (1 − J(JᵀJ)⁻¹Jᵀ) (m(a₀) − m(0))/a₀
/// ```
///
/// m(a₀) is the motion with a small addition, d what of its change no parameter of the simple law can follow (a score
/// test).
pub(crate) fn signs(base: &Identification, decays: &[Experiment]) -> Result<Vec<Sign>, IdentifyError> {
    let machine = *base.machine();
    let problem = Problem::with_terms::<CoulombViscous>(machine, base.terms().clone(), decays)?;
    let layout = problem.table();
    if layout.oscillator != 1 || !base.terms().is_plain() {
        return Ok(Vec::new());
    }
    let values = base.fit().values();
    let (frequency, friction, damping) = (values[0], values[1], values[2]);
    let own = &values[layout.shared..];
    let (length, speed) = reference(decays).scales();
    // Of a machine without friction the level with the same losses.
    let level = friction.max(0.25 * PI * 0.5 * damping * speed).max(f64::MIN_POSITIVE);
    let linear = Terms::NONE.with_linear_damping();
    let residuals = |problem: &Problem<'_>, shared: &[f64]| -> Result<Vec<f64>, EvaluationError> {
        let values: Vec<f64> = shared.iter().chain(own).copied().collect();
        let mut residuals = vec![0.0; problem.len()];
        problem.evaluate(&values, &mut residuals, None)?;
        Ok(residuals)
    };
    let mut changes: Vec<(Addition, Vec<f64>)> = Vec::new();
    for share in FALLS {
        let berger = Problem::of(Law::of::<Berger>(), machine, linear.clone(), decays)?;
        let shared = [frequency, damping, friction, STEP * level, 1.0 / (share * speed)];
        if let Ok(changed) = residuals(&berger, &shared) {
            changes.push((Addition::FallsWithSpeed(share), changed));
        }
    }
    let quadratic = Problem::of(Law::of::<CoulombViscous>(), machine, Terms::NONE.with_quadratic_damping(), decays)?;
    if let Ok(changed) = residuals(&quadratic, &[frequency, STEP * level / (speed * speed), friction, damping]) {
        changes.push((Addition::QuadraticDamping, changed));
    }
    if friction > 0.0 {
        let dahl = Problem::of(Law::of::<Dahl>(), machine, linear, decays)?;
        if let Ok(changed) = residuals(&dahl, &[frequency, damping, friction, friction / (STEP * length), 1.0]) {
            changes.push((Addition::Presliding, changed));
        }
    }
    if machine.restoring() == Restoring::Linear {
        let softened = |length: f64| -> Result<_, ModelError> { Ok(machine.with_restoring(Restoring::sine(length)?)) };
        // The sine of x/L loses x²/6L² of the stiffness.
        let softened = softened(length / (6.0 * STEP).sqrt())?;
        let softened = Problem::of(Law::of::<CoulombViscous>(), softened, Terms::NONE, decays)?;
        if let Ok(changed) = residuals(&softened, &values[..layout.shared]) {
            changes.push((Addition::SofteningSpring, changed));
        }
    }
    let Some(tangent) = base.tangent(&problem) else { return Ok(Vec::new()) };
    Ok(changes.into_iter().filter_map(|(addition, changed)| sign(base, &tangent, addition, &changed)).collect())
}

/// The sign for an `addition` whose small step makes the residuals `changed`; `None` if the parameters can follow it,
/// or if the residuals are rounding.
fn sign(base: &Identification, tangent: &Tangent, addition: Addition, changed: &[f64]) -> Option<Sign> {
    /// What is left below this share is rounding and curvature.
    const LEAST: f64 = 1e-6;
    let residuals = base.fit().residuals();
    let mut direction: Vec<f64> =
        changed.iter().zip(residuals).map(|(changed, residual)| (changed - residual) / STEP).collect();
    let before: f64 = direction.iter().map(|d| d * d).sum();
    tangent.take_out(&mut direction);
    let square: f64 = direction.iter().map(|d| d * d).sum();
    let noise = base.noise().product(&direction, &direction);
    if !(square > LEAST * before && noise > 0.0 && base.structure().is_noisy()) {
        return None;
    }
    let product: f64 = direction.iter().zip(residuals).map(|(d, r)| d * r).sum();
    Some(Sign { addition, size: -product / square, uncertainty: noise.sqrt() / square })
}
