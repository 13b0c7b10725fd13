//! Standard output, folders of figures, and progress.

use std::error::Error;
use std::fmt::Display;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use fmm_model::{Estimated, Rounded};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use crate::files::create_folder;

/// Form of a result: text or JSON, with or without figures.
#[derive(Debug, Args)]
pub(crate) struct Output {
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Write SVG figures into this folder
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

impl Output {
    /// The folder for figures, which exists, if they are asked for.
    pub(crate) fn folder(&self) -> Result<Option<&Path>, Box<dyn Error>> {
        self.figures.as_deref().map(create_folder).transpose()?;
        Ok(self.figures.as_deref())
    }

    /// Writes pictures (name of the file and SVG), if they are asked for, and says so by their `names`.
    pub(crate) fn draw<N: AsRef<Path>>(
        &self,
        names: &str,
        pictures: impl FnOnce() -> Result<Vec<(N, String)>, Box<dyn Error>>,
    ) -> Result<(), Box<dyn Error>> {
        let Some(folder) = self.folder()? else { return Ok(()) };
        for (name, svg) in pictures()? {
            std::fs::write(folder.join(name), svg)?;
        }
        eprintln!("figures: {}", folder.join(names).display());
        Ok(())
    }
}

/// Prints a result and the end of its line.
pub(crate) fn print(result: impl Display) -> Result<(), Box<dyn Error>> {
    let mut out = BufWriter::new(std::io::stdout().lock());
    match writeln!(out, "{result}").and_then(|()| out.flush()) {
        // Whoever reads may stop reading.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => Ok(written?),
    }
}

/// Value and standard uncertainty for a document.
pub(crate) fn pair(estimated: Estimated) -> [f64; 2] {
    [estimated.value, estimated.uncertainty]
}

/// Prints a document of JSON.
pub(crate) fn print_json(document: &impl Serialize) -> Result<(), Box<dyn Error>> {
    print(serde_json::to_string_pretty(document)?)
}

/// Result of `work` of unknown length, while a line on standard error says `what` it is.
pub(crate) fn while_busy<T>(what: &str, work: impl FnOnce() -> T) -> Result<T, Box<dyn Error>> {
    let bar = spinner()?;
    bar.set_message(format!("{what} …"));
    let done = work();
    bar.finish_and_clear();
    Ok(done)
}

/// A line on standard error that turns while work of unknown length is done.
pub(crate) fn spinner() -> Result<ProgressBar, Box<dyn Error>> {
    let bar = ProgressBar::new_spinner().with_style(ProgressStyle::with_template("{spinner} {msg}")?);
    bar.enable_steady_tick(Duration::from_millis(100));
    Ok(bar)
}

/// An uncertainty to the places that one of its size deserves.
pub(crate) fn of_size(uncertainty: f64) -> String {
    let text = Rounded::new(0.0, Some(uncertainty)).to_string();
    // Of "(0.0 ± 1.2)e-7" what stands behind the sign.
    text.split_once(" ± ").map_or(text.clone(), |(_, size)| size.replace(')', ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uncertainties_have_two_digits() {
        assert_eq!(of_size(0.012_345), "0.012");
        assert_eq!(of_size(1.234e-7), "1.2e-7");
        assert_eq!(of_size(271.0), "270");
    }
}
