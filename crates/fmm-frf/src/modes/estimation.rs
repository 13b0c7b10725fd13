//! From the stable poles to the modes that the lines need.

use fmm_fit::{Fit, Outcome};
use fmm_record::Complex64;
use nalgebra::DMatrix;

use super::band::Band;
use super::partial_fractions::{Basis, Lines, right_side};
use super::refinement::{Linear, Refinement, Weights, poles};

/// Normal deviation that noise passes with the probability of a false alarm, of 10⁻⁶ a pole (1). Origin: that of some
/// thousand lines, any of which may hold a peak of noise that is taken for a mode, one in a thousand is passed then.
const FALSE_ALARM: f64 = 4.753_424_308_822_899;

/// Poles (by the band's unit), their fit, and the linear fits of all responses.
pub(super) struct Estimation {
    pub(super) poles: Vec<Complex64>,
    pub(super) fit: Fit,
    pub(super) linear: Vec<Linear>,
    /// Σ r²/ν of the weighted residuals, at least 1 where the weights are those of known uncertainties.
    pub(super) variance: f64,
    pub(super) weights: Vec<Weights>,
}

impl Estimation {
    /// The poles that remain of `candidates` when those are left out of which no response has a residue that its
    /// uncertainty does not explain; none if all are.
    pub(super) fn of(band: &Band, lines: &Lines, mut candidates: Vec<Complex64>, is_choice: bool) -> Option<Self> {
        let mut weights = stated(band).unwrap_or_else(|| scatter(band, lines, &candidates));
        if !is_choice {
            screen(band, lines, &mut candidates, &weights);
        }
        let (mut reweighed, mut is_last) = (stated(band).is_some(), false);
        loop {
            if candidates.is_empty() {
                return None;
            }
            let refinement = Refinement::new(band, lines, &weights, candidates.len());
            let fit = refinement.fit(&candidates, is_last);
            let settled = fit.filter(|fit| {
                !matches!(fit.outcome(), Outcome::NonFinite) && fit.values().iter().all(|value| value.is_finite())
            });
            let (Some(fit), mut weak) = (settled, Vec::new()) else {
                return None;
            };
            let linear = refinement.linear(&fit)?;
            let found = poles(fit.values());
            let variance = variance(band, lines, &fit, stated(band).is_some());
            let strengths = strengths(&found, &linear, variance);
            let limit = significant(band);
            for (mode, strength) in strengths.iter().enumerate() {
                // An uncertainty that does not exist is that of a pole on the axis, or of one too many.
                let is_undetermined =
                    (0..2).any(|part| fit.unit_covariance(2 * mode + part, 2 * mode + part).is_none());
                weak.push(is_undetermined || !(*strength >= limit));
            }
            if !reweighed {
                reweighed = true;
                weights = scatter(band, lines, &found);
                candidates = found;
                continue;
            }
            if !weak.contains(&true) && !is_last {
                (is_last, candidates) = (true, found);
                continue;
            }
            if !weak.contains(&true) {
                return Some(Self { poles: found, fit, linear, variance, weights });
            }
            if is_choice && weak.iter().all(|weak| *weak) {
                return None;
            }
            candidates = without_weakest(&found, &strengths, &weak);
        }
    }
}

/// Weights by the uncertainties of the lines, if all responses have them.
fn stated(band: &Band) -> Option<Vec<Weights>> {
    let weights = band.channels.iter().map(|channel| {
        let uncertainty = channel.uncertainty.as_ref()?;
        Some(Weights::Lines(uncertainty.iter().map(|u| u.recip()).collect()))
    });
    weights.collect()
}

/// Equal weights of each response, by what the fit with these poles leaves of it.
fn scatter(band: &Band, lines: &Lines, poles: &[Complex64]) -> Vec<Weights> {
    let basis = Basis::of(lines, poles, None);
    let freedom = 2.0 * lines.len() as f64 - Lines::unknowns(poles.len()) as f64;
    let of = |channel| {
        let mut left = right_side(channel, None);
        let projection = basis.project(&left);
        basis.take_out(&mut left, &projection);
        let variance = left.norm_squared() / freedom.max(1.0);
        // Lines without noise leave rounding only.
        Weights::Equal(variance.sqrt().max(f64::EPSILON).recip())
    };
    if basis.is_determined() {
        band.channels.iter().map(of).collect()
    } else {
        vec![Weights::Equal(1.0); band.channels.len()]
    }
}

/// Variance of the weighted residuals.
fn variance(band: &Band, lines: &Lines, fit: &Fit, is_stated: bool) -> f64 {
    let modes = fit.values().len() / 2;
    let unknowns = 2 * modes + band.channels.len() * Lines::unknowns(modes);
    let freedom = (2 * lines.len() * band.channels.len()).saturating_sub(unknowns).max(1);
    let variance = fit.sum_of_squares() / freedom as f64;
    if is_stated { variance.max(1.0) } else { variance }
}

