//! Reports as documents for other programs.

use std::collections::BTreeMap;

use fmm_fit::EstimateStatus;
use fmm_uq::{Budget, Contribution};
use serde::ser::{Serialize, SerializeStruct, Serializer};

use crate::experiment::RecordSummary;
use crate::finding::{Finding, Origin};
use crate::identification::Identification;
use crate::judgement::unseen_damping::UnseenDamping;
use crate::judgement::{Comparison, FrictionChange, ScoreTest};
use crate::report::FrictionBound;

impl Serialize for Finding {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let status = match self.origin() {
            Origin::Derived => "derived",
            Origin::Fitted(EstimateStatus::Undetermined) => "undetermined",
            Origin::Fitted(EstimateStatus::Fixed) => "fixed",
            Origin::Fitted(status) if status.is_at_bound() => "at_bound",
            Origin::Fitted(_) => "fitted",
        };
        // An infinite number of them is null, as JSON has none.
        let freedom = Some(self.degrees_of_freedom()).filter(|freedom| freedom.is_finite());
        let budget = self.budget();
        let contributions: Vec<Part<'_>> = budget.iter().flat_map(Budget::contributions).map(Part).collect();
        let mut document = serializer.serialize_struct("Finding", 8)?;
        document.serialize_field("value", &self.value())?;
        document.serialize_field("u", &self.uncertainty())?;
        document.serialize_field("interval_95", &self.interval(0.95))?;
        document.serialize_field("no_interval", &self.without_interval())?;
        document.serialize_field("degrees_of_freedom", &freedom)?;
        document.serialize_field("unit", self.parameter().unit())?;
        document.serialize_field("status", status)?;
        document.serialize_field("contributions", &contributions)?;
        document.end()
    }
}

/// Source of a part of an uncertainty, with u and its share of the variance.
struct Part<'a>(Contribution<'a>);

impl Serialize for Part<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let freedom = Some(self.0.input.degrees_of_freedom()).filter(|freedom| freedom.is_finite());
        let mut document = serializer.serialize_struct("Contribution", 4)?;
        document.serialize_field("source", self.0.input.name())?;
        document.serialize_field("u", &self.0.uncertainty)?;
        document.serialize_field("share", &self.0.share.clamp(0.0, 1.0))?;
        document.serialize_field("degrees_of_freedom", &freedom)?;
        document.end()
    }
}

/// `law`, `parameters` (by name), `rms_residual`, `rank`, `stop_time_s` and `swings` (of the first record),
/// `aicc` (all residuals counted), `outcome`, `autocorrelation_time`, `warnings`.
impl Serialize for Identification {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let parameters: BTreeMap<_, _> =
            self.findings().iter().map(|finding| (finding.parameter().name(), finding)).collect();
        let warnings: Vec<String> = self.warnings().iter().map(ToString::to_string).collect();
        let mut document = serializer.serialize_struct("Identification", 10)?;
        document.serialize_field("law", self.law())?;
        document.serialize_field("parameters", &parameters)?;
        document.serialize_field("rms_residual", &self.rms_residual())?;
        document.serialize_field("rank", &self.fit().rank())?;
        document.serialize_field(
            "stop_time_s",
            &self.motions().first().and_then(crate::identification::FittedMotion::stop_time),
        )?;
        document
            .serialize_field("swings", &self.motions().first().map(crate::identification::FittedMotion::half_swings))?;
        document.serialize_field("aicc", &self.fit().corrected_akaike())?;
        document.serialize_field("outcome", &self.fit().outcome().to_string())?;
        document.serialize_field("autocorrelation_time", &self.autocorrelation_time())?;
        document.serialize_field("warnings", &warnings)?;
        document.end()
    }
}

