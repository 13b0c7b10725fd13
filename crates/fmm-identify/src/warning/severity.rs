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

    /// True for a doubt that friction over the speed without a law does not share: one of the law that was fitted, of
    /// what its residuals ask for, or of a drift, which stands beside the curve as well. The curve
    /// [judges](crate::FrictionCurve::limits) its own residuals.
    ///
    /// ```
    /// use fmm_identify::Warning;
    ///
    /// assert!(Warning::Undecided.spares_curve() && !Warning::NoDecay.spares_curve());
    /// ```
    pub const fn spares_curve(&self) -> bool {
        matches!(
            self,
            Self::StructuredResiduals { .. }
                | Self::WorseThanNone { .. }
                | Self::OtherPredicts { .. }
                | Self::NotConverged { .. }
                | Self::NegativeDamping { .. }
                | Self::FrictionChanges { .. }
                | Self::FrictionOverPosition { .. }
                | Self::GrowingNoise { .. }
                | Self::Drift
                | Self::Undecided
        )
    }
}
