//! Refusal of a command: kinds of errors to act on, and what is put around an error.

use std::error::Error;
use std::fmt::Display;

use fmm_fit::FitError;
use fmm_frf::FrfError;
use fmm_identify::IdentifyError;
use fmm_record::RecordError;
use fmm_sim::SimulationError;
use fmm_uq::UncertaintyError;
use serde::Serialize;

/// Why a command gave no answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Refusal {
    /// Kind of the refusal, to act on: `usage`, `option`, `document`, `unreadable`, `unwritable`, `unclear`,
    /// `contradiction`, `channel`, `time`, `values`, `record`, `name`, `fit`, `simulation`, `uncertainty`, `stopped` or
    /// `refused`.
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
        Self { code: code(error).unwrap_or("refused"), message, remedy }
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

/// Kind of a refusal by the program itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// There is no such channel, or several may be meant.
    Channel,
    /// Two statements exclude each other.
    Contradiction,
    /// A scenario, a measurement, a plan or a manifest that is no such thing.
    Document,
    /// There is no law or parameter of this name.
    Name,
    /// The value of an option cannot be.
    Option,
    /// The host stopped the command.
    Stopped,
    /// The quantity that was measured, or its unit, is not said.
    Unclear,
    /// A file or a folder cannot be read.
    Unreadable,
    /// A file or a folder cannot be written.
    Unwritable,
}

impl Kind {
    const fn code(self) -> &'static str {
        match self {
            Self::Channel => "channel",
            Self::Contradiction => "contradiction",
            Self::Document => "document",
            Self::Name => "name",
            Self::Option => "option",
            Self::Stopped => "stopped",
            Self::Unclear => "unclear",
            Self::Unreadable => "unreadable",
            Self::Unwritable => "unwritable",
        }
    }

    /// A refusal of this kind.
    pub(crate) fn refusal(self, message: impl Into<String>) -> OfKind {
        OfKind { kind: self, error: message.into().into() }
    }

    /// An error of this kind unless its cause has one of its own.
    pub(crate) fn unless_known(self, error: impl Into<Box<dyn Error>>) -> OfKind {
        OfKind { kind: self, error: error.into() }
    }
}

/// An error of a kind that it does not have by its type.
#[derive(Debug, thiserror::Error)]
#[error("{error}")]
pub(crate) struct OfKind {
    kind: Kind,
    error: Box<dyn Error>,
}

/// An error with the place where it is, such as a file.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {error}")]
pub(crate) struct Placed {
    place: String,
    error: Box<dyn Error>,
}

/// Puts a place before an error.
pub(crate) fn placed<E: Into<Box<dyn Error>>>(place: impl Display) -> impl Fn(E) -> Placed {
    move |error| Placed { place: place.to_string(), error: error.into() }
}

/// Kind of an error, by the first cause that has one.
fn code(error: &(dyn Error + 'static)) -> Option<&'static str> {
    if let Some(Placed { error, .. }) = error.downcast_ref() {
        return code(&**error);
    }
    if let Some(OfKind { kind, error }) = error.downcast_ref() {
        return code(&**error).or(Some(kind.code()));
    }
    if let Some(error) = error.downcast_ref() {
        return Some(match error {
            RecordError::Io { .. } | RecordError::UnknownFormat { .. } | RecordError::Damaged { .. } => "unreadable",
            RecordError::Unclear { .. } => "unclear",
            RecordError::Contradiction { .. } => "contradiction",
            RecordError::Channel { .. } => "channel",
            RecordError::TimeAxis { .. } => "time",
            RecordError::Values { .. } => "values",
            _ => "record",
        });
    }
    if let Some(error) = error.downcast_ref() {
        return Some(match error {
            IdentifyError::UnknownName { .. } => "name",
            IdentifyError::Fit { .. } => "fit",
            IdentifyError::Contradiction { .. } => "contradiction",
            IdentifyError::Record(error) => return code(error),
            _ => "record",
        });
    }
    if let Some(error) = error.downcast_ref() {
        return match error {
            FrfError::Values { .. } => Some("values"),
            FrfError::Mismatch { .. } => Some("contradiction"),
            FrfError::TooFew { .. } | FrfError::Outside { .. } => Some("record"),
            FrfError::NoFit { .. } => Some("fit"),
            _ => None,
        };
    }
    if error.is::<SimulationError>() {
        return Some("simulation");
    }
    if error.is::<FitError>() {
        return Some("fit");
    }
    // What is wrong with an input is a fault of where it stands.
    if let Some(error) = error.downcast_ref() {
        return (!matches!(error, UncertaintyError::Invalid { .. })).then_some("uncertainty");
    }
    error.source().and_then(code)
}

/// Document of a refusal.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Refused<'a> {
    pub(crate) error: &'a Refusal,
}

#[cfg(test)]
mod tests {
    use crate::{Host, answer};

    /// Code of the refusal of a line, in which `file` is one of this content.
    fn code(line: &str, content: &str) -> &'static str {
        let host = Host::default().with_file("file", content.into()).with_file("file.json", content.into());
        let arguments = ["fmm"].into_iter().chain(line.split(' '));
        answer(arguments, &host).err().unwrap_or_else(|| panic!("{line} has an answer")).code
    }

    #[test]
    fn refusals_say_their_kind() {
        let run = include_str!("../../../examples/data/flexure/run_1.csv");
        let scenario = r#"{"oscillator": {"mass": 1, "stiffness": 100}, "law": {"coulomb": {"mu": 0.1}},
            "normal_load": 1, "initial": {"position": 0.01}, "duration": 1}"#;
        let budget = r#"{"input": [{"name": "a", "value": 1, "u": 0.1}], "result": [{"name": "y", "formula": "2*b"}]}"#;
        let lines = [
            ("identify missing.csv", "", "unreadable"),
            ("identify docs", "", "unreadable"),
            ("identify file --mass 1 --stiffness 2", run, "contradiction"),
            ("identify file file --normal-loads 1", run, "contradiction"),
            ("identify file --law coulomb --hold mu", run, "option"),
            ("identify file --law coulomb --hold dahl.exponent=1", run, "name"),
            ("identify file --law coulom", run, "name"),
            ("identify file --mass -1", run, "option"),
            ("identify file --law coulomb --to 0.001", run, "record"),
            ("compare file --time-limit 1", run, "contradiction"),
            ("simulate missing.json", "", "unreadable"),
            ("simulate file.json", "{", "document"),
            ("simulate file.json", &scenario.replace("0.1", "-0.1"), "document"),
            ("simulate file.json --record no_folder/record.csv", scenario, "unwritable"),
            ("budget file.json", "{}", "document"),
            ("budget file.json", budget, "document"),
            ("design file.json", r#"{"machine": 1}"#, "document"),
            ("force file", "t,x\n0,1\n1,2\n2,3\n", "channel"),
            ("frf file", run, "unclear"),
            ("batch --manifest file", "record\na\n", "document"),
        ];
        let found = lines.map(|(line, content, _)| (line, code(line, content)));
        assert_eq!(found, lines.map(|(line, _, expected)| (line, expected)));
    }
}
