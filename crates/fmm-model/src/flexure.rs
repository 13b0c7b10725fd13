//! The guide of the machine: leaf springs, the platform that they carry, and the tilt of a shaft.

use crate::error::ModelError;
use crate::scalar::Scalar;

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

    /// λ, distance by which `deflection` δ (m) brings the ends nearer to each other (m).
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

/// A parallelogram flexure: a platform that several equal leaf springs carry side by side, so that it moves along x
/// without turning, and a little along the leaves, y.
///
/// ```text
/// k = n E b t³/L³                                                  (n leaves in parallel)
/// δ_y = −3 δ_x²/(5 L)                                              (thesis Eq. 4.3)
/// v_y = −6 δ_x v_x/(5 L)                                           (its derivative in time)
/// v = √(v_x² + v_y²)
/// ```
///
/// The parasitic motion δ_y points towards the clamps at the base whichever way the platform moves; it has twice the
/// frequency of an oscillation, and its velocity vanishes both at the turning points and at the centre.
///
/// ```
/// use fmm_model::{Flexure, LeafSpring};
///
/// let flexure = Flexure::new(4, LeafSpring::new(0.552, 0.1016, 0.001_587_5, 205e9)?)?;
/// assert!((flexure.stiffness() - 1981.7).abs() < 0.05);
/// assert!((flexure.parasitic_motion(0.004) + 17.39e-6).abs() < 5e-9);
/// assert!((flexure.motion_ratio(0.022) - 41.8).abs() < 0.05);
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flexure<D = f64> {
    leaves: u32,
    leaf: LeafSpring<D>,
}

impl<D: Scalar> Flexure<D> {
    /// A platform on `leaves` springs like `leaf`.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if there is no leaf.
    pub fn new(leaves: u32, leaf: LeafSpring<D>) -> Result<Self, ModelError> {
        ModelError::require_positive("number of leaf springs", f64::from(leaves), "(dimensionless)")?;
        Ok(Self { leaves, leaf })
    }

    /// n, the number of leaf springs.
    pub fn leaves(&self) -> u32 {
        self.leaves
    }

    /// One of the leaf springs; bending stress and allowed deflection of the flexure are those of each leaf.
    pub fn leaf(&self) -> LeafSpring<D> {
        self.leaf
    }

    /// k, stiffness of all leaf springs together (N/m).
    pub fn stiffness(&self) -> D {
        self.leaf.stiffness() * f64::from(self.leaves)
    }

    /// δ_y, motion across the guided direction (m) at `deflection` δ_x (m); zero or negative.
    pub fn parasitic_motion(&self, deflection: D) -> D {
        -self.leaf.shortening(deflection)
    }

    /// v_y, velocity across the guided direction (m/s) at `deflection` δ_x (m) and `velocity` v_x (m/s).
    pub fn parasitic_velocity(&self, deflection: D, velocity: D) -> D {
        -(self.leaf.shortening_slope(deflection) * velocity)
    }

    /// v, speed of the platform along its path (m/s) at `deflection` δ_x (m) and `velocity` v_x (m/s).
    pub fn resultant_speed(&self, deflection: D, velocity: D) -> D {
        let slope = self.leaf.shortening_slope(deflection);
        // |v_x| times the length of the path per deflection: differentiable in the deflection also where v_x vanishes.
        velocity.abs() * (slope * slope + 1.0).sqrt()
    }

    /// |δ_x/δ_y| = 5 L/(3 |δ_x|), ratio of `deflection` δ_x (m) to the parasitic motion; infinite at the centre (1).
    pub fn motion_ratio(&self, deflection: D) -> D {
        self.leaf.length() / (deflection.abs() * 0.6)
    }

    /// The length of leaf springs (m) with which the parasitic motion is `ratio` times smaller than `deflection` (m),
    /// the inverse of [`motion_ratio`](Self::motion_ratio).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if the magnitude of the deflection or the ratio is zero or not finite, or the ratio
    /// negative.
    pub fn length_for_motion_ratio(deflection: D, ratio: D) -> Result<D, ModelError> {
        ModelError::require_positive("magnitude of a deflection", deflection.value().abs(), "m")?;
        ModelError::require_positive("ratio of deflection to parasitic motion", ratio.value(), "(dimensionless)")?;
        Ok(deflection.abs() * ratio * 0.6)
    }
}

/// The angle by which a straight shaft leans, from its sideways displacement at two places along it.
///
/// ```text
/// φ = arctan((x₁ − x₂)/s)                                          (thesis 4.3)
/// ```
///
/// ```
/// use fmm_model::Tilt;
///
/// // 1.6 µm between two sensors 10.8 cm apart.
/// let tilt: Tilt = Tilt::from_displacements(1.6e-6, 0.0, 0.108)?;
/// assert!((tilt.degrees() - 8.488e-4).abs() < 5e-8);
/// assert!((tilt.arcseconds() - 3.056).abs() < 5e-4);
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tilt<D = f64> {
    radians: D,
}

