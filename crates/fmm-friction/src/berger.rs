//! Friction that falls exponentially with the speed to a floor.

use fmm_model::Scalar;

use crate::family::law_family;
use crate::{LawError, LawFamily, LawParameter, Role, SlidingLaw};

law_family! {
    /// Berger's exponentially falling friction.
    ///
    /// ```text
    /// F = N (μ₀ + μ₁ exp(−α v))                                      (thesis Eq. 7.4)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ₀ | `floor` | 1 | coefficient at large speed |
    /// | μ₁ | `excess` | 1 | how far the coefficient at zero speed lies above it |
    /// | α | `decay` | s/m | inverse of the speed over which the excess falls |
    ///
    /// The static level is μ₀ + μ₁. With μ₁ = 0 this is [`Coulomb`](crate::Coulomb) with μ₀, with α = 0 with μ₀ + μ₁,
    /// each bit for bit; for α → ∞ it becomes [`CoulombStatic`](crate::CoulombStatic).
    ///
    /// ```
    /// use fmm_friction::{Berger, SlidingLaw};
    ///
    /// // A row of the thesis' Table 5.
    /// let law = Berger::new(0.228, 0.261, 2.852)?;
    /// assert_eq!(law.breakaway(), 0.489);
    /// assert!((law.coefficient(0.2_f64) - 0.375_543).abs() < 1e-6);
    /// # Ok::<(), fmm_friction::LawError>(())
    /// ```
    ///
    /// # References
    /// E. J. Berger, "Friction modeling for dynamic system simulation", Applied Mechanics Reviews 55 (2002) 535,
    /// doi 10.1115/1.1501080.
    pub struct Berger, "berger", sliding {
        floor: LawParameter::level("coefficient", "μ₀").typically(0.7),
        excess: LawParameter::not_negative("excess_coefficient", "μ₁", "1", Role::Excess).typically(0.6),
        decay: LawParameter::not_negative("decay", "α", "s/m", Role::Shape).typically(3.0),
    }

    /// Coefficient `floor` μ₀ (1) at large speed, `excess` μ₁ (1) at zero speed and its `decay` α (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter is negative or not finite.
    pub fn new {}
    special cases [crate::SpecialCase::of("coulomb")]
    tried [crate::SearchStage::Stribeck.trial().damped()]
}

impl<D: Scalar> SlidingLaw<D> for Berger<D> {
    fn coefficient(&self, speed: D) -> D {
        self.floor + self.excess * (-(self.decay * speed)).exp()
    }

    fn breakaway(&self) -> D {
        self.floor + self.excess
    }
}
