//! Standard output and folders of figures.

use std::error::Error;
use std::fmt::Display;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::PathBuf;

use clap::Args;
use fmm_model::{Estimated, Rounded};

use crate::answer::{Answer, Detail, Document};
use crate::files::{self, create_folder};
use crate::refusal::{Kind, Refusal, Refused};

/// Form of a result: text or JSON.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct Form {
    /// Print one JSON document instead of text, also of an error; with =full, that of a fit holds measured and fitted
    /// curve and residuals
    #[arg(long, value_name = "DETAIL", num_args = 0..=1, require_equals = true, default_missing_value = "brief")]
    pub(crate) json: Option<Detail>,
}

/// Form of a result, with or without figures.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct Output {
    #[command(flatten)]
    pub(crate) form: Form,
    /// Write SVG figures into this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
}

/// Forms in which a result is wanted.
#[derive(Debug, Clone, Default)]
pub(crate) struct Wanted {
    pub(crate) output: Output,
    /// Page of HTML.
    pub(crate) report: Option<PathBuf>,
}

impl Wanted {
    /// Refuses folders and files that cannot be written, before work is done for them.
    pub(crate) fn check(&self) -> Result<(), Box<dyn Error>> {
        self.output.figures.as_deref().map(create_folder).transpose()?;
        let Some(path) = &self.report else { return Ok(()) };
        files::require_writable(path)?;
        let is_page =
            path.extension().is_some_and(|ending| ["html", "htm"].iter().any(|page| ending.eq_ignore_ascii_case(page)));
        if is_page {
            return Ok(());
        }
        let path = path.display();
        let what = format!(
            "--report writes a page of HTML, but {path} is called otherwise; give a name that ends in .html, which a \
             browser prints as PDF"
        );
        Err(Kind::Option.refusal(what).into())
    }

    /// Prints an answer, and writes its figures and its page.
    pub(crate) fn give_out(&self, answer: &dyn Answer) -> Result<(), Box<dyn Error>> {
        for remark in answer.remarks() {
            eprintln!("warning: {remark}");
        }
        if let Some(written) = answer.written() {
            eprintln!("{written}");
        }
        print(match self.output.form.json {
            Some(detail) => answer.document(detail)?,
            None => answer.text()?,
        })?;
        if let Some(folder) = &self.output.figures {
            let pictures = answer.pictures()?;
            for (name, svg) in &pictures {
                std::fs::write(folder.join(name), svg)?;
            }
            let names: Vec<&str> = pictures.iter().map(|(name, _)| name.trim_end_matches(".svg")).collect();
            let names = if let [name] = names[..] { name.to_owned() } else { format!("{{{}}}", names.join(",")) };
            eprintln!("figures: {}", folder.join(format!("{names}.svg")).display());
        }
        if let (Some(path), Some(page)) = (&self.report, self.report.as_ref().map_or(Ok(None), |_| answer.page())?) {
            std::fs::write(path, page).map_err(files::unwritable(path))?;
            eprintln!("report: {}", path.display());
        }
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

/// Prints the document of a refusal.
pub(crate) fn print_refusal(refusal: &Refusal) -> Result<(), Box<dyn Error>> {
    print(Document::new("error-1", Refused { error: refusal }).pretty()?)
}

/// Value and standard uncertainty for a document.
pub(crate) fn pair(estimated: Estimated) -> [f64; 2] {
    [estimated.value, estimated.uncertainty]
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