impl<D: Scalar> Tilt<D> {
    /// The tilt at which two sensors, `spacing` s (m) apart along the shaft, show the displacements `first` x₁ and
    /// `second` x₂ (m).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if the spacing is zero, negative or not finite, [`ModelError::NotFinite`] if the
    /// difference of the displacements is not finite.
    pub fn from_displacements(first: D, second: D, spacing: D) -> Result<Self, ModelError> {
        ModelError::require_positive("spacing of two sensors", spacing.value(), "m")?;
        let difference = first - second;
        ModelError::require_finite("difference of two displacements", difference.value(), "m")?;
        Ok(Self { radians: difference.atan2(spacing) })
    }

    /// φ (rad), positive if the first displacement is the larger one.
    pub fn radians(&self) -> D {
        self.radians
    }

    /// φ in degrees.
    pub fn degrees(&self) -> D {
        self.radians * 1f64.to_degrees()
    }

    /// φ in seconds of arc, 3600 to the degree.
    pub fn arcseconds(&self) -> D {
        self.degrees() * 3600.0
    }
}

#[cfg(test)]
mod leaf_spring_tests {
    use super::*;
    use crate::dual::Dual;

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

#[cfg(test)]
mod flexure_tests {
    use super::*;
    use crate::dual::Dual;

    fn flexure() -> Flexure {
        Flexure::new(4, LeafSpring::new(0.552, 0.1016, 0.001_587_5, 205e9).unwrap()).unwrap()
    }

    /// v_y is the derivative of δ_y in time, here by the chain rule of dual numbers; rounding only.
    #[test]
    fn parasitic_velocity_is_the_derivative_of_the_parasitic_motion() {
        let leaf = LeafSpring::new(0.552.into(), 0.1016.into(), 0.001_587_5.into(), 205e9.into()).unwrap();
        let dual = Flexure::<Dual<1>>::new(4, leaf).unwrap();
        for (deflection, velocity) in [(0.022, 0.3), (-0.006, 0.08), (0.01, -0.1), (0.0, 0.3)] {
            let along_time = Dual::variable(deflection, 0);
            let expected = dual.parasitic_motion(along_time).partial(0) * velocity;
            let found = flexure().parasitic_velocity(deflection, velocity);
            assert!((found - expected).abs() <= 1e-17, "{found} m/s against {expected} m/s");
            let speed = flexure().resultant_speed(deflection, velocity);
            assert!((speed - velocity.hypot(found)).abs() < 1e-16, "{speed} m/s");
        }
        assert_eq!(flexure().parasitic_motion(-0.01), flexure().parasitic_motion(0.01));
        // A platform at rest has no speed, and the derivative of that is a number.
        assert_eq!(dual.resultant_speed(Dual::variable(0.01, 0), Dual::from(0.0)).partial(0), 0.0);
    }

    #[test]
    fn the_length_follows_from_the_ratio() {
        let ratio = flexure().motion_ratio(-0.004);
        assert!((ratio - 230.0).abs() < 1e-12, "{ratio}");
        let length = Flexure::length_for_motion_ratio(-0.004, ratio).unwrap();
        assert!((length - 0.552).abs() < 1e-15, "{length} m");
        for (deflection, ratio) in
            [(0.0, 230.0), (f64::NAN, 230.0), (0.004, 0.0), (0.004, -1.0), (0.004, f64::INFINITY)]
        {
            assert!(Flexure::length_for_motion_ratio(deflection, ratio).is_err(), "{deflection} m, {ratio}");
        }
    }

    #[test]
    fn a_flexure_needs_a_leaf() {
        let message = Flexure::new(0, flexure().leaf()).unwrap_err().to_string();
        assert_eq!(message, "number of leaf springs must be positive and finite, but is 0 (dimensionless)");
        assert_eq!(flexure().stiffness(), 4.0 * flexure().leaf().stiffness());
    }
}

#[cfg(test)]
mod tilt_tests {
    use super::*;
    use crate::dual::Dual;

    #[test]
    fn tilts_have_their_sign_and_units() {
        let tilt = |first: f64, second| Tilt::from_displacements(first, second, 0.5).unwrap();
        assert!((tilt(0.7, 0.2).degrees() - 45.0).abs() < 1e-13);
        assert!((tilt(0.2, 0.7).arcseconds() + 162_000.0).abs() < 1e-9);
        assert_eq!(tilt(0.3, 0.3).radians(), 0.0);
        let sensitive = Tilt::from_displacements(Dual::<1>::variable(0.0, 0), 0.0.into(), 0.5.into()).unwrap();
        assert_eq!(sensitive.radians().partial(0), 2.0);
    }

    #[test]
    fn impossible_tilts_are_refused() {
        for bad in [0.0, -0.1, f64::NAN, f64::INFINITY] {
            assert!(Tilt::from_displacements(1e-6, 0.0, bad).is_err(), "spacing {bad} m");
        }
        assert!(Tilt::from_displacements(f64::NAN, 0.0, 0.1).is_err());
        assert!(Tilt::from_displacements(f64::MAX, -f64::MAX, 0.1).is_err());
    }
}
