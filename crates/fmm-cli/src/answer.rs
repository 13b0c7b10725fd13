//! Answer of a command in every form in which it is given out.

use std::error::Error;

use clap::ValueEnum;
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

/// A record and the preferred fit, sample by sample.
///
/// ```
/// use fmm_cli::{FittedRecord, Host, answer};
///
/// let found = answer(["fmm", "compare", "--law", "coulomb_viscous", "--to", "5"], &Host::default())?;
/// let fits = found.fits().unwrap();
/// let [FittedRecord { unit, time, measured, fitted }] = &fits[..] else { panic!("one record") };
/// assert_eq!((unit.as_str(), time.len(), measured.len()), ("V", fitted.len(), fitted.len()));
/// # Ok::<(), fmm_cli::Refusal>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FittedRecord {
    /// Unit of the values.
    pub unit: String,
    /// Times (s).
    pub time: Vec<f64>,
    /// Measured values.
    pub measured: Vec<f64>,
    /// Values of the model, NaN where it says nothing.
    pub fitted: Vec<f64>,
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

    /// Samples of the records that were fitted and of the preferred fit; none of a command that fits no record.
    ///
    /// # Errors
    /// The reason why the model cannot be followed.
    fn fits(&self) -> Result<Vec<FittedRecord>, Box<dyn Error>> {
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
