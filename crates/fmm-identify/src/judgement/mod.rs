//! The judgement: the fitted laws that the records allow, those that they exclude, and the preferred one.

mod asked;
pub(crate) mod change;
pub(crate) mod comparison;
pub(crate) mod filtering;
mod friction_over_load;
mod inquiry;
pub(crate) mod rules;
pub(crate) mod score_test;
mod search;
mod trials;
pub(crate) mod unseen;

pub use comparison::Comparison;
pub use friction_over_load::FrictionOverLoad;
pub use inquiry::{Inquiry, compare, identify, search};
pub use score_test::ScoreTest;
pub use unseen::Unseen;

use fmm_fit::FTest;

use crate::candidate::Candidate;
use crate::finding::Finding;
use crate::identification::Identification;
use crate::judgement::rules::{
    BADLY_KNOWN, CLOSE, DOUBTED, DUE_TO_DAMPING, EQUAL_MISFIT, EXCLUDED, LEAST_COUNT, ROUNDING_OF_SQUARES, UNFIT,
    USUAL_DAMPING,
};

/// Judgement of several laws beside the one that fits the records best: the laws that are left, and the preferred one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Judgement {
    /// D of each law, its misfit beside the best law in variances of the noise (1).
    misfits: Vec<f64>,
    /// Probability of a misfit as large if the law were true (1).
    pub(crate) p_values: Vec<f64>,
    /// D + 2 k, the rank of laws with as many parameters or more (1).
    pub(crate) scores: Vec<f64>,
    /// Each law was fitted to its lowest minimum, as far as is known.
    pub(crate) is_finished: Vec<bool>,
    /// Place of the preferred law.
    pub(crate) preferred: usize,
    /// No rival is left.
    pub(crate) is_decided: bool,
}

/// A parameter of the law `without` damping may be wrong because damping is missing: the law `with` it knows the
/// parameter much less well.
fn hides_damping(without: &Identification, with: &Identification) -> bool {
    without.findings().iter().filter(|own| !own.is_of_record()).any(|own| {
        let theirs = with.finding(own.parameter().name());
        let (u, value, their_u) = (own.uncertainty(), own.value().abs(), theirs.and_then(Finding::uncertainty));
        match (u, their_u) {
            (Some(u), Some(their_u)) => their_u > BADLY_KNOWN * value && their_u > DUE_TO_DAMPING * u,
            _ => false,
        }
    })
}

/// Reasons why the fit at this place is not the best of its law: it has not ended, or a special case fits better.
pub(crate) fn shortcomings(place: usize, candidates: &[Candidate], identifications: &[Identification]) -> Vec<String> {
    let found = &identifications[place];
    let mut sentences = Vec::new();
    if !found.fit().outcome().is_success() {
        sentences.push(format!("the fit {}", found.fit().outcome()));
    }
    if let Some(special) = better_special_case(place, candidates, identifications) {
        sentences.push(format!("the fit missed its lowest minimum, as {} fits better", candidates[special].name()));
    }
    sentences
}

/// Place of a special case of the candidate at this place that fits better, which shows that the fit missed its lowest
/// minimum.
pub(crate) fn better_special_case(
    place: usize,
    candidates: &[Candidate],
    identifications: &[Identification],
) -> Option<usize> {
    let found = &identifications[place];
    let least = found.fit().sum_of_squares() * (1.0 - ROUNDING_OF_SQUARES) - found.floor();
    // Where other samples count, a special case may fit its own better.
    let is_better = |other: &Identification| found.counts_within(other) && other.squares_within(found) < least;
    let is_special = |special: &usize| candidates[*special].is_nested_in(&candidates[place]);
    let better = (0..candidates.len()).filter(is_special).filter(|special| is_better(&identifications[*special]));
    better
        .min_by(|a, b| identifications[*a].squares_within(found).total_cmp(&identifications[*b].squares_within(found)))
}

