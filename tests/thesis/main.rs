//! The thesis beside ours: the targets of its chapters, and its errata.

mod chapter_4_flexure;
mod errata;
