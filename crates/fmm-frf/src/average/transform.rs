//! The two spectra of a trial, in buffers that are used again.

use std::ops::Range;

use fmm_record::{Complex64, RealTransform};
use pulp::Arch;

use crate::average::options::AverageOptions;
use crate::channel::{Baseline, Channel};
use crate::error::FrfError;

/// Number of trials whose spectra are kept. Adding up two at a time saves a third of the time, which goes into memory
/// transfers.
pub(crate) const SLOTS: usize = 2;

/// Preparation of one channel before its transform, and the transform.
#[derive(Debug, Clone)]
struct Side {
    channel: Channel,
    unit: &'static str,
    baseline: Baseline,
    weights: Option<Vec<f64>>,
    spectra: [Vec<Complex64>; SLOTS],
}

/// The plan of a transform of one length, with all memory that it needs.
#[derive(Debug, Clone)]
pub(crate) struct TrialTransform {
    plan: RealTransform,
    samples: Vec<f64>,
    scratch: Vec<Complex64>,
    force: Side,
    response: Side,
}

impl TrialTransform {
    /// A transform of `length` samples, `interval` (s) apart.
    pub(crate) fn new(length: usize, interval: f64, options: &AverageOptions) -> Result<Self, FrfError> {
        let plan = RealTransform::new(length);
        let side = |channel, unit, baseline, weights| Side {
            channel,
            unit,
            baseline,
            weights,
            spectra: [vec![Complex64::default(); plan.lines()], vec![Complex64::default(); plan.lines()]],
        };
        Ok(Self {
            samples: vec![0.0; length],
            scratch: plan.scratch(),
            force: side(Channel::Force, "N", options.force_baseline.clone(), options.force_weights(length, interval)?),
            response: side(
                Channel::Response,
                "(unit of the response)",
                options.response_baseline.clone(),
                options.response_weights(length, interval),
            ),
            plan,
        })
    }

    /// Transforms a trial into one of the slots; without an error, [`TrialTransform::spectra`] of that are its.
    pub(crate) fn run(&mut self, slot: usize, force: &[f64], response: &[f64]) -> Result<(), FrfError> {
        let Self { plan, samples, scratch, force: force_side, response: response_side } = self;
        for (side, given) in [(&*force_side, force), (&*response_side, response)] {
            if given.len() != samples.len() {
                return Err(FrfError::sample_count(side.channel, samples.len(), given.len()));
            }
        }
        let mut force_energy = 0.0;
        for (side, given) in [(force_side, force), (response_side, response)] {
            let energy = side.weigh(given, samples)?;
            if side.channel == Channel::Force {
                force_energy = energy;
            }
            let run = plan.run(samples, &mut side.spectra[slot], scratch);
            run.map_err(|_| FrfError::sample_count(side.channel, plan.length(), samples.len()))?;
        }
        if force_energy > 0.0 { Ok(()) } else { Err(FrfError::no_force()) }
    }

    /// Spectra of force and response at some `lines` of those from zero frequency to half the rate; their unit is that
    /// of a sum of samples.
    pub(crate) fn spectra(&self, slot: usize, lines: &Range<usize>) -> (&[Complex64], &[Complex64]) {
        (&self.force.spectra[slot][lines.clone()], &self.response.spectra[slot][lines.clone()])
    }

    /// Sums of the squared weights of force and response.
    pub(crate) fn weight_energies(&self) -> (f64, f64) {
        let energy = |side: &Side| match &side.weights {
            Some(weights) => weights.iter().map(|weight| weight * weight).sum(),
            None => self.samples.len() as f64,
        };
        (energy(&self.force), energy(&self.response))
    }
}

impl Side {
    /// Writes the weighed samples and gives the sum of their squares.
    ///
    /// A line of the spectrum is at most the root of N times that sum, so that a finite sum keeps every square finite.
    fn weigh(&self, given: &[f64], samples: &mut [f64]) -> Result<f64, FrfError> {
        let energy = match (&self.baseline, &self.weights) {
            (Baseline::Keep, None) => weigh(given, samples, |x, _| x, &[]),
            (baseline, weights) => {
                let offset = baseline.clone().offset_of(given, self.unit);
                // A mean that is not finite has a sample to blame.
                let offset = offset.map_err(|error| match FrfError::require_samples(self.channel, given) {
                    Err(sample) => sample,
                    Ok(()) => error,
                })?;
                match weights {
                    None => weigh(given, samples, |x, _| x - offset, &[]),
                    Some(weights) => weigh(given, samples, |x, w| (x - offset) * w, weights),
                }
            }
        };
        if (energy * given.len() as f64).is_finite() {
            return Ok(energy);
        }
        FrfError::require_samples(self.channel, given)?;
        let what = format!("the samples of the {} are so large that their squares overflow", self.channel);
        Err(FrfError::values(what))
    }
}

/// Writes `rule` of each sample and its weight, and gives the sum of the squares; without `weights` the weight is one.
fn weigh(given: &[f64], samples: &mut [f64], rule: impl Fn(f64, f64) -> f64, weights: &[f64]) -> f64 {
    const LANES: usize = 8;
    // A block small enough to be still in the cache when its squares are summed.
    const BLOCK: usize = 1024;
    #[expect(clippy::inline_always, reason = "only what is inlined is compiled for the wide vectors")]
    #[inline(always)]
    fn squares(block: &[f64]) -> f64 {
        let mut sums = [0.0; LANES];
        let (chunks, rest) = block.as_chunks::<LANES>();
        for chunk in chunks {
            for (sum, x) in sums.iter_mut().zip(chunk) {
                *sum += x * x;
            }
        }
        sums.iter().sum::<f64>() + rest.iter().map(|x| x * x).sum::<f64>()
    }
    Arch::new().dispatch(
        #[inline(always)]
        || {
            let mut energy = 0.0;
            let blocks = given.chunks(BLOCK).zip(samples.chunks_mut(BLOCK)).enumerate();
            for (block, (given, samples)) in blocks {
                if weights.is_empty() {
                    samples.iter_mut().zip(given).for_each(|(sample, &x)| *sample = rule(x, 1.0));
                } else {
                    let weights = &weights[block * BLOCK..];
                    let weighed = samples.iter_mut().zip(given).zip(weights);
                    weighed.for_each(|((sample, &x), &w)| *sample = rule(x, w));
                }
                energy += squares(samples);
            }
            energy
        },
    )
}
