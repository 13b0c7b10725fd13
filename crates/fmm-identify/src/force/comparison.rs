//! Several models of the same forces side by side.

use std::fmt;

use fmm_fit::{ComparisonOptions, Contender, Criterion, ModelTable};

use crate::error::IdentifyError;
use crate::force::{ForceIdentification, ForceModel, ForceRecord, identify_force};

/// Models of the same forces side by side, and whether the records decide between them.
///
/// `Display` gives the table.
#[derive(Debug, Clone)]
pub struct ForceComparison {
    identifications: Vec<ForceIdentification>,
    table: ModelTable,
}

/// Fits each of `models` to `records` and compares what they leave, by Schwarz' criterion of the samples that count for
/// all of them; of neighbouring samples that leave the same only one counts.
///
/// ```
/// use fmm_identify::{ForceModel, ForceRecord, compare_force};
///
/// // 12 N and 30 N s/m, with 0.2 N of noise.
/// let times: Vec<f64> = (0..800).map(|i| 0.01 * f64::from(i)).collect();
/// let velocities: Vec<f64> = times.iter().map(|t| 0.06 * (3.0 * t).cos()).collect();
/// let noise = |i: usize| 0.2 * (1.7 * (i * i) as f64).sin();
/// let forces: Vec<f64> =
///     velocities.iter().enumerate().map(|(i, v)| 12.0 * v.signum() + 30.0 * v + noise(i)).collect();
/// let record = ForceRecord::of_velocities(&times, &velocities, &forces)?;
/// let models = ["coulomb", "coulomb + linear", "coulomb + linear + zero"];
/// let models = models.into_iter().map(ForceModel::named).collect::<Result<Vec<_>, _>>()?;
/// let compared = compare_force(&models, &[record])?;
/// assert_eq!(compared.preferred().model(), "coulomb + linear");
/// println!("{compared}");
/// # Ok::<(), fmm_identify::IdentifyError>(())
/// ```
///
/// # Errors
/// As for [`identify_force`], [`IdentifyError::Missing`] without a model, [`IdentifyError::Contradiction`] for a model
/// given twice, and [`IdentifyError::TooFew`] if hardly a sample counts for all of them.
pub fn compare_force(models: &[ForceModel], records: &[ForceRecord]) -> Result<ForceComparison, IdentifyError> {
    let identifications = models.iter().map(|model| identify_force(model, records)).collect::<Result<Vec<_>, _>>()?;
    let residuals = identifications.iter().map(|found| residuals(found, records)).collect::<Result<Vec<_>, _>>()?;
    let samples = residuals.first().map_or(0, Vec::len);
    let counts: Vec<bool> = (0..samples).map(|row| residuals.iter().all(|of| of[row].is_some())).collect();
    let contender = |index: usize| {
        let found = &identifications[index];
        let counted: Vec<f64> =
            residuals[index].iter().zip(&counts).filter(|(_, counts)| **counts).filter_map(|(left, _)| *left).collect();
        let contender = Contender::new(found.model(), &counted, found.fit().rank());
        let special = models.iter().enumerate().filter(|(other, _)| *other != index);
        let special = special.filter(|(_, other)| other.is_nested_in(&models[index]));
        special.fold(contender, |contender, (other, _)| contender.containing(identifications[other].model()))
    };
    let contenders: Vec<Contender> = (0..models.len()).map(contender).collect();
    let comparing = ComparisonOptions::default().by(Criterion::Bayesian);
    let table = ModelTable::of(&contenders, comparing).map_err(|error| match error {
        fmm_fit::FitError::Count { .. } if models.is_empty() => {
            IdentifyError::missing("there is no model to compare; give at least one")
        }
        fmm_fit::FitError::Undetermined { .. } => {
            let counted = counts.iter().filter(|counts| **counts).count();
            let parameters = identifications.iter().map(|found| found.fit().rank()).max().unwrap_or(0);
            IdentifyError::too_short(counted, parameters + 3)
        }
        other => IdentifyError::contradiction(other.to_string()),
    })?;
    Ok(ForceComparison { identifications, table })
}

/// What `found` says less the force at each sample of all `records`; `None` where it says nothing.
fn residuals(found: &ForceIdentification, records: &[ForceRecord]) -> Result<Vec<Option<f64>>, IdentifyError> {
    let mut all = Vec::new();
    for record in records {
        let said = found.predict(record)?;
        all.extend(said.iter().zip(record.forces()).map(|(said, force)| Some((*said)? - force)));
    }
    Ok(all)
}

impl ForceComparison {
    /// The fits, in the order of the models.
    pub fn identifications(&self) -> &[ForceIdentification] {
        &self.identifications
    }

    /// The fit of the model that the records prefer: the winner, or the simplest of those that they leave.
    pub fn preferred(&self) -> &ForceIdentification {
        &self.identifications[self.table.verdict().preferred()]
    }

    /// Whether the records decide for it.
    pub fn is_decided(&self) -> bool {
        self.table.verdict().is_decided()
    }

    /// The models side by side.
    pub fn table(&self) -> &ModelTable {
        &self.table
    }
}

impl fmt::Display for ForceComparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.table.fmt(f)
    }
}
