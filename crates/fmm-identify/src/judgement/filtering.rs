//! A sensor that filters, as the explanation of residuals that a simple law leaves.

use std::ops::ControlFlow;

use fmm_fit::Options;

use crate::experiment::{Experiment, Sensor};
use crate::fit::stages::Begin;
use crate::identification::Identification;
use crate::identification::{closest, identify_by};
use crate::warning::Warning;

/// Order of the filter that is tried: that of most sensors with one.
const ORDER: usize = 2;
/// Corner frequency over its uncertainty from which on a record tells it (1).
const TOLD: f64 = 5.0;
/// Residuals that exceed those of the preferred law by no more than this factor explain the record as well.
const AS_GOOD: f64 = 1.02;
/// Residuals that exceed the noise by this factor leave something to explain, however short it lasts.
const EXCESS: f64 = 1.1;
/// Samples of a period that are enough to see what a filter rounds.
const ENOUGH_SAMPLES: f64 = 400.0;
/// Iterations after which the filter is no plain explanation.
const MOST_ITERATIONS: usize = 60;

/// That a low-pass filter in the sensor, of which nothing was said, would explain the records by a simple law as well
/// as the preferred law does without: both round the motion where it reverses, and only one is friction. Or, if the
/// records do not tell the filter, that their beginning, which it leaves out, is all that the preferred law misses.
pub(crate) fn filtering_sensor(
    decays: &[Experiment],
    identifications: &[Identification],
    preferred: usize,
) -> Option<Warning> {
    let (found, settled) = behind_filter(decays, identifications)?;
    let preferred = &identifications[preferred];
    if found.rms_residual() > AS_GOOD * preferred.rms_residual() {
        return None;
    }
    let law = found.law().to_owned();
    let is_corner = |name: &str| name.starts_with("sensor_corner_hz");
    let corner = found.findings().iter().find(|finding| is_corner(finding.parameter().name()))?;
    if let Some(uncertainty) = corner.uncertainty().filter(|u| corner.value() > TOLD * u) {
        return Some(Warning::FilteringSensor { law, corner: corner.value(), uncertainty });
    }
    let is_explained = preferred.structure().is_structured() && !found.structure().is_correlated();
    is_explained.then_some(Warning::Beginning { law, time: settled })
}

/// The fit by the closest simple law, behind a low-pass filter in the sensor, with the time (s) at the beginning that
/// it leaves out; none if nothing is left to explain, a filter is known, or the fit fails.
pub(crate) fn behind_filter(
    decays: &[Experiment],
    identifications: &[Identification],
) -> Option<(Identification, f64)> {
    let is_known = |decay: &Experiment| decay.sensor().low_pass().is_some() || decay.drive().is_some();
    if decays.iter().any(is_known) {
        return None;
    }
    let is_simple = |found: &&Identification| {
        matches!(found.family().dry_name(), None | Some("coulomb")) && !found.terms().has_spring()
    };
    let simple = closest(identifications.iter().filter(is_simple))?;
    let structure = simple.structure();
    if !structure.is_correlated() && structure.residual < EXCESS * structure.noise {
        return None;
    }
    let sensor = Sensor::default().with_free_low_pass(ORDER).ok()?;
    let behind = |decay: &Experiment| {
        let stride = (decay.record().rate() / (ENOUGH_SAMPLES * decay.guess().frequency())) as usize;
        let thinned = (stride > 1).then(|| decay.thinned(stride)).flatten();
        thinned.unwrap_or_else(|| decay.clone()).seen_by(sensor)
    };
    let seen = decays.iter().map(behind).collect::<Result<Vec<_>, _>>().ok()?;
    let options = Options::default().with_max_iterations(MOST_ITERATIONS);
    let (machine, terms) = (simple.machine(), simple.terms());
    let mut observer = |_: &fmm_fit::Progress<'_>| ControlFlow::Continue(());
    let found =
        identify_by(simple.family(), machine, terms, &seen, Begin::Behind(simple.fitted()), &options, &mut observer)
            .ok()?;
    let settled = decays.iter().map(|decay| sensor.settling(decay.guess().frequency())).fold(0.0, f64::max);
    Some((found, settled))
}
