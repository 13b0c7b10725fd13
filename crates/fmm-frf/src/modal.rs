//! Natural frequency and damping of a mode, by a rational fraction fit of order 2.

use std::array;
use std::f64::consts::TAU;
use std::fmt;

use fmm_fit::{Derivatives, EvaluationError, LinearRegression, Options, Residuals, Weighting, solve};
use fmm_model::{Estimated, Parameter};
use fmm_record::Complex64;

use crate::error::FrfError;
use crate::response::FrequencyResponse;

const NAME: &str = "rational fraction fit";

/// Background that the numerator of a [`RationalFit`] allows for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Background {
    /// Nothing: one degree of freedom, n₁ = n₂ = 0.
    #[default]
    None,
    /// Other modes, as long as they are far: n₂ is their flexibility, and n₁ makes the modal constant complex.
    OtherModes,
}

/// A mode as the quotient of two polynomials, fitted to the complex values: its natural frequency and damping, with the
/// damping of an exponential window taken out.
///
/// ```text
/// H(s) = sᵖ (n₀ + n₁ s + n₂ s²)/(s² + q₁ s + q₀)                                                       (1)
/// pole s = −ζω₀ ± iω₀√(1 − ζ²),   f₀ = ω₀/2π
/// ```
///
/// p is 0, 1 or 2 for receptance, mobility and accelerance, so that no conversion weighs the lines; s is iω, or σ + iω
/// behind an exponential window, whose damping is thus never in the result. The sum of |H_measured − H|² over the lines
/// is least (an output error with equal weights), found by Gauss-Newton steps from the linear fit of H·denominator =
/// numerator with iterated weights.
///
/// Uncertainties are those of the scatter of the lines about the fit. They do not contain errors that all lines share:
/// leakage, a delay between the channels, other modes in the band.
///
/// ```
/// use fmm_frf::{Background, RationalFit, ResponseForm, SingleDegreeOfFreedom};
///
/// let lines: Vec<f64> = (1..100).map(|i| f64::from(i) / 16.0).collect();
/// let machine = SingleDegreeOfFreedom::new(10.391, 8.0, 1982.0)?;
/// let response = machine.frequency_response(ResponseForm::Mobility, &lines)?;
/// let fit = RationalFit::of(&response, 1.0, 4.0, Background::None)?;
/// assert!((fit.damping_ratio.value - 0.027_872_73).abs() < 1e-8);
/// let [mass, damping, stiffness] = fit.machine.expect("there is no background");
/// assert!((mass.value - 10.391).abs() < 1e-9 && (damping.value - 8.0).abs() < 1e-9);
/// assert!((stiffness.value - 1982.0).abs() < 1e-7);
/// assert!((fit.value(2.5) - machine.response(ResponseForm::Mobility, 2.5)?).norm() < 1e-12);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # References
/// C. K. Sanathanan, J. Koerner, "Transfer function synthesis as a ratio of two complex polynomials", IEEE Transactions
/// on Automatic Control 8 (1963) 56 (the iterated weights).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RationalFit {
    /// f₀, undamped natural frequency (Hz).
    pub natural_frequency: Estimated,
    /// ζ, damping ratio (1).
    pub damping_ratio: Estimated,
    /// Mass (kg), viscous coefficient (N s/m) and stiffness (N/m) of the machine with this mode alone, if there is no
    /// background; of the driving point if it is a mode of many.
    pub machine: Option<[Estimated; 3]>,
    /// Root mean square (unit of the response given) of the deviation from the fit at a line.
    pub residual: f64,
    curve: Curve,
}

/// A fitted quotient: q₀, q₁ and the coefficients of the numerator, for s in units of `unit` (rad/s) and H in those of
/// `size`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Curve {
    denominator: [f64; 2],
    numerator: [f64; 3],
    form: i32,
    unit: f64,
    size: f64,
    decay_rate: f64,
}

impl RationalFit {
    /// Fits the lines of `response` from `low` to `high` (Hz); at least three, or with a background four.
    ///
    /// # Errors
    /// [`FrfError::Outside`] for a band outside the response, [`FrfError::TooFew`] for fewer lines, and
    /// [`FrfError::NoFit`] if the lines show no mode or do not determine it.
    pub fn of(response: &FrequencyResponse, low: f64, high: f64, background: Background) -> Result<Self, FrfError> {
        let band = Band::of(response, low, high, if background == Background::None { 3 } else { 4 })?;
        let form = i32::from(response.form().derivatives());
        match background {
            Background::None => Fitting::<3>::new(band, form).fit(),
            Background::OtherModes => Fitting::<5>::new(band, form).fit(),
        }
    }

