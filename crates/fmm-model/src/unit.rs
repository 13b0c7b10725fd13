//! Unit as a value: a product of powers of symbols, which multiplies and prints.

use alloc::borrow::ToOwned;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt::{self, Display, Formatter};

use crate::dimension::Dimension;
use crate::symbol;

/// A unit: symbols with powers, in the order in which it was written. Symbols are whatever a record states: `m`, `mm`,
/// `V`, `counts`.
///
/// ```
/// use fmm_model::Unit;
///
/// // A velocity in volts: positions are V s, and a stiffness per volt-second is the force by that.
/// let velocity = Unit::of("V");
/// let position = velocity.times(&Unit::of("s"));
/// assert_eq!(position.to_string(), "V s");
/// assert_eq!(Unit::of("N").per(&position).to_string(), "N/(V s)");
/// // A law states lengths in m; the record has them in rad.
/// assert_eq!(Unit::of("(s/m)^p").with("m", &Unit::of("rad")).to_string(), "(s/rad)^p");
/// assert_eq!(Unit::of("m/s²").times(&Unit::of("s/m")).to_string(), "1/s");
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Unit {
    factors: Vec<Factor>,
}

/// A symbol to a power, which may be that of a parameter.
#[derive(Debug, Clone, PartialEq)]
struct Factor {
    symbol: String,
    power: f64,
    /// Symbol of the parameter by which the power is multiplied; `None` if the power is a number.
    exponent: Option<String>,
}

impl Unit {
    /// The unit that `text` says: symbols with powers (`s²`, `s^2`, `s^n`), beside each other or with a `*`, each
    /// divided by that has a `/` before it, and parentheses with a power. A text that is not built like that is one
    /// symbol.
    pub fn of(text: &str) -> Self {
        let mut rest = text.trim();
        let whole = || Self { factors: [Factor::of(text.trim())].into() };
        product(&mut rest, DEEPEST).filter(|_| rest.is_empty()).unwrap_or_else(whole)
    }

    /// Unit as a person or an instrument writes it, in the symbols of this crate; `None` if one of its symbols is not
    /// known, or if it has two different units of time.
    ///
    /// Beside the notation of [`Unit::of`]: `m s-1`, `ms^-1`, `m/s2`, `m/s**2`, `m.s-2`, `metres per second`; names
    /// such as `deg`, `rev`, `micron`, `lbf`, `ticks` with their plurals; `u` for µ; `g` for free fall. Capitals matter
    /// only where the text would be another unit without them.
    ///
    /// ```
    /// use fmm_model::Unit;
    ///
    /// assert_eq!(Unit::written("MM/Sec"), Some(Unit::of("mm/s")));
    /// assert_eq!(Unit::written("degrees per second"), Some(Unit::of("deg/s")));
    /// assert_eq!(Unit::written("mN"), Some(Unit::of("mN")));
    /// assert_eq!((Unit::written("furlong"), Unit::written("m/s/min")), (None, None));
    /// ```
    pub fn written(text: &str) -> Option<Self> {
        /// Small letters that mean another unit in capitals: gauss, megagram, newton metre.
        const SMALL_ONLY: [&str; 4] = ["g", "gn", "mg", "nm"];
        let text = plain(text);
        let lower = text.to_lowercase();
        let read = |mut text: &str| {
            let unit = product(&mut text, DEEPEST).filter(|_| text.is_empty())?;
            unit.in_symbols()
        };
        read(&text).or_else(|| if SMALL_ONLY.contains(&&*lower) { None } else { read(&lower) })
    }

    /// This unit with the symbol of the table for each of its names, which may have a power behind them, as in `s2`.
    fn in_symbols(self) -> Option<Self> {
        let mut unit = Self::default();
        for Factor { symbol, power, exponent } in self.factors {
            let (stem, number) = symbol.split_at(symbol.trim_end_matches(|c: char| c.is_ascii_digit()).len());
            let (stem, sign) = stem.strip_suffix('-').map_or((stem, 1.0), |stem| (stem, -1.0));
            let (name, number) = match (symbol::named(&symbol), exponent) {
                (_, Some(_)) => return None,
                (Some(name), None) => (name, 1.0),
                (None, None) => (symbol::named(stem)?, sign * number.parse::<f64>().ok()?),
            };
            unit.multiply(Factor { symbol: [name.0, name.1].concat(), power: power * number, exponent: None });
        }
        let has_time = |factor: &&Factor| symbol::dimension(&factor.symbol).is_some_and(|found| found.time() != 0.0);
        (unit.factors.iter().filter(has_time).count() < 2).then_some(unit)
    }

