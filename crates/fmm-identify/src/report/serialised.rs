//! Reports as documents for other programs.

use std::collections::BTreeMap;

use fmm_fit::EstimateStatus;
use fmm_uq::{Budget, Contribution};
use serde::Serialize;

use crate::experiment::RecordSummary;
use crate::finding::{Finding, Origin};
use crate::identification::{FittedMotion, Identification};
use crate::judgement::unseen::{Kind, Unseen};
use crate::judgement::{Comparison, ScoreTest};
use crate::report::FrictionBound;
use crate::written::written_as;

written_as! {
    Finding as FindingDocument,
    Identification as IdentificationDocument,
    RecordSummary as RecordDocument,
    Unseen as UnseenDocument,
    FrictionBound as BoundDocument,
    ScoreTest as ScoreTestDocument,
    Comparison as ComparisonDocument,
}

/// A quantity that was found, in `unit`.
#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
struct FindingDocument<'a> {
    value: f64,
    /// Standard uncertainty; none where the record does not determine the value.
    u: Option<f64>,
    interval_95: Option<(f64, f64)>,
    /// Why there is no interval.
    no_interval: Option<&'static str>,
    /// Degrees of freedom of u; none if they are infinite.
    degrees_of_freedom: Option<f64>,
    unit: &'a str,
    /// `fitted`, `derived`, `fixed`, `at_bound` or `undetermined`.
    status: &'static str,
    /// Sources of u.
    contributions: Vec<Part>,
}

/// Source of a part of an uncertainty.
#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
struct Part {
    source: String,
    /// Contribution in the unit of the finding.
    u: f64,
    /// Share of the variance (1).
    share: f64,
    /// Degrees of freedom; none if they are infinite.
    degrees_of_freedom: Option<f64>,
}

/// An infinite number of degrees of freedom is none, as JSON has none.
fn finite(freedom: f64) -> Option<f64> {
    Some(freedom).filter(|freedom| freedom.is_finite())
}

impl<'a> FindingDocument<'a> {
    fn of(finding: &'a Finding) -> Self {
        let part = |part: Contribution<'_>| Part {
            source: part.input.name().to_owned(),
            u: part.uncertainty,
            share: part.share.clamp(0.0, 1.0),
            degrees_of_freedom: finite(part.input.degrees_of_freedom()),
        };
        Self {
            value: finding.value(),
            u: finding.uncertainty(),
            interval_95: finding.interval(0.95),
            no_interval: finding.without_interval(),
            degrees_of_freedom: finite(finding.degrees_of_freedom()),
            unit: finding.parameter().unit(),
            status: match finding.origin() {
                Origin::Derived => "derived",
                Origin::Fitted(EstimateStatus::Undetermined) => "undetermined",
                Origin::Fitted(EstimateStatus::Fixed) => "fixed",
                Origin::Fitted(status) if status.is_at_bound() => "at_bound",
                Origin::Fitted(_) => "fitted",
            },
            contributions: finding.budget().iter().flat_map(Budget::contributions).map(part).collect(),
        }
    }
}

/// A law that was fitted.
#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
struct IdentificationDocument<'a> {
    law: &'a str,
    /// Findings by name.
    parameters: BTreeMap<&'a str, &'a Finding>,
    /// Root mean square of the residuals, in the unit of the record.
    rms_residual: f64,
    /// Number of directions of the parameters that the record determines.
    rank: usize,
    /// Time from which the fitted motion of the first record rests (s).
    stop_time_s: Option<f64>,
    /// Half swings of the fitted motion of the first record.
    swings: Option<usize>,
    /// Corrected criterion of Akaike, all residuals counted.
    aicc: Option<f64>,
    /// End of the search for the least squares, in words.
    outcome: String,
    /// Correlation time of the residuals, in samples.
    autocorrelation_time: f64,
    warnings: Vec<String>,
}