    /// The fitted response at `frequency` (Hz), in the form and with the window of the response given.
    pub fn value(&self, frequency: f64) -> Complex64 {
        let Curve { denominator: [q0, q1], numerator: [n0, n1, n2], form, unit, size, decay_rate } = self.curve;
        let s = Complex64::new(decay_rate, TAU * frequency) / unit;
        s.powi(form) * (n0 + s * (n1 + s * n2)) / (q0 + s * (q1 + s)) * size
    }
}

/// Text such as `f₀ = 2.1979(4) Hz, ζ = 0.0280(2)`.
impl fmt::Display for RationalFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "f₀ = {} Hz, ζ = {}", self.natural_frequency, self.damping_ratio)
    }
}

/// A fit of P unknowns: q₀, q₁ and P − 2 coefficients of the numerator; s is in units of the band's, H in that of its
/// highest line.
struct Fitting<const P: usize> {
    band: Band,
    form: i32,
    size: f64,
    parameters: [Parameter; P],
}

impl<const P: usize> Fitting<P> {
    fn new(band: Band, form: i32) -> Self {
        let size = band.values[band.highest].norm();
        let parameters = array::from_fn(|j| Parameter::named(format!("unknown_{j}"), "x", "1"));
        Self { band, form, size, parameters }
    }

    fn fit(&self) -> Result<RationalFit, FrfError> {
        let Band { unit, low, high, decay_rate, .. } = self.band;
        let undetermined = || FrfError::undetermined(NAME, self.band.values.len());
        let none = || FrfError::no_mode(NAME, low, high);
        let unsettled = || {
            let advice = "a narrower band around one resonance may help";
            FrfError::NoFit { what: format!("the {NAME} did not settle; {advice}") }
        };
        let start = self.start().ok_or_else(undetermined)?;
        let fit = solve(self, &start, &Options::default().with_jacobian_check(false));
        let fit = fit.ok().filter(|fit| fit.outcome().is_success() && fit.null_directions().is_empty());
        let fit = fit.ok_or_else(unsettled)?;
        let measured = |value: f64, slopes: [(usize, f64); 2]| {
            let mut gradient = [0.0; P];
            for (at, slope) in slopes {
                gradient[at] += slope;
            }
            let found = fit.predict(value, &gradient).ok_or_else(undetermined)?;
            Ok::<_, FrfError>(Estimated::new(value, found.standard_uncertainty()))
        };
        let (q0, q1) = (fit.values()[0], fit.values()[1]);
        if !(q0 > 0.0 && q0.is_finite() && q1.is_finite()) {
            return Err(none());
        }
        // The lines were taken at their true s, so that there is no window to take out.
        let (root, hertz) = (q0.sqrt(), unit / TAU);
        let ratio = q1 / (2.0 * root);
        let natural_frequency = measured(hertz * root, [(0, hertz * 0.5 / root), (1, 0.0)])?;
        let damping_ratio = measured(ratio, [(0, -0.5 * ratio / q0), (1, 0.5 / root)])?;
        let machine = if P == 3 {
            let n0 = fit.values()[2];
            // H = (s/unit)ᵖ size n₀/(…) = sᵖ (1/m)/(…), so that m = unit^(p − 2)/(n₀ size).
            let mass = unit.powi(self.form - 2) / (n0 * self.size);
            if !(mass.is_finite() && mass > 0.0) {
                return Err(none());
            }
            let (damping, stiffness) = (mass * unit, mass * unit * unit);
            Some([
                measured(mass, [(2, -mass / n0), (0, 0.0)])?,
                measured(damping * q1, [(2, -damping * q1 / n0), (1, damping)])?,
                measured(stiffness * q0, [(2, -stiffness * q0 / n0), (0, stiffness)])?,
            ])
        } else {
            None
        };
        let mut numerator = [0.0; 3];
        numerator.iter_mut().zip(&fit.values()[2..]).for_each(|(to, from)| *to = *from);
        let (form, size) = (self.form, self.size);
        let curve = Curve { denominator: [q0, q1], numerator, form, unit, size, decay_rate };
        let residual = size * (fit.sum_of_squares() / self.band.values.len() as f64).sqrt();
        Ok(RationalFit { natural_frequency, damping_ratio, machine, residual, curve })
    }

