//! Verdict of a comparison: decided between models, or not.

/// What a comparison of models comes to. Models are meant by their index in the comparison.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The data decide for one model.
    Decided {
        /// The model.
        winner: usize,
        /// By how much its score is below that of the next; `None` if there is no other.
        lead: Option<f64>,
    },
    /// The data do not decide.
    Undecided {
        /// The simplest of the models that the data leave.
        preferred: usize,
        /// Why they do not decide.
        doubts: Vec<Doubt>,
    },
}

impl Verdict {
    /// Whether the data decide.
    pub const fn is_decided(&self) -> bool {
        matches!(self, Self::Decided { .. })
    }

    /// The winner, or the model that is preferred without having won.
    pub const fn preferred(&self) -> usize {
        match self {
            Self::Decided { winner, .. } => *winner,
            Self::Undecided { preferred, .. } => *preferred,
        }
    }
}

/// A reason why data do not decide between models.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// Another model scores nearly as well, or better with more parameters.
    TooClose {
        /// The other model.
        rival: usize,
        /// Its score less that of the preferred one.
        difference: f64,
    },
    /// The fit of a model did not end at a minimum, so it may be better than it looks.
    Unfinished {
        /// The model.
        contender: usize,
    },
    /// A model fits worse than a special case of it, so its fit missed the lowest minimum.
    MissedMinimum {
        /// The model.
        contender: usize,
        /// The special case.
        special: usize,
    },
    /// All residuals were counted as independent, but those of the preferred model are not.
    Correlated {
        /// Probability of so few runs of equal sign if they were.
        p_value: f64,
    },
    /// The preferred model has a special case that the F-test does not reject.
    NotRejected {
        /// The special case.
        special: usize,
        /// Probability of the improvement by chance.
        p_value: f64,
    },
}
