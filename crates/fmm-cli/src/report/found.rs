//! Content of a report: a record, as it was prepared and fitted, and its pictures.

use std::error::Error;

use fmm_identify::{Comparison, Experiment, Finding};
use fmm_record::{Record, Swings};

use crate::figure::{Panel, Role, label};
use crate::posterior::Posterior;

/// A record, as it was prepared and fitted.
pub(crate) struct Found {
    /// The file, the channel, what it was taken for.
    pub(crate) origin: String,
    pub(crate) decay: Experiment,
    pub(crate) comparison: Comparison,
    /// Of the preferred law, if that was asked for.
    pub(crate) posterior: Option<Posterior>,
}

/// Pictures of a fit.
pub(crate) struct Pictures {
    /// The record with the preferred fit, and what is left.
    pub(crate) fit: Vec<Panel>,
    /// The amplitude of each half swing.
    pub(crate) amplitude: Vec<Panel>,
    /// Measured less fitted, in the unit of the record.
    pub(crate) residuals: Vec<f64>,
}

impl Pictures {
    pub(crate) fn of(decay: &Experiment, comparison: &Comparison) -> Result<Self, Box<dyn Error>> {
        let preferred = comparison.preferred();
        let record = decay.record();
        let model = preferred.model(std::slice::from_ref(decay), 0).ok_or("the fitted motion cannot be drawn")?;
        let (unit, quantity) = (record.unit(), record.quantity());
        let curve = |values: &[f64]| record.times().zip(values.iter().copied()).collect::<Vec<_>>();
        let residuals: Vec<f64> =
            record.values().iter().zip(&model).map(|(measured, model)| measured - model).collect();
        let motion = Panel::new("", label(quantity, unit), 330.0)
            .with(Role::Measured, "measured", curve(record.values()))
            .with(Role::Fitted, format!("fit by {}", preferred.law()), curve(&model));
        let remainder = Panel::new("time / s", label("residual", unit), 210.0).with(
            Role::Residual,
            "measured − fit",
            curve(&residuals),
        );
        let offset = preferred.finding("offset").map_or(0.0, Finding::value);
        let measured = decay.peaks().iter().map(|(time, value)| (*time, (value - offset).abs()));
        let swings = Swings::of(&Record::new(record.start(), record.interval(), model, quantity, unit)?);
        let fitted = swings.peaks().iter().map(|peak| (peak.time, (peak.value - offset).abs()));
        let amplitude = Panel::new("time / s", label("amplitude of each half swing", unit), 380.0)
            .with(Role::Points, "measured", measured)
            .with(Role::Fitted, format!("envelope of {}", preferred.law()), fitted);
        Ok(Self { fit: vec![motion, remainder], amplitude: vec![amplitude], residuals })
    }
}
