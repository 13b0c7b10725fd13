//! Noise of the records as the residuals of a fit show it: its growth with the signal, and its correlation from sample
//! to sample.

use std::f64::consts::TAU;
use std::ops::Range;

use fmm_record::{Complex64, RealTransform};

use crate::residuals::autoregression::Autoregression;
use crate::residuals::noise_growth::NoiseGrowth;
use crate::residuals::rules::{
    FEWEST_ORDINATES, FEWEST_RESIDUALS, GROUPS_PER_PERIOD, MOST_ROWS, MOST_TAKEN, RESTORATIONS, SIGNIFICANT_DENSITY,
    SPREAD,
};

/// The noise of several series of residuals, such as one per record.
///
/// ```text
/// e_i = σ_i z_i,     z stationary with unit variance and the spectral density S(f):     Σ = D C D,   D = diag(σ_i)
/// ```
///
/// S is the density of an autoregression, times the periodogram over it where that, averaged over frequencies up to 2.5
/// times lower and higher, is significantly larger (prewhitening; Andrews and Monahan). The part of the periodogram P
/// that the parameters of the fit took is put back: E[P] = (1 − h) S, h the share of a line that they took.
///
/// The errors of a converter whose steps exceed the noise are not stationary: they last while the machine turns, and
/// change with every sample while it is fast. There the values stay within one step over a plateau: the residuals of
/// one plateau count together, and different plateaus are independent:
///
/// ```text
/// aᵀΣb = Σ_g (a_gᵀe_g)(b_gᵀe_g)/(1 − h_g)
/// ```
///
/// over the plateaus g, h the share of its mean that the parameters took (Liang and Zeger; Bell and McCaffrey).
///
/// # References
/// K.-Y. Liang, S. L. Zeger, "Longitudinal data analysis using generalized linear models", Biometrika 73 (1986) 13,
/// <https://doi.org/10.1093/biomet/73.1.13>; R. M. Bell, D. F. McCaffrey, "Bias reduction in standard errors for linear
/// regression with multi-stage samples", Survey Methodology 28 (2002) 169.
///
/// D. W. K. Andrews, J. C. Monahan, "An improved heteroskedasticity and autocorrelation consistent covariance matrix
/// estimator", Econometrica 60 (1992) 953, <https://doi.org/10.2307/2951574>.
#[derive(Debug, Clone)]
pub(crate) struct ResidualNoise {
    series: Vec<SeriesNoise>,
}

/// One series of residuals, with its signal and the columns of the fit.
pub(crate) struct Series<'a> {
    /// Its rows among all residuals.
    pub(crate) rows: Range<usize>,
    /// The signal without offset, one value a row, if the noise may grow with it.
    pub(crate) signal: Option<&'a [f64]>,
    /// Period of the signal (samples).
    pub(crate) period: f64,
    /// Columns of the fit at all rows, and the elements (JᵀJ)⁺ by which they count: pairs of columns with their weight.
    pub(crate) columns: &'a [Vec<f64>],
    pub(crate) weights: &'a [f64],
    /// Plateaus: rows within the series over which the values stay within one step of the converter, where its steps
    /// exceed the noise.
    pub(crate) plateaus: Vec<Range<usize>>,
}

#[derive(Debug, Clone)]
struct SeriesNoise {
    rows: Range<usize>,
    /// Neighbouring rows that are taken together.
    group: usize,
    /// σ of every group.
    deviations: Vec<f64>,
    growth: Option<NoiseGrowth>,
    transform: RealTransform,
    /// S at the lines of the padded transform (1).
    density: Vec<f64>,
    /// Independent ordinates of the periodogram behind each line of the density.
    ordinates: Vec<f64>,
    is_white: bool,
    /// The residuals of each plateau; empty where no steps exceed the noise.
    plateaus: Vec<Plateau>,
}

/// Neighbouring rows with one error of rounding.
#[derive(Debug, Clone)]
struct Plateau {
    rows: Range<usize>,
    /// The part that the parameters took is put back; in the unit of the residuals.
    residuals: Vec<f64>,
}

/// Image of a column under the noise of a series.
enum Image {
    Spectrum(Vec<Complex64>),
    Plateaus(Vec<f64>),
}

