//! Natural frequency and damping of a mode, by a rational fraction fit of order 2.

use std::f64::consts::TAU;
use std::fmt;

use fmm_model::Estimated;
use fmm_record::Complex64;

use crate::error::FrfError;
use crate::least_squares::{Equations, Solution, minimise, variance_of};
use crate::response::FrequencyResponse;

const NAME: &str = "rational fraction fit";

/// Natural frequency and damping of a mode, with the damping of an exponential window taken out.
///
/// ```text
/// pole s = −ζω₀ ± iω₀√(1 − ζ²),   f₀ = ω₀/2π
/// ```
///
/// Uncertainties are those of the scatter of the lines about the fit. They do not contain errors that all lines share:
/// leakage, a delay between the channels, other modes in the band.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Mode {
    /// f₀, undamped natural frequency (Hz).
    pub natural_frequency: Estimated,
    /// ζ, damping ratio (1).
    pub damping_ratio: Estimated,
}

impl Mode {
    /// The mode of s² + q₁ s + q₀ with the covariance of (q₀, q₁), both in units of powers of `unit` (rad/s); `None` if
    /// it does not oscillate.
    fn new([q0, q1]: [f64; 2], covariance: &[[f64; 2]; 2], unit: f64) -> Option<Self> {
        if !(q0 > 0.0 && q0.is_finite() && q1.is_finite()) {
            return None;
        }
        let root = q0.sqrt();
        let ratio = q1 / (2.0 * root);
        // Gradients with respect to (q₀, q₁).
        let (of_frequency, of_ratio) = ([0.5 / root, 0.0], [-0.5 * ratio / q0, 0.5 / root]);
        let hertz = unit / TAU;
        Some(Self {
            natural_frequency: Estimated::new(hertz * root, hertz * variance_of(of_frequency, covariance).sqrt()),
            damping_ratio: Estimated::new(ratio, variance_of(of_ratio, covariance).sqrt()),
        })
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "f₀ = {} Hz, ζ = {}", self.natural_frequency, self.damping_ratio)
    }
}

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

/// A mode as the quotient of two polynomials, fitted to the complex values.
///
/// ```text
/// H(s) = sᵖ (n₀ + n₁ s + n₂ s²)/(s² + q₁ s + q₀)                                                       (1)
/// ```
///
/// p is 0, 1 or 2 for receptance, mobility and accelerance, so that no conversion weighs the lines; s is iω, or σ + iω
/// behind an exponential window, whose damping is thus never in the result. The sum of |H_measured − H|² over the lines
/// is least (an output error with equal weights), found by Gauss-Newton steps from the linear fit of H·denominator =
/// numerator with iterated weights.
///
/// ```
/// use fmm_frf::{Background, RationalFit, ResponseForm, SingleDegreeOfFreedom};
///
/// let lines: Vec<f64> = (1..100).map(|i| f64::from(i) / 16.0).collect();
/// let machine = SingleDegreeOfFreedom::new(10.391, 8.0, 1982.0)?;
/// let response = machine.frequency_response(ResponseForm::Mobility, &lines)?;
/// let fit = RationalFit::of(&response, 1.0, 4.0, Background::None)?;
/// assert!((fit.mode.damping_ratio.value - 0.027_872_73).abs() < 1e-8);
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
    /// Natural frequency and damping.
    pub mode: Mode,
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

/// A fit of P unknowns: q₀, q₁ and P − 2 coefficients of the numerator; s is in units of the band's, H in that of its
/// highest line.
struct Fitting<const P: usize> {
    band: Band,
    form: i32,
    size: f64,
}

impl<const P: usize> Fitting<P> {
    fn new(band: Band, form: i32) -> Self {
        let size = band.values[band.highest].norm();
        Self { band, form, size }
    }

