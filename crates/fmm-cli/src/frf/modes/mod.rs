//! All modes at once: `fmm frf --modes FILES...`.

mod document;
mod figures;
mod source;
#[cfg(test)]
mod tests;

use std::error::Error;
use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use fmm_frf::{FrfError, ModalFit, ModalOptions, Mode};
use fmm_model::{Estimated, Rounded};
use fmm_record::uff::{Form, write};

use crate::answer::{Answer, Detail, Document};
use crate::files::require_writable;
use crate::host::Host;
use crate::refusal::Remedied;
pub(crate) use document::Content;
pub(crate) use source::Measured;

/// Share of the response that a fit may leave before it is said (1). Origin: chosen; that of one mode at one peak.
const MISFIT: f64 = 0.05;
/// χ² by its degrees of freedom above which the fit leaves more than noise (1). Origin: chosen; a hundred lines scatter
/// by 0.1.
const CHI_SQUARE: f64 = 1.5;

/// Choices for modes.
#[derive(Debug, Default, Args)]
pub(crate) struct Choices {
    /// Fit all modes to all lines at once: poles, damping ratios, shapes, with the stabilisation diagram. The files are
    /// trials, or hold measured responses: Universal Files of function type 4, or tables of frequency, real and
    /// imaginary part (or magnitude and phase)
    #[arg(long)]
    modes: bool,
    /// The files hold measured responses, although no name of a column says so
    #[arg(long, requires = "modes")]
    responses: bool,
    /// Number of averages behind the coherence in a file of responses, from which the uncertainties of the lines follow
    #[arg(long, value_name = "N", requires = "modes")]
    averages: Option<f64>,
    /// Fit lines from LOW to HIGH (Hz) only
    #[arg(long, num_args = 2, value_names = ["LOW", "HIGH"], requires = "modes")]
    band: Option<Vec<f64>>,
    /// Highest order of the stabilisation diagram: how many poles the band may hold
    #[arg(long, value_name = "N", requires = "modes")]
    order: Option<usize>,
    /// Fit the stable pole nearest to this frequency instead of all that are stable; give it once for each mode
    #[arg(long, value_name = "HZ", requires = "modes")]
    near: Vec<f64>,
    /// Write the responses that were fitted into this Universal File, as data sets 58
    #[arg(long, value_name = "FILE", requires = "modes")]
    save_responses: Option<PathBuf>,
}

impl Choices {
    pub(crate) fn are_wanted(&self) -> bool {
        self.modes
    }

    /// Fits the modes of what was measured.
    pub(crate) fn fit(&self, measured: Measured, host: &Host<'_>) -> Result<Found, Box<dyn Error>> {
        let mut options = ModalOptions::default();
        if let Some(order) = self.order {
            options = options.up_to_order(order);
        }
        if !self.near.is_empty() {
            options = options.nearest_to(self.near.clone());
        }
        match (self.band.as_deref(), measured.usable) {
            (Some([low, high]), _) => options = options.within(*low, *high),
            (_, Some(usable)) => options = options.within(0.0, usable),
            _ => {}
        }
        let fitted = host.while_busy("fitting modes", || ModalFit::of(&measured.responses, &options))?;
        let fit = fitted.map_err(|error| remedied(error, &options))?;
        let mut written = None;
        if let Some(path) = &self.save_responses {
            require_writable(path)?;
            let sets = measured.responses.iter().map(fmm_frf::MeasuredResponse::data_set);
            write(path, &sets.collect::<Result<Vec<_>, _>>()?, Form::Ascii)?;
            written = Some(format!("responses: {}", path.display()));
        }
        let mut warnings = measured.warnings.clone();
        warnings.extend(doubts(&measured, &fit));
        Ok(Found { measured, fit, warnings, written })
    }
}

/// The error with what to do about it.
fn remedied(error: FrfError, options: &ModalOptions) -> Box<dyn Error> {
    let remedy = match &error {
        FrfError::TooFew { .. } => "give a lower --order, or measure longer",
        FrfError::NoFit { .. } if *options == ModalOptions::default() => {
            "give the --band of the modes, or a higher --order"
        }
        FrfError::NoFit { .. } => "give another --band, another --order, or other frequencies with --near",
        FrfError::Outside { .. } => "give a --band that has lines",
        FrfError::Values { .. } => "leave the response out, or give a --band without these lines",
        _ => return error.into(),
    };
    Remedied::new(error, remedy).into()
}

