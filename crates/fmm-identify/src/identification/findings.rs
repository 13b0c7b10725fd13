//! Findings of a fit: its estimates, and what follows from them and the known inputs of the machine.

use fmm_fit::Fit;

use crate::finding::{Finding, Origin, Source};
use crate::machine::Machine;
use crate::quantities::derived::{Derived, Inputs, KNOWN};
use crate::quantities::layout::Layout;
use crate::residuals::structure::Covariance;

/// Everything that a fit found: its parameters, and what follows from them and the known inputs of the machine.
///
/// Uncertainties of derived quantities are first order, u² = gᵀ V g + Σ (∂y/∂xᵢ)² u²(xᵢ), with exact derivatives
/// (JCGM 100:2008, 5.1.2 and 5.2.2).
pub(crate) fn findings(
    machine: &Machine,
    layout: &Layout,
    fit: &Fit,
    covariance: &Covariance,
    gain_uncertainty: f64,
) -> Vec<Finding> {
    let estimated = fit.estimates().iter().enumerate().map(|(index, estimate)| {
        // What is proportional to a power of the record is uncertain with its gain.
        let gain = gain_uncertainty * layout.power_of_gain(index, fit.values()) * estimate.value();
        let by_force = if layout.is_scaled_by_force(index) { layout.force_uncertainty * estimate.value() } else { 0.0 };
        Finding::new(
            estimate.parameter().clone(),
            estimate.value(),
            covariance.get(index, index).map(|variance| {
                vec![
                    (Source::Residuals, variance),
                    (Source::Gain, gain * gain),
                    (Source::ForceGain, by_force * by_force),
                ]
            }),
            covariance.degrees_of_freedom(),
            Origin::Fitted(estimate.status()),
            index >= layout.shared,
        )
        .at_bound(
            Some(estimate)
                .filter(|estimate| estimate.status().is_at_bound())
                .and(covariance.relaxed(index))
                .map(f64::sqrt),
            covariance.degrees_of_freedom(),
        )
    });
    let mut findings: Vec<Finding> = estimated.collect();
    let shared = &fit.values()[..layout.shared];
    let inputs = Inputs { machine, shared, layout, gains: [1.0; 2], gain_uncertainty };
    for Derived { parameter, value, gradient } in inputs.with_gradients() {
        let known = inputs.uncertainties();
        let inside = variances(|i, j| covariance.get(i, j), &gradient, known);
        let relaxed = variances(|i, j| covariance.relaxed_pair(i, j), &gradient, known);
        let relaxed = relaxed.map(|parts| parts.iter().map(|(_, variance)| variance).sum::<f64>().sqrt());
        let freedom = covariance.degrees_of_freedom();
        let finding = Finding::new(parameter, value, inside, freedom, Origin::Derived, false);
        findings.push(finding.at_bound(relaxed, freedom));
    }
    findings
}

/// gᵀ V g over the fitted values, and the variances by the inputs; `None` if a value that matters has none.
fn variances(
    covariance: impl Fn(usize, usize) -> Option<f64>,
    gradient: &[f64],
    inputs: [(Source, f64); KNOWN],
) -> Option<Vec<(Source, f64)>> {
    let (shared, known) = gradient.split_at(gradient.len() - inputs.len());
    let mut random = 0.0;
    for (i, row) in shared.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
        for (j, column) in shared.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
            random += row * column * covariance(i, j)?;
        }
    }
    let known = known.iter().zip(inputs).map(|(slope, (source, u))| (source, (slope * u).powi(2)));
    Some(std::iter::once((Source::Residuals, random)).chain(known).collect())
}
