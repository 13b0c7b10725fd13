//! Start points: spread over a region, or around one point.

use fmm_model::Parameter;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Kicks are this many decades smaller than the region, at most.
const DECADES: f64 = 3.0;

/// The region from which starts are drawn, and the seed; every start has its own stream of random numbers, so that
/// none depends on how many were drawn before.
#[derive(Debug, Clone)]
pub(crate) struct StartPoints {
    /// Per parameter; equal ends hold it.
    intervals: Vec<(f64, f64)>,
    seed: u64,
}

impl StartPoints {
    /// The region within `reach` of `start` and inside the bounds. Where there is no reach it is the interval of the
    /// parameter, or, if that is unbounded, within `size(parameter)` of the start.
    pub(crate) fn new(
        parameters: &[Parameter],
        start: &[f64],
        reach: Option<&[f64]>,
        size: impl Fn(usize) -> f64,
        seed: u64,
    ) -> Self {
        let interval = |(j, (parameter, start)): (usize, (&Parameter, &f64))| {
            let bounds = parameter.bounds();
            let reach = match reach {
                Some(reach) => reach[j],
                None if (bounds.upper() - bounds.lower()).is_finite() => return (bounds.lower(), bounds.upper()),
                None => size(j),
            };
            (bounds.clamp(start - reach), bounds.clamp(start + reach))
        };
        Self { intervals: parameters.iter().zip(start).enumerate().map(interval).collect(), seed }
    }

    fn stream(&self, stream: u64) -> ChaCha8Rng {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        random.set_stream(stream);
        random
    }

    /// `count` points of a Latin hypercube: each `count`-th part of each interval holds one. They take the streams
    /// from `first` on.
    ///
    /// # References
    /// M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21 (1979) 239,
    /// <https://doi.org/10.1080/00401706.1979.10489755>.
    pub(crate) fn latin_hypercube(&self, count: usize, first: usize) -> Vec<Vec<f64>> {
        let mut points = vec![Vec::with_capacity(self.intervals.len()); count];
        let mut randoms: Vec<ChaCha8Rng> = (0..count).map(|i| self.stream((first + i) as u64)).collect();
        for (j, (lower, upper)) in self.intervals.iter().enumerate() {
            // Streams of permutations count down from the last.
            let strata = permutation(&mut self.stream(u64::MAX - j as u64), count);
            for ((point, random), stratum) in points.iter_mut().zip(&mut randoms).zip(strata) {
                let fraction = (stratum as f64 + random.random::<f64>()) / count as f64;
                point.push(between(*lower, *upper, fraction));
            }
        }
        points
    }

    /// `count` points around `centre`, at distances from the whole region down to a thousandth of it, all sizes being
    /// equally likely. They take the streams from `first` on.
    pub(crate) fn kicks(&self, centre: &[f64], parameters: &[Parameter], count: usize, first: usize) -> Vec<Vec<f64>> {
        let kick = |i: usize| {
            let mut random = self.stream((first + i) as u64);
            let size = 10f64.powf(-DECADES * random.random::<f64>());
            let moved = |((centre, (lower, upper)), parameter): ((&f64, &(f64, f64)), &Parameter)| {
                let half = 0.5 * upper - 0.5 * lower;
                let bounds = parameter.bounds();
                bounds.clamp(centre + size * half * (2.0 * random.random::<f64>() - 1.0))
            };
            centre.iter().zip(&self.intervals).zip(parameters).map(moved).collect()
        };
        (0..count).map(kick).collect()
    }
}

/// The point that far from `lower` to `upper`, without overflow and never outside.
fn between(lower: f64, upper: f64, fraction: f64) -> f64 {
    ((1.0 - fraction) * lower + fraction * upper).max(lower).min(upper)
}

/// The numbers below `count` in random order (Fisher and Yates).
fn permutation(random: &mut ChaCha8Rng, count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    for i in (1..count).rev() {
        order.swap(i, random.random_range(0..=i));
    }
    order
}

#[cfg(test)]
mod tests {
    use fmm_model::Bounds;

    use super::*;

    fn parameters() -> Vec<Parameter> {
        let bounds = [Bounds::new(-2.0, 6.0).unwrap(), Bounds::NOT_NEGATIVE, Bounds::new(3.0, 3.0).unwrap()];
        bounds.map(|bounds| Parameter::new("p", "p", "1").bounded(bounds)).to_vec()
    }

    #[test]
    fn every_stratum_of_every_interval_holds_one_point() {
        let parameters = parameters();
        let points = StartPoints::new(&parameters, &[0.0, 5.0, 3.0], None, |_| 10.0, 7);
        assert_eq!(points.intervals, [(-2.0, 6.0), (0.0, 15.0), (3.0, 3.0)]);
        let cube = points.latin_hypercube(20, 1);
        for (j, (lower, upper)) in points.intervals[..2].iter().enumerate() {
            let mut strata: Vec<usize> =
                cube.iter().map(|point| ((point[j] - lower) / (upper - lower) * 20.0) as usize).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..20).collect::<Vec<_>>(), "parameter {j}");
        }
        assert!(cube.iter().all(|point| point[2] == 3.0));
        assert_ne!(cube, StartPoints { seed: 8, ..points.clone() }.latin_hypercube(20, 1));
    }

    #[test]
    fn kicks_depend_on_their_number_only_and_stay_inside() {
        let parameters = parameters();
        let points = StartPoints::new(&parameters, &[0.0, 5.0, 3.0], Some(&[1.0, 0.5, 1.0]), |_| 10.0, 7);
        assert_eq!(points.intervals, [(-1.0, 1.0), (4.5, 5.5), (3.0, 3.0)]);
        let centre = [-2.0, 0.1, 3.0];
        let kicks = points.kicks(&centre, &parameters, 50, 10);
        assert_eq!(points.kicks(&centre, &parameters, 3, 27), kicks[17..20]);
        for kick in &kicks {
            assert!((-2.0..=-1.0).contains(&kick[0]) && (0.0..=0.6).contains(&kick[1]), "{kick:?}");
            assert_eq!(kick[2], 3.0);
        }
        let small = kicks.iter().filter(|kick| (kick[1] - 0.1).abs() < 0.5 * 0.03).count();
        // Half of the kicks are smaller than 10^-1.5 of the region: 25 ± 3.5, and a few of the others by chance.
        assert!((15..=40).contains(&small), "{small} of 50 are small");
    }
}
