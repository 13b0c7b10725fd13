//! The law of propagation of uncertainty, the budget that it gives, and the intervals that follow (JCGM 100:2008).

mod budget;
mod expanded;
mod linear_region;
pub(crate) mod linearisation;
mod propagate;
mod propagation;
mod second_order;
mod validation;

pub use budget::{Budget, Contribution};
pub use expanded::Expanded;
pub use linearisation::Linearisation;
pub use propagate::{Gum, propagate};
pub use propagation::Propagation;
pub use second_order::SecondOrder;
pub use validation::{Validation, validate};
