//! Dimension of a unit: which powers of length, time, mass and angle it is, and how much of the SI unit.

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
    /// Length, time, mass, angle.
    powers: [f64; 4],
}

impl Dimension {
    /// A pure number.
    pub(crate) const NONE: Self = Self { factor: 1.0, powers: [0.0; 4] };

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

    /// This dimension times a power of another.
    pub(crate) fn times(self, other: Self, power: f64) -> Self {
        let mut powers = self.powers;
        powers.iter_mut().zip(other.powers).for_each(|(mine, others)| *mine += power * others);
        Self { factor: self.factor * math::powf(other.factor, power), powers }
    }
}

/// Dimension of one symbol; `None` for one that is not known.
pub(crate) fn of_symbol(symbol: &str) -> Option<Dimension> {
    const BASE: [(&str, [f64; 4]); 7] = [
        ("m", [1.0, 0.0, 0.0, 0.0]),
        ("s", [0.0, 1.0, 0.0, 0.0]),
        ("kg", [0.0, 0.0, 1.0, 0.0]),
        ("rad", [0.0, 0.0, 0.0, 1.0]),
        ("N", [1.0, -2.0, 1.0, 0.0]),
        ("J", [2.0, -2.0, 1.0, 0.0]),
        ("Hz", [0.0, -1.0, 0.0, 0.0]),
    ];
    const PREFIX: [(&str, f64); 8] =
        [("", 1.0), ("m", 1e-3), ("c", 1e-2), ("µ", 1e-6), ("μ", 1e-6), ("u", 1e-6), ("n", 1e-9), ("k", 1e3)];
    const OTHER: [(&str, f64, [f64; 4]); 5] = [
        ("1", 1.0, [0.0; 4]),
        ("%", 1e-2, [0.0; 4]),
        ("g", 1e-3, [0.0, 0.0, 1.0, 0.0]),
        ("deg", core::f64::consts::PI / 180.0, [0.0, 0.0, 0.0, 1.0]),
        ("°", core::f64::consts::PI / 180.0, [0.0, 0.0, 0.0, 1.0]),
    ];
    let of_base = |name: &str| BASE.iter().find(|(base, _)| *base == name);
    let prefixed = PREFIX.iter().find_map(|(prefix, factor)| {
        let (_, powers) = of_base(symbol.strip_prefix(prefix)?)?;
        // A kilogram has its prefix.
        (prefix.is_empty() || !symbol.ends_with("kg")).then_some(Dimension { factor: *factor, powers: *powers })
    });
    let other = || OTHER.iter().find(|(name, ..)| *name == symbol);
    prefixed.or_else(|| other().map(|(_, factor, powers)| Dimension { factor: *factor, powers: *powers }))
}

/// The digit that is written as a power.
pub(crate) fn superscript(c: char) -> Option<u32> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|digit| digit == c).map(|digit| digit as u32)
}

#[cfg(test)]
mod tests {
    use crate::Unit;

    fn of(unit: &str) -> Option<(f64, [f64; 4])> {
        Unit::of(unit).dimension(|symbol| (symbol == "n").then_some(3.0)).map(|found| (found.factor, found.powers))
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
        ] {
            let (found, dimension) = of(unit).unwrap();
            assert!((found / factor - 1.0).abs() < 1e-14 && dimension == powers, "{unit}: {found} {dimension:?}");
        }
    }

    #[test]
    fn what_is_no_unit_is_none() {
        for text in ["", "/", "m/", "m^", "m^k", "(m", "m)", "()", "furlong", "V", "m⁻", "kkg", "^2", "()^2"] {
            assert_eq!(of(text), None, "{text}");
        }
    }
}