    /// Product of this unit and `other`.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let mut product = self.clone();
        other.factors.iter().for_each(|factor| product.multiply(factor.clone()));
        product
    }

    /// Quotient of this unit by `other`.
    #[must_use]
    pub fn per(&self, other: &Self) -> Self {
        self.times(&other.power(-1))
    }

    /// Power `n` of this unit.
    #[must_use]
    pub fn power(&self, n: i32) -> Self {
        self.raised(f64::from(n))
    }

    /// This unit with `other` in the place of `symbol`.
    #[must_use]
    pub fn with(&self, symbol: &str, other: &Self) -> Self {
        let mut result = Self::default();
        for factor in &self.factors {
            if factor.symbol != symbol {
                result.multiply(factor.clone());
                continue;
            }
            for inner in other.raised(factor.power).factors {
                // A power that is a parameter is not put into another one.
                let exponent = inner.exponent.or_else(|| factor.exponent.clone());
                result.multiply(Factor { exponent, ..inner });
            }
        }
        result
    }

    /// Its powers of length, time, mass and angle; `exponent` gives the value of a power that is a parameter. `None`
    /// for a symbol or a power that is not known.
    pub fn dimension(&self, exponent: impl Fn(&str) -> Option<f64>) -> Option<Dimension> {
        self.factors.iter().try_fold(Dimension::NONE, |dimension, factor| {
            let power = match &factor.exponent {
                None => factor.power,
                Some(symbol) => factor.power * exponent(symbol)?,
            };
            Some(dimension.times(symbol::dimension(&factor.symbol)?, power))
        })
    }

    fn raised(&self, power: f64) -> Self {
        let raise = |factor: &Factor| Factor { power: power * factor.power, ..factor.clone() };
        Self { factors: self.factors.iter().map(raise).collect() }
    }

    fn multiply(&mut self, factor: Factor) {
        let is_same = |mine: &Factor| mine.symbol == factor.symbol && mine.exponent == factor.exponent;
        match self.factors.iter_mut().find(|mine| is_same(mine)) {
            Some(mine) => mine.power += factor.power,
            None => self.factors.push(factor),
        }
        self.factors.retain(|factor| factor.power != 0.0);
    }
}

impl Factor {
    fn of(symbol: &str) -> Self {
        Self { symbol: symbol.to_owned(), power: 1.0, exponent: None }
    }
}

impl Display for Unit {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let numbers: Vec<&Factor> = self.factors.iter().filter(|factor| factor.exponent.is_none()).collect();
        let mut is_first = true;
        if !numbers.is_empty() || self.factors.is_empty() {
            fraction(f, &numbers)?;
            is_first = false;
        }
        let mut done: Vec<&str> = Vec::new();
        for exponent in self.factors.iter().filter_map(|factor| factor.exponent.as_deref()) {
            if done.contains(&exponent) {
                continue;
            }
            done.push(exponent);
            let mut group: Vec<Factor> =
                self.factors.iter().filter(|factor| factor.exponent.as_deref() == Some(exponent)).cloned().collect();
            let is_below = group.iter().all(|factor| factor.power < 0.0);
            f.write_str(match (is_below, is_first) {
                (true, true) => "1/",
                (true, false) => "/",
                (false, true) => "",
                (false, false) => " ",
            })?;
            group.iter_mut().filter(|_| is_below).for_each(|factor| factor.power = -factor.power);
            match &group[..] {
                [Factor { symbol, power, .. }] if *power == 1.0 => f.write_str(symbol)?,
                _ => {
                    f.write_str("(")?;
                    fraction(f, &group.iter().collect::<Vec<_>>())?;
                    f.write_str(")")?;
                }
            }
            write!(f, "^{exponent}")?;
            is_first = false;
        }
        Ok(())
    }
}

/// Writes powers that are numbers: those above the line, then those below it.
fn fraction(f: &mut Formatter<'_>, factors: &[&Factor]) -> fmt::Result {
    let above = || factors.iter().filter(|factor| factor.power > 0.0);
    let below = || factors.iter().filter(|factor| factor.power < 0.0);
    if above().next().is_none() {
        f.write_str("1")?;
    }
    for (place, factor) in above().enumerate() {
        f.write_str(if place == 0 { "" } else { " " })?;
        powered(f, &factor.symbol, factor.power)?;
    }
    let is_group = below().count() > 1;
    for (place, factor) in below().enumerate() {
        f.write_str(if place > 0 {
            " "
        } else if is_group {
            "/("
        } else {
            "/"
        })?;
        powered(f, &factor.symbol, -factor.power)?;
    }
    f.write_str(if is_group { ")" } else { "" })
}

