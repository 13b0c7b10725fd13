//! The discrete Fourier transform of real samples.

use std::fmt;
use std::sync::Arc;

use realfft::num_complex::Complex64;
use realfft::{RealFftPlanner, RealToComplex};

use crate::RecordError;

/// The discrete Fourier transform of real samples of one length.
///
/// ```text
/// X_k = Σ_j x_j e^{−2πi jk/n},   0 ≤ k ≤ n/2
/// ```
///
/// Of `realfft`, and compiled once for all crates that transform: its plans are generic, and each crate that made its
/// own would compile every algorithm of it again, half a minute each. It is planned once for as many records as have
/// that length, and copies share the plan. Any length will do, but primes are slow.
///
/// ```
/// use fmm_record::RealTransform;
///
/// let transform = RealTransform::new(4);
/// let (mut spectrum, mut scratch) = (Vec::new(), Vec::new());
/// transform.run(&mut [1.0, 2.0, 3.0, 2.0], &mut spectrum, &mut scratch)?;
/// let expected = [(8.0, 0.0), (-2.0, 0.0), (0.0, 0.0)];
/// assert!(spectrum.iter().zip(expected).all(|(line, (re, im))| line.re == re && line.im == im));
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Clone)]
pub struct RealTransform {
    plan: Arc<dyn RealToComplex<f64>>,
}

impl RealTransform {
    /// The transform of `length` samples.
    pub fn new(length: usize) -> Self {
        Self { plan: RealFftPlanner::new().plan_fft_forward(length) }
    }

    /// Number of samples.
    pub fn length(&self) -> usize {
        self.plan.len()
    }

    /// Number of lines: those from zero frequency to half the rate.
    pub fn lines(&self) -> usize {
        self.length() / 2 + 1
    }

    /// Memory in which [`run`](Self::run) works, so that its first call takes none.
    pub fn scratch(&self) -> Vec<Complex64> {
        self.plan.make_scratch_vec()
    }

    /// Writes the lines of `samples`, which are lost, to `spectrum`, in the unit of the samples; `scratch` is memory,
    /// and both are used again.
    ///
    /// # Errors
    /// [`RecordError::Options`] for another number of samples.
    pub fn run(
        &self,
        samples: &mut [f64],
        spectrum: &mut Vec<Complex64>,
        scratch: &mut Vec<Complex64>,
    ) -> Result<(), RecordError> {
        let wrong_length = |samples: &[f64]| {
            RecordError::options(format!("a transform of {} samples was given {}", self.length(), samples.len()))
        };
        if samples.len() != self.length() {
            return Err(wrong_length(samples));
        }
        spectrum.resize(self.lines(), Complex64::default());
        scratch.resize(self.plan.get_scratch_len(), Complex64::default());
        self.plan.process_with_scratch(samples, spectrum, scratch).map_err(|_| wrong_length(samples))
    }
}

impl fmt::Debug for RealTransform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RealTransform").field("length", &self.length()).finish_non_exhaustive()
    }
}
