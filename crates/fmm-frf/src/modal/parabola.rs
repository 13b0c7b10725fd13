//! Peak picking: a mode from the magnitude around its peak.

use std::f64::consts::TAU;

use crate::least_squares::{Equations, Solution};
use crate::modal::band::Band;
use crate::{FrequencyResponse, FrfError, Mode, ResponseForm};

const NAME: &str = "fit of a peak";

/// A mode from magnitudes alone.
///
/// ```text
/// 1/|H|² = m²ω⁴ + (c² − 2mk) ω² + k²                                                                 (1)
/// ```
///
/// For one degree of freedom this parabola in ω² is exact, so that the lines need not be dense: where a straight line
/// through the half-power points of a coarse grid misses the damping by 8 %, this does not. Lines are weighed for noise
/// that is the same at all of them. Phases are not used, which makes it the method for magnitudes only, or for a delay
/// that is not known; other modes in the band count as if they were this one.
///
/// ```
/// use fmm_frf::{PeakFit, ResponseForm, SingleDegreeOfFreedom};
///
/// let lines: Vec<f64> = (1..100).map(|i| f64::from(i) / 16.0).collect();
/// let machine = SingleDegreeOfFreedom::new(10.391, 8.0, 1982.0)?;
/// let response = machine.frequency_response(ResponseForm::Mobility, &lines)?;
/// let mode = PeakFit::of(&response, 2.0, 2.4)?.mode;
/// assert!((mode.natural_frequency.value - 2.198_079).abs() < 1e-6);
/// assert!((mode.damping_ratio.value - 0.027_872_73).abs() < 1e-8);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PeakFit {
    /// Natural frequency and damping.
    pub mode: Mode,
    /// Frequency (Hz) of the line of largest magnitude.
    pub peak_frequency: f64,
    /// Its magnitude, in the unit of the response given.
    pub peak_magnitude: f64,
}

impl PeakFit {
    /// Fits the lines of `response` from `low` to `high` (Hz); at least four.
    ///
    /// # Errors
    /// [`FrfError::Outside`] for a band outside the response, [`FrfError::TooFew`] for fewer lines, and
    /// [`FrfError::NoFit`] if the magnitudes have no peak or do not determine it.
    pub fn of(response: &FrequencyResponse, low: f64, high: f64) -> Result<Self, FrfError> {
        let given = Band::of(response, low, high, 4)?;
        let receptance = Band::apparent(&response.within(low, high)?, ResponseForm::Receptance)?;
        let none = || FrfError::no_mode(NAME, low, high);
        let derivatives = i32::from(response.form().derivatives());
        let magnitudes: Vec<f64> = receptance.values().iter().map(|value| value.norm()).collect();
        let largest = magnitudes.iter().copied().fold(0.0, f64::max);
        let mut parabola = Equations::new();
        for (&magnitude, &ratio) in magnitudes.iter().zip(&given.ratios) {
            // d(1/|H|²) = −2|H|⁻³ d|H|, and noise of the given form is 1/ωᵖ of that in the receptance.
            let relative = magnitude / largest;
            let weight = relative.powi(3) * ratio.powi(derivatives);
            let u = ratio * ratio - 1.0;
            if weight > 0.0 {
                parabola.add([u * u, u, 1.0].map(|term| term * weight), weight / (relative * relative));
            }
        }
        let undetermined = || FrfError::undetermined(NAME, parabola.len());
        let Some(Solution { values: [a, b, d], covariance: Some(covariance), .. }) = parabola.solve() else {
            return Err(undetermined());
        };
        // a u² + b u + d = a (w² + (q₁² − 2q₀) w + q₀²) with w = 1 + u, without cancellation near the peak.
        let e = (d - b) / a;
        let q0 = (1.0 + e).sqrt();
        let q1_squared = b / a + 2.0 * e / (1.0 + q0);
        if !(a > 0.0 && q1_squared > 0.0 && q0.is_finite()) {
            return Err(none());
        }
        let q1 = q1_squared.sqrt();
        let of_e = [-e / a, -1.0 / a, 1.0 / a];
        let of_q0 = of_e.map(|slope| 0.5 * slope / q0);
        let of_ratio = [-b / (a * a), 1.0 / a, 0.0];
        let of_q1: [f64; 3] = std::array::from_fn(|i| 0.5 * (of_ratio[i] + of_e[i] / q0) / q1);
        let product = |g: [f64; 3], h: [f64; 3]| {
            let pairs = covariance.iter().zip(g);
            pairs.map(|(row, g)| g * row.iter().zip(h).map(|(c, h)| c * h).sum::<f64>()).sum::<f64>()
        };
        let mixed = product(of_q0, of_q1);
        let covariance = [[product(of_q0, of_q0), mixed], [mixed, product(of_q1, of_q1)]];
        Ok(Self {
            mode: Mode::new([q0, q1], &covariance, given.unit, given.decay_rate, none)?,
            peak_frequency: given.unit / TAU,
            peak_magnitude: given.values[given.highest].norm(),
        })
    }
}
