//! A number of the thesis, ours, and how near the two have to be.

use std::fmt;

/// How a number of ours was come by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Computed from the thesis' own inputs (A).
    Computed,
    /// Computed from inputs that the thesis does not print and that were inferred from it (A*): a check of consistency.
    Inferred,
    /// A regression on printed data (B).
    Regression,
    /// Simulated with a known truth and analysed as the thesis does (C), since no raw data are published.
    Simulated,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Computed => "A",
            Self::Inferred => "A*",
            Self::Regression => "B",
            Self::Simulated => "C",
        })
    }
}

/// Criterion that a number of ours has to satisfy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Criterion {
    /// Within an absolute tolerance of a reference.
    Near {
        /// The value to meet.
        reference: f64,
        /// The largest distance that passes.
        tolerance: f64,
    },
    /// Not above a limit.
    AtMost(f64),
    /// Not below a limit.
    AtLeast(f64),
    /// Shown beside the printed value and not required: it cannot be met, and the note says why.
    Shown,
}

impl Criterion {
    /// Within `tolerance` of `reference`.
    pub fn near(reference: f64, tolerance: f64) -> Self {
        Self::Near { reference, tolerance }
    }

    /// Within `share` (1) of `reference`.
    pub fn within(reference: f64, share: f64) -> Self {
        Self::Near { reference, tolerance: share * reference.abs() }
    }

    fn is_met_by(self, value: f64) -> bool {
        match self {
            Self::Near { reference, tolerance } => (value - reference).abs() <= tolerance,
            Self::AtMost(limit) => value <= limit,
            Self::AtLeast(limit) => value >= limit,
            Self::Shown => value.is_finite(),
        }
    }
}

impl fmt::Display for Criterion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&match self {
            Self::Near { reference, tolerance } => format!("{} ± {}", number(*reference), short(*tolerance)),
            Self::AtMost(limit) => format!("≤ {}", short(*limit)),
            Self::AtLeast(limit) => format!("≥ {}", number(*limit)),
            Self::Shown => "shown only".to_owned(),
        })
    }
}

/// One number, printed and ours. Several targets may share an identifier, each with its own quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    id: &'static str,
    kind: Kind,
    quantity: String,
    unit: &'static str,
    thesis: Option<String>,
    ours: f64,
    criterion: Criterion,
    note: String,
}

impl Target {
    /// The target `id`, A1 to C16, whose letter says its [`Kind`], or F1 to F3 of section 9.2, which are simulated;
    /// `ours` and the criterion are in `unit`.
    pub fn new(
        id: &'static str,
        quantity: impl Into<String>,
        unit: &'static str,
        ours: f64,
        criterion: Criterion,
    ) -> Self {
        let kind = match id.as_bytes().first() {
            Some(b'A') => Kind::Computed,
            Some(b'B') => Kind::Regression,
            _ => Kind::Simulated,
        };
        Self { id, kind, quantity: quantity.into(), unit, thesis: None, ours, criterion, note: String::new() }
    }

    /// The value that the thesis prints, digit for digit, in the same unit.
    #[must_use]
    pub fn printed(mut self, thesis: impl Into<String>) -> Self {
        self.thesis = Some(thesis.into());
        self
    }

    /// Says that inputs had to be inferred.
    #[must_use]
    pub fn inferred(mut self) -> Self {
        self.kind = Kind::Inferred;
        self
    }

