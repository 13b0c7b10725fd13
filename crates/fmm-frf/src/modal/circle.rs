//! Circle fit: a mode from the circle that it draws in the complex plane.

use std::f64::consts::{PI, TAU};

use fmm_record::Complex64;

use crate::least_squares::{Equations, minimise};
use crate::modal::band::Band;
use crate::{Estimated, FrequencyResponse, FrfError, Mode, ResponseForm};

const NAME: &str = "circle fit";

/// A mode from the circle of its mobility.
///
/// ```text
/// Y(ω) = z + r e^{i(α + φ)},   tan(φ/2) = (ω₀² − ω²)/(2ζω₀ω)                                           (1)
/// ```
///
/// With viscous damping the mobility of one degree of freedom lies on a circle of diameter 1/c through the origin,
/// exactly. Other modes, if they are far, shift the circle to another centre z and turn it by α. First the circle is
/// fitted to the points (distances from it, not the algebraic form), then frequency and damping to the angles on it.
///
/// ```
/// use fmm_frf::{CircleFit, ResponseForm, SingleDegreeOfFreedom};
///
/// let lines: Vec<f64> = (1..100).map(|i| f64::from(i) / 16.0).collect();
/// let machine = SingleDegreeOfFreedom::new(10.391, 8.0, 1982.0)?;
/// let response = machine.frequency_response(ResponseForm::Receptance, &lines)?;
/// let fit = CircleFit::of(&response, 1.7, 2.8)?;
/// assert!((fit.mode.damping_ratio.value - 0.027_872_73).abs() < 1e-8);
/// assert!((fit.damping.value - 8.0).abs() < 1e-9 && fit.rotation.abs() < 1e-9);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # References
/// D. J. Ewins, *Modal Testing*, 2nd ed., Research Studies Press 2000, section 4.3.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CircleFit {
    /// Natural frequency and damping.
    pub mode: Mode,
    /// c, viscous coefficient (N s/m), as if the machine had one degree of freedom and were driven where it is
    /// measured: the reciprocal of the diameter, less what an exponential window adds.
    pub damping: Estimated,
    /// z, centre (m/(N s)) of the mobility circle.
    pub centre: Complex64,
    /// r, radius (m/(N s)).
    pub radius: Estimated,
    /// α, angle (rad) by which the circle is turned; zero for one degree of freedom.
    pub rotation: f64,
}

impl CircleFit {
    /// Fits the lines of `response` from `low` to `high` (Hz); at least four, around one resonance.
    ///
    /// # Errors
    /// [`FrfError::Outside`] for a band outside the response, [`FrfError::TooFew`] for fewer lines, and
    /// [`FrfError::NoFit`] if the lines show no mode or do not determine the circle.
    pub fn of(response: &FrequencyResponse, low: f64, high: f64) -> Result<Self, FrfError> {
        Band::of(response, low, high, 4)?;
        let band = Band::of(&Band::apparent(&response.within(low, high)?, ResponseForm::Mobility)?, low, high, 4)?;
        let size = band.values[band.highest].norm();
        let points: Vec<Complex64> = band.values.iter().map(|value| value / size).collect();
        let undetermined = || FrfError::undetermined(NAME, points.len());
        let unsettled = || FrfError::not_converged(NAME);
        let none = || FrfError::no_mode(NAME, low, high);

        let start = algebraic_circle(&points).ok_or_else(undetermined)?;
        let circle = minimise(start, points.len(), |circle| Some(distances(&points, circle))).ok_or_else(unsettled)?;
        let [x, y, radius] = circle.values;
        let centre = Complex64::new(x, y);
        let angles: Vec<f64> = points.iter().map(|point| (point - centre).arg()).collect();
        let start = starting_mode(&band, &angles).ok_or_else(none)?;
        let turning = minimise(start, angles.len(), |mode| sweep(&band.ratios, &angles, mode)).ok_or_else(unsettled)?;
        let [q0, q1, rotation] = turning.values;
        let (Some([[a, b, _], [_, c, _], _]), Some(of_circle)) = (turning.covariance, circle.covariance) else {
            return Err(undetermined());
        };
        let mode = Mode::new([q0, q1], &[[a, b], [b, c]], band.unit, band.decay_rate, none)?;
        let relative = of_circle[2][2].sqrt() / radius;
        // 2mσ is the share 2σ/q₁ of the apparent damping.
        let apparent = 0.5 / (radius * size);
        let damping = apparent * (1.0 - 2.0 * band.decay_rate / (q1 * band.unit));
        Ok(Self {
            mode,
            damping: Estimated::new(damping, apparent * relative),
            centre: centre * size,
            radius: Estimated::new(radius * size, radius * size * relative),
            rotation,
        })
    }
}

/// Centre and radius for which the sum of (|z − centre|² − r²)² is least, a linear problem.
fn algebraic_circle(points: &[Complex64]) -> Option<[f64; 3]> {
    let mut equations = Equations::new();
    for point in points {
        equations.add([2.0 * point.re, 2.0 * point.im, 1.0], point.norm_sqr());
    }
    let [x, y, power] = equations.solve()?.values;
    let square = power + x * x + y * y;
    (square > 0.0).then(|| [x, y, square.sqrt()])
}

/// Distances of `points` from a circle (centre, radius), linearised.
fn distances(points: &[Complex64], &[x, y, radius]: &[f64; 3]) -> Equations<3> {
    let mut equations = Equations::new();
    for point in points {
        let from_centre = point - Complex64::new(x, y);
        let distance = from_centre.norm();
        let direction = if distance > 0.0 { from_centre / distance } else { Complex64::ONE };
        equations.add([-direction.re, -direction.im, -1.0], radius - distance);
    }
    equations
}

/// q₀, q₁ and α to begin with: the highest line is taken for the resonance, and the others tell how fast the angle
/// turns.
fn starting_mode(band: &Band, angles: &[f64]) -> Option<[f64; 3]> {
    let rotation = angles[band.highest];
    let mut estimates: Vec<f64> = band
        .ratios
        .iter()
        .zip(angles)
        .filter_map(|(ratio, angle)| {
            let tangent = (0.5 * wrapped(angle - rotation)).tan();
            let estimate = (1.0 - ratio * ratio) / (ratio * tangent);
            // Points opposite the resonance, and the resonance itself, say little.
            ((0.05..20.0).contains(&tangent.abs()) && estimate > 0.0).then_some(estimate)
        })
        .collect();
    estimates.sort_by(f64::total_cmp);
    Some([1.0, *estimates.get(estimates.len() / 2)?, rotation])
}

/// Angles on the circle against those of a mode (q₀, q₁, α), linearised; `None` for a mode that does not exist.
fn sweep(ratios: &[f64], angles: &[f64], &[q0, q1, rotation]: &[f64; 3]) -> Option<Equations<3>> {
    if !(q0 > 0.0 && q1 > 0.0) {
        return None;
    }
    let mut equations = Equations::new();
    for (&w, angle) in ratios.iter().zip(angles) {
        let (elastic, viscous) = (q0 - w * w, q1 * w);
        let square = elastic * elastic + viscous * viscous;
        let model = rotation + 2.0 * elastic.atan2(viscous);
        equations.add([2.0 * viscous / square, -2.0 * elastic * w / square, 1.0], wrapped(angle - model));
    }
    Some(equations)
}

/// The same angle between −π and π.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * ((angle + PI) / TAU).floor()
}
