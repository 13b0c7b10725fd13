//! Label of a channel: name, unit and quantity as the file states them.

use crate::units::word::{Word, is_in};
use crate::units::{Quantity, WrittenUnit};

/// Statement of a file about a channel: the unit, and a word for the quantity.
///
/// A unit is found in a name in these places, in this order:
///
/// | place | examples |
/// |---|---|
/// | in brackets | `v [mm/s]`, `theta (deg)`; text that is no unit is kept as a unit that is not known |
/// | behind a space, comma or colon | `vel mm/s`, `Angle: deg` |
/// | behind a slash | `x/mm`, `v / m/s` |
/// | behind underscores | `theta_rad`, `vel_mm_s`, `omega_rad_per_s`, `acc_ms2`, `encoder_counts` |
///
/// A suffix that may be something else, as `m`, `cm` or `g`, is a unit only behind a word for its quantity: `pos_m` is
/// in metres, of `x_m` nothing is known. Words are `velocity`, `vel`, `speed`, `rate`; `displacement`, `disp`,
/// `position`, `pos`, `angle`; `acceleration`, `accel`, `acc`; `force`, `torque`. Sensors and symbols (`gyro`,
/// `encoder`, `accelerometer`, `omega`, `theta`) are words as well, but leave it to the unit and to other words to say
/// otherwise.
///
/// ```
/// use fmm_record::{Label, Quantity};
///
/// let label = Label::of("vel_mm_s");
/// assert_eq!(label.unit().map(|unit| unit.si()), Some("m/s"));
/// assert_eq!(Label::of("angular_velocity").quantity(), Some(Quantity::Velocity));
/// assert_eq!(Label::of("speed [knots]").unknown_unit(), Some("knots"));
/// assert_eq!(Label::of("v (raw, m/s)").unit(), None);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    name: String,
    unit: Written,
    stated: Option<Quantity>,
    pub(super) word: Word,
}

/// The unit that is written.
#[derive(Debug, Clone, PartialEq)]
enum Written {
    Nothing,
    Unknown(String),
    Known(WrittenUnit),
}

impl Label {
    /// Label by the name of a channel.
    pub fn of(name: &str) -> Self {
        let (bare, groups) = without_groups(name);
        let word = Word::in_name(&bare);
        let unit = in_groups(&groups)
            .or_else(|| behind_space(&bare, word).map(Written::Known))
            .or_else(|| behind_slash(&bare).map(Written::Known))
            .or_else(|| behind_underscore(&bare, word).map(Written::Known));
        Self { name: name.trim().to_owned(), unit: unit.unwrap_or(Written::Nothing), stated: None, word }
    }

    /// This label with a unit that the file states beside the name; an empty text changes nothing.
    #[must_use]
    pub fn with_unit(mut self, unit: &str) -> Self {
        let unit = unit.trim();
        if !unit.is_empty() {
            self.unit = unit.parse().map_or_else(|_| Written::Unknown(unit.to_owned()), Written::Known);
        }
        self
    }

    /// This label with a quantity that the file states; [`Quantity::Other`] states none.
    #[must_use]
    pub fn with_quantity(mut self, quantity: Quantity) -> Self {
        self.stated = (quantity != Quantity::Other).then_some(quantity);
        self
    }

    /// The name of the channel.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The unit, if one is written that is known.
    pub fn unit(&self) -> Option<&WrittenUnit> {
        if let Written::Known(unit) = &self.unit { Some(unit) } else { None }
    }

    /// Text in the place of a unit, if it is no known unit.
    pub fn unknown_unit(&self) -> Option<&str> {
        if let Written::Unknown(text) = &self.unit { Some(text) } else { None }
    }

    /// The quantity: that of the unit, else as the file states it, else by a word in the name.
    pub fn quantity(&self) -> Option<Quantity> {
        self.quantity_of_unit().or(self.stated).or(self.word.quantity)
    }

    /// The quantity that has this unit, if the unit shows it.
    pub(super) fn quantity_of_unit(&self) -> Option<Quantity> {
        self.unit().and_then(WrittenUnit::shown_quantity)
    }

    /// The quantity that the file states beside the name.
    pub fn stated_quantity(&self) -> Option<Quantity> {
        self.stated
    }
}

