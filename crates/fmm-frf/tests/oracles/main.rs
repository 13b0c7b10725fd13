//! Values that others computed: see `../data/SOURCE.md`.

mod closed_forms;
mod estimates;
mod harmonics;
mod modes;
mod table;
