//! Estimators that simulate nothing: against known truth, the thesis' figures, and a real record.

mod decrement;
mod energy;
mod failures;
mod fork;
mod measurement;
mod weak_form;
mod windows;
