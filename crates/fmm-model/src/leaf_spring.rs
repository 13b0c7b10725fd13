//! A leaf spring that is clamped at one end and guided at the other, as in a parallelogram flexure.

use crate::{ModelError, Scalar};

/// A flat leaf spring between two clamps, one of which moves sideways and does not turn.
///
/// ```text
/// k = 12 E I/L³ = E b t³/L³,   I = b t³/12
/// σ = 3 E t |δ|/L²                                                 (thesis Eq. 4.2, corrected)
/// δ_σ = σ L²/(3 E t)                                               (thesis Eq. 4.1, corrected)
/// λ = 3 δ²/(5 L)                                                   (thesis Eq. 4.3)
/// ```
///
/// | symbol | argument | unit | meaning |
/// |---|---|---|---|
/// | L | `length` | m | free length between the clamps |
/// | b | `width` | m | across the motion, in the plane of the leaf |
/// | t | `thickness` | m | along the motion |
/// | E | `elastic_modulus` | Pa | Young's modulus |
///
/// The formulas are those of slender beams at deflections δ that are small beside the length: the leaf takes the shape
/// δ (3 s² − 2 s³) along s = 0 … 1, which bends it most at both clamps and draws its ends together by λ.
/// The thesis prints L for L² in Eq. 4.1 and b t² for L² in Eq. 4.2; neither is then a length or a stress.
///
/// ```
/// use fmm_model::LeafSpring;
///
/// // 552 mm by 4 in by 1/16 in of steel.
/// let leaf = LeafSpring::new(0.552, 0.1016, 0.001_587_5, 205e9)?;
/// assert!((leaf.stiffness() - 495.4).abs() < 0.05);
/// let stress: f64 = leaf.bending_stress(0.022);
/// assert!((stress / 1e6 - 70.49).abs() < 5e-3);
/// assert!((leaf.deflection_at(stress) - 0.022).abs() < 1e-17);
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
///
/// # References
/// S. T. Smith, *Flexures: Elements of Elastic Mechanisms*, CRC Press, 2000.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeafSpring<D = f64> {
    length: D,
    width: D,
    thickness: D,
    elastic_modulus: D,
}

impl<D: Scalar> LeafSpring<D> {
    /// A leaf of `length`, `width` and `thickness` (m) and `elastic_modulus` (Pa).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if one of them is zero, negative or not finite.
    pub fn new(length: D, width: D, thickness: D, elastic_modulus: D) -> Result<Self, ModelError> {
        ModelError::require_positive("length of a leaf spring", length.value(), "m")?;
        ModelError::require_positive("width of a leaf spring", width.value(), "m")?;
        ModelError::require_positive("thickness of a leaf spring", thickness.value(), "m")?;
        ModelError::require_positive("elastic modulus", elastic_modulus.value(), "Pa")?;
        Ok(Self { length, width, thickness, elastic_modulus })
    }

    /// L, free length (m).
    pub fn length(&self) -> D {
        self.length
    }

    /// b, width (m).
    pub fn width(&self) -> D {
        self.width
    }

    /// t, thickness (m).
    pub fn thickness(&self) -> D {
        self.thickness
    }

    /// E, elastic modulus (Pa).
    pub fn elastic_modulus(&self) -> D {
        self.elastic_modulus
    }

    /// k, stiffness against deflection (N/m).
    pub fn stiffness(&self) -> D {
        let slenderness = self.thickness / self.length;
        self.elastic_modulus * self.width * slenderness * slenderness * slenderness
    }

    /// σ, the largest bending stress (Pa), at `deflection` δ (m).
    pub fn bending_stress(&self, deflection: D) -> D {
        deflection.abs() * self.stress_per_deflection()
    }

    /// δ_σ, the deflection (m) at which the largest bending stress is `stress` σ (Pa): with the yield strength, the
    /// largest deflection from which the leaf returns; with a part of it, the largest one allowed.
    pub fn deflection_at(&self, stress: D) -> D {
        stress.abs() / self.stress_per_deflection()
    }

    /// λ, how much nearer to each other `deflection` δ (m) brings the ends (m).
    pub fn shortening(&self, deflection: D) -> D {
        deflection * deflection * 0.6 / self.length
    }

