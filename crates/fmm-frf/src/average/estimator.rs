//! Estimators of a response, quotients of averaged spectra, and the coherence of the two channels.

use std::sync::Arc;

use fmm_record::Complex64;

use crate::error::FrfError;

/// Quotient of averaged spectra that is taken for the response.
///
/// | estimator | formula | noise of the force | noise of the response |
/// |---|---|---|---|
/// | H1 | S_fv/S_ff | makes it too small | averages out |
/// | H2 | S_vv/S_vf | averages out | makes it too large |
/// | Hv | (S_fv/∣S_fv∣) √(S_vv/S_ff) | half of H1's bias | half of H2's bias |
/// | mean of ratios | ⟨V/F⟩ | wild where a trial has little force | averages out |
///
/// All have the phase of S_fv but the mean of ratios, and |H1| ≤ |Hv| ≤ |H2| with |H1| = γ² |H2|. The geometric Hv is
/// the one that does not depend on the units of the channels; a total least squares in mixed units is H1 or H2 in
/// disguise. The mean of ratios is that of the thesis' chapter 8.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Estimator {
    /// S_fv/S_ff, for noise on the response.
    H1,
    /// S_vv/S_vf, for noise on the force.
    H2,
    /// (S_fv/|S_fv|) √(S_vv/S_ff), the geometric mean of H1 and H2.
    Hv,
    /// ⟨V/F⟩, the mean of the responses of the single trials.
    MeanOfRatios,
}

/// Averaged spectra at one line, all in one arbitrary unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spectra {
    pub(crate) force: f64,
    pub(crate) response: f64,
    pub(crate) cross: Complex64,
}

/// Reason why an estimate does not exist at a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Undefined {
    Force,
    Cross,
}

impl Undefined {
    pub(crate) fn at(self, frequency: f64) -> FrfError {
        match self {
            Self::Force => FrfError::no_force_at(frequency),
            Self::Cross => {
                let what = format!("the response has nothing of the force at {frequency} Hz");
                FrfError::not_defined(what + ", so that neither phase nor H2 can be stated", frequency)
            }
        }
    }
}

impl Spectra {
    /// γ², at most 1.
    pub(crate) fn coherence(&self) -> Result<f64, Undefined> {
        if self.force == 0.0 {
            return Err(Undefined::Force);
        }
        if self.response == 0.0 {
            return Err(Undefined::Cross);
        }
        let (squared, product) = (self.cross.norm_sqr(), self.force * self.response);
        if squared.is_normal() && product.is_normal() {
            return Ok((squared / product).min(1.0));
        }
        // Rooted first, so that products of squares neither underflow nor overflow.
        let coherence = self.cross.norm() / self.force.sqrt() / self.response.sqrt();
        Ok((coherence * coherence).min(1.0))
    }
}

impl Estimator {
    /// The estimate at one line; that of the mean of ratios does not follow from averaged spectra and is H1 here.
    pub(crate) fn of(self, spectra: &Spectra) -> Result<Complex64, Undefined> {
        let Spectra { force, cross, .. } = *spectra;
        if force == 0.0 {
            return Err(Undefined::Force);
        }
        if matches!(self, Self::H2 | Self::Hv) && cross == Complex64::ZERO {
            return Err(Undefined::Cross);
        }
        Ok(self.quotient(spectra))
    }

    /// The estimate at one line; not finite where it does not exist.
    pub(crate) fn quotient(self, spectra: &Spectra) -> Complex64 {
        let Spectra { force, response, cross } = *spectra;
        match self {
            Self::H1 | Self::MeanOfRatios => cross / force,
            // Not divided as complex numbers, whose squares may overflow.
            Self::H2 => cross / cross.norm() * (response / cross.norm()),
            Self::Hv => cross / cross.norm() * (response / force).sqrt(),
        }
    }

    /// |H| √(1/γ² − 1) of the estimate at one line: the root, as squares may overflow.
    pub(crate) fn scatter(self, spectra: &Spectra) -> Result<f64, Undefined> {
        let estimate = self.of(spectra)?;
        if spectra.response == 0.0 {
            return Ok(0.0);
        }
        let coherence = spectra.coherence()?;
        // For H1 written without a division by γ², which may be zero.
        Ok(match self {
            Self::H1 | Self::MeanOfRatios => (spectra.response / spectra.force).sqrt() * (1.0 - coherence).sqrt(),
            Self::H2 | Self::Hv => estimate.norm() * ((1.0 - coherence) / coherence).sqrt(),
        })
    }
}

