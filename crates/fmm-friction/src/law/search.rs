//! Part of a law family in a search for the law of a record.

/// Stages of a search for the law of a record, in the order in which they are tried.
///
/// ```
/// use fmm_friction::{Berger, LawFamily, SearchRole, SearchStage};
///
/// let SearchRole::Tried([trial]) = Berger::SEARCH else { panic!("one trial") };
/// assert_eq!(trial.stage, SearchStage::OfSpeed);
/// // The law has no viscous part of its own.
/// assert!(trial.is_damped);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SearchStage {
    /// A level, a straight line, or both: tried on every record.
    Simple,
    /// A curve over the speed or the acceleration: tried if the simple laws leave a part of the motion unexplained. A
    /// law of the speed is fitted only if the friction over the speed that the record shows, without a law, allows it.
    OfSpeed,
    /// Friction that builds up over a small displacement: tried if the residuals show presliding.
    Presliding,
    /// Presliding with further parameters: tried in the same case, and begun near the best presliding law.
    FurtherPresliding,
}

impl SearchStage {
    /// A trial at this stage, with all parameters free and without damping beside the law.
    pub const fn trial(self) -> SearchTrial {
        SearchTrial { stage: self, fixed: &[], is_damped: false }
    }
}

/// One fit of a family in a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchTrial {
    /// Stage of the search.
    pub stage: SearchStage,
    /// Names and values of the parameters that are fixed.
    pub fixed: &'static [(&'static str, f64)],
    /// True if viscous damping of the machine is fitted beside the law.
    pub is_damped: bool,
}

impl SearchTrial {
    /// The same trial with these parameters of the law fixed, by name and value.
    #[must_use]
    pub const fn fixing(self, fixed: &'static [(&'static str, f64)]) -> Self {
        Self { fixed, ..self }
    }

    /// The same trial with viscous damping of the machine fitted beside the law, for laws without a viscous part.
    #[must_use]
    pub const fn damped(self) -> Self {
        Self { is_damped: true, ..self }
    }
}

/// Part of a family in a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SearchRole {
    /// Fits that a search makes.
    Tried(&'static [SearchTrial]),
    /// No fit, with the reason.
    NotTried(&'static str),
}

impl SearchRole {
    /// Role of a family that states none.
    pub const UNSTATED: Self = Self::NotTried("the family states no trial");
}
