//! Records of known truth, what the default judgement makes of them, and the tables of that.
//!
//! ```text
//! cells ── a case a record ──> judge ── a verdict ──> summary ──> text or JSON
//!   │
//!   └─ setup: machine and law, simulated;  draw: machines at random;  noise, filter: what a measurement adds
//! ```

mod case;
mod cell;
mod changing;
mod coverage;
mod disturbances;
mod document;
mod draw;
mod falling;
mod filter;
mod judge;
mod law;
mod laws;
mod noise;
mod random;
mod sameness;
mod setup;
pub(crate) mod speed;
mod study;
mod summary;
mod text;
mod thesis;

use case::{Case, Truth};
pub(crate) use cell::{Cell, cells};
pub(crate) use document::document;
use judge::{Verdict, judge};
use law::Levels;
use random::Random;
pub(crate) use sameness::sameness;
use setup::Setup;
pub(crate) use study::study;
pub(crate) use summary::Summary;
pub(crate) use text::text;

/// The thing that is made, or the reason why not.
pub(crate) type Found<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;
