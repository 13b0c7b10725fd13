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
        writeln!(f, "  samples down to {} {}", Rounded::significant(self.slowest(), 4), self.speed_unit())?;
        self.doubts().try_for_each(|doubt| writeln!(f, "  {doubt}"))
    }
}

#[cfg(feature = "serde")]
mod serialised {
    use serde::Serialize;

    use crate::friction_curve::{FrictionCurve, FrictionLevel};
    use crate::written::written_as;

    written_as! { FrictionLevel as LevelDocument, FrictionCurve as CurveDocument }

    /// Friction at a speed, or over a path.
    #[derive(Serialize)]
    #[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
    struct LevelDocument {
        value: f64,
        /// Standard uncertainty.
        u: f64,
        interval_95: Option<(f64, f64)>,
    }

    impl LevelDocument {
        fn of(level: &FrictionLevel) -> Self {
            Self { value: level.value(), u: level.uncertainty(), interval_95: level.interval(0.95) }
        }
    }

    /// Friction over the speed, no law assumed.
    #[derive(Serialize)]
    #[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
    struct CurveDocument<'a> {
        /// Friction coefficient, force or per mass.
        quantity: &'a str,
        unit: &'a str,
        speed_unit: &'a str,
        /// False if a declared damping of the machine is not part of the curve.
        whole_resistance: bool,
        at_rest: FrictionLevel,
        mean_over_path: FrictionLevel,
        at_top_speed: FrictionLevel,
        /// Speeds of `levels` and of the band.
        speeds: &'a [f64],
        levels: Vec<FrictionLevel>,
        /// Band in which the whole curve lies with 95 %.
        simultaneous_band_95: Option<Vec<(f64, f64)>>,
        /// Speed below which there is no sample.
        samples_down_to: f64,
        /// Reasons to doubt the curve.
        limits: Vec<&'a str>,
    }

    impl<'a> CurveDocument<'a> {
        fn of(curve: &'a FrictionCurve) -> Self {
            Self {
                quantity: curve.name(),
                unit: curve.unit(),
                speed_unit: curve.speed_unit(),
                whole_resistance: curve.is_whole(),
                at_rest: curve.at_rest(),
                mean_over_path: curve.mean_over_path(),
                at_top_speed: curve.at_top_speed(),
                speeds: curve.speeds(),
                levels: curve.levels(),
                simultaneous_band_95: curve.band(0.95),
                samples_down_to: curve.slowest(),
                limits: curve.doubts().collect(),
            }
        }
    }
}