    fn fit(&self) -> Result<RationalFit, FrfError> {
        let Band { unit, low, high, .. } = self.band;
        let undetermined = || FrfError::undetermined(NAME, self.band.values.len());
        let none = || FrfError::no_mode(NAME, low, high);
        let unsettled = || {
            let advice = "a narrower band around one resonance may help";
            FrfError::NoFit { what: format!("the {NAME} did not settle; {advice}") }
        };
        let start = self.start().ok_or_else(undetermined)?;
        // A line is a complex equation, which is two real ones.
        let minimum = minimise(start, 2 * self.band.values.len(), |parameters| self.linearise(parameters));
        let Solution { values: parameters, covariance, sum_of_squares } = minimum.ok_or_else(unsettled)?;
        let covariance = covariance.ok_or_else(undetermined)?;
        let (q0, q1) = (parameters[0], parameters[1]);
        let of_mode = [[covariance[0][0], covariance[0][1]], [covariance[1][0], covariance[1][1]]];
        // The lines were taken at their true s, so that there is no window to take out.
        let mode = Mode::new([q0, q1], &of_mode, unit).ok_or_else(none)?;
        let machine = if P == 3 {
            let n0 = parameters[2];
            // H = (s/unit)ᵖ size n₀/(…) = sᵖ (1/m)/(…), so that m = unit^(p − 2)/(n₀ size).
            let mass = unit.powi(self.form - 2) / (n0 * self.size);
            if !(mass.is_finite() && mass > 0.0) {
                return Err(none());
            }
            let measured = |value: f64, gradient: [(usize, f64); 2]| {
                let mut full = [0.0; P];
                for (at, slope) in gradient {
                    full[at] += slope;
                }
                Estimated::new(value, variance_of(full, &covariance).sqrt())
            };
            let (damping, stiffness) = (mass * unit, mass * unit * unit);
            Some([
                measured(mass, [(2, -mass / n0), (0, 0.0)]),
                measured(damping * q1, [(2, -damping * q1 / n0), (1, damping)]),
                measured(stiffness * q0, [(2, -stiffness * q0 / n0), (0, stiffness)]),
            ])
        } else {
            None
        };
        let mut numerator = [0.0; 3];
        numerator.iter_mut().zip(&parameters[2..]).for_each(|(to, from)| *to = *from);
        let (form, size, decay_rate) = (self.form, self.size, self.band.decay_rate);
        let curve = Curve { denominator: [q0, q1], numerator, form, unit, size, decay_rate };
        let residual = self.size * (sum_of_squares / self.band.values.len() as f64).sqrt();
        Ok(RationalFit { mode, machine, residual, curve })
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
            let mut equations = Equations::new();
            for (s, form, value) in self.lines() {
                let denominator = s * s + s * parameters[1] + parameters[0];
                let weight = if iteration == 0 { 1.0 } else { denominator.norm().recip() };
                if weight.is_finite() {
                    let powers = [Complex64::ONE, s, s * s];
                    let column = |i: usize| if i < 2 { value * powers[i] } else { -form * powers[i - 2] };
                    add(&mut equations, std::array::from_fn(|i| column(i) * weight), -value * s * s * weight);
                }
            }
            parameters = equations.solve()?.values;
        }
        Some(parameters)
    }

    /// Residuals H_measured − H with their derivatives.
    fn linearise(&self, parameters: &[f64; P]) -> Option<Equations<P>> {
        let mut equations = Equations::new();
        for (s, form, value) in self.lines() {
            let denominator = s * s + s * parameters[1] + parameters[0];
            let numerator = parameters[2..].iter().rev().fold(Complex64::ZERO, |sum, n| sum * s + n);
            let model = form * numerator / denominator;
            if !model.is_finite() {
                return None;
            }
            let powers = [Complex64::ONE, s, s * s];
            let slope = |i: usize| if i < 2 { -model * powers[i] } else { form * powers[i - 2] };
            add(&mut equations, std::array::from_fn(|i| slope(i) / denominator), value - model);
        }
        Some(equations)
    }
}

/// Adds a complex equation as two real ones.
fn add<const P: usize>(equations: &mut Equations<P>, row: [Complex64; P], right: Complex64) {
    equations.add(row.map(|entry| entry.re), right.re);
    equations.add(row.map(|entry| entry.im), right.im);
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
