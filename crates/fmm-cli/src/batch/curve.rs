//! Friction over the speed of one record, no law assumed, as a row keeps it.

use fmm_identify::{FrictionCurve, FrictionLevel};
use serde::{Deserialize, Serialize};

use super::row::{Part, Told};

/// Friction curve of one record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct RowCurve {
    /// Unit of friction: 1 for a coefficient, N for a force, else that of a force per mass.
    pub(crate) unit: String,
    pub(crate) speed_unit: String,
    /// False if a declared damping of the machine is not part of the curve.
    pub(crate) whole_resistance: bool,
    /// Friction at rest, in the mean over the path, and at the top speed.
    pub(crate) stated: Vec<Told>,
    /// Speeds of the levels.
    pub(crate) speeds: Vec<f64>,
    pub(crate) levels: Vec<f64>,
    /// Contributions to the standard uncertainty of the levels by source.
    pub(crate) contributions: Vec<Contribution>,
    /// Speed below which there is no sample.
    pub(crate) samples_down_to: f64,
    /// Reasons to doubt the curve: its own, and warnings that doubt the record, whatever its law.
    pub(crate) limits: Vec<String>,
}

/// Contribution of one source to the uncertainties of all levels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Contribution {
    pub(crate) source: String,
    pub(crate) u: Vec<f64>,
}

/// Names of the three numbers that a curve states.
pub(super) const STATED: [&str; 3] = ["friction_at_rest", "friction_over_path", "friction_at_top_speed"];
/// Name of the friction at one speed.
const AT_SPEED: &str = "friction_at_speed";

impl RowCurve {
    /// The `curve` of a record with these `doubts`.
    pub(super) fn of(curve: &FrictionCurve, doubts: impl Iterator<Item = String>) -> Self {
        let levels = curve.levels();
        let mut contributions: Vec<Contribution> = Vec::new();
        for (place, level) in levels.iter().enumerate() {
            for Part { source, u } in parts(level) {
                let at = contributions.iter().position(|one| one.source == source).unwrap_or_else(|| {
                    contributions.push(Contribution { source, u: vec![0.0; levels.len()] });
                    contributions.len() - 1
                });
                contributions[at].u[place] = u;
            }
        }
        let stated = [curve.at_rest(), curve.mean_over_path(), curve.at_top_speed()];
        let told = |(name, level): (&str, &FrictionLevel)| Told {
            name: name.to_owned(),
            unit: level.unit().to_owned(),
            value: level.value(),
            u: Some(level.uncertainty()),
            degrees_of_freedom: None,
            contributions: parts(level),
        };
        Self {
            unit: curve.unit().to_owned(),
            speed_unit: curve.speed_unit().to_owned(),
            whole_resistance: curve.is_whole(),
            stated: STATED.into_iter().zip(&stated).map(told).collect(),
            speeds: curve.speeds().to_vec(),
            levels: levels.iter().map(FrictionLevel::value).collect(),
            contributions,
            samples_down_to: curve.slowest(),
            limits: curve.limits().iter().cloned().chain(doubts).collect(),
        }
    }

    /// Largest speed.
    pub(super) fn top(&self) -> f64 {
        self.speeds.last().copied().unwrap_or_default()
    }

    /// Speeds and levels.
    pub(super) fn points(&self) -> Vec<(f64, f64)> {
        self.speeds.iter().copied().zip(self.levels.iter().copied()).collect()
    }

    /// Friction at `speed`; `None` above the top speed. Contributions go from level to level in straight lines, as if
    /// neighbours were wrong together: rather too large, by up to a fifth between the two highest.
    pub(super) fn at(&self, speed: f64) -> Option<Told> {
        let value = FrictionCurve::through(&self.speeds, &self.levels, speed)?;
        let above = self.speeds.partition_point(|knot| *knot < speed).max(1);
        let (low, high) = (self.speeds[above - 1], self.speeds[above]);
        let share = (speed - low) / (high - low);
        let part = |Contribution { source, u }: &Contribution| Part {
            source: source.clone(),
            u: (1.0 - share) * u[above - 1] + share * u[above],
        };
        let contributions: Vec<Part> = self.contributions.iter().map(part).collect();
        let u = contributions.iter().fold(0.0, |u: f64, part| u.hypot(part.u));
        let (name, unit) = (AT_SPEED.to_owned(), self.unit.clone());
        Some(Told { name, unit, value, u: Some(u), degrees_of_freedom: None, contributions })
    }
}

fn parts(level: &FrictionLevel) -> Vec<Part> {
    level.contributions().iter().map(|(source, u)| Part { source: source.to_string(), u: *u }).collect()
}
