//! The thesis, chapter by chapter: what it prints, what we find, and where the two differ.
//!
//! One module per chapter, each a function from [`Settings`] to a [`Chapter`]: targets with their criteria, tables of
//! printed values beside ours, figures, and findings. The examples print chapters, the report collects them, the
//! tests assert their targets. No raw data of the thesis are published: what is simulated is called so ([`Kind`]).

mod chapter;
pub mod chapter_4_flexure;
pub mod chapter_5_modal;
pub mod chapter_5_monte_carlo;
pub mod chapter_6_energy;
pub mod chapter_7_friction;
pub mod chapter_8_impact;
pub mod chapter_9_future;
mod kicks;
pub mod printed;
mod program;
pub mod report;
mod ring_down;
mod settings;
pub mod table_3;
mod target;
mod windows;

pub use chapter::{Chapter, Drawing, Finding, Table};
pub use program::program;
pub use settings::Settings;
pub use target::{Criterion, Kind, Target};

/// Result of a chapter: it fails only if a computation cannot be done at all, not if a target is missed.
pub type Found<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// How a chapter is computed.
pub type Computation = fn(&Settings<'_>) -> Found<Chapter>;

/// All chapters in the order of the thesis, under the names of their examples.
pub const CHAPTERS: &[(&str, Computation)] = &[
    ("chapter_4_flexure", chapter_4_flexure::chapter),
    ("chapter_5_modal", chapter_5_modal::chapter),
    ("chapter_5_monte_carlo", chapter_5_monte_carlo::chapter),
    ("chapter_6_energy", chapter_6_energy::chapter),
    ("chapter_7_friction", chapter_7_friction::chapter),
    ("chapter_8_impact", chapter_8_impact::chapter),
    ("chapter_9_future", chapter_9_future::chapter),
];
