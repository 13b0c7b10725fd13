//! A piece of a sine, fitted to few samples around a point of interest.

use std::f64::consts::PI;
use std::ops::Range;

/// `c + a cos φ + b sin φ` with `φ = ω (i − origin)`, fitted to samples `i` near `origin` by least squares.
///
/// Over a narrow range 1, sin φ and 1 − cos φ are a parabola to leading order, and the fit averages noise as one:
/// the value at the origin has a standard deviation of 1.5 σ/√m for m samples. But a parabola fitted to a sine over
/// ±w misses the extremum by w⁴/280 of the amplitude (2.7e-4 for w = π/6, more for few samples); this misses
/// nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Harmonic {
    origin: f64,
    omega: f64,
    centre: f64,
    cosine: f64,
    sine: f64,
    /// Coefficient of |sin φ|: half of the change of slope at the origin, for a fit with a kink.
    kink: f64,
}

impl Harmonic {
    /// Fit with the half cycle `half` (samples) known and the centre unknown; `None` if the samples do not
    /// determine it.
    pub(crate) fn fit(values: &[f64], range: Range<usize>, origin: f64, half: f64) -> Option<Self> {
        if range.len() < 3 {
            return None;
        }
        let omega = PI / half;
        let first = *values.get(range.start)?;
        let n = range.len() as f64;
        // 1 − cos φ as 2 sin²(φ/2) keeps its digits near φ = 0.
        let basis = |i: usize| {
            let (sin, cos) = (0.5 * omega * (i as f64 - origin)).sin_cos();
            (2.0 * sin * cos, 2.0 * sin * sin)
        };
        let mut mean = (0.0, 0.0, 0.0);
        for i in range.clone() {
            let (s, q) = basis(i);
            mean = (mean.0 + s / n, mean.1 + q / n, mean.2 + (values[i] - first) / n);
        }
        let (mut ss, mut sq, mut qq, mut sy, mut qy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for i in range {
            let (s, q) = basis(i);
            let (s, q, y) = (s - mean.0, q - mean.1, values[i] - first - mean.2);
            ss += s * s;
            sq += s * q;
            qq += q * q;
            sy += s * y;
            qy += q * y;
        }
        let (sine, bend) = solve(ss, sq, qq, sy, qy)?;
        let level = first + mean.2 - sine * mean.0 - bend * mean.1;
        Some(Self { origin, omega, centre: level + bend, cosine: -bend, sine, kink: 0.0 })
    }

    /// Fit with the centre known as well. With a `kink`, the slopes before and after the origin may differ, as those
    /// of a velocity do where it changes sign against dry friction; without it that would shift the crossing by
    /// w Δ/4 for a relative change Δ of slope. It doubles the scatter of the crossing.
    pub(crate) fn fit_about(
        values: &[f64],
        range: Range<usize>,
        origin: f64,
        half: f64,
        centre: f64,
        kink: bool,
    ) -> Option<Self> {
        if range.len() < 2 {
            return None;
        }
        let omega = PI / half;
        let (mut ss, mut sc, mut cc, mut sy, mut cy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let (mut kk, mut sk, mut ck, mut ky) = (0.0, 0.0, 0.0, 0.0);
        for i in range {
            let (s, c) = (omega * (i as f64 - origin)).sin_cos();
            let (k, y) = (s.abs(), values[i] - centre);
            ss += s * s;
            sc += s * c;
            cc += c * c;
            sy += s * y;
            cy += c * y;
            kk += k * k;
            sk += s * k;
            ck += c * k;
            ky += k * y;
        }
        if !kink {
            let (sine, cosine) = solve(ss, sc, cc, sy, cy)?;
            return Some(Self { origin, omega, centre, cosine, sine, kink: 0.0 });
        }
        // What the other two leave of |sin φ| has the kink to itself.
        let (s, c) = (sk / kk, ck / kk);
        let (sine, cosine) = solve(ss - s * sk, sc - s * ck, cc - c * ck, sy - s * ky, cy - c * ky)?;
        Some(Self { origin, omega, centre, cosine, sine, kink: (ky - sine * sk - cosine * ck) / kk })
    }

    /// Position of the extremum nearest to the origin (samples).
    pub(crate) fn extremum(&self) -> f64 {
        let side = self.cosine.signum();
        self.origin + (side * self.sine).atan2(side * self.cosine) / self.omega
    }

    /// Height of the extremum above the centre: positive for a maximum, negative for a minimum.
    pub(crate) fn height(&self) -> f64 {
        self.cosine.hypot(self.sine).copysign(self.cosine)
    }

    /// Value of the extremum.
    pub(crate) fn peak(&self) -> f64 {
        self.centre + self.height()
    }

    /// Position of the crossing of the centre nearest to the origin (samples).
    pub(crate) fn crossing(&self) -> f64 {
        let is_later = self.cosine * self.sine < 0.0;
        let slope = if is_later { self.sine + self.kink } else { self.sine - self.kink };
        let side = slope.signum();
        self.origin - (side * self.cosine).atan2(side * slope) / self.omega
    }
}

/// Solves a symmetric system of two equations; `None` if it is singular to rounding.
fn solve(aa: f64, ab: f64, bb: f64, ay: f64, by: f64) -> Option<(f64, f64)> {
    let determinant = aa * bb - ab * ab;
    (determinant > 1e-12 * aa * bb).then(|| ((bb * ay - ab * by) / determinant, (aa * by - ab * ay) / determinant))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_is_met_exactly_however_few_samples() {
        for (half, reach) in [(4.0, 1), (8.3, 1), (200.0, 33)] {
            let peak_at = 500.3;
            let values: Vec<f64> =
                (0..1001).map(|i| 7.0 - 2.0 * (PI * (f64::from(i) - peak_at) / half).cos()).collect();
            let fit = Harmonic::fit(&values, 500 - reach..501 + reach, 500.0, half).unwrap();
            // Seven digits of the basis cancel for the narrowest range, 1 − cos 0.5 against 1.
            assert!((fit.extremum() - peak_at).abs() < 1e-9 * half, "{} samples", fit.extremum());
            assert!((fit.peak() - 5.0).abs() < 1e-11 && fit.height() < 0.0, "{}", fit.peak());
            let at = (peak_at + half / 2.0).round();
            let i = at as usize;
            let fit = Harmonic::fit_about(&values, i - reach..i + reach + 1, at, half, 7.0, false).unwrap();
            assert!((fit.crossing() - (peak_at + half / 2.0)).abs() < 1e-11 * half, "{} samples", fit.crossing());
        }
    }

    #[test]
    fn a_kink_does_not_shift_the_crossing() {
        let (half, zero) = (200.0, 500.3);
        let values: Vec<f64> = (0..1001)
            .map(|i| (PI * (f64::from(i) - zero) / half).sin())
            .map(|sine| if sine < 0.0 { sine } else { 0.5 * sine })
            .collect();
        let mut at = 495.0f64;
        for _ in 0..4 {
            let centre = at.round() as usize;
            at = Harmonic::fit_about(&values, centre - 33..centre + 34, at, half, 0.0, true).unwrap().crossing();
        }
        // A fit without a kink is off by w Δ/4 = 0.09 rad, 5.5 samples; each step here leaves a seventh or so.
        assert!((at - zero).abs() < 0.1, "{at} samples");
    }

    #[test]
    fn too_few_samples_determine_nothing() {
        assert!(Harmonic::fit(&[1.0, 2.0], 0..2, 0.0, 4.0).is_none());
        assert!(Harmonic::fit_about(&[1.0], 0..1, 0.0, 4.0, 0.0, false).is_none());
    }
}
