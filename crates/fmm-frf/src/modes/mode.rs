//! Mode of a structure: pole, residues and shape.

use std::fmt;

use fmm_model::Estimated;
use fmm_record::Complex64;
use fmm_record::uff::Freedom;

use super::pole::Pole;

/// A mode with its uncertainties.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Mode {
    /// λ, the pole.
    pub pole: Pole,
    /// f₀, undamped natural frequency (Hz).
    pub natural_frequency: Estimated,
    /// ζ, damping ratio (1).
    pub damping_ratio: Estimated,
    /// A, one for each response in the order given.
    pub residues: Vec<Residue>,
    /// Real shape, of largest component 1.
    pub shape: Vec<ShapePoint>,
    /// |Σ A²|²/(Σ |A|²)² over the points of the shape, the phase collinearity (1): 1 if all move in phase or against
    /// it, as those of proportional damping do; 0 for a wave that travels.
    pub phase_collinearity: f64,
}

/// Residue of a pole in one response.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Residue {
    /// A, of the receptance whatever the form of the response (m/(N s)).
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::modes::pole::pair"))]
    pub value: Complex64,
    /// Standard uncertainty of its real part (m/(N s)).
    pub real_uncertainty: f64,
    /// Standard uncertainty of its imaginary part (m/(N s)).
    pub imaginary_uncertainty: f64,
    /// Covariance of the two (m²/(N² s²)).
    pub covariance: f64,
}

/// A place of a structure, and how far it moves in a mode.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ShapePoint {
    /// Place and direction.
    pub place: Freedom,
    /// Deflection by the largest (1).
    pub deflection: Estimated,
}

/// Text such as `f₀ = 2.1979(4) Hz, ζ = 0.0280(2)`.
impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "f₀ = {} Hz, ζ = {}", self.natural_frequency, self.damping_ratio)
    }
}

/// The shape that `residues` at `places` have, and its phase collinearity: their parts along the phase that all have
/// most in common, by the largest.
pub(super) fn shape(places: &[&Freedom], residues: &[Residue]) -> (Vec<ShapePoint>, f64) {
    let largest = residues.iter().map(|residue| residue.value.norm()).fold(0.0, f64::max);
    if !(largest > 0.0) {
        return (Vec::new(), 0.0);
    }
    let squares: Complex64 = residues.iter().map(|residue| (residue.value / largest).powi(2)).sum();
    let norm: f64 = residues.iter().map(|residue| (residue.value / largest).norm_sqr()).sum();
    let axis = Complex64::from_polar(1.0, 0.5 * squares.arg());
    let along = |residue: &Residue| (residue.value * axis.conj()).re;
    let longest = residues.iter().map(along).reduce(|a, b| if b.abs() > a.abs() { b } else { a }).unwrap_or(largest);
    let points = places.iter().zip(residues).map(|(place, residue)| {
        let Residue { real_uncertainty, imaginary_uncertainty, covariance, .. } = residue;
        let variance = (axis.re * real_uncertainty).powi(2)
            + (axis.im * imaginary_uncertainty).powi(2)
            + 2.0 * axis.re * axis.im * covariance;
        let u = variance.max(0.0).sqrt() / longest.abs();
        ShapePoint { place: (*place).clone(), deflection: Estimated::new(along(residue) / longest, u) }
    });
    (points.collect(), squares.norm_sqr() / (norm * norm))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_is_real_and_its_largest_deflection_is_one() {
        let residue = |re: f64, im: f64| Residue {
            value: Complex64::new(re, im),
            real_uncertainty: 0.3,
            imaginary_uncertainty: 0.1,
            covariance: 0.0,
        };
        let place = Freedom::default();
        let (points, collinearity) = shape(&[&place, &place], &[residue(0.0, -1.0), residue(0.0, 2.0)]);
        let deflections: Vec<Estimated> = points.iter().map(|point| point.deflection).collect();
        assert!((deflections[0].value + 0.5).abs() < 1e-15 && (deflections[1].value - 1.0).abs() < 1e-15);
        assert!((deflections[0].uncertainty - 0.05).abs() < 1e-15, "{}", deflections[0].uncertainty);
        assert!((collinearity - 1.0).abs() < 1e-15);
        let (_, collinearity) = shape(&[&place, &place], &[residue(1.0, 0.0), residue(0.0, 1.0)]);
        assert!(collinearity < 1e-15, "a wave that travels: {collinearity}");
    }
}