fn powered(f: &mut Formatter<'_>, symbol: &str, power: f64) -> fmt::Result {
    f.write_str(symbol)?;
    match power as u32 {
        1 if power == 1.0 => Ok(()),
        digit @ 2..=9 if f64::from(digit) == power => {
            write!(f, "{}", ['²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize - 2])
        }
        _ => write!(f, "^{power}"),
    }
}

/// A written unit with one sign for each operation. `ms-1` becomes `m s-1`, as its power belongs to s alone.
fn plain(text: &str) -> String {
    let text = text.replace("**", "^").replace(" per ", "/").replace('−', "-").replace(['∕', '⁄'], "/");
    let text = text.replace(['.', '⋅'], " ");
    let text = text.trim();
    let powers = ["s-1", "s^-1", "s⁻¹", "s-2", "s^-2", "s⁻²"];
    let stem =
        powers.iter().find_map(|power| text.strip_suffix(power)).filter(|stem| stem.ends_with(char::is_alphabetic));
    stem.map_or_else(|| text.to_owned(), |stem| [stem, " ", &text[stem.len()..]].concat())
}

/// Parentheses within each other that are read: units come from files, where there may be any number.
const DEEPEST: usize = 8;

/// Symbols and parentheses, up to `depth` within each other, as far as the text or a closing parenthesis.
fn product(rest: &mut &str, depth: usize) -> Option<Unit> {
    let mut unit = Unit::default();
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
        let inner = if first == '(' {
            *rest = &rest[1..];
            let inner = product(rest, depth.checked_sub(1)?)?;
            *rest = rest.strip_prefix(')')?;
            inner
        } else {
            let symbol = symbol(rest);
            // The number one is no symbol.
            if symbol == "1" { Unit::default() } else { Unit { factors: [Factor::of(symbol)].into() } }
        };
        let (power, exponent) = power(rest)?;
        for factor in inner.raised(sign * power).factors {
            unit.multiply(Factor { exponent: factor.exponent.or_else(|| exponent.map(ToOwned::to_owned)), ..factor });
        }
        (sign, count) = (1.0, count + 1);
    }
    (count > 0 && sign > 0.0).then_some(unit)
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

/// Takes the power that the text begins with, 1 without one, and the parameter by which it is multiplied.
fn power<'a>(rest: &mut &'a str) -> Option<(f64, Option<&'a str>)> {
    if let Some(behind) = rest.strip_prefix('^') {
        *rest = behind;
        let negative = rest.strip_prefix('-').map(|behind| *rest = behind).is_some();
        let text = symbol(rest);
        let sign = if negative { -1.0 } else { 1.0 };
        let is_word = |text: &str| text.chars().next().is_some_and(char::is_alphabetic);
        return match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Some((sign * value, None)),
            _ => is_word(text).then_some((sign, Some(text))),
        };
    }
    let negative = rest.strip_prefix('⁻').map(|behind| *rest = behind).is_some();
    let mut value = None;
    while let Some(digit) = rest.chars().next().and_then(superscript) {
        value = Some(10.0 * value.unwrap_or(0.0) + f64::from(digit));
        *rest = &rest[rest.chars().next().map_or(0, char::len_utf8)..];
    }
    match value {
        Some(value) => f64::is_finite(value).then_some((if negative { -value } else { value }, None)),
        None => (!negative).then_some((1.0, None)),
    }
}

/// The digit that is written as a power.
fn superscript(c: char) -> Option<u32> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|digit| digit == c).map(|digit| digit as u32)
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use super::*;

    #[test]
    fn units_print_as_they_are_written() {
        for text in [
            "1",
            "m",
            "m/s",
            "m/s²",
            "1/s",
            "N s/m",
            "N s²/m²",
            "kg m²",
            "s/m²",
            "1/m^n",
            "(s/m)^p",
            "m^0.5/s",
            "counts",
            "V",
            "°/s",
            "N/(V s)",
            "m/s² (s/m)^p",
        ] {
            assert_eq!(Unit::of(text).to_string(), text);
        }
        for (text, wanted) in
            [("m s⁻¹", "m/s"), ("1/mm^2", "1/mm²"), ("m/s/s", "m/s²"), ("s m/s", "m"), ("m^12", "m^12")]
        {
            assert_eq!(Unit::of(text).to_string(), wanted);
        }
    }

    #[test]
    fn what_is_no_product_is_one_symbol() {
        let (deep, high) = ("(".repeat(100_000) + "m" + &")".repeat(100_000), "m".to_owned() + &"⁹".repeat(400));
        for text in ["counts per turn/", "m^", "(m", "m⁻", "a)", &deep, &high] {
            assert_eq!(Unit::of(text).to_string(), text);
            assert_eq!(Unit::of(text).dimension(|_| Some(1.0)), None, "{text}");
        }
    }

    #[test]
    fn units_multiply() {
        let of = |text: &str| Unit::of(text);
        for (left, right, product) in [
            ("m/s²", "1/m", "1/s²"),
            ("N", "1/m", "N/m"),
            ("N", "s/m", "N s/m"),
            ("N m", "s/rad", "N m s/rad"),
            ("m/s²", "(s/m)^p", "m/s² (s/m)^p"),
            ("m/s²", "s/mm", "m/(s mm)"),
            ("V", "s", "V s"),
            ("V s", "1/s", "V"),
            ("N", "1/m^n", "N/m^n"),
        ] {
            assert_eq!(of(left).times(&of(right)).to_string(), product, "{left} times {right}");
        }
        assert_eq!(of("N s/m").per(&of("N s/m")).to_string(), "1");
        assert_eq!(of("m/s").power(-2).to_string(), "s²/m²");
    }

    #[test]
    fn the_unit_of_a_length_is_put_in() {
        let position = Unit::of("V s");
        for (text, wanted) in
            [("m/s", "V"), ("s/m", "1/V"), ("1/m", "1/(V s)"), ("1/m^n", "1/(V s)^n"), ("s/mm", "s/mm"), ("1", "1")]
        {
            assert_eq!(Unit::of(text).with("m", &position).to_string(), wanted, "{text}");
        }
    }
}
