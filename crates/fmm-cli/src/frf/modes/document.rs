//! Modes for programs.

use fmm_frf::{Complex64, DiagramPole, FrequencyResponse, Mode, Residue, ShapePoint, StabilisationDiagram};
use serde::Serialize;

use super::Found;
use crate::answer::Detail;
use crate::frf::Measured;

/// Modes for programs; lists of a mode are as long as `responses`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Content<'a> {
    /// Files and estimator of the responses.
    origin: &'a str,
    /// Receptance, mobility or accelerance.
    form: String,
    /// Unit of the responses.
    unit: &'a str,
    /// Rate of an exponential window, which is in no result (1/s).
    decay_rate_per_s: f64,
    first_line_hz: f64,
    last_line_hz: f64,
    lines: usize,
    responses: Vec<OfResponse>,
    modes: Vec<OfMode>,
    /// χ² by its degrees of freedom, of the residuals by the uncertainties of the lines; none without these.
    reduced_chi_square: Option<f64>,
    /// Highest order of the diagram.
    order: usize,
    diagram: Vec<OfPole>,
    /// Measured and fitted lines of each response, with `--json=full`.
    curves: Option<Curves>,
    warnings: &'a [String],
}

/// A response, and what its fit has besides modes.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct OfResponse {
    /// Place and direction of the response, as in 3+Z.
    response: String,
    /// Place and direction of the force.
    reference: String,
    /// Root mean square of what the fit leaves, by that of the response.
    misfit: f64,
    /// Receptance of the modes above the band (m/N).
    upper_residual_m_per_n: Complex,
    /// Accelerance of the modes below the band (1/kg).
    lower_residual_per_kg: Complex,
}

#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct OfMode {
    natural_frequency_hz: Measured,
    damping_ratio: Measured,
    /// Pole of positive frequency (1/s).
    pole_per_s: Complex,
    /// 1 if all places move in phase or against it.
    phase_collinearity: f64,
    shape: Vec<Deflection>,
    residues: Vec<OfResidue>,
}

/// A place and its deflection by the largest.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Deflection {
    place: String,
    deflection: Measured,
}

/// Residue of the receptance (m/(N s)) with the standard uncertainties of its parts.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct OfResidue {
    real: Measured,
    imag: Measured,
}

/// A pole of the stabilisation diagram.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct OfPole {
    order: usize,
    natural_frequency_hz: f64,
    damping_ratio: f64,
    is_stable_in_frequency: bool,
    is_stable_in_damping: bool,
}

/// Lines of all responses.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Curves {
    frequencies_hz: Vec<f64>,
    /// One list a response, in the order of `responses`.
    fitted: Vec<Vec<Complex>>,
    measured: Vec<Vec<Complex>>,
}

#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Complex {
    real: f64,
    imag: f64,
}

impl From<Complex64> for Complex {
    fn from(value: Complex64) -> Self {
        Self { real: value.re, imag: value.im }
    }
}

impl From<&ShapePoint> for Deflection {
    fn from(point: &ShapePoint) -> Self {
        Self { place: point.place.to_string(), deflection: point.deflection.into() }
    }
}

impl From<&Residue> for OfResidue {
    fn from(residue: &Residue) -> Self {
        Self {
            real: Measured { value: residue.value.re, u: residue.real_uncertainty },
            imag: Measured { value: residue.value.im, u: residue.imaginary_uncertainty },
        }
    }
}

impl From<&Mode> for OfMode {
    fn from(mode: &Mode) -> Self {
        Self {
            natural_frequency_hz: mode.natural_frequency.into(),
            damping_ratio: mode.damping_ratio.into(),
            pole_per_s: mode.pole.value().into(),
            phase_collinearity: mode.phase_collinearity,
            shape: mode.shape.iter().map(Deflection::from).collect(),
            residues: mode.residues.iter().map(OfResidue::from).collect(),
        }
    }
}

impl From<&DiagramPole> for OfPole {
    fn from(pole: &DiagramPole) -> Self {
        Self {
            order: pole.order,
            natural_frequency_hz: pole.pole.natural_frequency(),
            damping_ratio: pole.pole.damping_ratio(),
            is_stable_in_frequency: pole.is_stable_in_frequency,
            is_stable_in_damping: pole.is_stable_in_damping,
        }
    }
}

fn diagram(diagram: &StabilisationDiagram) -> Vec<OfPole> {
    diagram.poles().iter().map(OfPole::from).collect()
}

impl<'a> Content<'a> {
    pub(super) fn of(found: &'a Found, detail: Detail) -> Self {
        let (measured, fit) = (&found.measured, &found.fit);
        let fitted = &fit.fitted()[0];
        let lines = fitted.frequencies();
        let (first, last) = (lines[0], lines[lines.len() - 1]);
        let rest = fit.misfits().iter().zip(fit.upper_residuals()).zip(fit.lower_residuals());
        let responses = measured.responses.iter().zip(rest).map(|(response, ((misfit, upper), lower))| OfResponse {
            response: response.response().to_string(),
            reference: response.reference().to_string(),
            misfit: *misfit,
            upper_residual_m_per_n: (*upper).into(),
            lower_residual_per_kg: (*lower).into(),
        });
        let values = |response: &FrequencyResponse| response.values().iter().map(|value| (*value).into()).collect();
        let inside = |response: &FrequencyResponse| response.within(first, last).as_ref().map_or(Vec::new(), values);
        let curves = (detail == Detail::Full).then(|| Curves {
            frequencies_hz: lines.to_vec(),
            fitted: fit.fitted().iter().map(values).collect(),
            measured: measured.responses.iter().map(|response| inside(response.values())).collect(),
        });
        Self {
            origin: &measured.origin,
            form: fitted.form().to_string(),
            unit: fitted.form().unit(),
            decay_rate_per_s: fitted.decay_rate(),
            first_line_hz: first,
            last_line_hz: last,
            lines: lines.len(),
            responses: responses.collect(),
            modes: fit.modes().iter().map(OfMode::from).collect(),
            reduced_chi_square: fit.reduced_chi_square(),
            order: fit.diagram().order(),
            diagram: diagram(fit.diagram()),
            curves,
            warnings: &found.warnings,
        }
    }
}
