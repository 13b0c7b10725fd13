//! A number that was found, with what is known of it.

use std::fmt;

use fmm_model::Rounded;

/// A value with its standard uncertainty, in the same unit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// u, its standard uncertainty.
    pub uncertainty: f64,
}

impl Measured {
    pub(crate) fn new(value: f64, uncertainty: f64) -> Self {
        Self { value, uncertainty }
    }
}

impl fmt::Display for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Rounded::new(self.value, Some(self.uncertainty)).fmt(f)
    }
}
