//! Inputs that several records share, so that what they make of an uncertainty does not average out.

use std::collections::BTreeMap;

use fmm_identify::Source;
use fmm_model::Estimated;
use fmm_uq::{Consensus, RandomEffects, UncertaintyError};
use serde::Serialize;

use super::row::{Row, Stated, Told};

/// Contribution of an input that records share to the uncertainty of a consensus.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct SharedPart {
    pub(crate) input: Stated,
    /// Records that share it.
    pub(crate) records: usize,
    /// Standard uncertainty in the unit of the quantity.
    pub(crate) u: f64,
}

/// Contributions of one input, each with the place of its record.
type Parts = Vec<(usize, f64)>;

/// Results of records in parts.
pub(super) struct Parted {
    /// Results of the records, with the uncertainties that are their own.
    results: Vec<Estimated>,
    /// Each input that two records or more share, with how many they are.
    inputs: Vec<(Stated, usize)>,
    /// Its contribution to each result.
    contributions: Vec<Vec<f64>>,
}

impl Parted {
    /// Inputs of what records tell of one quantity. Inputs of one source, value and uncertainty are one input. The
    /// smoothness that friction curves are given is one for all, 0 ± 1 in standard deviations.
    pub(super) fn of(told: &[(&Row, &Told)]) -> Self {
        let smoothness = Stated { source: Source::Smoothness.to_string(), value: 0.0, u: 1.0 };
        let mut own: Vec<f64> = vec![0.0; told.len()];
        let mut by_input: BTreeMap<(&str, u64, u64), (&Stated, Parts)> = BTreeMap::new();
        for (record, (row, told)) in told.iter().enumerate() {
            for part in &told.contributions {
                let mut stated = row.found().into_iter().flat_map(|found| &found.stated).chain([&smoothness]);
                match stated.find(|stated| stated.source == part.source) {
                    Some(input) => {
                        let key = (input.source.as_str(), input.value.to_bits(), input.u.to_bits());
                        by_input.entry(key).or_insert((input, Vec::new())).1.push((record, part.u));
                    }
                    None => own[record] = own[record].hypot(part.u),
                }
            }
        }
        let (mut inputs, mut contributions) = (Vec::new(), Vec::new());
        for (input, parts) in by_input.into_values() {
            let is_shared = parts.iter().any(|(record, _)| *record != parts[0].0);
            let mut of_each = vec![0.0_f64; if is_shared { told.len() } else { 0 }];
            for (record, u) in parts {
                let place = if is_shared { &mut of_each[record] } else { &mut own[record] };
                *place = place.hypot(u);
            }
            if is_shared {
                inputs.push((input.clone(), of_each.iter().filter(|u| **u > 0.0).count()));
                contributions.push(of_each);
            }
        }
        let results = told.iter().zip(own).map(|((_, told), own)| Estimated::new(told.value, own)).collect();
        Self { results, inputs, contributions }
    }

    pub(super) fn consensus(&self, effects: RandomEffects) -> Result<Consensus, UncertaintyError> {
        Consensus::of(&self.results, effects)?.with_shared(&self.contributions)
    }

    /// Contribution of each shared input to the uncertainty of a consensus.
    pub(super) fn shared(&self, consensus: &Consensus) -> Vec<SharedPart> {
        let part =
            |((input, records), u): (&(Stated, usize), f64)| SharedPart { input: input.clone(), records: *records, u };
        self.inputs.iter().zip(consensus.shared()).map(part).collect()
    }
}