impl ResidualNoise {
    /// The noise that `residuals`, of a fit, show in each of `series`.
    pub(crate) fn of(residuals: &[f64], series: &[Series<'_>]) -> Self {
        Self { series: series.iter().map(|series| SeriesNoise::of(residuals, series)).collect() }
    }

    /// aᵀ Σ b of two columns over all residuals.
    pub(crate) fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        self.series.iter().map(|series| series.product(&series.image(a), &series.image(b))).sum()
    }

    /// Jᵀ Σ J of `columns` over all residuals, row by row.
    pub(crate) fn products(&self, columns: &[Vec<f64>]) -> Vec<f64> {
        let count = columns.len();
        let mut products = vec![0.0; count * count];
        for series in &self.series {
            let images: Vec<_> = columns.iter().map(|column| series.image(column)).collect();
            for i in 0..count {
                for j in i..count {
                    let product = series.product(&images[i], &images[j]);
                    products[i * count + j] += product;
                    if i != j {
                        products[j * count + i] += product;
                    }
                }
            }
        }
        products
    }

    /// Variance of the noise along `direction`, aᵀ Σ a/aᵀa, in the unit of the residuals squared; along zero the mean
    /// variance.
    pub(crate) fn variance_along(&self, direction: &[f64]) -> f64 {
        let square: f64 = direction.iter().map(|a| a * a).sum();
        if square > 0.0 {
            return self.product(direction, direction) / square;
        }
        let count: usize = self.series.iter().map(|series| series.deviations.len()).sum();
        let sum: f64 =
            self.series.iter().flat_map(|series| &series.deviations).map(|deviation| deviation * deviation).sum();
        sum / count.max(1) as f64
    }

    /// Every series is white and of one variance.
    pub(crate) fn is_white(&self) -> bool {
        self.series.iter().all(|series| series.is_white && series.growth.is_none() && series.plateaus.is_empty())
    }

    /// Growth of the noise with the signal, in the first series that shows one.
    pub(crate) fn growth(&self) -> Option<NoiseGrowth> {
        self.series.iter().find_map(|series| series.growth)
    }

    /// Independent ordinates of the periodogram, or plateaus, on which the variance along `direction` rests.
    pub(crate) fn ordinates_along(&self, direction: &[f64]) -> f64 {
        let (mut sum, mut weight) = (0.0, 0.0);
        for series in &self.series {
            match series.image(direction) {
                Image::Spectrum(lines) => {
                    for (line, ordinates) in lines.iter().zip(&series.ordinates) {
                        sum += line.norm_sqr() / ordinates;
                        weight += line.norm_sqr();
                    }
                }
                Image::Plateaus(parts) => {
                    let squares: f64 = parts.iter().map(|part| part * part).sum();
                    sum += parts.iter().map(|part| part.powi(4)).sum::<f64>() / squares.max(f64::MIN_POSITIVE);
                    weight += squares;
                }
            }
        }
        if sum > 0.0 { weight / sum } else { f64::INFINITY }
    }
}

impl SeriesNoise {
    fn of(residuals: &[f64], series: &Series<'_>) -> Self {
        let group = series.rows.len().div_ceil(MOST_ROWS).min((series.period / GROUPS_PER_PERIOD) as usize).max(1);
        let own = gathered(&residuals[series.rows.clone()], group);
        let count = own.len();
        let period = series.period / group as f64;
        let signal = series.signal.map(|signal| {
            // Means of the groups, as the noise of a group has the deviation of one row.
            gathered(signal, group).into_iter().map(|y| y / (group as f64).sqrt()).collect::<Vec<_>>()
        });
        let growth = signal.as_ref().and_then(|signal| NoiseGrowth::of(&own, signal, period));
        let deviations = match (growth, &signal) {
            (Some(growth), Some(signal)) => growth.deviations(signal, period),
            _ => vec![(own.iter().map(|r| r * r).sum::<f64>() / count.max(1) as f64).sqrt(); count],
        };
        let transform = RealTransform::new(padded(count));
        let mut noise = Self {
            rows: series.rows.clone(),
            group,
            deviations,
            growth,
            density: vec![1.0; transform.lines()],
            ordinates: vec![f64::INFINITY; transform.lines()],
            transform,
            is_white: true,
            plateaus: plateaus(&residuals[series.rows.clone()], series),
        };
        if count >= FEWEST_RESIDUALS && noise.deviations.iter().all(|deviation| *deviation > 0.0) {
            noise.colour(&own, series);
        }
        noise
    }

