//! Search for the set of candidates with the most information.

use fmm_model::Rounded;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::design::design_case::{DesignCase, DesignCriterion};
use crate::design::exchange::{Exchange, Purse};
use crate::design::information::mismatch;
use crate::error::FitError;

/// Search for the measurements, out of a list of candidates, that make what is asked for least uncertain.
///
/// Every set is looked at where there are few; otherwise measurements are exchanged for others one at a time, begun
/// with the candidates that help most one after the other and with random sets, until no exchange helps (Fedorov; Cook
/// and Nachtsheim). With several [cases](DesignCase) it is the mean of the logarithm of the uncertainty over them that
/// is made small, or the [worst](Self::for_worst_case).
///
/// ```
/// use fmm_fit::design::{DesignCase, DesignCriterion, DesignSearch, Information};
///
/// // A straight line, which may be measured at 21 places between −1 and 1: half of the measurements at either end.
/// let candidates = (-10..=10).map(|i| Information::of_rows(2, &[1.0, f64::from(i) / 10.0])).collect::<Result<_, _>>()?;
/// let case = DesignCase::of_all(Information::none(2), candidates)?;
/// let best = DesignSearch::new(vec![case], DesignCriterion::Determinant)?.best(4)?;
/// assert_eq!(best.counts(), [(0, 2), (20, 2)]);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
///
/// # References
/// V. V. Fedorov, "Theory of Optimal Experiments", Academic Press 1972, section 3.2; R. D. Cook, C. J. Nachtsheim, "A
/// comparison of algorithms for constructing exact D-optimal designs", Technometrics 22 (1980) 315,
/// <https://doi.org/10.1080/00401706.1980.10486162>; A. C. Atkinson, A. N. Donev, R. D. Tobias, "Optimum Experimental
/// Designs, with SAS", Oxford University Press 2007, chapters 10 to 12 (criteria, algorithms) and 18 (designs over a
/// prior).
#[derive(Debug, Clone)]
pub struct DesignSearch {
    cases: Vec<DesignCase>,
    criterion: DesignCriterion,
    is_worst: bool,
    starts: usize,
    seed: u64,
}

/// Measurements in a set at most.
const MOST: usize = 1000;
/// Sets, times cases, that are all looked at.
const FEW: usize = 20_000;

impl DesignSearch {
    /// Searches by `criterion`; each of the `cases` has the same candidates at other values of the parameters.
    ///
    /// # Errors
    /// [`FitError::Count`] without a case, or if the cases have different numbers of candidates.
    pub fn new(cases: Vec<DesignCase>, criterion: DesignCriterion) -> Result<Self, FitError> {
        let Some(first) = cases.first() else { return Err(mismatch("cases of a design", 0, 1)) };
        let count = first.candidates.len();
        if let Some(other) = cases.iter().find(|case| case.candidates.len() != count) {
            return Err(mismatch("candidates of a case", other.candidates.len(), count));
        }
        Ok(Self { cases, criterion, is_worst: false, starts: 8, seed: 1 })
    }

    /// The same for the worst of the cases instead of the mean.
    #[must_use]
    pub fn for_worst_case(self) -> Self {
        Self { is_worst: true, ..self }
    }

    /// The same with another seed of the random sets; 1 if none is given.
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// The same with another number of random sets to begin with; 8 if none is given.
    #[must_use]
    pub fn with_starts(self, starts: usize) -> Self {
        Self { starts, ..self }
    }

    /// Number of candidates.
    pub fn candidates(&self) -> usize {
        self.cases[0].candidates.len()
    }

    /// ln u of the combinations that are asked for, after the measurements at these places among the candidates: the
    /// mean over the cases, or the worst. u is det(G M⁻¹ Gᵀ)^(1/2q) or √(tr(G M⁻¹ Gᵀ)/q) of the q combinations G; where
    /// they are not determined it is that with 10⁻¹⁰ of the information of a mean candidate beside, which is large.
    ///
    /// # Errors
    /// [`FitError::Count`] for a place beyond the candidates.
    pub fn score(&self, measurements: &[usize]) -> Result<f64, FitError> {
        if let Some(place) = measurements.iter().find(|place| **place >= self.candidates()) {
            return Err(mismatch("place of a candidate", *place, self.candidates()));
        }
        Ok(self.score_of(&self.summed(measurements)))
    }

