//! A posterior as a document for other programs.

use std::collections::BTreeMap;

use fmm_fit::posterior::Marginal;
use serde::ser::{Serialize, SerializeStruct, Serializer};

use crate::posterior::intervals::LEVEL;
use crate::posterior::{IdentificationPosterior, IntervalComparison, PredictiveCheck};

/// A marginal with its intervals of all kinds.
struct Row<'a>(&'a Marginal, Option<&'a IntervalComparison>);

impl Serialize for Row<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self(marginal, intervals) = self;
        let mut document = serializer.serialize_struct("Marginal", 12)?;
        document.serialize_field("unit", marginal.parameter().unit())?;
        document.serialize_field("mean", &marginal.mean())?;
        document.serialize_field("standard_deviation", &marginal.standard_deviation())?;
        document.serialize_field("interval_95", &marginal.interval(LEVEL))?;
        document.serialize_field("shortest_interval_95", &marginal.shortest_interval(LEVEL))?;
        document.serialize_field("interval_95_by_uncertainty", &intervals.and_then(IntervalComparison::wald))?;
        document.serialize_field("interval_95_by_profile", &intervals.and_then(IntervalComparison::profile))?;
        document.serialize_field("intervals_agree", &intervals.map(IntervalComparison::agrees))?;
        document.serialize_field("r_hat", &marginal.r_hat())?;
        document.serialize_field("effective_draws", &marginal.bulk_effective_size())?;
        document.serialize_field("effective_draws_in_tails", &marginal.tail_effective_size())?;
        document.serialize_field("error_of_mean", &marginal.error_of_mean())?;
        document.end()
    }
}

impl Serialize for PredictiveCheck {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut document = serializer.serialize_struct("PredictiveCheck", 5)?;
        document.serialize_field("feature", self.feature())?;
        document.serialize_field("unit", self.unit())?;
        document.serialize_field("record", &self.record())?;
        document.serialize_field("measured", &self.measured())?;
        document.serialize_field("p", &self.p_value())?;
        document.end()
    }
}

/// `law`, `draws`, `chains`, `divergences`, `acceptance`, `parameters` (by name), `agrees`, `verdict`, `checks`,
/// `warnings`.
impl Serialize for IdentificationPosterior {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let row = |marginal| {
            let name = Marginal::parameter(marginal).name();
            (name, Row(marginal, self.intervals().iter().find(|interval| interval.name() == name)))
        };
        let parameters: BTreeMap<_, _> = self.findings().iter().map(row).collect();
        let mut document = serializer.serialize_struct("IdentificationPosterior", 10)?;
        document.serialize_field("law", self.law())?;
        document.serialize_field("draws", &self.posterior().len())?;
        document.serialize_field("chains", &self.posterior().chains())?;
        document.serialize_field("divergences", &self.posterior().divergences())?;
        document.serialize_field("acceptance", &self.posterior().acceptance())?;
        document.serialize_field("parameters", &parameters)?;
        document.serialize_field("agrees", &self.agrees())?;
        document.serialize_field("verdict", &self.verdict())?;
        document.serialize_field("checks", self.checks())?;
        document.serialize_field("warnings", &self.warnings())?;
        document.end()
    }
}