    /// Finds the spectral density of `residuals` of this series.
    fn colour(&mut self, residuals: &[f64], series: &Series<'_>) {
        let count = residuals.len();
        let unit: Vec<f64> = residuals.iter().zip(&self.deviations).map(|(r, deviation)| r / deviation).collect();
        let raw: Vec<f64> = self.spectrum(&unit).iter().map(|line| line.norm_sqr() / count as f64).collect();
        let taken = self.taken(series);
        let mut periodogram = raw.clone();
        let length = self.transform.length();
        let cosines: Vec<f64> = (0..length).map(|i| (TAU * i as f64 / length as f64).cos()).collect();
        let mut regression = Autoregression::of(&self.autocovariances(&periodogram, &cosines, count), count);
        // The parameters took a share of the density of a line, which is known better after each step.
        for _ in 0..RESTORATIONS {
            self.density = self.densities(&regression);
            periodogram = raw.iter().zip(&taken).zip(&self.density).map(|((p, share), s)| p + share * s).collect();
            regression = Autoregression::of(&self.autocovariances(&periodogram, &cosines, count), count);
        }
        self.density = self.densities(&regression);
        let lines = self.density.len();
        let mut sums = vec![0.0];
        for (p, s) in periodogram.iter().zip(&self.density) {
            sums.push(sums[sums.len() - 1] + p / s);
        }
        let mut known = vec![0.0];
        for share in &taken {
            known.push(known[known.len() - 1] + (1.0 - share).max(0.0));
        }
        let per_line = count as f64 / self.transform.length() as f64;
        let fewest = FEWEST_ORDINATES / per_line;
        let mut is_flat = true;
        for k in 0..lines {
            let line = k as f64;
            let low = (line / SPREAD).min(line - 0.5 * fewest).max(0.0) as usize;
            let high = (SPREAD * line).max(low as f64 + fewest).ceil().min(lines as f64) as usize;
            let ordinates = ((known[high] - known[low]) * per_line).max(1.0);
            let average = (sums[high] - sums[low]) / (high - low).max(1) as f64;
            if average.ln() > SIGNIFICANT_DENSITY / ordinates.sqrt() {
                self.density[k] *= average;
                self.ordinates[k] = ordinates;
                is_flat = false;
            }
        }
        self.is_white = is_flat && regression.order() == 0;
    }

    fn densities(&self, regression: &Autoregression) -> Vec<f64> {
        let length = self.transform.length() as f64;
        (0..self.transform.lines()).map(|k| regression.density(k as f64 / length)).collect()
    }

    /// The autocovariances of a series of `count` values that belong to its `periodogram`; `cosines` are those of one
    /// turn.
    fn autocovariances(&self, periodogram: &[f64], cosines: &[f64], count: usize) -> Vec<f64> {
        let length = self.transform.length();
        let last = periodogram.len() - 1;
        let at = |lag: usize| {
            let mut turn = 0;
            let terms = periodogram.iter().enumerate().map(|(k, p)| {
                let times = if k == 0 || (k == last && length.is_multiple_of(2)) { 1.0 } else { 2.0 };
                let term = times * p * cosines[turn];
                turn = if turn + lag >= length { turn + lag - length } else { turn + lag };
                term
            });
            terms.sum::<f64>() / length as f64
        };
        (0..Autoregression::lags(count)).map(at).collect()
    }

    /// The share of each line that the parameters of the fit have taken (1).
    fn taken(&self, series: &Series<'_>) -> Vec<f64> {
        let own = |column: &Vec<f64>| self.spectrum(&gathered(&column[self.rows.clone()], self.group));
        let lines: Vec<Vec<Complex64>> = series.columns.iter().map(own).collect();
        let count = (self.deviations.len().max(1)) as f64;
        let mut taken = vec![0.0; self.transform.lines()];
        for (i, a) in lines.iter().enumerate() {
            for (j, b) in lines.iter().enumerate() {
                let weight = series.weights[i * lines.len() + j] / count;
                for ((share, a), b) in taken.iter_mut().zip(a).zip(b) {
                    *share += weight * (a.conj() * b).re;
                }
            }
        }
        taken.iter().map(|share| share.clamp(0.0, 1.0)).collect()
    }

