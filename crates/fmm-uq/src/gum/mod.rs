//! The law of propagation of uncertainty, the budget that it gives, and the intervals that follow (JCGM 100:2008).

mod budget;
mod derivatives;
#[cfg(feature = "serde")]
mod document;
mod excursion;
mod propagate;
mod propagation;
mod second_order;
mod text;

pub use budget::{Budget, Contribution, Expanded};
pub use propagate::{Gum, propagate};
pub use propagation::Propagation;
pub use second_order::{Linearisation, SecondOrder};
pub use text::Statement;
