//! Answer of a command in every form in which it is given out, or the reason of its refusal.

use std::error::Error;

use clap::ValueEnum;
use fmm_frf::FrfError;
use fmm_identify::IdentifyError;
use fmm_record::RecordError;
use serde::Serialize;

/// Detail of a document.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum Detail {
    /// Findings and judgements.
    #[default]
    Brief,
    /// The same with the measured and the fitted curve and the residuals, sample by sample.
    Full,
}

/// Findings of a command.
pub trait Answer: Send + Sync {
    /// Screen of text.
    ///
    /// # Errors
    /// Reason why it cannot be written.
    fn text(&self) -> Result<String, Box<dyn Error>>;

    /// Document of JSON with the keys `schema` and `version`.
    ///
    /// # Errors
    /// Reason why it cannot be written.
    fn document(&self, detail: Detail) -> Result<String, Box<dyn Error>>;

    /// Figures: name of the file and SVG.
    ///
    /// # Errors
    /// Reason why they cannot be drawn.
    fn pictures(&self) -> Result<Vec<(String, String)>, Box<dyn Error>> {
        Ok(Vec::new())
    }

    /// Page of HTML; `None` for a command without one.
    ///
    /// # Errors
    /// Reason why it cannot be made.
    fn page(&self) -> Result<Option<String>, Box<dyn Error>> {
        Ok(None)
    }

    /// Faults of the input that are no part of the text.
    fn remarks(&self) -> &[String] {
        &[]
    }

    /// Sentence on what the command wrote by itself.
    fn written(&self) -> Option<String> {
        None
    }

    /// Why what was found is a failure nevertheless.
    ///
    /// # Errors
    /// The reason.
    fn verdict(&self) -> Result<(), String> {
        Ok(())
    }
}

/// A document with the name of its schema, `docs/schemas/NAME.json`, and the version of the program.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Document<T> {
    /// Name and generation of the schema of this document.
    schema: &'static str,
    /// Version of the program that wrote it.
    version: &'static str,
    #[serde(flatten)]
    content: T,
}

impl<T: Serialize> Document<T> {
    pub(crate) fn new(schema: &'static str, content: T) -> Self {
        Self { schema, version: env!("CARGO_PKG_VERSION"), content }
    }

    /// Lines for the eye.
    pub(crate) fn pretty(&self) -> Result<String, Box<dyn Error>> {
        Ok(serde_json::to_string_pretty(self)?)
    }

    /// One line, for documents of many samples.
    pub(crate) fn compact(&self) -> Result<String, Box<dyn Error>> {
        Ok(serde_json::to_string(self)?)
    }
}

/// Why a command gave no answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Refusal {
    /// Kind of the refusal, to act on: `usage`, `unreadable`, `unclear`, `contradiction`, `channel`, `time`, `values`,
    /// `record`, `name`, `fit` or `refused`.
    pub code: &'static str,
    /// Fault, in one sentence.
    pub message: String,
    /// Remedy, if it is known apart from the message.
    pub remedy: Option<String>,
}

impl Refusal {
    /// Wrong usage of the program, in the words of its parser.
    pub(crate) fn usage(error: &clap::Error) -> Self {
        let text = error.to_string();
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let message = lines.next().unwrap_or_default().trim_start_matches("error: ").to_owned();
        let remedy = lines.find_map(|line| line.strip_prefix("tip: ")).map(str::to_owned);
        Self { code: "usage", message, remedy }
    }

    /// The refusal that an error of a command is.
    pub(crate) fn of(error: &(dyn Error + 'static)) -> Self {
        let mut message = error.to_string();
        let mut remedy = None;
        if let Some(Remedied { error, remedy: known }) = error.downcast_ref() {
            (message, remedy) = (error.to_string(), Some(known.clone()));
        }
        Self { code: code(error), message, remedy }
    }
}

/// An error with the remedy in the words of the options.
#[derive(Debug, thiserror::Error)]
#[error("{error}; {remedy}")]
pub(crate) struct Remedied {
    #[source]
    error: Box<dyn Error + Send + Sync>,
    remedy: String,
}

impl Remedied {
    pub(crate) fn new(error: impl Error + Send + Sync + 'static, remedy: impl Into<String>) -> Self {
        Self { error: Box::new(error), remedy: remedy.into() }
    }
}

/// Kind of an error, by the first cause that has one.
fn code(error: &(dyn Error + 'static)) -> &'static str {
    if let Some(error) = error.downcast_ref() {
        return match error {
            RecordError::Io { .. } | RecordError::UnknownFormat { .. } | RecordError::Damaged { .. } => "unreadable",
            RecordError::Unclear { .. } => "unclear",
            RecordError::Contradiction { .. } => "contradiction",
            RecordError::Channel { .. } => "channel",
            RecordError::TimeAxis { .. } => "time",
            RecordError::Values { .. } => "values",
            _ => "record",
        };
    }
    if let Some(error) = error.downcast_ref() {
        return match error {
            IdentifyError::UnknownName { .. } => "name",
            IdentifyError::Fit { .. } => "fit",
            IdentifyError::Contradiction { .. } => "contradiction",
            IdentifyError::Record(error) => code(error),
            _ => "record",
        };
    }
    if let Some(error) = error.downcast_ref() {
        return match error {
            FrfError::Values { .. } => "values",
            FrfError::Mismatch { .. } => "contradiction",
            FrfError::TooFew { .. } | FrfError::Outside { .. } => "record",
            FrfError::NoFit { .. } => "fit",
            _ => "refused",
        };
    }
    error.source().map_or("refused", code)
}

/// Document of a refusal.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Refused<'a> {
    pub(crate) error: &'a Refusal,
}
