//! Planned experiment: one that has no record yet.

use fmm_record::Record;

use super::{Drive, Driven, DrivenGuess, Experiment};
use crate::experiment::RecordSummary;
use crate::experiment::first_guess::FirstGuess;

impl Experiment {
    /// An experiment of a machine that vibrates at this `frequency` (Hz); the `record` says when and what would be
    /// recorded, and its values nothing. It begins at rest where the spring is free of force if it `is_at_rest`.
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
            held_offset,
            amplitudes: (amplitude, amplitude),
            is_driven: drive.is_some(),
            ..RecordSummary::unseen(&record, frequency, noise)
        };
        let of_drive = |drive| Driven { drive, guess: DrivenGuess::planned(frequency), is_at_rest };
        let kept = std::iter::once(0..record.len()).collect();
        Self { driven: drive.map(of_drive), ..Self::bare(record, kept, guess, summary) }
    }
}