    /// The spectrum of `values`, one a group of this series, padded with zeros.
    fn spectrum(&self, values: &[f64]) -> Vec<Complex64> {
        let mut samples = values.to_vec();
        samples.resize(self.transform.length(), 0.0);
        let (mut spectrum, mut scratch) = (Vec::new(), Vec::new());
        // The length is that of the transform.
        let _ = self.transform.run(&mut samples, &mut spectrum, &mut scratch);
        spectrum
    }

    /// Image of a `column` over all residuals: the spectrum of D a, or its part in every plateau.
    fn image(&self, column: &[f64]) -> Image {
        let column = &column[self.rows.clone()];
        if !self.plateaus.is_empty() {
            let part = |plateau: &Plateau| {
                column[plateau.rows.clone()].iter().zip(&plateau.residuals).map(|(a, r)| a * r).sum()
            };
            return Image::Plateaus(self.plateaus.iter().map(part).collect());
        }
        let mut values = gathered(column, self.group);
        values.iter_mut().zip(&self.deviations).for_each(|(a, deviation)| *a *= deviation);
        Image::Spectrum(self.spectrum(&values))
    }

    /// aᵀ Σ b of the images of two columns. With C the Toeplitz matrix that belongs to the density, aᵀ D C D b is a sum
    /// over the lines of spectra of values with as many zeros behind them.
    fn product(&self, a: &Image, b: &Image) -> f64 {
        match (a, b) {
            (Image::Spectrum(a), Image::Spectrum(b)) => {
                let length = self.transform.length();
                let last = self.transform.lines() - 1;
                let terms = a.iter().zip(b).zip(&self.density).enumerate().map(|(k, ((a, b), density))| {
                    let times = if k == 0 || (k == last && length.is_multiple_of(2)) { 1.0 } else { 2.0 };
                    times * density * (a.conj() * b).re
                });
                terms.sum::<f64>() / length as f64
            }
            (Image::Plateaus(a), Image::Plateaus(b)) => a.iter().zip(b).map(|(a, b)| a * b).sum(),
            // One series makes images of one kind.
            _ => 0.0,
        }
    }
}

/// The plateaus of `series` with its own `residuals`; the share of each mean that the parameters took is put back.
fn plateaus(residuals: &[f64], series: &Series<'_>) -> Vec<Plateau> {
    let own = |column: &Vec<f64>, rows: &Range<usize>| -> f64 {
        column[series.rows.start + rows.start..series.rows.start + rows.end].iter().sum()
    };
    let plateau = |rows: &Range<usize>| {
        let sums: Vec<f64> = series.columns.iter().map(|column| own(column, rows)).collect();
        let mut share = 0.0;
        for (a, weights) in sums.iter().zip(series.weights.chunks(sums.len().max(1))) {
            share += a * weights.iter().zip(&sums).map(|(weight, b)| weight * b).sum::<f64>();
        }
        let left = 1.0 - (share / rows.len() as f64).clamp(0.0, MOST_TAKEN);
        Plateau { rows: rows.clone(), residuals: residuals[rows.clone()].iter().map(|r| r / left.sqrt()).collect() }
    };
    series.plateaus.iter().map(plateau).collect()
}

/// Σ/√m of every `group` of m neighbouring values: independent values keep their variance, slow ones their sum of
/// products.
fn gathered(values: &[f64], group: usize) -> Vec<f64> {
    if group == 1 {
        return values.to_vec();
    }
    values.chunks(group).map(|values| values.iter().sum::<f64>() / (values.len() as f64).sqrt()).collect()
}

