//! Search about the best values so far, for a sum of squares that jumps.

use fmm_fit::{Fit, FitError, Minimizer, Options, Residuals};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Sizes of kicks: from the whole reach down to this many decades less, all equally likely.
const DECADES: f64 = 3.0;

/// Rounds of kicks about the best values so far.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kicks {
    pub(crate) rounds: usize,
    /// Kicks of each round.
    pub(crate) count: usize,
    pub(crate) seed: u64,
}

impl Kicks {
    /// The lowest end of the fits of `problem` from `start` and from kicks no farther than `reach`, one value per
    /// parameter in its unit; one that is no minimum if none is.
    pub(crate) fn lowest(
        &self,
        problem: &impl Residuals,
        start: &[f64],
        reach: &[f64],
        options: Options,
    ) -> Result<Fit, FitError> {
        let mut minimizer = Minimizer::new(options);
        let mut ends = [None, None];
        let mut fit = |from: &[f64], ends: &mut [Option<Fit>; 2]| {
            let is_minimum = minimizer.minimize(problem, from)?.is_success();
            let best = &mut ends[usize::from(is_minimum)];
            if best.as_ref().is_none_or(|best| minimizer.sum_of_squares() < best.sum_of_squares()) {
                *best = Some(minimizer.fit()?);
            }
            Ok::<_, FitError>(())
        };
        fit(start, &mut ends)?;
        for round in 0..self.rounds {
            let lowest = ends.iter().flatten().min_by(|a, b| a.sum_of_squares().total_cmp(&b.sum_of_squares()));
            let centre = lowest.map_or(start, Fit::values).to_vec();
            for number in 0..self.count {
                let from = self.kick(problem, start, reach, &centre, round * self.count + number);
                match fit(&from, &mut ends) {
                    // The motion has no value there: other kicks may do.
                    Ok(()) | Err(FitError::NoModel { .. }) => {}
                    Err(error) => return Err(error),
                }
            }
        }
        let [unfinished, minimum] = ends;
        minimum.or(unfinished).ok_or(FitError::NotStarted)
    }

    /// A point about `centre`; each kick has a stream of random numbers of its own.
    fn kick(&self, problem: &impl Residuals, start: &[f64], reach: &[f64], centre: &[f64], number: usize) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        random.set_stream(1 + number as u64);
        let size = 10f64.powf(-DECADES * random.random::<f64>());
        let of_all = problem.parameters().iter().zip(start).zip(reach).zip(centre);
        of_all
            .map(|(((parameter, start), reach), centre)| {
                let bounds = parameter.bounds();
                let half = 0.5 * bounds.clamp(start + reach) - 0.5 * bounds.clamp(start - reach);
                bounds.clamp(centre + size * half * (2.0 * random.random::<f64>() - 1.0))
            })
            .collect()
    }
}