/// γ² at each line, with the number of averages without which it means nothing.
///
/// Of n averages with no connection between the channels, γ² is 1/n in the mean; of one, it is 1 whatever was measured.
/// Low coherence has many causes: noise, leakage, a second input, or a machine that is not linear, such as one with
/// friction under different impulses.
#[derive(Debug, Clone, PartialEq)]
pub struct Coherence {
    pub(super) frequencies: Arc<[f64]>,
    pub(super) values: Vec<f64>,
    pub(super) averages: f64,
}

impl Coherence {
    /// Frequencies (Hz), increasing.
    pub fn frequencies(&self) -> &[f64] {
        &self.frequencies
    }

    /// γ², one for each frequency, from 0 to 1.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Number of trials in the average.
    pub fn averages(&self) -> f64 {
        self.averages
    }

    /// True for two averages or more: without them γ² is 1 by construction.
    pub fn is_meaningful(&self) -> bool {
        self.averages > 1.0
    }

    /// The median of γ² over the lines from `low` to `high` (Hz), both ends included; `None` if no line lies there.
    pub fn median(&self, low: f64, high: f64) -> Option<f64> {
        let lines = self.frequencies.iter().zip(&self.values);
        let inside = lines.filter(|(frequency, _)| (low..=high).contains(*frequency));
        let mut values: Vec<f64> = inside.map(|(_, value)| *value).collect();
        values.sort_by(f64::total_cmp);
        let (below, above) = (values.get(values.len().checked_sub(1)? / 2)?, values.get(values.len() / 2)?);
        Some(0.5 * (below + above))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_of_each_estimator_is_that_of_its_noise() {
        // γ² = |2 + 2i|²/(4 · 8) = 0.25: of S_xx/S_ff = 2 three quarters are noise; H2 and Hv scatter by 3 |H|².
        let spectra = Spectra { force: 4.0, response: 8.0, cross: Complex64::new(2.0, 2.0) };
        assert_eq!(spectra.coherence(), Ok(0.25));
        for (estimator, square, scatter) in
            [(Estimator::H1, 0.5, 1.5), (Estimator::H2, 8.0, 24.0), (Estimator::Hv, 2.0, 6.0)]
        {
            let found = estimator.of(&spectra).unwrap().norm_sqr();
            assert!((found - square).abs() < 1e-14 * square, "{estimator:?}: |H|² = {found}");
            let found = estimator.scatter(&spectra).unwrap().powi(2);
            assert!((found - scatter).abs() < 1e-14 * scatter, "{estimator:?}: a scatter of {found}");
        }
    }

    /// Responses of 1e150, whose squares are the largest numbers that there are.
    #[test]
    fn estimates_and_scatter_of_huge_responses() {
        for size in [1e-150, 1e150] {
            let cross = Complex64::new(2.0 * size, 2.0 * size);
            let spectra = Spectra { force: 4.0, response: 8.0 * size * size, cross };
            for (estimator, magnitude, scatter) in
                [(Estimator::H1, 0.5, 1.5), (Estimator::H2, 8.0, 24.0), (Estimator::Hv, 2.0, 6.0)]
            {
                let (found, expected) = (estimator.of(&spectra).unwrap().norm() / size, f64::sqrt(magnitude));
                assert!((found / expected - 1.0).abs() < 1e-14, "{estimator:?}, {size}: |H| = {found}");
                let (found, expected) = (estimator.scatter(&spectra).unwrap() / size, f64::sqrt(scatter));
                assert!((found / expected - 1.0).abs() < 1e-14, "{estimator:?}, {size}: a scatter of {found}");
            }
        }
    }

    #[test]
    fn coherence_of_tiny_and_of_huge_spectra() {
        for size in [1e-200, 1e200] {
            let spectra = Spectra { force: 4.0 * size, response: size, cross: Complex64::new(size, 0.0) };
            // Two roots and two quotients, each right to half an ε.
            let coherence = spectra.coherence().unwrap();
            assert!((coherence - 0.25).abs() < 4.0 * f64::EPSILON, "spectra of {size}: γ² = {coherence}");
        }
    }

    #[test]
    fn the_median_is_of_a_band() {
        let frequencies = vec![0.0, 1.0, 2.0, 3.0].into();
        let coherence = Coherence { frequencies, values: vec![0.1, 0.9, 0.5, 0.7], averages: 3.0 };
        assert_eq!(coherence.median(1.0, 3.0), Some(0.7));
        assert_eq!(coherence.median(0.0, 1.0), Some(0.5));
        assert_eq!(coherence.median(4.0, 5.0), None);
        assert!(coherence.is_meaningful() && !Coherence { averages: 1.0, ..coherence }.is_meaningful());
    }
}
