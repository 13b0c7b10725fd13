//! Errors of questions to results, of trials, and of partial runs.

use crate::UncertaintyError;

/// Questions.
impl UncertaintyError {
    /// The first-order uncertainty is zero although inputs are uncertain, so that no interval follows from it.
    pub(crate) fn linearisation_suspect() -> Self {
        Self::NoAnswer { what: "the first-order uncertainty is zero although inputs are uncertain: the linear approximation cannot see them, and no coverage interval follows from it".to_owned() }
    }

    /// The Welch–Satterthwaite formula does not hold, so that a coverage factor has to be chosen by the caller.
    pub(crate) fn degrees_of_freedom_undefined() -> Self {
        Self::NoAnswer { what: "inputs of finite degrees of freedom are correlated, where the Welch-Satterthwaite formula does not hold; choose the degrees of freedom and use coverage_factor".to_owned() }
    }

    /// Trials of an input that has no variance, so that the standard deviation of their results is a matter of chance.
    pub(crate) fn no_variance(input: &str, degrees_of_freedom: f64) -> Self {
        Self::NoAnswer {
            what: format!(
                "Student's t of {degrees_of_freedom} degrees of freedom, which {input} has, has no standard deviation, and so has none to state of the result; an interval can be stated"
            ),
        }
    }

    /// Trials of an input that has no mean, so that the mean of their results is a matter of chance.
    pub(crate) fn no_mean(input: &str, degrees_of_freedom: f64) -> Self {
        Self::NoAnswer {
            what: format!(
                "Student's t of {degrees_of_freedom} degrees of freedom, which {input} has, has no mean, and so has none to state of the result; an interval can be stated"
            ),
        }
    }

    /// A spread so small that it would count as none.
    pub(crate) fn too_small(of: &str) -> Self {
        Self::NoAnswer {
            what: format!("the spread of {of} is so small that its square loses its digits; take a smaller unit"),
        }
    }

    /// An output that does not vary has no variance to share among inputs.
    pub(crate) fn constant_output() -> Self {
        Self::NoAnswer {
            what: "the output does not vary, so that there is no variance to share among the inputs".to_owned(),
        }
    }

    /// Second-order terms that were not asked for, are not finite, or make the variance negative.
    pub(crate) fn no_second_order() -> Self {
        Self::NoAnswer { what: "there is no uncertainty to second order: it was not asked for, or the model cannot be expanded that far".to_owned() }
    }

    /// A covariance matrix of outputs that has no inverse, so that no ellipsoid belongs to it.
    pub(crate) fn singular_covariance() -> Self {
        Self::NoAnswer { what: "the outputs are fully correlated or constant, so that their coverage region has no extent in some direction".to_owned() }
    }

    /// Sensitivity indices of correlated inputs have no meaning as shares of a variance.
    pub(crate) fn correlated_inputs(first: &str, second: &str) -> Self {
        Self::NoAnswer {
            what: format!("variance shares need independent inputs, but `{first}` and `{second}` are not"),
        }
    }

    /// More inputs than the Sobol sequence has dimensions.
    pub(crate) fn too_many_dimensions(needed: usize, most: usize) -> Self {
        Self::NoAnswer { what: format!("the Sobol sequence has {most} dimensions, but these inputs need {needed}") }
    }
}

/// Trials.
impl UncertaintyError {
    /// So few trials that an interval would have to reach beyond the smallest or largest of them.
    pub(crate) fn too_few_trials(trials: usize, level: f64, needed: usize) -> Self {
        Self::TooFewTrials {
            what: format!(
                "{trials} trials are too few for an interval of coverage probability {level}; at least {needed} are needed"
            ),
            found: trials as u64,
            needed: needed as u64,
        }
    }

    /// An adaptive run that may not make the trials that its first decision takes.
    pub(crate) fn too_few_trials_allowed(allowed: u64, needed: u64) -> Self {
        Self::TooFewTrials {
            what: format!(
                "the first decision takes {needed} trials, but at most {allowed} are allowed; lower the level, or allow more"
            ),
            found: allowed,
            needed,
        }
    }
}

/// Partial runs.
impl UncertaintyError {
    /// Parts of different runs.
    pub(crate) fn layout_mismatch(what: &str, first: u64, second: u64) -> Self {
        Self::PartialRun {
            what: format!(
                "partial results belong together only if their {what} agree, but one has {first} and another {second}"
            ),
            block: None,
        }
    }

    /// The same block of trials twice.
    pub(crate) fn duplicate_block(block: u64) -> Self {
        Self::PartialRun {
            what: format!("block {block} is in both partial results; a shard must not be counted twice"),
            block: Some(block),
        }
    }

    /// A block of trials that no partial result holds.
    pub(crate) fn missing_block(block: u64) -> Self {
        Self::PartialRun {
            what: format!("block {block} is missing; merge the shard that holds it, or run it"),
            block: Some(block),
        }
    }

    /// A partial result that no run can have given.
    pub(crate) fn damaged_partial(block: u64, what: &str) -> Self {
        Self::PartialRun { what: format!("block {block} of the partial result is damaged: {what}"), block: Some(block) }
    }
}
