//! Errors of a joint problem.

use fmm_model::Rounded;

/// Problems that cannot be joined, or values that do not belong to a joint problem.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JointError {
    /// There is nothing to join.
    #[error("a joint fit needs at least one problem")]
    NoProblem,
    /// A shared name that no problem has.
    #[error("no problem has a parameter called {name} to share")]
    UnknownName {
        /// The name.
        name: String,
    },
    /// A name stands twice, among those shared or in one problem.
    #[error("the name {name} stands twice; names tell the parameters of a joint fit apart")]
    NameTwice {
        /// The name.
        name: String,
    },
    /// A shared parameter has different units.
    #[error("the shared parameter {name} is in {first} in one problem and in {other} in another; give it one unit")]
    UnitsDiffer {
        /// The name.
        name: String,
        /// Its unit where it first occurs.
        first: String,
        /// The other unit.
        other: String,
    },
    /// A shared parameter has no value that all problems allow.
    #[error("no value of the shared parameter {name} is at least {lower} and at most {upper}, as the problems ask", lower = Rounded::every_digit(*.lower), upper = Rounded::every_digit(*.upper))]
    BoundsApart {
        /// The name.
        name: String,
        /// The largest of the lower bounds.
        lower: f64,
        /// The smallest of the upper bounds.
        upper: f64,
    },
    /// A problem has a block of parameters that it does not have.
    #[error("block {block} of problem {problem} names a parameter that the problem does not have")]
    InvalidBlock {
        /// Index of the problem, from 0.
        problem: usize,
        /// Index of its block, from 0.
        block: usize,
    },
    /// There is not one start per problem.
    #[error("there are {starts} starts for {problems} problems")]
    StartCount {
        /// Number of starts.
        starts: usize,
        /// Number of problems.
        problems: usize,
    },
    /// A start has not one value per parameter.
    #[error("the start of problem {problem} has {values} values, but the problem has {parameters} parameters")]
    StartLength {
        /// Index of the problem, from 0.
        problem: usize,
        /// Number of values.
        values: usize,
        /// Number of parameters.
        parameters: usize,
    },
    /// A fit is not one of the joint problem.
    #[error("the fit is not one of this joint problem: its parameters or residuals are not as many")]
    OtherFit,
}
