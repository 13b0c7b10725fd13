//! Warnings about a record that is not the free vibration of one mode.

use std::fmt;

use crate::{RecordSummary, Warning};

impl Warning {
    /// What besides one ring-down of one mode is in a record.
    pub(crate) fn of_disturbances(summary: &RecordSummary) -> impl Iterator<Item = Self> {
        let further = summary.further_releases.first().map(|time| Self::FurtherRelease { time: *time });
        let second = summary.second_mode.map(|mode| Self::SecondMode { frequency: mode.frequency, share: mode.share });
        further.into_iter().chain(second)
    }

    /// The sentences of these warnings; nothing for others.
    pub(crate) fn write_of_disturbances(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FurtherRelease { time } => write!(
                f,
                "a second release at {time:.2} s: only the part before it was used; give --from for the part after it"
            ),
            Self::SecondMode { frequency, share } => write!(
                f,
                "a second mode vibrates at {frequency:.3} Hz with about {:.0} % of the amplitude; the fit knows one mode only: use a \
                 part in which one is left, or isolate one with a band filter",
                100.0 * share
            ),
            _ => Ok(()),
        }
    }
}
