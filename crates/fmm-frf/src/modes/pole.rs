//! Pole of a structure: frequency and damping of a mode in one complex number.

use std::f64::consts::TAU;

use fmm_record::Complex64;

/// A pole λ = −ζω₀ + iω₀√(1 − ζ²), of the pair that a mode has the one of positive frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Pole(
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::modes::pole::pair"))] pub(super) Complex64,
);

impl Pole {
    /// λ (rad/s).
    pub fn value(self) -> Complex64 {
        self.0
    }

    /// f₀ = |λ|/2π, undamped natural frequency (Hz).
    pub fn natural_frequency(self) -> f64 {
        self.0.norm() / TAU
    }

    /// ζ = −Re λ/|λ|, damping ratio (1).
    pub fn damping_ratio(self) -> f64 {
        -self.0.re / self.0.norm()
    }
}

/// Writes a complex number as the pair of its parts, as JSON has no number for it.
#[cfg(feature = "serde")]
pub(super) fn pair<S: serde::Serializer>(value: &Complex64, serializer: S) -> Result<S::Ok, S::Error> {
    serde::Serialize::serialize(&[value.re, value.im], serializer)
}
