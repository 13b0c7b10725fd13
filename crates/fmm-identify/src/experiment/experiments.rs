//! Experiments of one identification, of either kind.

use crate::experiment::Experiment;
use crate::experiment::force::ForceRecord;

/// Experiments of one identification: vibrations of a machine, or forces along motions.
///
/// A slice, array or vector of either makes it.
///
/// ```
/// use fmm_identify::{Experiments, ForceRecord};
///
/// let record = ForceRecord::of_positions(&[0.0, 0.1, 0.2], &[0.0, 0.01, 0.02], &[0.8, 1.1, 1.1])?;
/// assert!(matches!(Experiments::from(&[record]), Experiments::Forces([_])));
/// # Ok::<(), fmm_identify::IdentifyError>(())
/// ```
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Experiments<'a> {
    /// Ring-downs, impacts and driven motions of one machine.
    Vibrations(&'a [Experiment]),
    /// Forces along motions of one contact.
    Forces(&'a [ForceRecord]),
}

impl<'a> From<&'a [Experiment]> for Experiments<'a> {
    fn from(experiments: &'a [Experiment]) -> Self {
        Self::Vibrations(experiments)
    }
}

impl<'a> From<&'a [ForceRecord]> for Experiments<'a> {
    fn from(records: &'a [ForceRecord]) -> Self {
        Self::Forces(records)
    }
}

impl<'a, T, const N: usize> From<&'a [T; N]> for Experiments<'a>
where
    Self: From<&'a [T]>,
{
    fn from(experiments: &'a [T; N]) -> Self {
        Self::from(experiments.as_slice())
    }
}

impl<'a, T> From<&'a Vec<T>> for Experiments<'a>
where
    Self: From<&'a [T]>,
{
    fn from(experiments: &'a Vec<T>) -> Self {
        Self::from(experiments.as_slice())
    }
}
