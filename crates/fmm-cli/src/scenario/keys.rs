//! The keys by which a scenario names a parameter of a law.

use fmm_friction::LawParameter;

/// Form of a parameter's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    /// A number.
    Number,
    /// A list of numbers, one for each element.
    List,
    /// Another law.
    Law,
}

/// A parameter of a law as a scenario sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slot {
    pub(crate) name: &'static str,
    /// Empty if formulas have no symbol for it.
    pub(crate) symbol: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) shape: Shape,
    /// The value of a parameter that is left out.
    pub(crate) default: Option<f64>,
}

/// Other keys than name and symbol, as papers and other programs write them: parameter, symbol, keys.
const ALIASES: &[(&str, &str, &[&str])] = &[
    ("coefficient", "μ", &["f", "fc"]),
    ("sliding_coefficient", "μ_c", &["fc", "mu_d", "mu_k"]),
    ("sliding_coefficient", "μ_d", &["fd", "fc", "fk", "mu", "mu_c", "mu_k"]),
    ("sliding_coefficient", "μ_k", &["fk", "fc", "mu_c", "mu_d"]),
    ("static_coefficient", "μ_s", &["fs"]),
    ("viscous", "β", &["f2"]),
    ("gaining_coefficient", "μ₁", &["mu_d1"]),
    ("losing_coefficient", "μ₂", &["mu_d2"]),
    ("difference_coefficient", "γ₁", &["g1"]),
    ("rise", "γ₂", &["g2"]),
    ("fall", "γ₃", &["g3"]),
    ("coefficient", "γ₄", &["g4"]),
    ("level_rise", "γ₅", &["g5"]),
    ("viscous", "γ₆", &["g6"]),
    ("dead_zone", "v_d", &["dv"]),
    ("stiffness", "σ", &["sigma0", "s0"]),
    ("stiffness", "σ₀", &["s0"]),
    ("bristle_damping", "σ₁", &["s1"]),
    ("viscous", "σ₂", &["s2"]),
    ("smoothing_width", "ε", &["width", "eps"]),
];

/// Values of parameters that are left out, and the laws in which they may be: a part that many contacts do not have, or
/// the usual choice of an exponent.
const DEFAULTS: [(&str, f64, &[&str]); 4] = [
    (
        "viscous",
        0.0,
        &[
            "stribeck",
            "stribeck_lorentzian",
            "regularised_stribeck",
            "makkar_dixon",
            "makkar_dixon_shifted",
            "lugre",
            "gms",
        ],
    ),
    ("exponent", 2.0, &["stribeck", "lugre", "gms"]),
    ("exponent", 1.0, &["dahl"]),
    ("amplitude", 1.0, &["bouc_wen", "bouc_wen_by_level"]),
];

impl Slot {
    /// The slots of the numbers that the law of this name takes.
    pub(crate) fn numbers(law: &str, parameters: &'static [LawParameter]) -> Vec<Self> {
        let slot = |parameter: &'static LawParameter| {
            let parameter = parameter.parameter();
            let is_this = |(name, _, laws): &&(&str, f64, &[&str])| *name == parameter.name() && laws.contains(&law);
            Self {
                default: DEFAULTS.iter().find(is_this).map(|(_, value, _)| *value),
                ..Self::of(parameter.name(), parameter.symbol(), parameter.unit(), Shape::Number)
            }
        };
        parameters.iter().map(slot).collect()
    }

    /// A slot without a default.
    pub(crate) const fn of(name: &'static str, symbol: &'static str, unit: &'static str, shape: Shape) -> Self {
        Self { name, symbol, unit, shape, default: None }
    }

    /// Every key that means this parameter, in lower case: its name, its symbol in ASCII with and without underscore,
    /// and its aliases.
    pub(crate) fn keys(&self) -> Vec<String> {
        let symbol = ascii(self.symbol);
        let aliases = ALIASES.iter().filter(|alias| alias.0 == self.name && alias.1 == self.symbol);
        let mut keys = vec![self.name.to_owned(), symbol.replace('_', ""), symbol];
        keys.extend(aliases.flat_map(|alias| alias.2.iter().map(|key| (*key).to_owned())));
        keys.retain(|key| !key.is_empty());
        keys.sort();
        keys.dedup();
        keys
    }

    /// True if `key` means this parameter, in upper or lower case.
    pub(crate) fn is(&self, key: &str) -> bool {
        self.keys().contains(&ascii(key))
    }

    /// Name, symbol in ASCII, unit and default for a message.
    pub(crate) fn description(&self) -> String {
        let symbol = ascii(self.symbol);
        let symbol = if symbol.is_empty() || symbol == self.name { symbol } else { format!(" or {symbol}") };
        let symbol = if symbol == self.name { "" } else { &symbol };
        let kind = match self.shape {
            Shape::Number => self.unit.to_owned(),
            Shape::List => format!("list, {}", self.unit),
            Shape::Law => "law".to_owned(),
        };
        let default = self.default.map_or_else(String::new, |value| format!(", default {value}"));
        format!("{}{symbol} ({kind}{default})", self.name)
    }
}

/// A symbol in lower-case ASCII: μ_s becomes `mu_s`, γ₁ becomes `gamma1`.
fn ascii(symbol: &str) -> String {
    let mut text = String::new();
    for letter in symbol.chars() {
        match letter {
            'α' => text.push_str("alpha"),
            'β' => text.push_str("beta"),
            'γ' => text.push_str("gamma"),
            'δ' => text.push_str("delta"),
            'ε' => text.push_str("epsilon"),
            'κ' => text.push_str("kappa"),
            // U+00B5 is what keyboards give.
            'μ' | 'µ' => text.push_str("mu"),
            'σ' => text.push_str("sigma"),
            '₀'..='₉' => text.extend(char::from_digit(letter as u32 - '₀' as u32, 10)),
            _ => text.extend(letter.to_lowercase()),
        }
    }
    text
}
