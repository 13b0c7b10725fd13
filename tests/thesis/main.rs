//! The thesis' numbers beside ours: every target of a chapter and why its tolerance is what it is, and the errata.

mod chapter_4;
mod chapter_5;
mod chapter_6;
mod chapter_7;
mod errata;