/// Record: times in s, rates in Hz, values in `unit`.
impl Serialize for RecordSummary {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut document = serializer.serialize_struct("RecordSummary", 27)?;
        document.serialize_field("from_s", &self.from)?;
        document.serialize_field("to_s", &self.to)?;
        document.serialize_field("samples", &self.samples)?;
        document.serialize_field("rate_hz", &self.rate)?;
        document.serialize_field("quantity", &self.quantity.to_string())?;
        document.serialize_field("unit", &self.unit)?;
        document.serialize_field("offset_held_at", &self.held_offset)?;
        document.serialize_field("gain_uncertainty", &self.gain_uncertainty)?;
        document.serialize_field("clock_uncertainty", &self.clock_uncertainty)?;
        document.serialize_field("release_s", &self.release)?;
        document.serialize_field("half_swings", &self.half_swings)?;
        document.serialize_field("first_amplitude", &self.amplitudes.0)?;
        document.serialize_field("last_amplitude", &self.amplitudes.1)?;
        document.serialize_field("frequency_hz", &self.frequency)?;
        document.serialize_field("noise", &self.noise)?;
        document.serialize_field("resolution", &self.resolution)?;
        document.serialize_field("rest_from_s", &self.rest_from)?;
        document.serialize_field("spikes", &self.spikes)?;
        document.serialize_field("saturated", &self.saturation.map_or(0, |saturation| saturation.samples))?;
        document.serialize_field("offset_step_s", &self.offset_step.map(|step| step.time))?;
        document.serialize_field("period_change", &self.period_change)?;
        let hum: Vec<(f64, f64)> = self.hum.iter().map(|hum| (hum.frequency, hum.amplitude)).collect();
        document.serialize_field("hum_hz_amplitude", &hum)?;
        document.serialize_field("further_releases_s", &self.further_releases)?;
        document.serialize_field("interrupted_after_s", &self.interruption.map(|taken| taken.sound_until))?;
        document.serialize_field("samples_per_measured", &self.upsampling.map_or(1, |upsampling| upsampling.factor))?;
        document.serialize_field("second_mode_hz", &self.second_mode.map(|mode| mode.frequency))?;
        document.serialize_field("second_mode_share", &self.second_mode.map(|mode| mode.share))?;
        document.end()
    }
}

/// Relative change with each half cycle, its standard uncertainty, and the relative error of the level over it.
impl Serialize for FrictionChange {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut document = serializer.serialize_struct("FrictionChange", 3)?;
        document.serialize_field("per_half_cycle", &self.per_half_cycle)?;
        document.serialize_field("uncertainty", &self.uncertainty)?;
        document.serialize_field("price", &self.price)?;
        document.end()
    }
}

/// The damping that the residuals ask for, its standard uncertainty, the largest that would not show, and the relative
/// error of the level over it.
impl Serialize for UnseenDamping {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut document = serializer.serialize_struct("UnseenDamping", 4)?;
        document.serialize_field("per_mass", &self.per_mass)?;
        document.serialize_field("uncertainty", &self.uncertainty)?;
        document.serialize_field("largest_unseen", &self.largest_unseen())?;
        document.serialize_field("price", &self.price)?;
        document.end()
    }
}

/// `name` and `unit` of the friction, `upper_95`, and the `law` that has it.
impl Serialize for FrictionBound {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut document = serializer.serialize_struct("FrictionBound", 4)?;
        document.serialize_field("name", &self.name)?;
        document.serialize_field("unit", &self.unit)?;
        document.serialize_field("upper_95", &self.upper_95)?;
        document.serialize_field("law", &self.law)?;
        document.end()
    }
}

/// The extension, its size and standard uncertainty.
impl Serialize for ScoreTest {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut document = serializer.serialize_struct("ScoreTest", 3)?;
        document.serialize_field("addition", &self.extension.to_string())?;
        document.serialize_field("size", &self.size)?;
        document.serialize_field("u", &self.uncertainty)?;
        document.end()
    }
}

/// `preferred` (name of the law), `decided`, `summary` (one sentence), `not_excluded` and `excluded_without_fit`
/// (names), `complete`, `signs`, `friction_change` (of the preferred law), `unseen_damping` (where it has none),
/// `friction_bound` (where it has no friction), `p` and `scores` (one per model, by which laws are preferred),
/// `models`, `preparation` (one object, or a list if there are several records), `warnings`.
impl Serialize for Comparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let warnings: Vec<String> = self.warnings().iter().map(ToString::to_string).collect();
        let mut document = serializer.serialize_struct("Comparison", 15)?;
        document.serialize_field("preferred", self.preferred().law())?;
        document.serialize_field("decided", &self.is_conclusive())?;
        document.serialize_field("summary", &self.headline())?;
        let left: Vec<&str> = self.not_excluded().map(Identification::law).collect();
        document.serialize_field("not_excluded", &left)?;
        document.serialize_field("excluded_without_fit", self.excluded())?;
        document.serialize_field("complete", &self.is_complete())?;
        document.serialize_field("signs", self.score_tests())?;
        document.serialize_field("friction_change", &self.friction_change())?;
        document.serialize_field("unseen_damping", &self.unseen_damping)?;
        document.serialize_field("friction_bound", &self.friction_bound())?;
        document.serialize_field("p", self.p_values())?;
        document.serialize_field("scores", self.scores())?;
        document.serialize_field("models", self.identifications())?;
        match self.records() {
            [record] => document.serialize_field("preparation", record)?,
            records => document.serialize_field("preparation", records)?,
        }
        document.serialize_field("warnings", &warnings)?;
        document.end()
    }
}
