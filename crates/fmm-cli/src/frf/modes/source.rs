//! Measured responses: of files that hold them, or of trials.

use std::error::Error;
use std::path::{Path, PathBuf};

use fmm_frf::{FrfError, MeasuredResponse, ResponseForm};
use fmm_record::uff::{FunctionType, UffFile};
use fmm_record::{Column, DataFile, Format, Quantity, RecordError};

use super::{Choices, Remedied};
use crate::files;
use crate::frf::Found as OfTrials;
use crate::frf::trials::Channels;
use crate::host::Host;
use crate::refusal::placed;

/// Responses, and where they come from.
pub(crate) struct Measured {
    pub(super) responses: Vec<MeasuredResponse>,
    /// Files in words.
    pub(super) origin: String,
    /// The highest frequency (Hz) that a force reached, if it is known.
    pub(super) usable: Option<f64>,
    pub(super) warnings: Vec<String>,
}

impl Measured {
    /// H1 of trials, with the uncertainty of their scatter.
    pub(crate) fn of(found: &OfTrials) -> Result<Self, Box<dyn Error>> {
        let (analysis, count) = (&found.analysis, found.trials.len());
        let mut measured = MeasuredResponse::new(analysis.h1.clone());
        if let Some(uncertainty) = &analysis.uncertainty {
            measured = measured.with_uncertainty(uncertainty.clone(), count as f64)?;
        }
        let names: Vec<&str> = found.trials.iter().map(|trial| trial.name.as_str()).collect();
        // What is said of a peak, and not of a trial, is said of the fit of one mode.
        let of_trial = |warning: &&String| names.iter().any(|name| warning.starts_with(name));
        let warnings = analysis.warnings.iter().filter(of_trial).cloned().collect();
        let origin = format!("H1 of {}, window {}", names.join(", "), analysis.window);
        Ok(Self { responses: vec![measured], origin, usable: Some(analysis.usable), warnings })
    }
}

impl Choices {
    /// The responses in `files`, or none if these are trials.
    pub(crate) fn measured(
        &self,
        files: &[PathBuf],
        choice: &Channels,
        host: &Host<'_>,
    ) -> Result<Option<Measured>, Box<dyn Error>> {
        let mut responses: Vec<MeasuredResponse> = Vec::new();
        let mut warnings = Vec::new();
        for path in files {
            // The same bytes are read once as a table and once as a Universal File.
            let file = host.open(&choice.layout.reader(), path)?;
            let found = if file.format() == Format::Universal {
                let file = UffFile::parse(&host.bytes(path)?)?;
                let holds = file.sets().iter().any(|set| set.header.function == FunctionType::FREQUENCY_RESPONSE);
                if !holds && !self.responses {
                    return mixed(path, &responses);
                }
                warnings.extend(file.warnings().iter().map(|warning| format!("{}: {warning}", files::name(path))));
                let form = choice.quantity.and_then(form);
                let known = form.map(|form| (form, choice.response_scale.unwrap_or(1.0)));
                MeasuredResponse::of_universal(&file, known, self.averages).map_err(|error| of_file(path, error))?
            } else {
                let file = host.open(&choice.layout.reader().rate(1.0), path)?;
                let array = array(&file);
                let names = array.as_ref().map_or_else(|| names(&file), |columns| Ok(unnamed(columns.len())))?;
                if !self.responses && !MeasuredResponse::is_named_by(&names) {
                    return mixed(path, &responses);
                }
                let columns = array.map_or_else(|| columns(&file, names.len()), Ok)?;
                let form = choice.quantity.and_then(form).ok_or_else(|| without_form(path))?;
                let scale = choice.response_scale.unwrap_or(1.0);
                MeasuredResponse::of_columns(&names, &columns, form, scale, self.averages)
                    .map_err(|error| of_file(path, error))?
            };
            // Tables have no places; so those of a second file go on where the first one ended.
            let known = responses.len();
            responses.extend(found.into_iter().enumerate().map(|(index, measured)| {
                if file.format() == Format::Universal {
                    return measured;
                }
                let mut place = measured.response().clone();
                place.node = i32::try_from(known + index + 1).unwrap_or(i32::MAX);
                let reference = measured.reference().clone();
                measured.between(place, reference)
            }));
        }
        let names: Vec<String> = files.iter().map(|path| files::name(path)).collect();
        Ok(Some(Measured { responses, origin: format!("responses of {}", names.join(", ")), usable: None, warnings }))
    }
}

/// A file that is none of responses: fine if none was, else refused.
fn mixed(path: &Path, before: &[MeasuredResponse]) -> Result<Option<Measured>, Box<dyn Error>> {
    if before.is_empty() {
        return Ok(None);
    }
    let what = "holds no frequency response, where files before it do; give --responses if it is a table of them";
    Err(format!("{}: {what}", path.display()).into())
}

/// The columns of the only array of a file, if it is one of arrays.
fn array(file: &DataFile) -> Option<Vec<Vec<f64>>> {
    let [array] = file.arrays() else { return None };
    let &[rows, columns] = array.shape() else { return None };
    let at = |row: usize, column: usize| match file.format() {
        Format::Numpy => row * columns + column,
        _ => column * rows + row,
    };
    let values = array.values();
    Some((0..columns).map(|column| (0..rows).map(|row| values[at(row, column)]).collect()).collect())
}

/// Names of columns that have none.
fn unnamed(count: usize) -> Vec<String> {
    (0..count).map(|column| format!("column {column}")).collect()
}

/// The names of all columns, also of one that a record would take for its time.
fn names(file: &DataFile) -> Result<Vec<String>, Box<dyn Error>> {
    let channels = file.channels()?;
    match channels.first() {
        Some(first) => Ok(file.channel(Column::Index(first.position))?.columns),
        None => Ok(Vec::new()),
    }
}

/// The numbers of all columns.
fn columns(file: &DataFile, count: usize) -> Result<Vec<Vec<f64>>, RecordError> {
    (0..count).map(|index| Ok(file.channel(Column::Index(index))?.record.into_values())).collect()
}

fn form(quantity: Quantity) -> Option<ResponseForm> {
    match quantity {
        Quantity::Displacement => Some(ResponseForm::Receptance),
        Quantity::Velocity => Some(ResponseForm::Mobility),
        Quantity::Acceleration => Some(ResponseForm::Accelerance),
        _ => None,
    }
}

fn without_form(path: &Path) -> Box<dyn Error> {
    let what = format!("{}: a table does not say whether its responses are those of a displacement", path.display());
    let error = FrfError::Mismatch { what: format!("{what}, a velocity or an acceleration") };
    Remedied::new(error, "give --quantity, and --response-scale unless they are in SI units").into()
}

/// An error of reading, with the file and what to do.
fn of_file(path: &Path, error: FrfError) -> Box<dyn Error> {
    let at = |what: String| format!("{}: {what}", path.display());
    match error {
        FrfError::Mismatch { what } => {
            let error = FrfError::Mismatch { what: at(what) };
            Remedied::new(error, "--quantity and --response-scale say form and unit").into()
        }
        FrfError::Values { what } => {
            let error = FrfError::Values { what: at(what) };
            Remedied::new(error, "leave these lines out of the file").into()
        }
        other => placed(path.display())(other).into(),
    }
}
