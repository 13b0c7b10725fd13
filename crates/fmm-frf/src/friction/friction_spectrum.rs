//! Spectrum of the friction force, from the difference of a response to a linear one.

use fmm_model::ModelError;
use fmm_record::Complex64;

use crate::error::FrfError;
use crate::response::FrequencyResponse;

/// The friction force by the applied force at each line.
///
/// ```text
/// V = H_lin (F − R),   H = V/F:   R/F = 1 − H/H_lin                                                    (1)
/// ```
///
/// R is whatever force the linear machine does not explain; with a body that slides to and fro it is nearly a square
/// wave, with harmonics n at 1/n of the fundamental: −9.5, −14.0, −16.9 and −19.1 dB for n = 3, 5, 7 and 9. They do not
/// show as peaks of the response, as they stand on the slope of the linear one: only the division by H_lin brings them
/// out.
///
/// Equation (1) holds for one impact (or several alike); an average over different impulses mixes different machines.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionSpectrum {
    frequencies: Vec<f64>,
    quotients: Vec<Complex64>,
}

/// Line of a [`FrictionSpectrum`] at a multiple of the fundamental frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Harmonic {
    /// n, multiple of the fundamental frequency.
    pub order: u32,
    /// Frequency (Hz) of the line nearest to it.
    pub frequency: f64,
    /// |R| (dB) by that of the fundamental.
    pub level: f64,
    /// |H/H_lin| (dB), how far the response is from the linear one.
    pub deviation: f64,
}

impl FrictionSpectrum {
    /// The spectrum behind a `measured` response, given the `linear` one of the machine without friction, in the same
    /// form at the same frequencies: of a model as
    /// [`SingleDegreeOfFreedom::frequency_response`](crate::SingleDegreeOfFreedom::frequency_response), or of a test
    /// with the contact removed.
    ///
    /// # Errors
    /// [`FrfError::Mismatch`] for responses of different form, window or frequencies, and [`FrfError::NotDefined`] at a
    /// line where the quotient is not finite, such as zero frequency for a mobility.
    pub fn of(measured: &FrequencyResponse, linear: &FrequencyResponse) -> Result<Self, FrfError> {
        if measured.form() != linear.form() || measured.decay_rate() != linear.decay_rate() {
            return Err(responses_differ(0));
        }
        let shorter = measured.frequencies().len().min(linear.frequencies().len());
        let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
        let differs = measured.frequencies().iter().zip(linear.frequencies()).position(|pair| !close(pair));
        if differs.is_some() || measured.frequencies().len() != linear.frequencies().len() {
            return Err(responses_differ(differs.unwrap_or(shorter)));
        }
        let quotients = measured.values().iter().zip(linear.values()).zip(measured.frequencies());
        let quotients = quotients.map(|((measured, linear), &frequency)| {
            let quotient = measured / linear;
            let what = || format!("the linear response is zero at {frequency} Hz; leave this line out");
            if quotient.is_finite() { Ok(quotient) } else { Err(FrfError::not_defined(what(), frequency)) }
        });
        Ok(Self { frequencies: measured.frequencies().to_vec(), quotients: quotients.collect::<Result<_, _>>()? })
    }

    /// Frequencies (Hz), increasing.
    pub fn frequencies(&self) -> &[f64] {
        &self.frequencies
    }