/// Doubts about the fit.
fn doubts(measured: &Measured, fit: &ModalFit) -> Vec<String> {
    let mut doubts = Vec::new();
    for (response, misfit) in measured.responses.iter().zip(fit.misfits()).filter(|(_, misfit)| **misfit > MISFIT) {
        let (place, share) = (response.response(), 100.0 * misfit);
        let which = if place.node == 0 { "the response".to_owned() } else { format!("the response at {place}") };
        doubts.push(format!(
            "the modes leave {share:.0} % of {which}: a mode may be missing, or the structure is not linear"
        ));
    }
    if let Some(chi_square) = fit.reduced_chi_square().filter(|square| *square > CHI_SQUARE) {
        doubts.push(format!(
            "the modes leave {:.1} times what the uncertainties of the lines say; those of the modes have grown by as \
             much",
            chi_square.sqrt()
        ));
    }
    doubts
}

/// Responses and their modes.
pub(crate) struct Found {
    measured: Measured,
    fit: ModalFit,
    warnings: Vec<String>,
    written: Option<String>,
}

/// A value and its expanded uncertainty.
fn expanded(found: Estimated) -> String {
    Rounded::new(found.value, Some(2.0 * found.uncertainty)).to_string()
}

impl Found {
    fn report(&self) -> Result<String, std::fmt::Error> {
        let mut text = String::new();
        let Measured { origin, responses, .. } = &self.measured;
        let fitted = &self.fit.fitted()[0];
        let (lines, form) = (fitted.frequencies(), fitted.form());
        let (first, last) = (lines[0], lines[lines.len() - 1]);
        writeln!(text, "{origin}")?;
        let count = responses.len();
        let responses = if count == 1 { "1 response".to_owned() } else { format!("{count} responses") };
        let order = self.fit.diagram().order();
        writeln!(
            text,
            "{responses}, {form}: {} lines from {first:.6} Hz to {last:.6} Hz, orders 1 to {order}",
            lines.len()
        )?;
        let largest = self.fit.misfits().iter().copied().fold(0.0, f64::max);
        write!(text, "the modes leave {} % of a response at most", Rounded::significant(100.0 * largest, 2))?;
        match self.fit.reduced_chi_square() {
            Some(square) => writeln!(text, "; χ²/ν = {square:.3} by the uncertainties of the lines")?,
            None => writeln!(text, "; uncertainties are those of the scatter about the fit")?,
        }
        writeln!(text, "\n{:>4}  {:<28} {:<28} {:>8}", "mode", "natural frequency / Hz", "damping ratio", "in phase")?;
        for (index, mode) in self.fit.modes().iter().enumerate() {
            let (frequency, ratio) = (expanded(mode.natural_frequency), expanded(mode.damping_ratio));
            writeln!(text, "{:>4}  {frequency:<28} {ratio:<28} {:>8.4}", index + 1, mode.phase_collinearity)?;
        }
        writeln!(text, "U = 2 u behind ±; in phase: 1 for a real shape")?;
        if self.fit.modes().iter().any(|mode| mode.shape.len() > 1) {
            writeln!(text, "\nshapes, by their largest deflection, ± U")?;
            for (index, mode) in self.fit.modes().iter().enumerate() {
                writeln!(text, "{:>4}  {}", index + 1, shape(mode))?;
            }
        }
        for warning in &self.warnings {
            writeln!(text, "warning: {warning}")?;
        }
        Ok(text)
    }
}

/// The points of a shape in a line.
fn shape(mode: &Mode) -> String {
    let point = |point: &fmm_frf::ShapePoint| format!("{} {}", point.place, expanded(point.deflection));
    mode.shape.iter().map(point).collect::<Vec<_>>().join(", ")
}

impl Answer for Found {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        Ok(self.report()?.trim_end().to_owned())
    }

    fn document(&self, detail: Detail) -> Result<String, Box<dyn Error>> {
        Document::new("modes-1", Content::of(self, detail)).compact()
    }

    fn pictures(&self) -> Result<Vec<(String, String)>, Box<dyn Error>> {
        Ok(figures::pictures(&self.measured.responses, &self.fit))
    }

    fn written(&self) -> Option<String> {
        self.written.clone()
    }
}