    /// The best set of this many measurements; a candidate may be in it more than once.
    ///
    /// # Errors
    /// [`FitError::OutOfRange`] for no measurement or more than 1000.
    pub fn best(&self, measurements: usize) -> Result<ChosenDesign, FitError> {
        if !(1..=MOST).contains(&measurements) {
            let what = format!("a set has 1 to {MOST} measurements, not {measurements}");
            return Err(FitError::out_of_range(what, measurements as f64));
        }
        self.best_within(&vec![1.0; self.candidates()], measurements as f64)
    }

    /// The best set whose costs, one for each candidate, add up to no more than `budget`.
    ///
    /// # Errors
    /// [`FitError::Count`] for another number of costs than candidates, [`FitError::OutOfRange`] for a cost
    /// that is not positive, and for a budget that allows no measurement or more than 1000.
    pub fn best_within(&self, costs: &[f64], budget: f64) -> Result<ChosenDesign, FitError> {
        if costs.len() != self.candidates() {
            return Err(mismatch("costs of the candidates", costs.len(), self.candidates()));
        }
        if let Some(cost) = costs.iter().find(|cost| !(**cost > 0.0 && cost.is_finite())) {
            let what = format!("the cost of a measurement must be positive, not {cost}");
            return Err(FitError::out_of_range(what, *cost));
        }
        let cheapest = costs.iter().copied().fold(f64::INFINITY, f64::min);
        // Costs that add up to the budget but for rounding.
        let given = budget;
        let budget = budget * (1.0 + 1e-12);
        let most = budget / cheapest;
        if !(1.0..MOST as f64 + 1.0).contains(&most) {
            let [asked, least, greatest] =
                [given, cheapest, cheapest * MOST as f64].map(|cost| Rounded::new(cost, None).to_string());
            let pays = format!("which pays for 1 to {MOST} of the cheapest measurement");
            let what = format!("the budget must be {least} to {greatest}, {pays}, not {asked}");
            return Err(FitError::out_of_range(what, given));
        }
        let purse = Purse { costs, budget };
        let mut exchange = Exchange::new(self, purse);
        if let Some(best) = exchange.of_all(FEW / self.cases.len()) {
            return Ok(best);
        }
        let mut best = exchange.improved(Vec::new());
        for start in 0..self.starts {
            let mut random = ChaCha8Rng::seed_from_u64(self.seed);
            random.set_stream(start as u64);
            let begun = purse.random(&mut random);
            let found = exchange.improved(begun);
            if found.score < best.score {
                best = found;
            }
        }
        Ok(best)
    }

    /// The information of each case after these measurements.
    pub(crate) fn summed(&self, measurements: &[usize]) -> Vec<Vec<f64>> {
        let mut sums: Vec<Vec<f64>> = self.cases.iter().map(|case| case.known.elements().to_vec()).collect();
        for place in measurements {
            self.add(&mut sums, *place, 1.0);
        }
        sums
    }

    /// Adds a measurement, or takes it out if `sign` is −1.
    pub(crate) fn add(&self, sums: &mut [Vec<f64>], place: usize, sign: f64) {
        for (sum, case) in sums.iter_mut().zip(&self.cases) {
            let elements = case.candidates[place].elements();
            sum.iter_mut().zip(elements).for_each(|(sum, element)| *sum += sign * element);
        }
    }

    pub(crate) fn score_of(&self, sums: &[Vec<f64>]) -> f64 {
        let scores = self.cases.iter().zip(sums).map(|(case, sum)| case.score(sum, self.criterion));
        if self.is_worst {
            scores.fold(f64::NEG_INFINITY, f64::max)
        } else {
            scores.sum::<f64>() / self.cases.len() as f64
        }
    }
}

/// A set of measurements that a [`DesignSearch`] chose.
#[derive(Debug, Clone, PartialEq)]
pub struct ChosenDesign {
    pub(crate) measurements: Vec<usize>,
    pub(crate) score: f64,
    pub(crate) is_exhaustive: bool,
}

