//! The friction curve as text and as a document.

use std::fmt;

use fmm_model::Rounded;

use crate::friction_curve::{FrictionCurve, FrictionLevel, Meaning};

impl FrictionCurve {
    /// Name of the number in which friction is stated.
    fn name(&self) -> &'static str {
        match self.meaning {
            Meaning::Coefficient => "friction coefficient",
            Meaning::Force => "friction force",
            Meaning::PerMass => "friction per mass",
        }
    }

    /// One sentence: friction at rest, in the mean over the path, and at the top speed.
    pub fn headline(&self) -> String {
        let text = |level: FrictionLevel| {
            let value = Rounded::new(level.value(), Some(level.uncertainty()));
            if self.unit() == "1" { value.to_string() } else { format!("{value} {}", self.unit()) }
        };
        let whole = if self.is_whole() { "" } else { ", without the declared damping" };
        format!(
            "friction over speed, no law assumed{whole}: at rest {}, in the mean over the path {}, at the top speed {}",
            text(self.at_rest()),
            text(self.mean_over_path()),
            text(self.at_top_speed())
        )
    }
}

impl fmt::Display for FrictionCurve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = if self.unit() == "1" { String::new() } else { format!(" ({})", self.unit()) };
        let whole = if self.is_whole() { "contact and machine" } else { "without the declared damping of the machine" };
        writeln!(f, "Friction over speed, no law assumed: {}{unit}, {whole}", self.name())?;
        writeln!(f, "  in the mean over the path = {}", self.mean_over_path())?;
        writeln!(f, "  value ± standard uncertainty  [95 % at this speed]  [95 % for the whole curve]")?;
        let band = self.band(0.95).unwrap_or_default();
        for ((speed, level), (low, high)) in self.speeds().iter().zip(self.levels()).zip(band) {
            let both = Rounded::new(level.value(), Some(level.uncertainty())).interval(low, high);
            writeln!(f, "  {speed:>10.4e} {}  {level}  {both}", self.speed_unit())?;
        }
        writeln!(f, "  samples down to {:.3e} {}", self.slowest(), self.speed_unit())?;
        self.limits().iter().try_for_each(|limit| writeln!(f, "  {limit}"))
    }
}

#[cfg(feature = "serde")]
mod serialised {
    use serde::ser::{Serialize, SerializeStruct, Serializer};

    use crate::friction_curve::{FrictionCurve, FrictionLevel};

    /// `value`, standard uncertainty `u` and `interval_95`.
    impl Serialize for FrictionLevel {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            let mut document = serializer.serialize_struct("FrictionLevel", 3)?;
            document.serialize_field("value", &self.value())?;
            document.serialize_field("u", &self.uncertainty())?;
            document.serialize_field("interval_95", &self.interval(0.95))?;
            document.end()
        }
    }

    /// Meaning and units, the three numbers, then for each speed its level, and the simultaneous 95 % band.
    impl Serialize for FrictionCurve {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            let mut document = serializer.serialize_struct("FrictionCurve", 12)?;
            document.serialize_field("quantity", self.name())?;
            document.serialize_field("unit", self.unit())?;
            document.serialize_field("speed_unit", self.speed_unit())?;
            document.serialize_field("whole_resistance", &self.is_whole())?;
            document.serialize_field("at_rest", &self.at_rest())?;
            document.serialize_field("mean_over_path", &self.mean_over_path())?;
            document.serialize_field("at_top_speed", &self.at_top_speed())?;
            document.serialize_field("speeds", self.speeds())?;
            document.serialize_field("levels", &self.levels())?;
            document.serialize_field("simultaneous_band_95", &self.band(0.95))?;
            document.serialize_field("samples_down_to", &self.slowest())?;
            document.serialize_field("limits", self.limits())?;
            document.end()
        }
    }
}
