//! Series at unequal times with its noise averaged, and its slope.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

/// Values and slopes of a series by cubics through each sample and its neighbours.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Smoothed {
    pub(crate) values: Vec<f64>,
    /// Per s.
    pub(crate) slopes: Vec<f64>,
    /// `None` where the series stays as it is.
    averaged: Option<Averaged>,
}

/// Averaging of a series.
#[derive(Debug, Clone, PartialEq)]
struct Averaged {
    /// Neighbours to either side.
    width: usize,
    /// Differences that it took off.
    rest: Vec<f64>,
}

/// Neighbours to either side that are tried, the fewest first.
const WIDTHS: [usize; 13] = [2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128];
/// Power of the number of neighbours with which the rest that cubics leave may grow and still be noise (1). Where
/// cubics do not follow the series it grows with the fourth power, for white noise not at all; the steps of a converter
/// lie between. Origin: least errors of velocity and acceleration for white noise of 0.3 to 20 % and for steps.
const GROWTH: f64 = 0.3;
/// Largest rest over that of the fewest neighbours (1): a series that leaps leaves more.
const LARGEST_RISE: f64 = 1.5;
/// Most samples, spread over the series, by which the number of neighbours is chosen.
const LOOKED_AT: usize = 2000;

/// Cubic through neighbours: value and slope at the sample, and the variance of its residuals.
struct Cubic {
    value: f64,
    slope: f64,
    variance: f64,
}

impl Smoothed {
    /// Smoothes `values` at ascending `times` (s), at least three. A series without noise stays unchanged, with the
    /// slopes of the parabola through a sample and its neighbours.
    pub(crate) fn of(times: &[f64], values: &[f64]) -> Self {
        let chosen = width_for(times, values);
        let averaged = chosen.and_then(|width| Self::by_cubics(times, values, width));
        averaged.unwrap_or_else(|| Self::plain(times, values.to_vec()))
    }

    /// The `values` as they are.
    pub(crate) fn plain(times: &[f64], values: Vec<f64>) -> Self {
        Self { slopes: slopes(times, &values, 1), values, averaged: None }
    }

    /// Smoothes `values` by cubics through `width` neighbours to either side; `None` if the samples are too few.
    pub(crate) fn by_cubics(times: &[f64], values: &[f64], width: usize) -> Option<Self> {
        let count = times.len();
        let is_enough = width >= WIDTHS[0] && 2 * width < count;
        let cubics =
            is_enough.then(|| (0..count).map(|at| cubic(times, values, at, width)).collect::<Option<Vec<_>>>());
        let cubics = cubics.flatten()?;
        let rest = values.iter().zip(&cubics).map(|(value, cubic)| value - cubic.value).collect();
        Some(Self {
            values: cubics.iter().map(|cubic| cubic.value).collect(),
            slopes: cubics.iter().map(|cubic| cubic.slope).collect(),
            averaged: Some(Averaged { width, rest }),
        })
    }

    /// Other `values`, averaged as this series was.
    pub(crate) fn like(&self, times: &[f64], values: Vec<f64>) -> Self {
        let averaged = self.averaged.as_ref().and_then(|own| Self::by_cubics(times, &values, own.width));
        averaged.unwrap_or_else(|| Self::plain(times, values))
    }

    /// This series averaged once more; one that is not averaged with the slopes of its quartics.
    pub(crate) fn again(&self, times: &[f64]) -> Self {
        let mut again = self.like(times, self.values.clone());
        if self.averaged.is_none() {
            // Twice as far away slopes of parabolas are off by four times as much (Richardson).
            for (slope, wide) in again.slopes.iter_mut().zip(slopes(times, &self.values, 2)) {
                *slope += (*slope - wide) / 3.0;
            }
        }
        again
    }