/// The name and what is known, as in `"theta_rad" (displacement in rad)`.
impl std::fmt::Display for Label {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "\"{}\" (", self.name)?;
        match self.quantity() {
            Some(quantity) => write!(f, "{quantity}")?,
            None => f.write_str("quantity not told")?,
        }
        match &self.unit {
            Written::Known(unit) => write!(f, " in {unit})"),
            Written::Unknown(text) => write!(f, ", unit \"{text}\" not known)"),
            Written::Nothing => f.write_str(", no unit)"),
        }
    }
}

/// A text in brackets, and whether they are square.
pub(crate) struct Group {
    pub(crate) text: String,
    is_square: bool,
}

/// The name with a space for every text in brackets, and these texts. An opening bracket without its partner is a sign
/// like others.
pub(crate) fn without_groups(name: &str) -> (String, Vec<Group>) {
    let (mut bare, mut groups, mut rest) = (String::new(), Vec::new(), name);
    while let Some(open) = rest.find(['[', '(']) {
        let is_square = rest[open..].starts_with('[');
        let inside = &rest[open + 1..];
        let Some(close) = partner(inside, is_square) else {
            bare.push_str(&rest[..=open]);
            rest = inside;
            continue;
        };
        bare.push_str(&rest[..open]);
        bare.push(' ');
        groups.push(Group { text: inside[..close].trim().to_owned(), is_square });
        rest = &inside[close + 1..];
    }
    bare.push_str(rest);
    (bare.trim().to_owned(), groups)
}

/// Place of the bracket that closes the one before `inside`.
fn partner(inside: &str, is_square: bool) -> Option<usize> {
    let (open, close) = if is_square { ('[', ']') } else { ('(', ')') };
    let mut depth = 0_usize;
    inside.char_indices().find_map(|(at, sign)| {
        if sign == close && depth == 0 {
            return Some(at);
        }
        if sign == open {
            depth += 1;
        } else if sign == close {
            depth -= 1;
        }
        None
    })
}

/// The last unit in brackets, or else the text in its place.
fn in_groups(groups: &[Group]) -> Option<Written> {
    if let Some(unit) = groups.iter().rev().find_map(|group| group.text.parse().ok()) {
        return Some(Written::Known(unit));
    }
    let may_be_unit = |group: &&Group| !is_remark(&group.text);
    let square = groups.iter().rev().filter(|group| group.is_square).find(may_be_unit);
    square.or_else(|| groups.iter().rev().find(may_be_unit)).map(|group| Written::Unknown(group.text.clone()))
}

/// True for a text in brackets that is no unit: an index, a column, an axis, a sentence.
pub(crate) fn is_remark(text: &str) -> bool {
    let is_axis = matches!(text, "x" | "y" | "z" | "X" | "Y" | "Z");
    let is_index = text.chars().all(|sign| sign.is_ascii_digit());
    is_axis || is_index || text.contains([':', ',']) || text.split_whitespace().count() > 2
}

/// The last word, where only a unit looks like it.
fn behind_space(bare: &str, word: Word) -> Option<WrittenUnit> {
    let (before, last) = bare.rsplit_once([' ', '\t', ',', ':', ';']).unwrap_or(("", bare));
    // A channel called by nothing but its unit has a slash in it, or is called rpm: other letters alone may be a symbol.
    match before.trim_end() {
        _ if last.contains('/') || is_in(SPEEDS, &last.to_lowercase()) => last.parse().ok(),
        before if before.is_empty() || before.ends_with('/') => None,
        _ => last_part(last, word),
    }
}

/// Unit behind the first slash, unless a unit stands before it.
fn behind_slash(bare: &str) -> Option<WrittenUnit> {
    let (before, behind) = bare.split_once('/')?;
    let last = before.trim().rsplit([' ', '_']).next().unwrap_or_default();
    if last.is_empty() || last.parse::<WrittenUnit>().is_ok() { None } else { behind.parse().ok() }
}

/// Units that a suffix or a last word may be, in small letters.
const SUFFIXES: &str = "mm um µm μm micron microns rad mrad urad deg ° mdeg degrees radians rpm dps mdps mps kph kmh \
    mph lbf lb lbs klbf kip kips volts volt counts count ticks lsb cts";

/// Units of speeds that no symbol looks like.
const SPEEDS: &str = "rpm dps mdps kph kmh mph";

/// Suffixes that are a unit behind a word for its quantity only: they may be a medium, a mass centre, a measured value.
const DOUBTFUL: &str = "m cm km g mg ft";

