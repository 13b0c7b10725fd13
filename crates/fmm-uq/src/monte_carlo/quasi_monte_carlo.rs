//! Fewer, better placed trials for models that take long.

#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::monte_carlo::allowed_failures::AllowedFailures;
use crate::monte_carlo::failure::Failure;
use crate::monte_carlo::heavy_tail::HeavyTail;
use crate::monte_carlo::order_statistics::ranked;
use crate::monte_carlo::sampler::Sampler;
use crate::random::sobol_sequence::{SobolSequence, mix};
use crate::{FailureKind, Failures, Inputs, ModelOutput, Moments, OutputSample, UncertaintyError};

/// Propagation of distributions on scrambled Sobol sequences instead of random numbers.
///
/// For smooth models of few inputs, estimate and uncertainty converge almost as 1/n instead of 1/√n: with 16 384
/// points, the variance of u(y) is some thousand times smaller than that of as many random trials for the
/// mass calibration of JCGM 101:2008, 9.3, and a hundred times for the gauge block of 9.5. Interval ends gain less, 2
/// to 15.
///
/// The error is told by independent scramblings, at least eight, whose results scatter. The adaptive procedure of
/// JCGM 101 does not apply. Inputs are drawn through their quantiles, one dimension each, up to 64.
///
/// ```
/// use fmm_uq::{Input, Inputs, QuasiMonteCarlo};
///
/// let inputs = Inputs::new([Input::new("a", 1.0, 0.1, "m")?, Input::new("b", 2.0, 0.2, "m")?])?;
/// let area = QuasiMonteCarlo::new(&inputs, 1024, 8)?.run(|x| x[0] * x[1])?;
/// // u² = (2·0.1)² + (1·0.2)² + (0.1·0.2)²
/// assert!((area.sample().standard_uncertainty(0)? - 0.0804f64.sqrt()).abs() < 1e-3);
/// assert!(area.standard_errors(0)?[1] < 3e-4);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone)]
pub struct QuasiMonteCarlo {
    sampler: Sampler,
    heavy_tail: Option<HeavyTail>,
    points: u32,
    scramblings: usize,
    seed: u64,
    allowed_failures: AllowedFailures,
}

/// The pooled values of all scramblings, with errors from their scatter.
#[derive(Debug, Clone, PartialEq)]
pub struct QuasiSample {
    sample: OutputSample,
    /// Values by scrambling and output.
    parts: Vec<Vec<Vec<f64>>>,
}

impl QuasiMonteCarlo {
    /// `points` of each of `scramblings` sequences.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless points are a power of two from 2 to 2³¹ and scramblings 8 to
    /// 65 536; [`UncertaintyError::NoAnswer`] for inputs that need more than 64 dimensions.
    pub fn new(inputs: &Inputs, points: u32, scramblings: usize) -> Result<Self, UncertaintyError> {
        let sampler = Sampler::new(inputs);
        SobolSequence::new(sampler.dimensions(), 0)?;
        let refuse = |option, value, must_be| Err(UncertaintyError::out_of_range(option, value, must_be));
        if !points.is_power_of_two() || points < 2 {
            return refuse("number of Sobol points", f64::from(points), "a power of two, at least 2");
        }
        if !(8..=65_536).contains(&scramblings) {
            return refuse("number of scramblings", scramblings as f64, "between 8 and 65536");
        }
        let (heavy_tail, allowed_failures) = (HeavyTail::of(inputs), AllowedFailures::default());
        Ok(Self { sampler, heavy_tail, points, scramblings, seed: 0, allowed_failures })
    }

    /// The same with another seed, and so with other scramblings.
    #[must_use]
    pub const fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// The same with a share of points that may fail, 0 unless set. Points that fail spoil the even placing.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless it lies in [0, 1).
    pub fn with_allowed_failures(mut self, share: f64) -> Result<Self, UncertaintyError> {
        self.allowed_failures = AllowedFailures::new(share)?;
        Ok(self)
    }

    /// Evaluates the model at all points.
    ///
    /// # Errors
    /// [`UncertaintyError::TooManyFailures`] if more points fail than allowed; [`UncertaintyError::Model`] if none of a
    /// scrambling succeeds, or the number of outputs changes; [`UncertaintyError::OutOfRange`] if the squares of the
    /// values overflow.
    ///
    /// # Panics
    /// If the model does.
    pub fn run<R: ModelOutput<f64>>(
        &self,
        model: impl Fn(&[f64]) -> R + Sync,
    ) -> Result<QuasiSample, UncertaintyError> {
        let one = |scrambling: usize| self.run_one(scrambling as u64, &model);
        #[cfg(feature = "rayon")]
        let results: Vec<_> = (0..self.scramblings).into_par_iter().map(one).collect();
        #[cfg(not(feature = "rayon"))]
        let results: Vec<_> = (0..self.scramblings).map(one).collect();
        let mut failures = Failures::default();
        let mut parts = Vec::with_capacity(results.len());
        for result in results {
            let (columns, failed) = result?;
            failures.append(&failed);
            parts.push(columns);
        }
        let trials = u64::from(self.points) * self.scramblings as u64;
        self.allowed_failures.check(&failures, trials)?;
        let outputs = parts.iter().map(Vec::len).max().unwrap_or(0);
        if parts.iter().any(Vec::is_empty) {
            return Err(UncertaintyError::no_success());
        }
        if let Some(other) = parts.iter().find(|part| part.len() != outputs) {
            return Err(UncertaintyError::output_count_changed(outputs, other.len()));
        }
        let column = |output: usize| parts.iter().flat_map(|part| &part[output]).copied().collect();
        let sample = OutputSample::new((0..outputs).map(column).collect(), trials, failures, self.heavy_tail.clone())?;
        Ok(QuasiSample { sample, parts })
    }