impl<'a> IdentificationDocument<'a> {
    fn of(found: &'a Identification) -> Self {
        Self {
            law: found.law(),
            parameters: found.findings().iter().map(|finding| (finding.parameter().name(), finding)).collect(),
            rms_residual: found.rms_residual(),
            rank: found.fit().rank(),
            stop_time_s: found.motions().first().and_then(FittedMotion::stop_time),
            swings: found.motions().first().map(FittedMotion::half_swings),
            aicc: found.fit().corrected_akaike(),
            outcome: found.fit().outcome().to_string(),
            autocorrelation_time: found.autocorrelation_time(),
            warnings: found.warnings().iter().map(ToString::to_string).collect(),
        }
    }
}

/// A record as it was prepared: values are in `unit`.
#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
struct RecordDocument<'a> {
    /// Beginning of the part that was used.
    from_s: f64,
    /// End of the part that was used.
    to_s: f64,
    samples: usize,
    rate_hz: f64,
    /// `displacement`, `velocity` or `acceleration`.
    quantity: String,
    unit: &'a str,
    /// Offset that was not fitted.
    offset_held_at: Option<f64>,
    /// Relative standard uncertainty.
    gain_uncertainty: f64,
    /// Relative standard uncertainty.
    clock_uncertainty: f64,
    /// Time of the release.
    release_s: Option<f64>,
    half_swings: usize,
    first_amplitude: f64,
    last_amplitude: f64,
    /// `None` for a run-down.
    frequency_hz: Option<f64>,
    /// Standard deviation.
    noise: f64,
    /// Step between two values, if it is seen.
    resolution: Option<f64>,
    /// Time from which the record rests within its noise.
    rest_from_s: Option<f64>,
    /// Number of spikes.
    spikes: usize,
    /// Number of samples on the ends of the range.
    saturated: usize,
    /// Time at which the offset changes.
    offset_step_s: Option<f64>,
    /// Relative change of the period over the record.
    period_change: Option<f64>,
    /// Frequency (Hz) and amplitude of each hum.
    hum_hz_amplitude: Vec<(f64, f64)>,
    further_releases_s: &'a [f64],
    /// Time up to which a motion that was interrupted is sound.
    interrupted_after_s: Option<f64>,
    /// Samples for each one that was measured: above 1 the record was interpolated.
    samples_per_measured: usize,
    second_mode_hz: Option<f64>,
    /// Amplitude of the second mode over that of the first.
    second_mode_share: Option<f64>,
}

impl<'a> RecordDocument<'a> {
    fn of(record: &'a RecordSummary) -> Self {
        Self {
            from_s: record.from,
            to_s: record.to,
            samples: record.samples,
            rate_hz: record.rate,
            quantity: record.quantity.to_string(),
            unit: &record.unit,
            offset_held_at: record.held_offset,
            gain_uncertainty: record.gain_uncertainty,
            clock_uncertainty: record.clock_uncertainty,
            release_s: record.release,
            half_swings: record.half_swings,
            first_amplitude: record.amplitudes.0,
            last_amplitude: record.amplitudes.1,
            frequency_hz: (!record.is_run_down).then_some(record.frequency),
            noise: record.noise,
            resolution: record.resolution,
            rest_from_s: record.rest_from,
            spikes: record.spikes,
            saturated: record.saturation.map_or(0, |saturation| saturation.samples),
            offset_step_s: record.offset_step.map(|step| step.time),
            period_change: record.period_change,
            hum_hz_amplitude: record.hum.iter().map(|hum| (hum.frequency, hum.amplitude)).collect(),
            further_releases_s: &record.further_releases,
            interrupted_after_s: record.interruption.map(|taken| taken.sound_until),
            samples_per_measured: record.upsampling.map_or(1, |upsampling| upsampling.factor),
            second_mode_hz: record.second_mode.map(|mode| mode.frequency),
            second_mode_share: record.second_mode.map(|mode| mode.share),
        }
    }
}

/// Term that a law leaves out, of the size that the residuals ask for.
#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
struct UnseenDocument {
    /// Relative change of the friction with each half cycle.
    #[serde(skip_serializing_if = "Option::is_none")]
    per_half_cycle: Option<f64>,
    /// Rise of the friction from the middle to the largest deflection, over its mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    rise: Option<f64>,
    /// Damping per mass (1/s).
    #[serde(skip_serializing_if = "Option::is_none")]
    per_mass: Option<f64>,
    /// Standard uncertainty of the size.
    uncertainty: f64,
    /// Largest size that would not show.
    largest_unseen: f64,
    /// Relative error of the level of friction for each unit of the size that is left out.
    price: f64,
}

