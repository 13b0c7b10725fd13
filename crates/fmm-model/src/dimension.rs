//! Dimension of a unit: its powers of length, time, mass and angle, and its size in the SI unit.

use crate::math;

/// Dimension of a unit.
///
/// ```text
/// unit = factor mˡ sᵗ kgᵐ radᵃ
/// ```
///
/// ```
/// use fmm_model::Unit;
///
/// let speed = Unit::of("mm/s").dimension(|_| None).unwrap();
/// assert_eq!((speed.factor(), speed.length(), speed.time()), (1e-3, 1.0, -1.0));
/// let damping = Unit::of("N s/m").dimension(|_| None).unwrap();
/// assert_eq!((damping.mass(), damping.length(), damping.time()), (1.0, 0.0, -1.0));
/// // An exponent that is a parameter itself.
/// assert_eq!(Unit::of("(s/m)^p").dimension(|symbol| (symbol == "p").then_some(0.5)).unwrap().length(), -0.5);
/// assert_eq!(Unit::of("furlong").dimension(|_| None), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dimension {
    factor: f64,
    /// Length, time, mass, angle, voltage, current, counts.
    powers: [f64; 7],
}

impl Dimension {
    /// A pure number.
    pub(crate) const NONE: Self = Self { factor: 1.0, powers: [0.0; 7] };

    /// A `factor` of the SI unit of these powers.
    pub(crate) const fn new(factor: f64, powers: [f64; 7]) -> Self {
        Self { factor, powers }
    }

    /// Size of the unit in the SI unit (1).
    pub const fn factor(&self) -> f64 {
        self.factor
    }

    /// Power of length.
    pub const fn length(&self) -> f64 {
        self.powers[0]
    }

    /// Power of time.
    pub const fn time(&self) -> f64 {
        self.powers[1]
    }

    /// Power of mass.
    pub const fn mass(&self) -> f64 {
        self.powers[2]
    }

    /// Power of angle.
    pub const fn angle(&self) -> f64 {
        self.powers[3]
    }

    /// True if both have the same powers: units of different size of one quantity, such as m/s and km/h.
    pub fn is_alike(&self, other: &Self) -> bool {
        self.powers == other.powers
    }

    /// This dimension times a power of another.
    pub(crate) fn times(self, other: Self, power: f64) -> Self {
        let mut powers = self.powers;
        powers.iter_mut().zip(other.powers).for_each(|(mine, others)| *mine += power * others);
        Self { factor: self.factor * math::powf(other.factor, power), powers }
    }
}

#[cfg(test)]
mod tests {
    use crate::unit::Unit;

    fn of(unit: &str) -> Option<(f64, [f64; 4])> {
        let found = Unit::of(unit).dimension(|symbol| (symbol == "n").then_some(3.0));
        found.map(|found| (found.factor, [found.length(), found.time(), found.mass(), found.angle()]))
    }

    #[test]
    fn units_are_read_as_they_are_written() {
        for (unit, factor, powers) in [
            ("1", 1.0, [0.0; 4]),
            ("m", 1.0, [1.0, 0.0, 0.0, 0.0]),
            ("mm", 1e-3, [1.0, 0.0, 0.0, 0.0]),
            ("ms", 1e-3, [0.0, 1.0, 0.0, 0.0]),
            ("1/m", 1.0, [-1.0, 0.0, 0.0, 0.0]),
            ("s/mm", 1e3, [-1.0, 1.0, 0.0, 0.0]),
            ("1/mm^n", 1e9, [-3.0, 0.0, 0.0, 0.0]),
            ("(s/m)^n", 1.0, [-3.0, 3.0, 0.0, 0.0]),
            ("rad/s²", 1.0, [0.0, -2.0, 0.0, 1.0]),
            ("m s⁻¹", 1.0, [1.0, -1.0, 0.0, 0.0]),
            ("m*s^-12", 1.0, [1.0, -12.0, 0.0, 0.0]),
            ("kg/g", 1e3, [0.0; 4]),
            ("N s²/m", 1.0, [0.0, 0.0, 1.0, 0.0]),
            ("µN m", 1e-6, [2.0, -2.0, 1.0, 0.0]),
            ("%", 1e-2, [0.0; 4]),
            ("mV", 1e-3, [0.0; 4]),
        ] {
            let (found, dimension) = of(unit).unwrap();
            assert!((found / factor - 1.0).abs() < 1e-14 && dimension == powers, "{unit}: {found} {dimension:?}");
        }
    }

    #[test]
    fn what_is_no_unit_is_none() {
        for text in ["", "/", "m/", "m^", "m^k", "(m", "m)", "()", "furlong", "m⁻", "kkg", "^2", "()^2"] {
            assert_eq!(of(text), None, "{text}");
        }
    }

    #[test]
    fn alike_are_units_of_one_quantity() {
        let dimension = |unit: &str| Unit::of(unit).dimension(|_| None).unwrap();
        assert!(dimension("km/h").is_alike(&dimension("m/s")) && dimension("J").is_alike(&dimension("N m")));
        assert!(!dimension("V").is_alike(&dimension("A")) && !dimension("V").is_alike(&dimension("%")));
    }
}