    /// The values of one scrambling by output, and the points that failed; their block is the scrambling.
    fn run_one<R: ModelOutput<f64>>(
        &self,
        scrambling: u64,
        model: &impl Fn(&[f64]) -> R,
    ) -> Result<(Vec<Vec<f64>>, Failures), UncertaintyError> {
        let seed = mix(self.seed).wrapping_add(mix(scrambling));
        let sequence = SobolSequence::new(self.sampler.dimensions(), seed)?;
        let mut uniform = vec![0.0; self.sampler.dimensions()];
        let mut row = vec![0.0; self.sampler.width()];
        let (mut columns, mut failures, mut values) = (Vec::<Vec<f64>>::new(), Failures::default(), Vec::new());
        for index in 0..self.points {
            sequence.point(index, &mut uniform);
            self.sampler.map(&uniform, &mut row);
            values.clear();
            let kind = match model(&row).append_to(&mut values) {
                Err(error) => Some(FailureKind::Error(error.to_string())),
                Ok(()) if values.is_empty() || (!columns.is_empty() && columns.len() != values.len()) => {
                    Some(FailureKind::OutputCount { found: values.len() })
                }
                Ok(()) => {
                    let output = values.iter().position(|value| !value.is_finite());
                    output.map(|output| FailureKind::NotFinite { output })
                }
            };
            if let Some(kind) = kind {
                failures.add(Failure { block: scrambling, trial: index as usize, kind });
                continue;
            }
            columns.resize(values.len(), Vec::new());
            for (column, &value) in columns.iter_mut().zip(&values) {
                column.push(value);
            }
        }
        Ok((columns, failures))
    }
}

impl QuasiSample {
    /// The values of all scramblings together. Its own standard errors are those of random trials and much too large
    /// here.
    pub const fn sample(&self) -> &OutputSample {
        &self.sample
    }

    /// Standard errors of y and of u(y) (unit of the output), from the scatter of the scramblings.
    ///
    /// # Errors
    /// Those of [`OutputSample::standard_uncertainty`].
    pub fn standard_errors(&self, output: usize) -> Result<[f64; 2], UncertaintyError> {
        self.sample.standard_uncertainty(output)?;
        let deviation = |m: &Moments| m.standard_deviation().unwrap_or(0.0);
        let moments: Vec<Moments> = self.columns(output)?.map(Moments::of_values).collect();
        let figures =
            [moments.iter().map(Moments::mean).collect::<Vec<_>>(), moments.iter().map(deviation).collect::<Vec<_>>()];
        Ok(figures.map(|figures| scatter(&figures)))
    }

    /// Standard errors of the ends of the symmetric interval (unit of the output), from the scatter of the scramblings.
    ///
    /// # Errors
    /// Those of [`OutputSample::symmetric_interval`], for the points of one scrambling.
    pub fn standard_errors_of_ends(&self, output: usize, level: f64) -> Result<[f64; 2], UncertaintyError> {
        let mut ends = [Vec::new(), Vec::new()];
        for column in self.columns(output)? {
            let interval = crate::monte_carlo::output_sample::symmetric(column, level)?;
            ends[0].push(interval.low);
            ends[1].push(interval.high);
        }
        Ok(ends.map(|figures| scatter(&figures)))
    }

    /// Median of an output (its unit), which suits skewed results.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] for an output that does not exist.
    pub fn median(&self, output: usize) -> Result<f64, UncertaintyError> {
        let values = self.sample.values(output)?;
        Ok(ranked(values, values.len().div_ceil(2)))
    }

    fn columns(&self, output: usize) -> Result<impl Iterator<Item = &[f64]>, UncertaintyError> {
        self.sample.values(output)?;
        Ok(self.parts.iter().map(move |part| part[output].as_slice()))
    }
}

/// Standard error of the mean of independent figures.
fn scatter(figures: &[f64]) -> f64 {
    Moments::of_values(figures).standard_deviation().unwrap_or(0.0) / (figures.len() as f64).sqrt()
}
