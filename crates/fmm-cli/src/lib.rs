//! The program `fmm`: friction out of records, from a terminal.
//!
//! A thin face of the other crates: it reads arguments and files, shows how far it is, and writes text, JSON, figures
//! and pages; all mathematics is theirs. `fmm --help` lists the commands.
//!
//! [`run`] is the program as a function, [`answer`] the same for a [`Host`] that is no shell, and [`figure`] the one
//! place that draws.
//!
//! ```
//! # use std::process::ExitCode;
//! // What a shell would call as `fmm formats`.
//! assert_eq!(fmm_cli::run(["fmm", "formats"]), ExitCode::SUCCESS);
//! ```

mod answer;
mod backbone;
mod batch;
mod budget;
mod commands;
mod design;
pub mod figure;
mod files;
mod force;
mod frf;
mod host;
mod identify;
mod input;
mod lists;
mod output;
pub mod page;
mod posterior;
mod refusal;
mod report;
mod scenario;
#[cfg(test)]
mod schemas;
mod simulate;

pub use answer::{Answer, Detail, FittedRecord};
pub use commands::{answer, run};
pub use host::Host;
pub use refusal::Refusal;