    /// R/F = 1 − H/H_lin, one for each frequency.
    pub fn values(&self) -> impl ExactSizeIterator<Item = Complex64> + '_ {
        self.quotients.iter().map(|quotient| 1.0 - quotient)
    }

    /// H/H_lin, one for each frequency.
    pub fn quotients(&self) -> &[Complex64] {
        &self.quotients
    }

    /// The harmonics of orders 1 to `highest` of the `fundamental` frequency (Hz), at the nearest lines.
    ///
    /// A motion that lasts for T smears each over 1/T, so that a fundamental known to a quarter of that, times the
    /// highest order, is good enough.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for the fundamental, and [`FrfError::Outside`] if no
    /// line is within an eighth of the fundamental of each multiple, or if nothing is left over at the fundamental.
    pub fn harmonics(&self, fundamental: f64, highest: u32) -> Result<Vec<Harmonic>, FrfError> {
        ModelError::require_positive("the fundamental frequency", fundamental, "Hz")?;
        let (spacing, reach) = (0.25 * fundamental, fundamental * f64::from(highest));
        let outside = || {
            FrfError::outside(format!(
                "harmonics of {fundamental} Hz up to order {highest} need lines that reach {reach} Hz, at most {spacing} \
                 Hz apart"
            ))
        };
        let nearest = |frequency: f64| {
            let above = self.frequencies.partition_point(|&line| line < frequency);
            let distance = |line: usize| self.frequencies.get(line).map(|at| (at - frequency).abs());
            let candidates = [above.checked_sub(1), Some(above)].into_iter().flatten();
            let lines = candidates.filter_map(|line| distance(line).map(|distance| (line, distance)));
            lines.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, distance)| *distance <= 0.5 * spacing)
        };
        let decibels = |value: f64| 20.0 * value.log10();
        let mut harmonics: Vec<Harmonic> = Vec::new();
        let mut first = 0.0;
        for order in 1..=highest {
            let (line, _) = nearest(fundamental * f64::from(order)).ok_or_else(outside)?;
            let size = (1.0 - self.quotients[line]).norm();
            if order == 1 {
                first = size;
            }
            if first == 0.0 {
                return Err(outside());
            }
            let (level, deviation) = (decibels(size / first), decibels(self.quotients[line].norm()));
            harmonics.push(Harmonic { order, frequency: self.frequencies[line], level, deviation });
        }
        Ok(harmonics)
    }

    /// Ratio of the odd harmonics from the third on to the even ones, as the ratio of the root mean squares of |R|,
    /// over orders up to `highest`.
    ///
    /// Friction is the same in both directions, so that its force has no even harmonics: the ratio is 5 for nine half
    /// swings of dry friction and grows with their number. A linear machine with noise, or one whose linear response is
    /// not quite known, has about 1; with orders up to 9, noise alone exceeds 2.4 in one of a hundred spectra.
    ///
    /// # Errors
    /// Those of [`FrictionSpectrum::harmonics`], with a highest order of 3 at least, and
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) if there is nothing at all at the odd or at the even
    /// ones.
    pub fn odd_by_even(&self, fundamental: f64, highest: u32) -> Result<f64, FrfError> {
        let harmonics = self.harmonics(fundamental, highest.max(3))?;
        let mean_square = |odd: bool| {
            let orders = harmonics.iter().filter(|harmonic| harmonic.order > 1 && (harmonic.order % 2 == 1) == odd);
            let (sum, count) = orders
                .fold((0.0, 0.0), |(sum, count), harmonic| (sum + 10f64.powf(harmonic.level / 10.0), count + 1.0));
            sum / count
        };
        let ratio = (mean_square(true) / mean_square(false)).sqrt();
        Ok(ModelError::require_positive("ratio of odd to even harmonics", ratio, "")?)
    }
}

/// Error of two responses that differ from `line` on; from 0 if their forms do.
fn responses_differ(line: usize) -> FrfError {
    let what = "both responses must be of one form and at the same frequencies";
    FrfError::mismatch(format!("{what}, but differ from line {line} on"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ResponseForm;

    fn spectrum(spacing: f64) -> FrictionSpectrum {
        let frequencies: Vec<f64> = (1..=40).map(|line| f64::from(line) * spacing).collect();
        let response = |size| {
            let values = vec![Complex64::new(size, 0.0); 40];
            FrequencyResponse::new(ResponseForm::Mobility, frequencies.clone(), values).unwrap()
        };
        FrictionSpectrum::of(&response(0.5), &response(1.0)).unwrap()
    }

    #[test]
    fn lines_too_far_apart_are_refused() {
        // The third harmonic of 1 Hz lies on a line when these are 0.25 Hz apart, and 0.15 Hz from one of 0.35 Hz.
        assert_eq!(spectrum(0.25).harmonics(1.0, 3).unwrap()[2].frequency, 3.0);
        let refused = spectrum(0.35).harmonics(1.0, 3);
        assert!(matches!(refused, Err(FrfError::Outside { ref what }) if what.contains("order 3")), "{refused:?}");
    }
}
