//! All records of a campaign fitted together as one problem: one law, one machine, an initial state and an offset for
//! each record.

use std::error::Error;
use std::ops::ControlFlow;

use fmm_fit::Minimizer;
use fmm_identify::Experiment;
use serde::Serialize;

use super::campaign::Campaign;
use super::row::{Found, Row, Told, tally, told};
use crate::host::Host;
use crate::input::Question;

/// The usual law with its viscous part as damping of the machine.
const OF_MACHINE: &str = "coulomb + linear";

/// Findings of all records as one.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Together {
    pub(crate) law: String,
    pub(crate) records: usize,
    pub(crate) findings: Vec<Told>,
    /// The load (N) to which forces and accelerations belong, where records state different ones.
    pub(crate) reference_load: Option<f64>,
    pub(crate) rms_residual: f64,
    pub(crate) unit: String,
    pub(crate) warnings: Vec<String>,
}

impl Together {
    /// Fits all records that count; `show` sees each trial step.
    pub(crate) fn of(
        campaign: &Campaign,
        rows: &[Row],
        with_doubtful: bool,
        host: &Host<'_>,
        show: impl FnMut(&str, &Minimizer) -> ControlFlow<()> + Send,
    ) -> Result<Self, Box<dyn Error>> {
        let counted = || (0..rows.len()).filter(|index| rows[*index].counts(with_doubtful));
        let law = one_law(counted().filter_map(|index| rows[index].found()))?;
        let (mut questions, mut experiments) = (Vec::new(), Vec::new());
        for index in counted() {
            let record = campaign.record(index)?;
            let (_, experiment) = record.prepared(host)?;
            questions.push((record.question, rows[index].file.display().to_string()));
            experiments.push(experiment);
        }
        let (question, factors) = Question::together(&questions)?;
        let under_its_load = |(experiment, factor): (Experiment, &f64)| experiment.with_load_factor(*factor);
        let experiments: Vec<Experiment> =
            experiments.into_iter().zip(&factors).map(under_its_load).collect::<Result<_, _>>()?;
        let loads_differ = factors.iter().any(|factor| *factor != 1.0);
        // A record alone does not tell whose the linear damping is. Of the law, it would grow with the load.
        let fitted = if loads_differ && law == super::LAW { OF_MACHINE } else { law };
        let candidate = question.candidate(fitted, host)?;
        let comparison = question.answer(&experiments, &[candidate], show)?;
        let found = comparison.preferred();
        Ok(Self {
            law: found.law().to_owned(),
            records: experiments.len(),
            findings: told(found),
            reference_load: question.normal_load.filter(|_| loads_differ),
            rms_residual: found.rms_residual(),
            unit: experiments[0].record().unit().to_owned(),
            warnings: comparison.warnings().iter().map(ToString::to_string).collect(),
        })
    }
}

/// The law of all records.
fn one_law<'a>(counted: impl Iterator<Item = &'a Found>) -> Result<&'a str, String> {
    let laws = tally(counted.map(|found| found.law.as_str()));
    match laws.as_slice() {
        [(law, count)] if *count > 1 => Ok(law),
        [] | [_] => Err("a joint fit needs two identified records or more that count".to_owned()),
        several => {
            let several: Vec<String> = several.iter().map(|(law, count)| format!("{law} ({count})")).collect();
            Err(format!(
                "the records follow different laws: {}; name one for all, as in -- --law {}",
                several.join(", "),
                laws[0].0.replace(' ', "")
            ))
        }
    }
}