impl Judgement {
    /// The judgement of `candidates` by their `identifications` from the same records; `None` without any.
    ///
    /// ```text
    /// D_i = (S_i − S_b)/σ_i²,     σ_i² = δᵀΣδ/δᵀδ,     δ = r_i − r_b
    /// ```
    ///
    /// b is the law with the smallest sum of squares S, Σ the noise that its residuals r show. At samples that count
    /// for one of the two laws alone, S counts what it leaves there beyond its usual residual, and δ nothing; b is the
    /// law that fewest others fit better than. σ_i² is the variance of that noise in the direction in which the two
    /// laws differ: twice the logarithm of a ratio of likelihoods for correlated noise. It depends on the two laws
    /// alone, and not on how often the record was sampled, nor on other candidates. The probability of D_i is that of
    /// Fisher's F with as many degrees of freedom as the best law has more parameters, at least one; times the
    /// positions at which a best law that leaps can leap, each of which is a try (Bonferroni).
    pub(crate) fn of(candidates: &[Candidate], identifications: &[Identification]) -> Option<Self> {
        let better =
            |found: &Identification| identifications.iter().filter(|other| found.excess_beside(other) > 0.0).count();
        let best = identifications.iter().min_by_key(|found| better(found))?;
        let rank = |i: usize| identifications[i].parameters_used();
        let standings = identifications.iter().map(|found| {
            let (misfit, freedom) = found.misfit_beside(best);
            let further = best.fit().rank().saturating_sub(found.fit().rank()).max(1) as f64;
            // A misfit without a probability excludes no law.
            let p = (FTest::tail(misfit / further, further, freedom).unwrap_or(1.0) * best.leap_positions()).min(1.0);
            (misfit, if misfit > 0.0 { p } else { 1.0 })
        });
        let (misfits, p_values): (Vec<f64>, Vec<f64>) = standings.unzip();
        let scores = misfits.iter().enumerate().map(|(i, misfit)| misfit + 2.0 * rank(i) as f64).collect();
        let is_finished: Vec<bool> =
            (0..candidates.len()).map(|place| shortcomings(place, candidates, identifications).is_empty()).collect();
        // A fit that has not ended gives an upper bound of the misfit of its law, not its parameters.
        let is_any = (0..misfits.len()).any(|i| p_values[i] >= UNFIT && is_finished[i]);
        let bears = |i: &usize| p_values[*i] >= UNFIT && (is_finished[*i] || !is_any);
        // A parameter on its bound is not counted: a law and its special case may use as many, and the special case is
        // simpler all the same.
        let count = |i: usize| candidates[i].parameter_count();
        let does_without = |special: usize, i: usize| {
            bears(&special)
                && rank(special) == rank(i)
                && count(special) < count(i)
                && candidates[special].is_nested_in(&candidates[i])
        };
        let is_simplest = |i: &usize| !(0..misfits.len()).any(|special| does_without(special, *i));
        let preferred = (0..misfits.len()).filter(bears).filter(is_simplest).min_by(|&a, &b| {
            let (near, far) = (misfits[a], misfits[b]);
            let by_misfit =
                if (near - far).abs() > EQUAL_MISFIT { near.total_cmp(&far) } else { std::cmp::Ordering::Equal };
            rank(a).cmp(&rank(b)).then(by_misfit).then(count(a).cmp(&count(b)))
        })?;
        let mut judgement = Self { misfits, p_values, scores, is_finished, preferred, is_decided: true };
        judgement.is_decided =
            !(0..candidates.len()).any(|place| judgement.is_rival(place, candidates, identifications));
        Some(judgement)
    }

    /// The records do not exclude the law at this place.
    pub(crate) fn is_left(&self, place: usize) -> bool {
        self.p_values[place] >= EXCLUDED
    }

    /// The law at this place may be true instead of the preferred one: it is not excluded, and it does not merely state
    /// the same friction with more parameters.
    fn is_rival(&self, place: usize, candidates: &[Candidate], identifications: &[Identification]) -> bool {
        let preferred = self.preferred;
        if place == preferred || !self.is_left(place) {
            return false;
        }
        // A special case of the preferred law is doubted, or it would be preferred, but it is not excluded.
        if candidates[place].is_nested_in(&candidates[preferred]) {
            return identifications[place].parameters_used() < identifications[preferred].parameters_used();
        }
        let is_general = candidates[preferred].is_nested_in(&candidates[place]);
        if is_general && candidates[place].differs_by_damping(&candidates[preferred]) {
            return hides_damping(&identifications[preferred], &identifications[place]);
        }
        if is_general && self.p_values[preferred] < DOUBTED {
            return self.scores[place] < self.scores[preferred];
        }
        let is_the_same = (self.misfits[place] - self.misfits[preferred]).abs() < EQUAL_MISFIT
            && identifications[place].parameters_used() == identifications[preferred].parameters_used()
            && candidates[place].parameter_count() > candidates[preferred].parameter_count();
        !is_general && !is_the_same && self.scores[place] < self.scores[preferred] + CLOSE
    }

    /// Weight of each law (1), the preferred one having 1: the ratio of their probabilities. A law that is excluded, or
    /// was not fitted to its lowest minimum, has none.
    ///
    /// ```text
    /// −2 ln w = D − D_p + (k − k_p) ln n,     for damping alone   D − D_p + 2 ln (4π ζ f₀/√(2π) u(c/m))
    /// ```
    ///
    /// The first is Schwarz' criterion for n independent residuals. The second is the ratio of evidences if a machine
    /// may have any damping up to a share ζ of the critical one: the less a record tells of it, the more it has to be
    /// allowed for.
    pub(crate) fn weights(&self, candidates: &[Candidate], identifications: &[Identification]) -> Vec<f64> {
        let preferred = &identifications[self.preferred];
        let penalty = preferred.covariance.effective_count.max(LEAST_COUNT).ln();
        let rank = |i: usize| identifications[i].parameters_used() as f64;
        let own = &candidates[self.preferred];
        let weight = |i: usize| {
            if i == self.preferred {
                return 1.0;
            }
            if !(self.is_left(i) && self.is_finished[i]) {
                return 0.0;
            }
            // A parameter that ended on its bound is one more all the same.
            let is_general = own.is_nested_in(&candidates[i]);
            let further = (rank(i) - rank(self.preferred)).max(if is_general { 1.0 } else { f64::NEG_INFINITY });
            let is_damped = is_general && candidates[i].differs_by_damping(own);
            let of_damping = identifications[i].range_of_damping(USUAL_DAMPING).filter(|_| is_damped);
            let penalty = of_damping.map_or(further * penalty, |range| 2.0 * range.max(1.0).ln().min(0.5 * penalty));
            (-0.5 * (self.misfits[i] - self.misfits[self.preferred] + penalty)).exp()
        };
        (0..identifications.len()).map(weight).collect()
    }
}
