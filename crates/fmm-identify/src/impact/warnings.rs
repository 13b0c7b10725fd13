//! Warnings about the findings of blows.

use std::f64::consts::PI;

use fmm_fit::Fit;
use fmm_frf::{Channel, coulomb_impact_duration};

use crate::experiment::ImpactTrial;
use crate::identification::FittedMotion;
use crate::impact::covariance::ImpactCovariance;
use crate::warning::Warning;

/// Relative error of an impulse from which on a pulse is coarse.
const COARSE: f64 = 5e-3;
/// Residuals this many times larger than explained say that something is missing.
const EXCESS: f64 = 1.5;

/// Everything that limits a `fit` of `trials`, in which friction is about `friction` (N).
pub(crate) fn of(
    fit: &Fit,
    covariance: &ImpactCovariance,
    trials: &[ImpactTrial],
    motions: &[FittedMotion],
    friction: Option<f64>,
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for (index, trial) in trials.iter().enumerate() {
        of_trial(index + 1, trial, friction, &mut warnings);
    }
    Warning::of_fit(fit, &mut warnings);
    if let Some(reason) = &covariance.unpropagated {
        warnings.push(Warning::InputsNotPropagated { reason: reason.clone() });
    }
    if covariance.remainder > EXCESS * covariance.noise {
        warnings.push(Warning::StructuredResiduals {
            residual: covariance.remainder,
            noise: covariance.noise,
            unit: "m/s".to_owned(),
            inflation: covariance.inflation(),
        });
    }
    warnings.extend(Warning::of_narrow_stop(motions));
    warnings
}

fn of_trial(number: usize, trial: &ImpactTrial, friction: Option<f64>, warnings: &mut Vec<Warning>) {
    let summary = trial.summary();
    warnings.extend(summary.further_hits.iter().map(|hit| Warning::FurtherHit {
        trial: number,
        time: summary.begin + hit.time - trial.begin() as f64 * trial.interval(),
        share: hit.level / summary.level,
    }));
    let (force, response) = summary.overloads;
    for (channel, samples) in [(Channel::Force, force), (Channel::Response, response)] {
        if samples > 0 {
            warnings.push(Warning::Overload { trial: number, channel, samples });
        }
    }
    // Of a half sine that is joined by straight lines.
    let error = (PI / summary.intervals as f64).powi(2) / 12.0;
    if error > COARSE {
        warnings.push(Warning::CoarsePulse { trial: number, intervals: summary.intervals, error });
    }
    if summary.spikes > 0 {
        warnings.push(Warning::SpikesBridged { trial: number, samples: summary.spikes });
    }
    if summary.rest.is_none() {
        let recorded = trial.interval() * trial.motion().len() as f64;
        let whole = friction.and_then(|friction| coulomb_impact_duration(summary.impulse.value.abs(), friction).ok());
        // Half the area under a ramp that is cut off, which is the height of its peak in the spectrum.
        let lost = whole.map_or(0.0, |whole| (1.0 - recorded / whole).max(0.0).powi(2));
        warnings.push(Warning::NotAtRest { trial: number, recorded, lost });
    }
}
