//! The thesis' numbers beside ours: every target of a chapter and why its tolerance is what it is, and the errata.

mod chapter_4_flexure;
mod chapter_5;
mod errata;
