//! Planned experiment: one that has no record yet.

use fmm_record::Record;

use super::{Drive, Driven, DrivenGuess, Experiment, Sensor};
use crate::RecordSummary;
use crate::fit::first_guess::FirstGuess;

impl Experiment {
    /// An experiment of a machine that vibrates at this `frequency` (Hz); the `record` says when and what would be recorded, and its values
    /// nothing. It begins at rest where the spring is free of force if it `is_at_rest`.
    pub(crate) fn planned(
        record: Record,
        drive: Option<Drive>,
        is_at_rest: bool,
        frequency: f64,
        noise: f64,
        held_offset: Option<f64>,
    ) -> Self {
        // Nothing is searched for, in which the size of the motion would be a limit.
        let amplitude = f64::INFINITY;
        let guess = FirstGuess::of_driven(frequency, 0.0, amplitude, amplitude, record.quantity());
        let summary = RecordSummary {
            from: record.start(),
            to: record.end(),
            samples: record.len(),
            rate: record.rate(),
            quantity: record.quantity(),
            unit: record.unit().to_owned(),
            held_offset,
            gain_uncertainty: 0.0,
            release: None,
            half_swings: 0,
            amplitudes: (amplitude, amplitude),
            frequency,
            noise,
            resolution: None,
            rest_from: None,
            spikes: 0,
            saturation: None,
            offset_step: None,
            period_change: None,
            hum: Vec::new(),
            further_releases: Vec::new(),
            interruption: None,
            upsampling: None,
            second_mode: None,
            is_driven: drive.is_some(),
        };
        let of_drive = |drive| Driven { drive, guess: DrivenGuess::planned(frequency), is_at_rest };
        Self {
            kept: std::iter::once(0..record.len()).collect(),
            record,
            guess,
            peaks: Vec::new(),
            nuisances: Vec::new(),
            shapes: Vec::new(),
            summary,
            sensor: Sensor::default(),
            load_factor: 1.0,
            driven: drive.map(of_drive),
        }
    }
}
