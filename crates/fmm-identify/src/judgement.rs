//! The judgement: which of several fitted laws the records bear, and which they exclude.

use fmm_fit::f_tail;

use crate::{Candidate, Identification};

/// What the records say of one law, beside the law that fits them best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Standing {
    /// D, by how much it fits worse, in variances of the noise (1).
    pub(crate) misfit: f64,
    /// Probability of a misfit as large if this law were the true one (1).
    pub(crate) probability: f64,
    /// D + 2 k, by which laws with as many parameters and more are ranked (1).
    pub(crate) score: f64,
}

/// Which laws are left, and which of them is preferred.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Judgement {
    /// One per law.
    pub(crate) standings: Vec<Standing>,
    /// Place of the preferred law.
    pub(crate) preferred: usize,
    /// Whether no rival is left.
    pub(crate) is_decided: bool,
}

/// A law that fits worse than this by chance is excluded. The law that is true is excluded by no more than one in a hundred records:
/// the best of several others is a little better than one other.
pub(crate) const EXCLUDED: f64 = 0.002;
/// A law with a smaller probability is not preferred to a more general one, and one with a larger is a rival. A law that is true is
/// therefore called undecided by about one record in ten.
pub(crate) const DOUBTED: f64 = 0.05;
/// A rival with more parameters must come within this of the score of the preferred law: what lies farther off has a twentieth of its
/// likelihood.
const CLOSE: f64 = 6.0;

impl Judgement {
    /// The judgement of `candidates` by their `identifications` from the same records; none without any.
    ///
    /// ```text
    /// D_i = (S_i − S_b)/σ_i²,     σ_i² = δᵀΣδ/δᵀδ,     δ = r_i − r_b
    /// ```
    ///
    /// b is the law with the smallest sum of squares S, Σ the noise that its residuals r show. σ_i² is the variance of that noise in the
    /// direction in which the two laws differ: twice the logarithm of a ratio of likelihoods for correlated noise. It depends on
    /// the two laws alone, and not on how often the record was sampled, nor on other candidates. The probability of D_i is that of
    /// Fisher's F with as many degrees of freedom as the best law has more parameters, at least one.
    pub(crate) fn of(candidates: &[Candidate], identifications: &[Identification]) -> Option<Self> {
        let floor = |found: &Identification| found.fit().sum_of_squares().max(found.floor());
        let best = identifications.iter().min_by(|a, b| floor(a).total_cmp(&floor(b)))?;
        let standings: Vec<Standing> = identifications.iter().map(|found| Standing::of(found, best)).collect();
        let bears = |i: &usize| standings[*i].probability >= DOUBTED;
        let rank = |i: usize| identifications[i].fit().rank();
        let preferred = (0..standings.len()).filter(bears).min_by(|&a, &b| {
            let (near, far) = (standings[a].misfit, standings[b].misfit);
            let by_misfit = if (near - far).abs() > 1e-6 { near.total_cmp(&far) } else { std::cmp::Ordering::Equal };
            let by_count = candidates[a].parameter_count().cmp(&candidates[b].parameter_count());
            rank(a).cmp(&rank(b)).then(by_misfit).then(by_count)
        })?;
        let mut judgement = Self { standings, preferred, is_decided: true };
        judgement.is_decided = !(0..judgement.standings.len()).any(|i| judgement.is_rival(i, candidates, identifications));
        Some(judgement)
    }

    /// Whether the records do not exclude the law at this place.
    pub(crate) fn is_left(&self, place: usize) -> bool {
        self.standings[place].probability >= EXCLUDED
    }

    /// Whether the law at this place may be true in the stead of the preferred one: not excluded, and no law that merely says the
    /// same with more parameters.
    fn is_rival(&self, place: usize, candidates: &[Candidate], identifications: &[Identification]) -> bool {
        let preferred = self.preferred;
        if place == preferred || !self.is_left(place) {
            return false;
        }
        // A special case of the preferred law is doubted, or it would be preferred, but it is not excluded.
        if candidates[place].is_nested_in(&candidates[preferred]) {
            return identifications[place].fit().rank() < identifications[preferred].fit().rank();
        }
        let is_general = candidates[preferred].is_nested_in(&candidates[place]);
        let says_the_same = (self.standings[place].misfit - self.standings[preferred].misfit).abs() < 1e-6
            && identifications[place].fit().rank() == identifications[preferred].fit().rank()
            && candidates[place].parameter_count() > candidates[preferred].parameter_count();
        !is_general && !says_the_same && self.standings[place].score < self.standings[preferred].score + CLOSE
    }

    /// The weight of the law at `general`, of which the preferred one is a special case, beside the preferred one (1): the ratio of
    /// their probabilities by Akaike's criterion where the one has only a viscous part more, as every machine has some, and by
    /// Schwarz' for about `count` independent residuals otherwise.
    pub(crate) fn weight(&self, general: usize, further: usize, is_damping: bool, count: f64) -> f64 {
        let gain = self.standings[self.preferred].misfit - self.standings[general].misfit;
        let penalty = if is_damping { 2.0 } else { count.max(8.0).ln() };
        let odds = (0.5 * (gain - further as f64 * penalty)).exp();
        odds / (1.0 + odds)
    }
}

impl Standing {
    fn of(found: &Identification, best: &Identification) -> Self {
        let (misfit, freedom) = found.misfit_beside(best);
        let (own, other) = (found.fit().rank(), best.fit().rank());
        let further = other.saturating_sub(own).max(1) as f64;
        let probability = if misfit > 0.0 { f_tail(misfit / further, further, freedom).unwrap_or(0.0) } else { 1.0 };
        Self { misfit, probability, score: misfit + 2.0 * own as f64 }
    }
}