impl ChosenDesign {
    /// Places of the chosen candidates, ascending; one that is to be repeated is there as often.
    pub fn measurements(&self) -> &[usize] {
        &self.measurements
    }

    /// Each chosen candidate with how often it is to be measured.
    pub fn counts(&self) -> Vec<(usize, usize)> {
        let groups = self.measurements.chunk_by(|a, b| a == b);
        groups.map(|group| (group[0], group.len())).collect()
    }

    /// The logarithm of the standard uncertainty that was made small, see
    /// [`DesignSearch::score`].
    pub fn score(&self) -> f64 {
        self.score
    }

    /// True if every possible set was compared: there is no better one.
    pub fn is_exhaustive(&self) -> bool {
        self.is_exhaustive
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::design::design_case::DesignUncertainty;
    use crate::design::information::Information;

    fn line(places: &[f64]) -> DesignCase {
        let candidates = places.iter().map(|x| Information::of_rows(2, &[1.0, *x]).unwrap()).collect();
        DesignCase::of_all(Information::none(2), candidates).unwrap()
    }

    #[test]
    fn exchanges_find_what_looking_at_all_finds() {
        let places: Vec<f64> = (0..30).map(|i| (f64::from(i) * 0.7).sin()).collect();
        let search = DesignSearch::new(vec![line(&places)], DesignCriterion::MeanVariance).unwrap();
        let costs: Vec<f64> = (0..30).map(|i| 1.0 + f64::from(i % 4)).collect();
        let purse = Purse { costs: &costs, budget: 7.0 };
        let mut exchange = Exchange::new(&search, purse);
        let all = exchange.of_all(1_000_000).unwrap();
        let found = search.best_within(&costs, 7.0).unwrap();
        assert!(all.is_exhaustive && !found.is_exhaustive(), "{all:?} {found:?}");
        assert!((all.score - found.score).abs() < 1e-12, "{all:?} {found:?}");
        assert!(found.measurements().iter().map(|place| costs[*place]).sum::<f64>() <= 7.0);
    }

    /// u of the slope of a line, by itself.
    #[derive(Debug)]
    struct Slope;

    impl DesignUncertainty for Slope {
        fn logarithm(&self, information: &Information) -> f64 {
            let variance = information.variance(&[0.0, 1.0]).unwrap();
            0.5 * variance.unwrap_or(1e9).ln()
        }
    }

    /// An uncertainty that somebody computes is made small as that of a combination is.
    #[test]
    fn an_uncertainty_of_ones_own_is_made_small() {
        let candidates: Vec<Information> =
            [-1.0, -0.2, 0.4, 0.9].map(|x| Information::of_rows(2, &[1.0, x]).unwrap()).to_vec();
        let none = Information::none(2);
        let own = DesignCase::of_uncertainty(none.clone(), candidates.clone(), Arc::new(Slope)).unwrap();
        let combination = DesignCase::new(none.clone(), candidates, vec![vec![0.0, 1.0]]).unwrap();
        let best = |case| DesignSearch::new(vec![case], DesignCriterion::MeanVariance).unwrap().best(3).unwrap();
        let (own, combination) = (best(own), best(combination));
        assert_eq!(own.measurements(), combination.measurements());
        assert!((own.score() - combination.score()).abs() < 1e-8, "{own:?} {combination:?}");
        assert!(DesignCase::of_uncertainty(none, vec![], Arc::new(Slope)).is_err());
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let search = DesignSearch::new(vec![line(&[-1.0, 1.0])], DesignCriterion::Determinant).unwrap();
        assert!(search.best(0).is_err() && search.best(1001).is_err() && search.score(&[2]).is_err());
        assert!(search.best_within(&[1.0], 3.0).is_err() && search.best_within(&[1.0, 0.0], 3.0).is_err());
        assert!(search.best_within(&[1.0, 2.0], f64::NAN).is_err());
        assert!(DesignSearch::new(vec![], DesignCriterion::Determinant).is_err());
        assert!(DesignSearch::new(vec![line(&[1.0]), line(&[1.0, 2.0])], DesignCriterion::Determinant).is_err());
        assert!(DesignCase::of_all(Information::none(2), vec![Information::none(3)]).is_err());
        assert!(DesignCase::of_all(Information::none(2), vec![]).is_err());
    }
}