    /// s, sᵖ and the measured value of each line.
    fn lines(&self) -> impl Iterator<Item = (Complex64, Complex64, Complex64)> + '_ {
        let sigma = self.band.decay_rate / self.band.unit;
        self.band.ratios.iter().zip(&self.band.values).map(move |(&ratio, value)| {
            let s = Complex64::new(sigma, ratio);
            (s, s.powi(self.form), value / self.size)
        })
    }

    /// The linear fit with weights of its own denominator, iterated.
    fn start(&self) -> Option<[f64; P]> {
        const ITERATIONS: usize = 10;
        let mut parameters = [0.0; P];
        for iteration in 0..ITERATIONS {
            // A line is a complex equation, which is two real ones.
            let (mut columns, mut right) = ([(); P].map(|()| Vec::new()), Vec::new());
            for (s, form, value) in self.lines() {
                let denominator = s * s + s * parameters[1] + parameters[0];
                let weight = if iteration == 0 { 1.0 } else { denominator.norm().recip() };
                if weight.is_finite() {
                    let powers = [Complex64::ONE, s, s * s];
                    for (i, column) in columns.iter_mut().enumerate() {
                        let entry = if i < 2 { value * powers[i] } else { -form * powers[i - 2] } * weight;
                        column.extend([entry.re, entry.im]);
                    }
                    let entry = -value * s * s * weight;
                    right.extend([entry.re, entry.im]);
                }
            }
            let named = columns.each_ref().map(|column| ("unknown", column.as_slice()));
            let found = LinearRegression::fit(&named, &right, Weighting::Equal).ok()?;
            if !found.null_directions().is_empty() {
                return None;
            }
            parameters.copy_from_slice(found.coefficients());
        }
        Some(parameters)
    }
}

/// Residuals H − H_measured, real and imaginary part of each line.
impl<const P: usize> Residuals for Fitting<P> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        2 * self.band.values.len()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let mut jacobian = jacobian;
        for (line, (s, form, value)) in self.lines().enumerate() {
            let denominator = s * s + s * p[1] + p[0];
            let numerator = p[2..].iter().rev().fold(Complex64::ZERO, |sum, n| sum * s + n);
            let model = form * numerator / denominator;
            if !model.is_finite() {
                return Err(EvaluationError::message("no such model"));
            }
            let residual = model - value;
            [residuals[2 * line], residuals[2 * line + 1]] = [residual.re, residual.im];
            let powers = [Complex64::ONE, s, s * s];
            let slope = |i: usize| if i < 2 { -model * powers[i] } else { form * powers[i - 2] } / denominator;
            for (i, column) in
                jacobian.iter_mut().flat_map(|jacobian| jacobian.chunks_exact_mut(self.len())).enumerate()
            {
                let slope = slope(i);
                [column[2 * line], column[2 * line + 1]] = [slope.re, slope.im];
            }
        }
        Ok(())
    }

    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}

/// Lines of a band in one form, without the line at zero frequency.
#[derive(Debug, Clone)]
struct Band {
    /// Angular frequencies by that of the highest line (1).
    ratios: Vec<f64>,
    values: Vec<Complex64>,
    /// Angular frequency (rad/s) of the highest line.
    unit: f64,
    /// Index of the line of largest magnitude.
    highest: usize,
    decay_rate: f64,
    low: f64,
    high: f64,
}

impl Band {
    /// The lines of `response` from `low` to `high` (Hz), at least `needed` of them.
    fn of(response: &FrequencyResponse, low: f64, high: f64, needed: usize) -> Result<Self, FrfError> {
        let lines = response.within(low, high)?.without_zero_frequency();
        let found = lines.frequencies().len();
        let magnitudes = lines.values().iter().map(|value| value.norm()).enumerate();
        let highest = magnitudes.reduce(|best, line| if line.1 > best.1 { line } else { best });
        let Some((highest, magnitude)) = highest.filter(|_| found >= needed) else {
            return Err(FrfError::too_few_points(needed, found));
        };
        if magnitude == 0.0 {
            return Err(FrfError::no_mode("fit of a mode", low, high));
        }
        let unit = TAU * lines.frequencies()[highest];
        let ratios = lines.frequencies().iter().map(|frequency| TAU * frequency / unit).collect();
        let values = lines.values().to_vec();
        Ok(Self { ratios, values, unit, highest, decay_rate: lines.decay_rate(), low, high })
    }
}
