//! Dimension of a unit: which powers of length, time, mass and angle it is, and how much of the SI unit.

use crate::math;

/// What a unit is made of.
///
/// ```text
/// unit = factor mˡ sᵗ kgᵐ radᵃ
/// ```
///
/// ```
/// use fmm_model::Dimension;
///
/// let speed = Dimension::of("mm/s", |_| None).unwrap();
/// assert_eq!((speed.factor(), speed.length(), speed.time()), (1e-3, 1.0, -1.0));
/// let damping = Dimension::of("N s/m", |_| None).unwrap();
/// assert_eq!((damping.mass(), damping.length(), damping.time()), (1.0, 0.0, -1.0));
/// // An exponent that is a parameter itself.
/// assert_eq!(Dimension::of("(s/m)^p", |symbol| (symbol == "p").then_some(0.5)).unwrap().length(), -0.5);
/// assert_eq!(Dimension::of("furlong", |_| None), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dimension {
    factor: f64,
    /// Length, time, mass, angle.
    powers: [f64; 4],
}

impl Dimension {
    /// A pure number.
    const NONE: Self = Self { factor: 1.0, powers: [0.0; 4] };

    /// Dimension of a unit as it is written: symbols with powers (`s²`, `s^2`, `s^n`), beside each other or with a `*`, each
    /// divided by that has a `/` before it, and parentheses with a power. `exponent` gives the value of a power that is a letter.
    /// None for a symbol or a power that is not known.
    pub fn of(unit: &str, exponent: impl Fn(&str) -> Option<f64>) -> Option<Self> {
        let mut rest = unit.trim();
        let dimension = product(&mut rest, &exponent)?;
        rest.is_empty().then_some(dimension)
    }

    /// How much of the SI unit it is (1).
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
    fn times(self, other: Self, power: f64) -> Self {
        let mut powers = self.powers;
        powers.iter_mut().zip(other.powers).for_each(|(mine, others)| *mine += power * others);
        Self { factor: self.factor * math::powf(other.factor, power), powers }
    }

    /// Of one symbol.
    fn of_symbol(symbol: &str) -> Option<Self> {
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
            (prefix.is_empty() || !symbol.ends_with("kg")).then_some(Self { factor: *factor, powers: *powers })
        });
        let other = || OTHER.iter().find(|(name, ..)| *name == symbol);
        prefixed.or_else(|| other().map(|(_, factor, powers)| Self { factor: *factor, powers: *powers }))
    }
}

/// Symbols and parentheses as far as the text or a closing parenthesis.
fn product(rest: &mut &str, exponent: &impl Fn(&str) -> Option<f64>) -> Option<Dimension> {
    let mut dimension = Dimension::NONE;
    let mut sign = 1.0;
    let mut count = 0;
    loop {
        *rest = rest.trim_start();
        let Some(first) = rest.chars().next().filter(|first| *first != ')') else { break };
        if matches!(first, '/' | '*' | '·') {
            sign = if first == '/' { -1.0 } else { 1.0 };
            *rest = &rest[first.len_utf8()..];
            continue;
        }
        let factor = if first == '(' {
            *rest = &rest[1..];
            let inner = product(rest, exponent)?;
            *rest = rest.strip_prefix(')')?;
            inner
        } else {
            Dimension::of_symbol(symbol(rest))?
        };
        dimension = dimension.times(factor, sign * power(rest, exponent)?);
        (sign, count) = (1.0, count + 1);
    }
    (count > 0 && sign > 0.0).then_some(dimension)
}

/// Takes the symbol that the text begins with.
fn symbol<'a>(rest: &mut &'a str) -> &'a str {
    let is_end =
        |c: char| c.is_whitespace() || matches!(c, '/' | '*' | '·' | '(' | ')' | '^' | '⁻') || superscript(c).is_some();
    let first = rest.chars().next().map_or(0, char::len_utf8);
    let length = rest[first..].find(is_end).map_or(rest.len(), |end| first + end);
    let (symbol, behind) = rest.split_at(length);
    *rest = behind;
    symbol
}

/// Takes the power that the text begins with; 1 without one.
fn power(rest: &mut &str, exponent: &impl Fn(&str) -> Option<f64>) -> Option<f64> {
    if let Some(behind) = rest.strip_prefix('^') {
        *rest = behind;
        let negative = rest.strip_prefix('-').map(|behind| *rest = behind).is_some();
        let text = symbol(rest);
        let value = text.parse().ok().or_else(|| exponent(text))?;
        return Some(if negative { -value } else { value });
    }
    let negative = rest.strip_prefix('⁻').map(|behind| *rest = behind).is_some();
    let mut value = None;
    while let Some(digit) = rest.chars().next().and_then(superscript) {
        value = Some(10.0 * value.unwrap_or(0.0) + f64::from(digit));
        *rest = &rest[rest.chars().next().map_or(0, char::len_utf8)..];
    }
    match value {
        Some(value) => Some(if negative { -value } else { value }),
        None => (!negative).then_some(1.0),
    }
}

/// The digit that is written as a power.
fn superscript(c: char) -> Option<u32> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|digit| digit == c).map(|digit| digit as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(unit: &str) -> Option<(f64, [f64; 4])> {
        Dimension::of(unit, |symbol| (symbol == "n").then_some(3.0)).map(|found| (found.factor, found.powers))
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
