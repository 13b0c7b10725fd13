//! A law of one's own: friction that grows with the logarithm of the speed, as between rough surfaces that creep.

use fmm_friction::{LawError, LawFamily, LawParameter, LawVisitor, Role, SlidingLaw};
use fmm_model::{Bounds, Parameter, Scalar};

/// Speed (m/s) from which on the logarithm counts.
const REFERENCE_SPEED: f64 = 0.01;

/// Friction that strengthens with speed.
///
/// ```text
/// μ(v) = μ₀ + a ln(1 + v/v₀),   v₀ = 10 mm/s
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Logarithmic<D = f64> {
    /// μ₀, coefficient at rest (1).
    pub at_rest: D,
    /// a, increase of the coefficient per factor e of speed (1).
    pub increase: D,
}

/// Formula of the law: enough to simulate it, at plain numbers and with derivatives.
impl<D: Scalar> SlidingLaw<D> for Logarithmic<D> {
    fn coefficient(&self, speed: D) -> D {
        self.at_rest + self.increase * (speed / REFERENCE_SPEED + 1.0).ln()
    }
    fn breakaway(&self) -> D {
        self.at_rest
    }
}

/// Names of its parameters and where they may lie: enough to fit it and to report it.
impl LawFamily for Logarithmic {
    const NAME: &'static str = "logarithmic";
    const PARAMETERS: &'static [LawParameter] = &[
        LawParameter::new(Parameter::new("at_rest", "μ₀", "1").bounded(Bounds::NOT_NEGATIVE), Role::Level),
        LawParameter::new(Parameter::new("increase", "a", "1").bounded(Bounds::NOT_NEGATIVE), Role::Level)
            .typically(0.1),
    ];
    type At<D: Scalar> = Logarithmic<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<Logarithmic<D>, LawError> {
        let [at_rest, increase] = Self::checked(values)?;
        Ok(Logarithmic { at_rest, increase })
    }

    fn visit<D: Scalar, V: LawVisitor<D, Logarithmic<D>>>(visitor: V) -> V::Output {
        visitor.sliding()
    }
}
