//! Evaluation of the uncertainty of an input, type A or B.

use std::fmt;

/// Type A or type B evaluation (JCGM 100:2008, 4.2 and 4.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Evaluation {
    /// From a series of observations.
    TypeA,
    /// From anything else: a certificate, limits, experience.
    #[default]
    TypeB,
}

impl fmt::Display for Evaluation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TypeA => "A",
            Self::TypeB => "B",
        })
    }
}