/// Σ aᵀC⁻¹a over the responses of each mode: the squared residues by their covariance.
fn strengths(poles: &[Complex64], linear: &[Linear], variance: f64) -> Vec<f64> {
    let of = |mode: usize, response: &Linear| {
        let (re, im) = (response.unknowns[2 * mode], response.unknowns[2 * mode + 1]);
        squared_by(&response.covariance, mode, re, im)
    };
    (0..poles.len()).map(|mode| linear.iter().map(|response| of(mode, response)).sum::<f64>() / variance).collect()
}

/// aᵀC⁻¹a of the two parts of a residue.
fn squared_by(covariance: &DMatrix<f64>, mode: usize, re: f64, im: f64) -> f64 {
    let (i, j) = (2 * mode, 2 * mode + 1);
    let (a, b, c) = (covariance[(i, i)], covariance[(i, j)], covariance[(j, j)]);
    let determinant = a * c - b * b;
    (re * re * c - 2.0 * re * im * b + im * im * a) / determinant
}

/// The quantile of χ² for the squared residues of all responses, above which they are not those of noise.
///
/// # References
/// E. B. Wilson, M. M. Hilferty, PNAS 17 (1931) 684.
fn significant(band: &Band) -> f64 {
    let freedom = 2.0 * band.channels.len() as f64;
    let share = 2.0 / (9.0 * freedom);
    freedom * (1.0 - share + FALSE_ALARM * share.sqrt()).powi(3)
}

/// Leaves out, for the poles as they are, those whose residues nothing needs; so the fit that follows is of few.
fn screen(band: &Band, lines: &Lines, candidates: &mut Vec<Complex64>, weights: &[Weights]) {
    let limit = significant(band);
    loop {
        let (mut strengths, mut sum) = (vec![0.0; candidates.len()], 0.0);
        let freedom = (2 * lines.len()).saturating_sub(Lines::unknowns(candidates.len())).max(1) * band.channels.len();
        let mut shared = None;
        for (channel, weights) in band.channels.iter().zip(weights) {
            let own;
            let (basis, factor) = match weights {
                Weights::Equal(factor) => (&*shared.get_or_insert_with(|| Basis::of(lines, candidates, None)), *factor),
                Weights::Lines(weights) => {
                    own = Basis::of(lines, candidates, Some(weights));
                    (&own, 1.0)
                }
            };
            let by_line = match weights {
                Weights::Equal(_) => None,
                Weights::Lines(weights) => Some(weights.as_slice()),
            };
            let mut left = right_side(channel, by_line);
            let projection = basis.project(&left);
            basis.take_out(&mut left, &projection);
            sum += factor * factor * left.norm_squared();
            let (unknowns, covariance) = (basis.solve(&projection), basis.covariance());
            for (mode, strength) in strengths.iter_mut().enumerate() {
                let parts = (unknowns[(2 * mode, 0)], unknowns[(2 * mode + 1, 0)]);
                *strength += factor * factor * squared_by(&covariance, mode, parts.0, parts.1);
            }
        }
        let variance = (sum / freedom as f64).max(f64::MIN_POSITIVE);
        for strength in &mut strengths {
            *strength /= variance;
        }
        let weak: Vec<bool> = strengths.iter().map(|strength| !(*strength >= limit)).collect();
        if !weak.contains(&true) || candidates.is_empty() {
            return;
        }
        *candidates = without_weakest(candidates, &strengths, &weak);
    }
}

/// The `poles` but those that are `weak`; of two neighbours that are, only the weaker goes, as the other may need its
/// place.
fn without_weakest(poles: &[Complex64], strengths: &[f64], weak: &[bool]) -> Vec<Complex64> {
    let by_neighbour = |mode: usize, other: Option<usize>| {
        other.is_none_or(|other| !weak.get(other).copied().unwrap_or(false) || !(strengths[other] < strengths[mode]))
    };
    let goes =
        |mode: usize| weak[mode] && by_neighbour(mode, mode.checked_sub(1)) && by_neighbour(mode, Some(mode + 1));
    let all = poles.iter().enumerate();
    let kept: Vec<Complex64> = all.filter(|(mode, _)| !goes(*mode)).map(|(_, pole)| *pole).collect();
    if kept.len() < poles.len() {
        return kept;
    }
    // Strengths that are no numbers: none is weaker than another.
    poles.iter().zip(weak).filter(|(_, weak)| !**weak).map(|(pole, _)| *pole).collect()
}