impl UnseenDocument {
    fn of(unseen: &Unseen) -> Self {
        let size = |kind: Kind| (unseen.kind == kind).then_some(unseen.size);
        Self {
            per_half_cycle: size(Kind::Change),
            rise: size(Kind::OverPosition),
            per_mass: size(Kind::Damping),
            uncertainty: unseen.uncertainty,
            largest_unseen: unseen.largest_unseen(),
            price: unseen.price,
        }
    }
}

/// Upper bound of a friction that the records do not show.
#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
struct BoundDocument<'a> {
    name: &'a str,
    unit: &'a str,
    /// Upper end of the 95 % interval.
    upper_95: f64,
    /// Law that has this friction beside the damping.
    law: &'a str,
}

impl<'a> BoundDocument<'a> {
    fn of(bound: &'a FrictionBound) -> Self {
        Self { name: &bound.name, unit: &bound.unit, upper_95: bound.upper_95, law: &bound.law }
    }
}

/// Statement of the residuals on a term that was not fitted.
#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
struct ScoreTestDocument {
    addition: String,
    /// Size that the residuals ask for, in SI units per mass.
    size: f64,
    /// Standard uncertainty of it.
    u: f64,
}

impl ScoreTestDocument {
    fn of(test: &ScoreTest) -> Self {
        Self { addition: test.extension.to_string(), size: test.size, u: test.uncertainty }
    }
}

/// Laws that were compared.
#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
struct ComparisonDocument<'a> {
    /// Name of the law that is preferred.
    preferred: &'a str,
    /// True if the records exclude all other laws and explain this one.
    decided: bool,
    /// One sentence.
    summary: String,
    /// Laws that the records do not exclude.
    not_excluded: Vec<&'a str>,
    /// Laws that were excluded without a fit.
    excluded_without_fit: &'a [String],
    /// False if a time limit ended the search.
    complete: bool,
    /// Terms that were not fitted, and what the residuals say of them.
    signs: &'a [ScoreTest],
    /// Change of the friction with time: the one that the residuals of the preferred law ask for, and its price.
    friction_change: Option<Unseen>,
    /// The same over the position.
    friction_over_position: Option<Unseen>,
    /// The same of a viscous damping beside a preferred law without damping.
    unseen_damping: &'a Option<Unseen>,
    /// Upper bound of the friction beside a preferred law without friction.
    friction_bound: Option<FrictionBound>,
    /// Value p of each model against the best one.
    p: &'a [f64],
    /// Misfit with twice the rank of each model, by which laws are preferred.
    scores: &'a [f64],
    models: &'a [Identification],
    preparation: Preparations<'a>,
    warnings: Vec<String>,
}

/// One record, or a list of several.
#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(untagged)]
enum Preparations<'a> {
    One(&'a RecordSummary),
    Several(&'a [RecordSummary]),
}

impl<'a> ComparisonDocument<'a> {
    fn of(comparison: &'a Comparison) -> Self {
        Self {
            preferred: comparison.preferred().law(),
            decided: comparison.is_conclusive(),
            summary: comparison.headline(),
            not_excluded: comparison.not_excluded().map(Identification::law).collect(),
            excluded_without_fit: comparison.excluded(),
            complete: comparison.is_complete(),
            signs: comparison.score_tests(),
            friction_change: comparison.friction_change(),
            friction_over_position: comparison.friction_over_position(),
            unseen_damping: &comparison.unseen_damping,
            friction_bound: comparison.friction_bound(),
            p: comparison.p_values(),
            scores: comparison.scores(),
            models: comparison.identifications(),
            preparation: match comparison.records() {
                [record] => Preparations::One(record),
                records => Preparations::Several(records),
            },
            warnings: comparison.warnings().iter().map(ToString::to_string).collect(),
        }
    }
}
