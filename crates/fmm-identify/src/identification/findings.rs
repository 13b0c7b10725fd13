//! Findings of a fit: its estimates, and what follows from them and the known inputs of the machine.

use fmm_fit::{EstimateStatus, Fit};

use crate::experiment::clock::Clock;
use crate::finding::{Finding, Origin, Source};
use crate::identification::force::MotionNoise;
use crate::machine::Machine;
use crate::quantities::derived::{Derived, Inputs, KNOWN};
use crate::quantities::table::Table;
use crate::residuals::structure::Covariance;

/// Everything that a fit found: its parameters, and what follows from them and the known inputs of the machine.
///
/// Uncertainties are first order, u² = gᵀ V g + Σ (∂y/∂xᵢ)² u²(xᵢ), with exact derivatives (JCGM 100:2008, 5.1.2 and
/// 5.2.2); V has one part by the residuals and one by each source of prior knowledge.
pub(crate) fn findings(
    machine: &Machine,
    table: &Table,
    fit: &Fit,
    covariance: &Covariance,
    gain_uncertainty: f64,
    clock: &Clock,
    motion_noise: &MotionNoise,
) -> Vec<Finding> {
    let count = fit.values().len();
    let by_clock: Vec<f64> = (0..count)
        .map(|index| clock.uncertainty * table.power_of_clock(index, fit.values(), clock.order) * fit.values()[index])
        .collect();
    let mut findings = Vec::new();
    let inseparable = inseparable(fit);
    for (index, estimate) in fit.estimates().iter().enumerate() {
        // What is proportional to a power of the record is uncertain with its gain.
        let gain = gain_uncertainty * table.power_of_gain(index, fit.values()) * estimate.value();
        let mut gradient = vec![0.0; count];
        gradient[index] = 1.0;
        let by_motion = motion_noise.along(&gradient);
        let known = [(Source::Gain, gain), (Source::Clock, by_clock[index]), (Source::Motion, by_motion)];
        let parts = variances(covariance, &gradient, &known, false);
        let relaxed = Some(estimate).filter(|estimate| estimate.status().is_at_bound()).and(covariance.relaxed(index));
        let is_lost = inseparable.contains(&index);
        let (parts, status) = if is_lost { (None, EstimateStatus::Undetermined) } else { (parts, estimate.status()) };
        let (parameter, origin) = (estimate.parameter().clone(), Origin::Fitted(status));
        let freedom = covariance.degrees_of_freedom(index);
        let finding = Finding::new(parameter, estimate.value(), parts, freedom, origin, index >= table.shared);
        findings.push(finding.at_bound(relaxed.map(f64::sqrt), freedom));
    }
    let shared = &fit.values()[..table.shared];
    let inputs = Inputs { machine, shared, table, gain: 1.0, gain_uncertainty };
    for Derived { parameter, value, gradient } in inputs.with_gradients() {
        let (by_shared, by_known) = gradient.split_at(gradient.len() - KNOWN);
        let by_clock = by_shared.iter().zip(&by_clock).map(|(slope, moved)| slope * moved).sum();
        let known: Vec<(Source, f64)> = inputs
            .uncertainties()
            .into_iter()
            .zip(by_known)
            .map(|((source, u), slope)| (source, slope * u))
            .chain([(Source::Clock, by_clock), (Source::Motion, motion_noise.along(by_shared))])
            .collect();
        let parts = variances(covariance, by_shared, &known, false);
        let relaxed = variances(covariance, by_shared, &known, true);
        let relaxed = relaxed.map(|parts| parts.iter().map(|(_, variance)| variance).sum::<f64>().sqrt());
        let freedom = covariance.degrees_of_freedom_along(by_shared);
        let finding = Finding::new(parameter, value, parts, freedom, Origin::Derived, false);
        findings.push(finding.at_bound(relaxed, freedom));
    }
    findings
}

/// Variances by their sources of what has the `gradient` over the first of the fitted values and these standard
/// uncertainties by `known` inputs; `None` if a value that matters has none. Values on a bound count as free to leave
/// it where `is_relaxed`.
fn variances(
    covariance: &Covariance,
    gradient: &[f64],
    known: &[(Source, f64)],
    is_relaxed: bool,
) -> Option<Vec<(Source, f64)>> {
    let mut random = 0.0;
    let slopes = || gradient.iter().enumerate().filter(|(_, slope)| **slope != 0.0);
    for (i, row) in slopes() {
        for (j, column) in slopes() {
            let element = if is_relaxed { covariance.relaxed_pair(i, j) } else { covariance.get(i, j) };
            random += row * column * element?;
        }
    }
    let mut parts: Vec<(Source, f64)> = covariance.of_knowledge(gradient);
    for (source, uncertainty) in known {
        match parts.iter_mut().find(|(other, _)| other == source) {
            Some((_, variance)) => *variance += uncertainty * uncertainty,
            None => parts.push((*source, uncertainty * uncertainty)),
        }
    }
    // What is left of the whole is that of the residuals.
    let by_knowledge: f64 = covariance.of_knowledge(gradient).iter().map(|(_, variance)| variance).sum();
    Some(std::iter::once((Source::Residuals, (random - by_knowledge).max(0.0))).chain(parts).collect())
}

/// Parameters of a fit that are one with another, as their correlation shows: neither is determined.
pub(crate) fn inseparable(fit: &Fit) -> Vec<usize> {
    /// Correlation from which on two parameters are one.
    const ONE: f64 = 1.0 - 1e-9;
    let count = fit.estimates().len();
    let as_one = |i: usize, j: usize| i != j && fit.correlation(i, j).is_some_and(|r| r.abs() > ONE);
    (0..count).filter(|i| (0..count).any(|j| as_one(*i, j))).collect()
}
