//! What can be wrong with inputs, with a model and with a question put to a budget.

/// Why an uncertainty could not be stated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UncertaintyError {
    /// An input without a name cannot be told apart in a budget.
    #[error("an input needs a name, but the one of value {value} {unit} has none")]
    Unnamed {
        /// The value given.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// The estimate of an input is infinite or not a number.
    #[error("the value of {input} must be finite, but is {value} {unit}")]
    ValueNotFinite {
        /// Which input.
        input: String,
        /// The value given.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// A standard uncertainty is negative or not finite.
    #[error("the standard uncertainty of {input} must be zero or positive and finite, but is {value} {unit}")]
    UncertaintyOutOfRange {
        /// Which input, or "the result".
        input: String,
        /// The standard uncertainty.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// Degrees of freedom below 1 or not a number.
    #[error("the degrees of freedom of {of} must be at least 1 and may be infinite, but are {value}")]
    DegreesOfFreedomOutOfRange {
        /// Which input, or "the result".
        of: String,
        /// The degrees of freedom given.
        value: f64,
    },
    /// A model of no inputs has no uncertainty to propagate.
    #[error("at least one input is needed, but none was given")]
    NoInputs,
    /// Two inputs of the same name.
    #[error("each input needs a name of its own, but `{name}` is given twice")]
    DuplicateName {
        /// The name given twice.
        name: String,
    },
    /// A correlation with an input that does not exist.
    #[error("there is no input `{name}`; the inputs are {known}")]
    UnknownName {
        /// The name given.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// A correlation of an input with itself; it is 1 and cannot be set.
    #[error("the correlation of `{name}` with itself is 1 and cannot be set")]
    SelfCorrelation {
        /// The name given on both sides.
        name: String,
    },
    /// The same pair of inputs twice in one list of correlations.
    #[error("the correlation of `{first}` and `{second}` is given twice")]
    RepeatedPair {
        /// One of the pair.
        first: String,
        /// The other.
        second: String,
    },
    /// A correlation coefficient outside [−1, 1] or not a number.
    #[error("the correlation of `{first}` and `{second}` must lie in [-1, 1], but is {value}")]
    CorrelationOutOfRange {
        /// One of the pair.
        first: String,
        /// The other.
        second: String,
        /// The coefficient given.
        value: f64,
    },
    /// Correlation coefficients that no set of quantities can have together.
    #[error(
        "no quantities can be correlated like this: the smallest eigenvalue of the correlation matrix is \
         {smallest_eigenvalue:.3e}, and it must not be negative"
    )]
    NotPositiveSemidefinite {
        /// The smallest eigenvalue of the matrix (1).
        smallest_eigenvalue: f64,
    },
    /// The model itself reported an error.
    #[error("the model failed at {at}")]
    ModelFailed {
        /// The values of the inputs.
        at: String,
        /// What the model reported.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The model gave an infinite result or no number.
    #[error("the model gives {result} at {at}")]
    ResultNotFinite {
        /// The result.
        result: f64,
        /// The values of the inputs.
        at: String,
    },
    /// A sensitivity is infinite or not a number, or its product with the uncertainty overflows.
    #[error("the sensitivity to {input} is {sensitivity}, which cannot be propagated, at {at}")]
    SensitivityNotFinite {
        /// Which input.
        input: String,
        /// The derivative of the result with respect to it.
        sensitivity: f64,
        /// The values of the inputs.
        at: String,
    },
    /// The model gave different results for the same values.
    #[error("the model gives {first}, then {again}, for the same values {at}; it must be deterministic")]
    ModelNotRepeatable {
        /// The first result.
        first: f64,
        /// The differing result.
        again: f64,
        /// The values of the inputs.
        at: String,
    },
    /// The first-order uncertainty is zero although inputs are uncertain, so that no interval follows from it.
    #[error(
        "the first-order uncertainty is zero although inputs are uncertain: the linear approximation cannot see \
         them, and no coverage interval follows from it"
    )]
    LinearisationSuspect,
    /// The Welch–Satterthwaite formula does not hold, so that a coverage factor has to be chosen by the caller.
    #[error(
        "inputs of finite degrees of freedom are correlated, where the Welch-Satterthwaite formula does not hold; \
         choose the degrees of freedom and use coverage_factor"
    )]
    DegreesOfFreedomUndefined,
    /// A coverage probability that is not strictly between 0 and 1.
    #[error("the coverage probability must lie between 0 and 1, such as 0.95, but is {level}")]
    LevelOutOfRange {
        /// The probability given.
        level: f64,
    },
    /// Two budgets compared that do not rest on the same inputs.
    #[error("the two budgets do not rest on the same inputs, so that their covariance is not known")]
    DifferentInputs,
    /// A parameter of a distribution outside its range.
    #[error("the {parameter} must be {must_be}, but is {value}")]
    ParameterOutOfRange {
        /// Which parameter.
        parameter: &'static str,
        /// The value given.
        value: f64,
        /// The range that would be right.
        must_be: &'static str,
    },
    /// Limits of a distribution that leave nothing between them.
    #[error("the lower limit {lower} must lie below the upper limit {upper}, and their distance must be finite")]
    LimitsOutOfOrder {
        /// The lower limit given.
        lower: f64,
        /// The upper limit given.
        upper: f64,
    },
    /// Too few observations to say anything about their spread.
    #[error("at least {needed} observations are needed, but {found} were given")]
    TooFewObservations {
        /// How many were given.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// An observation that is infinite or no number, or whose square is.
    #[error("observation {index} must be finite, and its square too, but is {value}")]
    ObservationNotFinite {
        /// Position of the observation.
        index: usize,
        /// The observation.
        value: f64,
    },
    /// Observations that cannot be simultaneous.
    #[error("simultaneous observations come in equal numbers, but there are {first} and {second}")]
    UnequalObservations {
        /// Number of observations of the first quantity.
        first: usize,
        /// Number of observations of the second.
        second: usize,
    },
    /// An input in two ensembles, or twice in one.
    #[error("`{name}` is in an ensemble already; an uncertainty comes from one set of observations")]
    AlreadyInEnsemble {
        /// The name given.
        name: String,
    },
    /// An ensemble is a multivariate t-distribution, which has room for normal and t-distributed inputs only.
    #[error("`{name}` is neither normal nor t-distributed, and cannot be part of a multivariate t-distribution")]
    NotNormal {
        /// The name given.
        name: String,
    },
    /// The model has another number of outputs than it should have.
    #[error("the model must give {expected} outputs, but gives {found}")]
    OutputCount {
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A model whose number of outputs is not always the same.
    #[error("the model gives {first} outputs, then {again}; their number must not change")]
    OutputCountChanged {
        /// How many it gave.
        first: usize,
        /// How many it gave another time.
        again: usize,
    },
    /// Trials of an input that has no variance, so that the standard deviation of their results is a matter of chance.
    #[error(
        "Student's t of {degrees_of_freedom} degrees of freedom, which {input} has, has no standard deviation, and so has \
         none to state of the result; an interval can be stated"
    )]
    NoVariance {
        /// Which input.
        input: String,
        /// Its degrees of freedom (1).
        degrees_of_freedom: f64,
    },
    /// Trials of an input that has no mean, so that the mean of their results is a matter of chance.
    #[error(
        "Student's t of {degrees_of_freedom} degrees of freedom, which {input} has, has no mean, and so has none to state of \
         the result; an interval can be stated"
    )]
    NoMean {
        /// Which input.
        input: String,
        /// Its degrees of freedom (1).
        degrees_of_freedom: f64,
    },
    /// A spread so small that it would count as none.
    #[error("the spread of {of} is so small that its square is no number any more; take a smaller unit")]
    TooSmall {
        /// What spreads.
        of: String,
    },
    /// An output that does not vary has no variance to share among inputs.
    #[error("the output does not vary, so that there is no variance to share among the inputs")]
    ConstantOutput,
    /// Second-order terms that were not asked for, are not finite, or make the variance negative.
    #[error("there is no uncertainty to second order: it was not asked for, or the model cannot be expanded that far")]
    NoSecondOrder,
    /// No trials at all.
    #[error("at least one trial is needed, but none was asked for")]
    NoTrials,
    /// More trials than can be counted.
    #[error("{trials} trials are more than can be told apart; at most {most} are possible")]
    TooManyTrials {
        /// How many were asked for.
        trials: u64,
        /// How many are possible.
        most: u64,
    },
    /// So few trials that an interval would have to reach beyond the smallest or largest of them.
    #[error(
        "{trials} trials are too few for an interval of coverage probability {level}; at least {needed} are needed"
    )]
    TooFewTrials {
        /// How many there are.
        trials: usize,
        /// The coverage probability.
        level: f64,
        /// How many are needed.
        needed: usize,
    },
    /// More trials failed than were allowed to.
    #[error("{failed} of {trials} trials failed, more than the allowed share of {allowed}; the first: {first}")]
    TooManyFailures {
        /// How many failed.
        failed: u64,
        /// How many were made before the run was given up or ended.
        trials: u64,
        /// The share allowed (1).
        allowed: f64,
        /// The first failure, by block and trial.
        first: Box<crate::Failure>,
    },
    /// No trial succeeded at all.
    #[error("none of the trials succeeded")]
    NoSuccess,
    /// The progress callback asked for an end.
    #[error("the run was cancelled after {trials} trials")]
    Cancelled {
        /// How many trials were done.
        trials: u64,
    },
    /// The tolerance was not reached within the largest number of trials allowed.
    #[error("the results are not stable to the tolerance after {trials} trials; allow more, or ask for fewer digits")]
    NotStable {
        /// How many trials were made.
        trials: u64,
    },
    /// An adaptive run that may not make the trials that its first decision takes.
    #[error(
        "the first decision takes {needed} trials, but at most {allowed} are allowed; lower the level, or allow more"
    )]
    TooFewTrialsAllowed {
        /// How many are allowed.
        allowed: u64,
        /// How many are needed.
        needed: u64,
    },
    /// Partial results of different runs.
    #[error("partial results belong together only if their {what} agree, but one has {first} and another {second}")]
    LayoutMismatch {
        /// What differs.
        what: &'static str,
        /// Its value in the first.
        first: u64,
        /// Its value in the second.
        second: u64,
    },
    /// The same block of trials twice.
    #[error("block {block} is in both partial results; a shard must not be counted twice")]
    DuplicateBlock {
        /// Index of the block.
        block: u64,
    },
    /// A block of trials that no partial result holds.
    #[error("block {block} is missing; merge the shard that holds it, or run it")]
    MissingBlock {
        /// Index of the first block that is missing.
        block: u64,
    },
    /// A partial result that no run can have given.
    #[error("block {block} of the partial result is damaged: {what}")]
    DamagedPartial {
        /// Index of the block.
        block: u64,
        /// What is wrong with it.
        what: &'static str,
    },
    /// An output that does not exist.
    #[error("there is no output {output}; the model has {outputs}, counted from 0")]
    NoSuchOutput {
        /// The position given.
        output: usize,
        /// How many outputs there are.
        outputs: usize,
    },
    /// An option of a run outside its range.
    #[error("the {option} must be {must_be}, but is {value}")]
    OptionOutOfRange {
        /// Which option.
        option: &'static str,
        /// The value given.
        value: f64,
        /// The range that would be right.
        must_be: &'static str,
    },
    /// A covariance matrix of outputs that has no inverse, so that no ellipsoid belongs to it.
    #[error(
        "the outputs are fully correlated or constant, so that their coverage region has no extent in some direction"
    )]
    SingularCovariance,
    /// Sensitivity indices of correlated inputs have no meaning as shares of a variance.
    #[error("variance shares need independent inputs, but `{first}` and `{second}` are not")]
    CorrelatedInputs {
        /// One of the pair.
        first: String,
        /// The other.
        second: String,
    },
    /// More inputs than the Sobol sequence has dimensions.
    #[error("the Sobol sequence has {most} dimensions, but these inputs need {needed}")]
    TooManyDimensions {
        /// How many are needed.
        needed: usize,
        /// How many there are.
        most: usize,
    },
    /// Too many rows of a variance analysis in which the model failed.
    #[error("the model failed in {failed} of {rows} rows, more than the allowed share of {allowed}")]
    RowsFailed {
        /// Rows with at least one failure.
        failed: u64,
        /// Rows in all.
        rows: u64,
        /// The share allowed (1).
        allowed: f64,
    },
}

impl UncertaintyError {
    /// Passes degrees of freedom through if they are at least 1; `of` says whose they are.
    pub(crate) fn require_degrees_of_freedom(of: &str, value: f64) -> Result<f64, Self> {
        if value >= 1.0 { Ok(value) } else { Err(Self::DegreesOfFreedomOutOfRange { of: of.to_owned(), value }) }
    }
}