/// The next length of at least twice `count` that has small factors only.
fn padded(count: usize) -> usize {
    let least = (2 * count).max(2);
    let mut best = least.next_power_of_two();
    for odd in [3, 5, 9, 15] {
        let mut length = odd;
        while length < least {
            length *= 2;
        }
        best = best.min(length);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal numbers by the sum of twelve uniform ones.
    fn normals(seed: u64, count: usize) -> Vec<f64> {
        let mut state = seed;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..count).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
    }

    fn series(rows: usize, plateaus: Vec<Range<usize>>) -> Series<'static> {
        Series { rows: 0..rows, signal: None, period: 100.0, columns: &[], weights: &[], plateaus }
    }

    fn slow(count: usize) -> Vec<f64> {
        (0..count).map(|i| (TAU * i as f64 / 500.0).sin()).collect()
    }

    #[test]
    fn white_noise_has_its_variance_along_every_direction() {
        let residuals = normals(1, 4000);
        let noise = ResidualNoise::of(&residuals, &[series(4000, Vec::new())]);
        assert!(noise.is_white());
        let variance = noise.variance_along(&slow(4000));
        assert!((variance - 1.0).abs() < 0.1, "{variance}");
    }

    /// z_i = 0.9 z_{i−1} + e_i has 19 times its variance at frequencies far below the rate.
    #[test]
    fn noise_that_remembers_itself_has_more_along_slow_directions() {
        let mut last = 0.0;
        let residuals: Vec<f64> = normals(2, 8000)
            .into_iter()
            .map(|e| {
                last = 0.9 * last + e;
                last
            })
            .collect();
        let noise = ResidualNoise::of(&residuals, &[series(8000, Vec::new())]);
        assert!(!noise.is_white());
        let variance = noise.variance_along(&slow(8000));
        assert!((variance / 100.0 - 1.0).abs() < 0.25, "{variance}");
    }

    /// Long series are judged by their groups, to the same end.
    #[test]
    fn a_million_residuals_tell_the_variance_of_one() {
        let count = 1_000_000;
        let residuals = normals(3, count);
        let series = Series { period: 1e5, ..series(count, Vec::new()) };
        let noise = ResidualNoise::of(&residuals, &[series]);
        let direction: Vec<f64> = (0..count).map(|i| (TAU * i as f64 / 1e5).sin()).collect();
        let variance = noise.variance_along(&direction);
        assert!((variance - 1.0).abs() < 0.1, "{variance}");
    }

    /// One error for each ten rows: along a constant its variance is ten times that of a row.
    #[test]
    fn plateaus_count_together() {
        let errors = normals(4, 400);
        let residuals: Vec<f64> = errors.iter().flat_map(|error| [*error; 10]).collect();
        let plateaus = (0..400).map(|plateau| 10 * plateau..10 * plateau + 10).collect();
        let noise = ResidualNoise::of(&residuals, &[series(4000, plateaus)]);
        let square = errors.iter().map(|e| e * e).sum::<f64>() / 400.0;
        let constant = vec![1.0; 4000];
        let variance = noise.variance_along(&constant);
        assert!((variance - 10.0 * square).abs() < 1e-9 * variance, "{variance}");
        assert!(!noise.is_white());
        assert!((50.0..400.0).contains(&noise.ordinates_along(&constant)));
    }

    /// A column that takes the whole mean of a plateau hides its error, which is put back in part.
    #[test]
    fn the_share_that_parameters_took_is_put_back() {
        let residuals = [0.6, 0.6, 0.6, 0.6, 1.0, 1.0, 1.0, 1.0];
        let columns = [vec![1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]];
        let series = Series {
            rows: 0..8,
            signal: None,
            period: 100.0,
            columns: &columns,
            weights: &[0.16],
            plateaus: vec![0..4, 4..8],
        };
        let noise = ResidualNoise::of(&residuals, &[series]);
        // h = 0.16 · 4²/4 = 0.64: the first error of 0.6 stands for 1.
        let [first, second] = [0..4, 4..8].map(|rows: Range<usize>| {
            let direction: Vec<f64> = (0..8).map(|row| f64::from(u8::from(rows.contains(&row)))).collect();
            noise.product(&direction, &direction)
        });
        assert!((first - 16.0).abs() < 1e-9 && (second - 16.0).abs() < 1e-9, "{first}, {second}");
    }
}
