//! Content of a report: a record, as it was prepared and fitted, and its pictures.

use std::collections::BTreeMap;
use std::error::Error;

use fmm_identify::{Comparison, Experiment, Finding, FrictionCurve, FrictionLevel};
use fmm_record::{Record, Swings};
use serde::Serialize;

use crate::figure::{Panel, Role, label};
use crate::posterior::Posterior;

/// Friction over the speed without a law, or the reason why it cannot be had.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged)]
pub(crate) enum Curve {
    Found(Box<FrictionCurve>),
    Missing { missing: String },
}

impl Curve {
    /// Three numbers of the curve and what speaks against it, or why there is none.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Found(curve) => {
                let doubts = curve.doubts().map(|doubt| format!("; {doubt}"));
                std::iter::once(curve.headline()).chain(doubts).chain([".".to_owned()]).collect()
            }
            Self::Missing { missing } => format!("friction over speed, no law assumed: none, as {missing}."),
        }
    }
}

/// A record, as it was prepared and fitted.
pub(crate) struct Found {
    /// The file, the channel, what it was taken for; a line for each record.
    pub(crate) origin: String,
    /// Faults of the file.
    pub(crate) remarks: Vec<String>,
    /// Declared inputs of the machine, by name: value and standard uncertainty.
    pub(crate) declared: BTreeMap<String, (f64, f64)>,
    /// The record, and those that are fitted with it.
    pub(crate) decays: Vec<Experiment>,
    pub(crate) comparison: Comparison,
    /// `None` where laws are compared.
    pub(crate) curve: Option<Curve>,
    /// Posterior of the preferred law, if that was asked for.
    pub(crate) posterior: Option<Posterior>,
    /// Why there is no posterior though one was asked for.
    pub(crate) failure: Option<String>,
    /// The command line as it was typed.
    pub(crate) command: String,
    /// Digest of each file.
    pub(crate) sha256: String,
}

impl Found {
    /// The motions fitted by the preferred law at the samples of each record, in its unit.
    pub(crate) fn fitted(&self) -> Result<Vec<Vec<f64>>, &'static str> {
        let model = |record: usize| self.comparison.preferred().model(&self.decays, record);
        (0..self.decays.len()).map(|record| model(record).ok_or("the fitted motion cannot be drawn")).collect()
    }

    /// Friction over the speed with its intervals, and the preferred law in it; `None` without a curve.
    pub(crate) fn curve_panels(&self) -> Option<Vec<Panel>> {
        let Some(Curve::Found(curve)) = &self.curve else { return None };
        let speeds = curve.speeds();
        let levels = curve.levels();
        let quantity = if curve.unit() == "1" { "friction coefficient" } else { "friction" };
        let along = |values: Vec<f64>| speeds.iter().copied().zip(values).collect::<Vec<_>>();
        let end = |is_high: bool| {
            let end = |(low, high): (f64, f64)| if is_high { high } else { low };
            along(levels.iter().map(|level| level.interval(0.95).map_or(f64::NAN, end)).collect())
        };
        let band = curve.band(0.95).unwrap_or_default();
        let preferred = self.comparison.preferred();
        let by_law = curve.by_law(preferred, &self.decays);
        let panel = Panel::new(label("speed", curve.speed_unit()), label(quantity, curve.unit()), 380.0)
            .with(Role::Measured, "no law assumed", along(levels.iter().map(FrictionLevel::value).collect()))
            .with(Role::Points, "95 % at each speed", end(false))
            .with(Role::Points, "95 % at each speed", end(true))
            .with(Role::Residual, "95 % for the whole curve", along(band.iter().map(|(low, _)| *low).collect()))
            .with(Role::Residual, "95 % for the whole curve", along(band.iter().map(|(_, high)| *high).collect()));
        Some(vec![match by_law {
            Some(points) => panel.with(Role::Fitted, preferred.law(), points),
            None => panel,
        }])
    }
}

/// Pictures of a fit.
pub(crate) struct Pictures {
    /// Each record with the preferred fit, and what is left.
    pub(crate) fit: Vec<Panel>,
    /// The amplitude of each half swing of the first record.
    pub(crate) amplitude: Vec<Panel>,
    /// Measured less fitted, in the unit of the first record.
    pub(crate) residuals: Vec<f64>,
}

impl Pictures {
    pub(crate) fn of(found: &Found) -> Result<Self, Box<dyn Error>> {
        let mut fitted = found.fitted()?;
        let fit = found.decays.iter().zip(&fitted).enumerate();
        let fit = fit.flat_map(|(number, (decay, model))| found.motion(number, decay.record(), model)).collect();
        let decay = &found.decays[0];
        let (record, preferred, model) = (decay.record(), found.comparison.preferred(), fitted.swap_remove(0));
        let residuals = less(record, &model).collect();
        let offset = preferred.finding("offset").or(preferred.finding("offset_1")).map_or(0.0, Finding::value);
        let measured = decay.peaks().iter().map(|(time, value)| (*time, (value - offset).abs()));
        let swings = Swings::of(&record.with_values(model)?);
        let envelope = swings.peaks().iter().map(|peak| (peak.time, (peak.value - offset).abs()));
        let amplitude = Panel::new("time / s", label("amplitude of each half swing", record.unit()), 380.0)
            .with(Role::Points, "measured", measured)
            .with(Role::Fitted, format!("envelope of {}", preferred.law()), envelope);
        Ok(Self { fit, amplitude: vec![amplitude], residuals })
    }
}

/// Measured less fitted, in the unit of the `record`.
fn less<'a>(record: &'a Record, model: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    record.values().iter().zip(model).map(|(measured, model)| measured - model)
}

impl Found {
    /// Record number `number` with the motion of the preferred law, and what is left.
    fn motion(&self, number: usize, record: &Record, model: &[f64]) -> [Panel; 2] {
        let along = |values: Vec<f64>| record.times().zip(values).collect::<Vec<_>>();
        let which = if self.decays.len() > 1 { format!("record {}: ", number + 1) } else { String::new() };
        let quantity = format!("{which}{}", label(record.quantity(), record.unit()));
        let motion = Panel::new("", quantity, 330.0)
            .with(Role::Measured, "measured", along(record.values().to_vec()))
            .with(Role::Fitted, format!("fit by {}", self.comparison.preferred().law()), along(model.to_vec()));
        let remainder = Panel::new("time / s", label("residual", record.unit()), 210.0).with(
            Role::Residual,
            "measured − fit",
            along(less(record, model).collect()),
        );
        [motion, remainder]
    }
}