    /// This series with as much white noise once more as was averaged in it, that of this `seed`.
    pub(crate) fn with_noise(&self, times: &[f64], seed: u64) -> Self {
        let Some(Averaged { rest, .. }) = &self.averaged else { return self.clone() };
        let deviation = (rest.iter().map(|rest| rest * rest).sum::<f64>() / rest.len() as f64).sqrt();
        let Ok(white) = Normal::new(0.0, deviation) else { return self.clone() };
        // Other noise for each series.
        let random = ChaCha8Rng::seed_from_u64(seed ^ rest[0].to_bits());
        let noise = white.sample_iter(random).take(rest.len()).collect();
        let noise = self.like(times, noise);
        let sum = |own: &[f64], noise: &[f64]| own.iter().zip(noise).map(|(a, b)| a + b).collect();
        Self { values: sum(&self.values, &noise.values), slopes: sum(&self.slopes, &noise.slopes), ..self.clone() }
    }

    /// Noise that was averaged, over the standard deviation of the series (1), and the samples over which it was;
    /// `None` if nothing was.
    pub(crate) fn noise(&self) -> Option<(f64, usize)> {
        let Averaged { width, rest } = self.averaged.as_ref()?;
        let mean = self.values.iter().sum::<f64>() / self.values.len() as f64;
        let sum = |values: &[f64], mean: f64| values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        let share = (sum(rest, 0.0) / sum(&self.values, mean)).sqrt();
        Some((share, 2 * width + 1)).filter(|(share, _)| share.is_finite())
    }
}

/// Neighbours to either side over which noise is averaged best: those for which the rest is least beside the growth
/// that noise may have; `None` where that are the fewest, so that no noise is seen.
fn width_for(times: &[f64], values: &[f64]) -> Option<usize> {
    let count = times.len();
    let stride = count.div_ceil(LOOKED_AT);
    // The median, so that a series that leaps is judged by what lies between.
    let left = |width: usize| {
        let cubics = (0..count).step_by(stride).filter_map(|at| cubic(times, values, at, width));
        let mut variances: Vec<f64> = cubics.map(|cubic| cubic.variance).collect();
        variances.sort_by(f64::total_cmp);
        // Of so many squares of noise the median lies below the mean (Wilson and Hilferty).
        let below = (1.0 - 2.0 / (9.0 * (2 * width + 1 - ORDER) as f64)).powi(3);
        variances.get(variances.len() / 2).map_or(0.0, |variance| (variance / below).sqrt())
    };
    let widths = WIDTHS.into_iter().take_while(|width| 2 * width < count);
    // Few neighbours do not see the steps of a converter.
    let seen: Vec<(usize, f64)> = widths.map(|width| (width, left(width))).filter(|(_, left)| *left > 0.0).collect();
    let (fewest, least) = *seen.first()?;
    let weighed = |(width, left): &(usize, f64)| left / (*width as f64).powf(GROWTH);
    let (width, left) = seen.into_iter().min_by(|a, b| weighed(a).total_cmp(&weighed(b)))?;
    (width > fewest && left <= LARGEST_RISE * least).then_some(width)
}

/// Coefficients of a cubic.
const ORDER: usize = 4;