    /// dλ/dδ, the change of the [shortening](Self::shortening) with `deflection` δ (m), of the sign of the deflection
    /// (1).
    pub fn shortening_slope(&self, deflection: D) -> D {
        deflection * 1.2 / self.length
    }

    fn stress_per_deflection(&self) -> D {
        self.elastic_modulus * self.thickness * 3.0 / (self.length * self.length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    fn leaf() -> LeafSpring {
        LeafSpring::new(0.552, 0.1016, 0.001_587_5, 205e9).unwrap()
    }

    /// Length of the deflected curve by Simpson's rule, and the curvature at the clamp: the shape itself is the
    /// reference.
    #[test]
    fn formulas_are_those_of_the_deflected_shape() {
        let (leaf, deflection, panels) = (leaf(), 0.022, 1000);
        let length = leaf.length();
        let slope = |s: f64| 6.0 * deflection / length * (s - s * s);
        let integral: f64 = (0..=panels)
            .map(|i| {
                let weight = if i == 0 || i == panels { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
                weight * slope(f64::from(i) / f64::from(panels)).powi(2)
            })
            .sum::<f64>()
            / f64::from(3 * panels);
        let shortening = 0.5 * integral * length;
        // Simpson's rule on (s − s²)²: 24 h⁴/180 of an integral of 1/30 is 4e-12 at h = 1/1000.
        assert!((leaf.shortening(deflection) / shortening - 1.0).abs() < 1e-11, "{shortening} m");

        let curvature = 6.0 * deflection / (length * length);
        let stress = leaf.elastic_modulus() * curvature * leaf.thickness() / 2.0;
        assert!((leaf.bending_stress(-deflection) / stress - 1.0).abs() < 1e-15, "{stress} Pa");
        // The moment at each clamp is half the force times the length: k δ L/2 = E I κ.
        let moment = leaf.elastic_modulus() * leaf.width() * leaf.thickness().powi(3) / 12.0 * curvature;
        assert!((leaf.stiffness() * deflection * length / 2.0 / moment - 1.0).abs() < 1e-14, "{moment} N m");
        assert!((leaf.deflection_at(stress) - deflection).abs() < 1e-16);
    }

    /// Each power of the dimensions shows as a relative sensitivity; rounding only.
    #[test]
    fn stiffness_goes_with_the_cube_of_the_slenderness() {
        let leaf = leaf();
        let variable = |value, direction| Dual::<3>::variable(value, direction);
        let dual = LeafSpring::new(
            variable(leaf.length(), 0),
            0.1016.into(),
            variable(leaf.thickness(), 1),
            variable(205e9, 2),
        )
        .unwrap();
        let stiffness = dual.stiffness();
        assert_eq!(stiffness.value(), leaf.stiffness());
        for (direction, (value, power)) in
            [(leaf.length(), -3.0), (leaf.thickness(), 3.0), (205e9, 1.0)].iter().enumerate()
        {
            let relative = stiffness.partial(direction) * value / stiffness.value();
            assert!((relative - power).abs() < 1e-14, "direction {direction}: {relative} against {power}");
        }
        let shortening = dual.shortening(Dual::from(0.01));
        assert!((shortening.partial(0) * leaf.length() / shortening.value() + 1.0).abs() < 1e-14);
        let slope = leaf.shortening_slope(-0.01);
        let difference = (leaf.shortening(-0.01 + 1e-6) - leaf.shortening(-0.01 - 1e-6)) / 2e-6;
        // The difference of a parabola is exact but for rounding, 1e-16 of 1e-4 over 2e-6.
        assert!((slope - difference).abs() < 1e-12, "{slope} against {difference}");
    }

    #[test]
    fn impossible_leaves_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for place in 0..4 {
                let mut values = [0.552, 0.1016, 0.001_587_5, 205e9];
                values[place] = bad;
                let [length, width, thickness, modulus] = values;
                assert!(LeafSpring::new(length, width, thickness, modulus).is_err(), "{bad} at place {place}");
            }
        }
        let message = LeafSpring::new(0.552, 0.1016, 0.0, 205e9).unwrap_err().to_string();
        assert_eq!(message, "thickness of a leaf spring must be positive and finite, but is 0 m");
    }
}