/// Suffixes that are a unit behind a word for force or torque only.
const OF_FORCES: &str = "N mN Nm Nmm Ncm mNm µNm uNm kNm";

/// Symbols of forces and torques, which are words for them in front of such a suffix.
const FORCES: &str = "f fx fy fz ft fn m mx my mz tau";

/// Lengths and angles that a suffix counts per time.
const PER_TIME: &str = "m mm cm um µm μm nm km ft rad mrad urad deg mdeg rev";

/// The unit in the last parts of `vel_mm_s`, `omega_rad_per_s`, `theta_rad`.
fn behind_underscore(bare: &str, word: Word) -> Option<WrittenUnit> {
    let parts: Vec<&str> = bare.split('_').map(str::trim).collect();
    let lower: Vec<String> = parts.iter().map(|part| part.to_lowercase()).collect();
    let lower: Vec<&str> = lower.iter().map(String::as_str).collect();
    let is_force = word.quantity == Some(Quantity::Force) || lower.first().is_some_and(|first| is_in(FORCES, first));
    let (base, time) = match lower[..] {
        [.., _, base, "per", time @ ("s" | "sec" | "second" | "min" | "h" | "s2" | "s^2" | "s²")]
        | [.., _, base, time @ ("s" | "sec" | "s2" | "s^2" | "s²")] => (base, time),
        [.., _, base, "per", "s", "2"] | [.., _, base, "s", "2"] => (base, "s2"),
        [.., _, "n", "m"] if is_force => return "N m".parse().ok(),
        [_, .., _] if is_force && is_in(OF_FORCES, parts.last()?) => return parts.last()?.parse().ok(),
        [_, .., _] => return last_part(parts.last()?, word),
        _ => return None,
    };
    if is_in(PER_TIME, base) { format!("{base}/{time}").parse().ok() } else { None }
}