    /// Where the reference is from, why the tolerance is what it is, what differs.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// Identifier, such as A13.
    pub fn id(&self) -> &'static str {
        self.id
    }

    /// How our value was come by.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// True if something is required of our value, which it can miss.
    pub fn is_required(&self) -> bool {
        self.criterion != Criterion::Shown
    }

    /// True if our value satisfies the criterion; not a number never does.
    pub fn passes(&self) -> bool {
        self.criterion.is_met_by(self.ours)
    }

    /// The cells of its row: identifier, quantity with unit, thesis, ours, difference, criterion, kind, verdict, note.
    pub fn cells(&self) -> [String; 9] {
        let unit = if matches!(self.unit, "" | "1") { String::new() } else { format!(" / {}", self.unit) };
        [
            self.id.to_owned(),
            format!("{}{unit}", self.quantity),
            self.thesis.clone().unwrap_or_else(|| "–".to_owned()),
            number(self.ours),
            self.difference().map_or_else(|| "–".to_owned(), percent),
            self.criterion.to_string(),
            self.kind.to_string(),
            if self.passes() { "ok" } else { "MISSED" }.to_owned(),
            self.note.clone(),
        ]
    }

    /// Ours less the printed value over the printed value, if that is one number.
    fn difference(&self) -> Option<f64> {
        let thesis: f64 = self.thesis.as_ref()?.parse().ok()?;
        (thesis != 0.0).then(|| self.ours / thesis - 1.0)
    }

    /// The target as an object of the report: `tolerance` is the distance from `reference` or the limit that passes.
    pub fn document(&self) -> serde_json::Value {
        let thesis =
            self.thesis.as_ref().map(|text| text.parse::<f64>().map_or_else(|_| text.clone().into(), Into::into));
        let (criterion, reference, tolerance) = match self.criterion {
            Criterion::Near { reference, tolerance } => ("near", Some(reference), Some(tolerance)),
            Criterion::AtMost(limit) => ("at most", None, Some(limit)),
            Criterion::AtLeast(limit) => ("at least", None, Some(limit)),
            Criterion::Shown => ("shown", None, None),
        };
        serde_json::json!({
            "id": self.id,
            "quantity": self.quantity,
            "unit": self.unit,
            "thesis": thesis.unwrap_or(serde_json::Value::Null),
            "ours": self.ours,
            "criterion": criterion,
            "reference": reference,
            "tolerance": tolerance,
            "pass": self.passes(),
            "kind": self.kind.to_string(),
            "note": self.note,
        })
    }
}

/// Six significant digits, without an exponent where that stays readable.
pub(crate) fn number(value: f64) -> String {
    significant(value, 6)
}

/// A share (1) in per cent with a sign, which zero has not.
fn percent(share: f64) -> String {
    let text = format!("{:+.1} %", 100.0 * share).replace('-', "−");
    if text.ends_with("0.0 %") && text.chars().count() == 6 { "0.0 %".to_owned() } else { text }
}

fn short(value: f64) -> String {
    significant(value, 2)
}

fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let power = value.abs().log10().floor() as i32;
    let decimals = (digits - 1 - power).clamp(0, 12) as usize;
    let text = if (-4..7).contains(&power) {
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.precision$e}", precision = (digits - 1) as usize)
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn criteria_decide_and_nan_never_passes() {
        let target = |ours, criterion| Target::new("A1", "length", "m", ours, criterion);
        assert!(target(0.552, Criterion::near(0.552, 1e-3)).passes());
        assert!(!target(0.554, Criterion::near(0.552, 1e-3)).passes());
        assert!(target(1.6, Criterion::AtMost(1.6)).passes() && !target(1.7, Criterion::AtMost(1.6)).passes());
        assert!(target(0.9, Criterion::AtLeast(0.9)).passes() && !target(0.8, Criterion::AtLeast(0.9)).passes());
        for criterion in [Criterion::near(0.0, 1.0), Criterion::AtMost(1.0), Criterion::AtLeast(0.0), Criterion::Shown]
        {
            assert!(!target(f64::NAN, criterion).passes());
        }
    }

    #[test]
    fn numbers_are_readable() {
        let texts = [0.113, -2.3763e-4, 6.751_234e-5, 330_000.0, 1.5e9].map(number);
        assert_eq!(texts, ["0.113", "−0.00023763", "6.75123e−5", "330000", "1.50000e9"]);
    }

    #[test]
    fn differences_need_one_printed_number() {
        let target = Target::new("A2", "y", "µm", 526.0, Criterion::Shown);
        assert_eq!(target.clone().printed("500").cells()[4], "+5.2 %");
        assert_eq!(target.clone().printed("526.1").cells()[4], "0.0 %");
        assert_eq!(target.clone().printed("478.1").cells()[4], "+10.0 %");
        assert_eq!(target.clone().printed("584.5").cells()[4], "−10.0 %");
        assert_eq!(target.printed("0.86, 0.97").cells()[4], "–");
    }
}
