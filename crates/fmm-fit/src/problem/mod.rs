//! Least-squares problems: residuals as a function of parameters, and ways to write them.

mod automatic;
pub(crate) mod block;
mod closure;
pub(crate) mod forward;
mod held;
mod joint;
mod joint_error;
mod residuals;
mod weighted;

pub use automatic::{Automatic, Model};
pub use block::Block;
pub use closure::{ClosureProblem, curve, curve_fit, fit};
pub use held::Held;
pub use joint::{Joint, JointPart};
pub use joint_error::JointError;
pub use residuals::{Derivatives, EvaluationError, Residuals};
pub use weighted::Weighted;