/// The unit that the last part of a name is.
fn last_part(written: &str, word: Word) -> Option<WrittenUnit> {
    let lower = &*written.to_lowercase();
    let spelled = match lower {
        "ms2" | "mps2" => "m/s2",
        "mms2" | "mmps2" => "mm/s2",
        "mmps" => "mm/s",
        "radps" => "rad/s",
        "degps" => "deg/s",
        "rads2" | "radps2" => "rad/s2",
        _ if matches!(written, "V" | "mV" | "uV") => written,
        "kn" if written == "kN" => written,
        _ if is_in(SUFFIXES, lower) => lower,
        _ if is_in(DOUBTFUL, lower) => {
            return lower
                .parse()
                .ok()
                .filter(|unit: &WrittenUnit| !word.is_angular && word.quantity == Some(unit.quantity()));
        }
        _ => return None,
    };
    spelled.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn si(name: &str) -> Option<(f64, &'static str)> {
        Label::of(name).unit().map(|unit| (unit.factor(), unit.si()))
    }

    #[test]
    fn units_in_names() {
        const DEGREE: f64 = std::f64::consts::PI / 180.0;
        for (name, factor, unit) in [
            ("v [mm/s]", 1e-3, "m/s"),
            ("theta (deg)", DEGREE, "rad"),
            ("v [m/s] (filtered)", 1.0, "m/s"),
            ("vel (x) [mm/s]", 1e-3, "m/s"),
            ("a[0] [m/s^2]", 1.0, "m/s²"),
            ("a [m/(s^2)]", 1.0, "m/s²"),
            ("v (m/(s)) raw", 1.0, "m/s"),
            ("v / (m/s)", 1.0, "m/s"),
            ("v / mm/s", 1e-3, "m/s"),
            ("x/mm", 1e-3, "m"),
            ("F/N", 1.0, "N"),
            ("vel mm/s", 1e-3, "m/s"),
            ("Velocity, mm/s", 1e-3, "m/s"),
            ("Angle: deg", DEGREE, "rad"),
            ("m/s", 1.0, "m/s"),
            ("RPM", std::f64::consts::TAU / 60.0, "rad/s"),
            ("theta_rad", 1.0, "rad"),
            ("Theta_Rad", 1.0, "rad"),
            ("omega_rad_per_s", 1.0, "rad/s"),
            ("omega_rad_s", 1.0, "rad/s"),
            ("vel_mm_s", 1e-3, "m/s"),
            ("v_m_s", 1.0, "m/s"),
            ("gyro_dps", DEGREE, "rad/s"),
            ("gyro_z_deg_per_sec", DEGREE, "rad/s"),
            ("acc_ms2", 1.0, "m/s²"),
            ("acc_m_s2", 1.0, "m/s²"),
            ("acc_m_s_2", 1.0, "m/s²"),
            ("acc_m_per_s2", 1.0, "m/s²"),
            ("acc_g", 9.806_65, "m/s²"),
            ("pos_m", 1.0, "m"),
            ("x_µm", 1e-6, "m"),
            ("x_μm", 1e-6, "m"),
            ("x_in_mm", 1e-3, "m"),
            ("gyro_V", 1.0, "V"),
            ("out_mV", 1e-3, "V"),
            ("force_N", 1.0, "N"),
            ("force_mN", 1e-3, "N"),
            ("torque_Nm", 1.0, "N m"),
            ("F_N", 1.0, "N"),
            ("Fx_N", 1.0, "N"),
            ("M_Nm", 1.0, "N m"),
            ("Torque_N_m", 1.0, "N m"),
            ("torque_mNm", 1e-3, "N m"),
            ("torque_Nmm", 1e-3, "N m"),
            ("encoder_counts", 1.0, "counts"),
        ] {
            assert_eq!(si(name), Some((factor, unit)), "{name}");
        }
    }

    #[test]
    fn what_may_be_something_else_is_no_unit() {
        let names = [
            "",
            "v",
            "x",
            "V",
            "g",
            "m",
            "rad",
            "0",
            "data",
            "data(:,2)",
            "v[0]",
            "v []",
            "gyro (z)",
            "x_m",
            "v_cm",
            "theta_m",
            "vel_in",
            "disp_in",
            "v_g",
            "k_N",
            "k_Nm",
            "v_v",
            "m_s",
            "v_s",
            "v_ms",
            "omega_rads",
            "x_out",
            "left/right",
            "counts/rev",
            "counts / deg",
            "in/out",
            "t_in_s",
            "a_per_s",
            "v (raw, m/s)",
            "_",
            "__",
            "/",
            "v (",
            "[",
            "]",
            "v [m/s",
        ];
        for name in names {
            let label = Label::of(name);
            assert_eq!((label.unit(), label.unknown_unit()), (None, None), "{name:?}");
        }
        for (name, text) in [
            ("v [knots]", "knots"),
            ("v (knots)", "knots"),
            ("v (raw) [furlong/h]", "furlong/h"),
            ("v [furlong/h] (raw)", "furlong/h"),
            ("v (knots (old))", "knots (old)"),
            ("v [-]", "-"),
        ] {
            assert_eq!((Label::of(name).unit(), Label::of(name).unknown_unit()), (None, Some(text)), "{name}");
        }
    }

    #[test]
    fn what_the_format_states_stands_above_the_name() {
        let label = Label::of("x [mm]").with_unit(" m/s ").with_quantity(Quantity::Velocity);
        assert_eq!(
            (label.unit().map(WrittenUnit::si), label.stated_quantity()),
            (Some("m/s"), Some(Quantity::Velocity))
        );
        assert_eq!(label.to_string(), "\"x [mm]\" (velocity in m/s)");
        let nothing = Label::of("x [mm]").with_unit(" ").with_quantity(Quantity::Other);
        assert_eq!((nothing.unit().map(WrittenUnit::si), nothing.stated_quantity()), (Some("m"), None));
        assert_eq!(
            Label::of("3+Z").with_unit("knot").to_string(),
            "\"3+Z\" (quantity not told, unit \"knot\" not known)"
        );
        assert_eq!(Label::of("angle").to_string(), "\"angle\" (displacement, no unit)");
        let volts = Label::of("gyro [V]").with_quantity(Quantity::Acceleration);
        assert_eq!(volts.quantity(), Some(Quantity::Acceleration), "a word stands below what the format states");
    }

    #[test]
    fn names_of_any_signs_never_panic() {
        let mut random = crate::tests::synthetic::Noise::new(7);
        let alphabet: Vec<char> = "[]()/_ ,:;°²⁻µms2radVgN^*-.1é\u{0}".chars().collect();
        for _ in 0..20_000 {
            let length = random.next() % 16;
            let name: String = (0..length).map(|_| alphabet[random.next() as usize % alphabet.len()]).collect();
            let label = Label::of(&name).with_unit(&name);
            // A unit is known, not known, or there is none; a panic is wrong.
            assert!(label.unit().is_none() || label.unknown_unit().is_none(), "{name:?}");
        }
    }
}
