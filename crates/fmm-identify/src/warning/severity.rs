//! Severity of a warning: how much it takes from a result.

use crate::warning::Warning;

/// Weight of a warning against a result, least first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Something that was done to the record, or that it cannot show.
    Remark,
    /// Something that disturbs the record or leaves the law open; the uncertainties take it into account.
    Caution,
    /// The fit may not describe the record.
    Doubt,
}

impl Warning {
    /// Weight of the warning against the result.
    ///
    /// ```
    /// use fmm_identify::{Severity, Warning};
    ///
    /// assert_eq!(Warning::NoDecay.severity(), Severity::Doubt);
    /// assert!(Warning::TimeLimit.severity() < Severity::Doubt);
    /// ```
    pub const fn severity(&self) -> Severity {
        match self {
            Self::StructuredResiduals { .. }
            | Self::PeriodDependsOnAmplitude { .. }
            | Self::Implausible { .. }
            | Self::OtherQuantity { .. }
            | Self::DrivesMotion { .. }
            | Self::WorseThanNone { .. }
            | Self::OtherPredicts { .. }
            | Self::NoDecay
            | Self::Saturated { .. }
            | Self::OffsetStep { .. }
            | Self::SecondMode { .. }
            | Self::NotConverged { .. }
            | Self::NegativeDamping { .. }
            | Self::KnowledgeContradicted { .. }
            | Self::FrictionChanges { .. }
            | Self::FrictionOverPosition { .. }
            | Self::Undecided
            | Self::Drift
            | Self::GrowingNoise { .. }
            | Self::FilteringSensor { .. }
            | Self::Beginning { .. } => Severity::Doubt,
            Self::DependsOnLaw { .. }
            | Self::OtherLaw { .. }
            | Self::Misled { .. }
            | Self::FurtherRelease { .. }
            | Self::Interrupted { .. }
            | Self::Hum { .. }
            | Self::Rounded { .. }
            | Self::ColouredNoise { .. }
            | Self::NoisyMotion { .. }
            | Self::CoarseMotion { .. }
            | Self::TimeLimit
            | Self::OneDirection
            | Self::FurtherHit { .. }
            | Self::Overload { .. }
            | Self::CoarsePulse { .. }
            | Self::NotAtRest { .. } => Severity::Caution,
            _ => Severity::Remark,
        }
    }
}
