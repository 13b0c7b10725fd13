//! A sensor that filters, or that measures another quantity, as the explanation of residuals that laws leave.

use std::ops::ControlFlow;

use fmm_fit::Options;
use fmm_friction::CoulombViscous;
use fmm_record::Quantity;

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::{Experiment, Preparation, Sensor};
use crate::fit::stages::Begin;
use crate::identification::Identification;
use crate::identification::beside::closest;
use crate::judgement::rules::{
    AS_GOOD, ENOUGH_SAMPLES, EXCESS_OF_FILTER, FAR, FILTER_ORDER, MOST_ITERATIONS_OF_FILTER, SHOWN_CORNER,
};
use crate::machine::Machine;
use crate::problem::Problem;
use crate::warning::Warning;

/// Fit by a simple law behind a low-pass filter in the sensor.
pub(crate) struct Filtered {
    /// The same law without a filter, from the end of whose fit it begins, and the values there.
    law: String,
    begun: Vec<f64>,
    pub(crate) found: Identification,
    /// Time (s) at the beginning of the records that it leaves out.
    settled: f64,
}

/// Warning about a low-pass filter in the sensor, of which nothing was declared, that explains the records by a simple
/// law as well as the preferred law does without: both round the motion where it reverses, and only one is friction. If
/// the records do not determine the filter, the warning is about their beginning, which the filter leaves out. A fit
/// that is `known` need not be made again.
///
/// # Errors
/// The error of a fit behind a filter, if it cannot be made.
pub(crate) fn filtering_sensor(
    decays: &[Experiment],
    identifications: &[Identification],
    preferred: usize,
    known: Option<Filtered>,
) -> Result<Option<Warning>, IdentifyError> {
    let filtered = behind_filter(decays, identifications, known)?;
    let Some(Filtered { found, settled, .. }) = filtered else { return Ok(None) };
    let preferred = &identifications[preferred];
    if found.rms_residual() > AS_GOOD * preferred.rms_residual() {
        return Ok(None);
    }
    let law = found.law().to_owned();
    let is_corner = |name: &str| name.starts_with("sensor_corner_hz");
    let corner = found.findings().iter().find(|finding| is_corner(finding.parameter().name()));
    let Some(corner) = corner else { return Ok(None) };
    if let Some(uncertainty) = corner.uncertainty().filter(|u| corner.value() > SHOWN_CORNER * u) {
        return Ok(Some(Warning::FilteringSensor { law, corner: corner.value(), uncertainty }));
    }
    let is_explained = preferred.structure.is_structured() && !found.structure.is_correlated();
    Ok(is_explained.then_some(Warning::Beginning { law, time: settled }))
}

/// Warning about records that Coulomb and viscous friction explain if they are of another quantity than declared, and
/// no law as they are; `None` for others.
pub(crate) fn other_quantity(decays: &[Experiment], preferred: &Identification) -> Option<Warning> {
    let declared = decays.first()?.record().quantity();
    if !preferred.structure.is_structured() || decays.iter().any(|decay| decay.drive().is_some()) {
        return None;
    }
    let as_quantity = |quantity: Quantity| {
        let retaken = |decay: &Experiment| {
            let record = decay.record();
            let record = record.clone().with_quantity(quantity).with_unit("1");
            Experiment::ring_down(&record, &Preparation::default()).ok()
        };
        let decays = decays.iter().map(retaken).collect::<Option<Vec<_>>>()?;
        let problem = Problem::of(&Candidate::of::<CoulombViscous>(), Machine::per_unit_mass(), &decays).ok()?;
        let options = Options::default().with_max_iterations(MOST_ITERATIONS_OF_FILTER);
        let found = Identification::of(&problem, Begin::Anywhere, &options, &mut |_| ControlFlow::Continue(())).ok()?;
        let is_explained = !found.structure.is_structured() && FAR * found.rms_residual() < preferred.rms_residual();
        is_explained.then(|| Warning::OtherQuantity { quantity, declared, law: found.law().to_owned() })
    };
    let all = [Quantity::Displacement, Quantity::Velocity, Quantity::Acceleration].into_iter();
    all.filter(|quantity| *quantity != declared).find_map(as_quantity)
}

/// The fit by the closest simple law, behind a low-pass filter in the sensor, or that which is `known` if it begins at
/// the same place; `None` if nothing is left to explain, a filter is known, the samples are unequally spaced, or there is
/// no vibration.
///
/// # Errors
/// The error of a record of which the filter leaves too little, or that of the fit.
pub(crate) fn behind_filter(
    decays: &[Experiment],
    identifications: &[Identification],
    known: Option<Filtered>,
) -> Result<Option<Filtered>, IdentifyError> {
    let is_known = |decay: &Experiment| {
        decay.sensor().low_pass().is_some()
            || decay.drive().is_some()
            || decay.is_run_down()
            || !decay.record().is_equally_spaced()
    };
    // Forces along motions have no such sensor.
    if decays.is_empty() || decays.iter().any(is_known) {
        return Ok(None);
    }
    let is_simple = |found: &&Identification| {
        matches!(found.family().dry_name(), None | Some("coulomb")) && !found.fitted.model.terms.has_spring()
    };
    let Some(simple) = closest(identifications.iter().filter(is_simple)) else { return Ok(None) };
    let structure = simple.structure;
    if !structure.is_correlated() && structure.residual < EXCESS_OF_FILTER * structure.noise {
        return Ok(None);
    }
    let (law, begun) = (simple.law().to_owned(), simple.fit().values().to_vec());
    if let Some(known) = known.filter(|known| known.law == law && known.begun == begun) {
        return Ok(Some(known));
    }
    let sensor = Sensor::default().with_free_low_pass(FILTER_ORDER)?;
    let behind = |decay: &Experiment| {
        let stride = (decay.record().rate() / (ENOUGH_SAMPLES * decay.guess.frequency())) as usize;
        let thinned = (stride > 1).then(|| decay.thinned(stride)).flatten();
        thinned.unwrap_or_else(|| decay.clone()).seen_by(sensor)
    };
    let seen = decays.iter().map(behind).collect::<Result<Vec<_>, _>>()?;
    let options = Options::default().with_max_iterations(MOST_ITERATIONS_OF_FILTER);
    let found = Identification::of(&simple.problem(&seen)?, Begin::Behind(&simple.fitted), &options, &mut |_| {
        ControlFlow::Continue(())
    })?;
    let settled = decays.iter().map(|decay| sensor.settling(decay.guess.frequency())).fold(0.0, f64::max);
    Ok(Some(Filtered { law, begun, found, settled }))
}
