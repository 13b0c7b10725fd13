//! Friction that falls with the speed as a hyperbola.

use fmm_model::Scalar;

use crate::family::law_family;
use crate::{LawError, LawFamily, LawParameter, Role, SlidingLaw};

law_family! {
    /// Hyperbolically falling friction.
    ///
    /// ```text
    /// F = N μ_s/(1 + δ v)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ_s | `breakaway` | 1 | coefficient at zero speed and at breakaway |
    /// | δ | `decay` | s/m | inverse of the speed at which the coefficient has halved |
    ///
    /// There is no Coulomb floor: the coefficient falls to zero. With δ = 0 this is [`Coulomb`](crate::Coulomb).
    ///
    /// # References
    /// R. I. Leine, D. H. van Campen, A. de Kraker, L. van den Steen, "Stick-slip vibrations induced by alternate
    /// friction models", Nonlinear Dynamics 16 (1998) 41, doi 10.1023/A:1008289604683.
    pub struct Hyperbolic, "hyperbolic", sliding {
        breakaway: LawParameter::level("static_coefficient", "μ_s").typically(1.3),
        decay: LawParameter::not_negative("decay", "δ", "s/m", Role::Shape).typically(0.5),
    }

    /// Coefficient `breakaway` μ_s (1) at zero speed, falling with `decay` δ (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if either is negative or not finite.
    pub fn new {}
    special cases [crate::SpecialCase::of("coulomb")]
    tried [crate::SearchStage::TwoNumbers.trial().damped()]
}

impl<D: Scalar> SlidingLaw<D> for Hyperbolic<D> {
    fn coefficient(&self, speed: D) -> D {
        self.breakaway / (self.decay * speed + 1.0)
    }

    fn breakaway(&self) -> D {
        self.breakaway
    }
}