/// The cubic of least squares through `width` neighbours to either side of sample `at`, as far as there are any; `None`
/// if they do not determine it.
fn cubic(times: &[f64], values: &[f64], at: usize, width: usize) -> Option<Cubic> {
    // At the ends as many neighbours, of one side.
    let first = at.saturating_sub(width).min(times.len() - 2 * width - 1);
    let around = first..first + 2 * width + 1;
    let scale = times[around.end - 1] - times[first];
    let mut normal = [[0.0; ORDER + 1]; ORDER];
    let mut square = 0.0;
    for i in around.clone() {
        let (t, y) = ((times[i] - times[at]) / scale, values[i] - values[at]);
        let powers = [1.0, t, t * t, t * t * t];
        for (row, a) in normal.iter_mut().zip(powers) {
            for (element, b) in row.iter_mut().zip(powers) {
                *element += a * b;
            }
            row[ORDER] += a * y;
        }
        square += y * y;
    }
    let right = normal.map(|row| row[ORDER]);
    // Positive definite: no pivot need be looked for. Columns that are alike to 1e-10, as a gap in the times makes
    // them, determine a cubic all the same; the inverse of linear_algebra.rs would leave one of them out.
    for pivot in 0..ORDER {
        if normal[pivot][pivot] <= 1e-14 {
            return None;
        }
        let row = normal[pivot];
        for below in &mut normal[pivot + 1..] {
            let factor = below[pivot] / row[pivot];
            below.iter_mut().zip(row).for_each(|(element, a)| *element -= factor * a);
        }
    }
    let mut solution = [0.0; ORDER];
    for i in (0..ORDER).rev() {
        let known: f64 = (i + 1..ORDER).map(|j| normal[i][j] * solution[j]).sum();
        solution[i] = (normal[i][ORDER] - known) / normal[i][i];
    }
    let explained: f64 = solution.iter().zip(right).map(|(a, b)| a * b).sum();
    let variance = (square - explained).max(0.0) / (around.len() - ORDER) as f64;
    Some(Cubic { value: values[at] + solution[0], slope: solution[1] / scale, variance })
}

/// Slope of the parabola through each value and those `distance` samples away; towards the ends those that are as far
/// away as there are any, at the ends that of the line to the only one.
fn slopes(times: &[f64], values: &[f64], distance: usize) -> Vec<f64> {
    let slope = |i: usize, j: usize| (values[j] - values[i]) / (times[j] - times[i]);
    let last = times.len() - 1;
    let inside = (1..last).map(|i| {
        let distance = distance.min(i).min(last - i);
        let (first, end) = (i - distance, i + distance);
        let (before, after) = (times[i] - times[first], times[end] - times[i]);
        (slope(first, i) * after + slope(i, end) * before) / (before + after)
    });
    std::iter::once(slope(0, 1)).chain(inside).chain(std::iter::once(slope(last - 1, last))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times() -> Vec<f64> {
        (0..2000).map(|i| 1e-3 * (f64::from(i) + 0.3 * f64::from(i % 3))).collect()
    }

    fn rms(found: &[f64], wanted: impl Iterator<Item = f64>) -> f64 {
        (found.iter().zip(wanted).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / found.len() as f64).sqrt()
    }

    #[test]
    fn what_has_no_noise_stays_as_it_is() {
        let times = times();
        let values: Vec<f64> = times.iter().map(|t| (20.0 * t).sin()).collect();
        let found = Smoothed::of(&times, &values);
        assert_eq!(found.values, values);
        assert!(rms(&found.slopes, times.iter().map(|t| 20.0 * (20.0 * t).cos())) < 1e-2);
    }

    /// Steps of an encoder: the slope of neighbours is off by 0.5, as steps of 1e-3 in 1 ms are.
    #[test]
    fn steps_are_averaged() {
        let times = times();
        let values: Vec<f64> = times.iter().map(|t| ((5.0 * t).sin() / 1e-3).round() * 1e-3).collect();
        let found = Smoothed::of(&times, &values);
        let slope = || times.iter().map(|t| 5.0 * (5.0 * t).cos());
        let off = rms(&found.values, times.iter().map(|t| (5.0 * t).sin()));
        assert!(off < 1.5e-4, "{off}");
        let (smooth, rough) = (rms(&found.slopes, slope()), rms(&slopes(&times, &values, 1), slope()));
        assert!(smooth < 0.02 && rough > 0.2, "{smooth}, {rough}");
    }

    #[test]
    fn few_values_stay_as_they_are() {
        for count in 3..7 {
            let times: Vec<f64> = (0..count).map(f64::from).collect();
            let found = Smoothed::of(&times, &times);
            assert_eq!((found.values, found.slopes), (times.clone(), vec![1.0; times.len()]));
        }
    }
}
