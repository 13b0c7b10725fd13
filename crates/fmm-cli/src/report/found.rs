//! Content of a report: a record, as it was prepared and fitted.

use fmm_identify::{Comparison, Experiment};

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
