//! Destinations of results: standard output, and folders of figures.

use std::error::Error;
use std::fmt::Display;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::Args;

/// How a result is given out.
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
        let Some(folder) = &self.figures else { return Ok(None) };
        std::fs::create_dir_all(folder).map_err(|error| format!("cannot create {}: {error}", folder.display()))?;
        Ok(Some(folder))
    }
}

/// Refuses a path at which no file can be, before work is done for it.
pub(crate) fn require_writable(path: &Path) -> Result<(), String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if path.is_dir() {
        return Err(format!("cannot write {}: it is a folder; give the name of a file", path.display()));
    }
    if folder.is_dir() {
        Ok(())
    } else {
        Err(format!("cannot write {}: there is no folder {}", path.display(), folder.display()))
    }
}

/// Says which figures were written.
pub(crate) fn drawn(folder: &Path, names: &str) {
    eprintln!("figures: {}", folder.join(names).display());
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

/// Writes a file so that at no time there is a part of it.
pub(crate) fn write_at_once(path: &Path, text: &str) -> Result<(), String> {
    // Another process may write the same, and then it is the same.
    let mut part = path.as_os_str().to_owned();
    part.push(format!(".part-{}", std::process::id()));
    let unwritable = |error| format!("cannot write {}: {error}", path.display());
    std::fs::write(&part, text).map_err(unwritable)?;
    std::fs::rename(&part, path).map_err(unwritable)
}
