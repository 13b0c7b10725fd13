//! Exchange of measurements for others, one at a time, until none helps.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::design::search::{ChosenDesign, DesignSearch};

/// Costs of the candidates and the budget.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Purse<'a> {
    pub(crate) costs: &'a [f64],
    pub(crate) budget: f64,
}

impl Purse<'_> {
    fn left(&self, measurements: &[usize]) -> f64 {
        self.budget - measurements.iter().map(|place| self.costs[*place]).sum::<f64>()
    }

    /// Measurements at random, as long as there is money.
    pub(crate) fn random(&self, random: &mut ChaCha8Rng) -> Vec<usize> {
        let mut measurements = Vec::new();
        loop {
            let left = self.left(&measurements);
            let affordable: Vec<usize> = (0..self.costs.len()).filter(|place| self.costs[*place] <= left).collect();
            if affordable.is_empty() {
                return measurements;
            }
            measurements.push(affordable[random.random_range(0..affordable.len())]);
        }
    }
}

/// A change of the score below this is rounding.
const ROUNDING: f64 = 1e-12;
/// Exchanges of a set at most; each lowers the score, so that they end, but perhaps late.
const MOST_EXCHANGES: usize = 500;

pub(crate) struct Exchange<'a> {
    search: &'a DesignSearch,
    purse: Purse<'a>,
    trial: Vec<Vec<f64>>,
}

impl<'a> Exchange<'a> {
    pub(crate) fn new(search: &'a DesignSearch, purse: Purse<'a>) -> Self {
        Self { search, purse, trial: Vec::new() }
    }

    /// The best of all sets that no further measurement fits in; `None` if there are more than `most`.
    pub(crate) fn of_all(&mut self, most: usize) -> Option<ChosenDesign> {
        let mut best: Option<(Vec<usize>, f64)> = None;
        let mut seen = 0;
        let mut chosen = Vec::new();
        self.below(&mut chosen, &self.search.summed(&[]), 0, (&mut seen, most), &mut best)?;
        best.map(|(measurements, score)| ChosenDesign { measurements, score, is_exhaustive: true })
    }

    /// Looks at the sets that begin with `chosen` and go on with candidates from `first` on; `None` if that takes too
    /// long.
    fn below(
        &mut self,
        chosen: &mut Vec<usize>,
        sums: &[Vec<f64>],
        first: usize,
        (seen, most): (&mut usize, usize),
        best: &mut Option<(Vec<usize>, f64)>,
    ) -> Option<()> {
        let left = self.purse.left(chosen);
        if !chosen.is_empty() {
            *seen += 1;
            if *seen > most {
                return None;
            }
            let is_full = self.purse.costs.iter().all(|cost| *cost > left);
            let score = if is_full { self.search.score_of(sums) } else { f64::INFINITY };
            if is_full && best.as_ref().is_none_or(|(_, lowest)| score < lowest - ROUNDING) {
                *best = Some((chosen.clone(), score));
            }
        }
        for place in first..self.purse.costs.len() {
            if self.purse.costs[place] > left {
                continue;
            }
            let mut with = sums.to_vec();
            self.search.add(&mut with, place, 1.0);
            chosen.push(place);
            self.below(chosen, &with, place, (seen, most), best)?;
            chosen.pop();
        }
        Some(())
    }

    /// The set that exchanges make of `measurements`: what is left of the budget is spent first on what helps most for
    /// its cost.
    pub(crate) fn improved(&mut self, mut measurements: Vec<usize>) -> ChosenDesign {
        let mut sums = self.search.summed(&measurements);
        let mut score = self.fill(&mut measurements, &mut sums);
        for _exchange in 0..MOST_EXCHANGES {
            let mut best: Option<(Vec<usize>, f64)> = None;
            let mut tried = Vec::new();
            for place in 0..measurements.len() {
                if tried.contains(&measurements[place]) {
                    continue;
                }
                tried.push(measurements[place]);
                let mut without = measurements.clone();
                let taken = without.swap_remove(place);
                let mut left = sums.clone();
                self.search.add(&mut left, taken, -1.0);
                let money = self.purse.left(&without);
                for new in (0..self.purse.costs.len()).filter(|new| *new != taken) {
                    if self.purse.costs[new] > money {
                        continue;
                    }
                    let mut other = without.clone();
                    other.push(new);
                    let reached = if self.purse.left(&other) >= self.cheapest() {
                        let mut sums = left.clone();
                        self.search.add(&mut sums, new, 1.0);
                        self.fill(&mut other, &mut sums)
                    } else {
                        self.with(&left, new)
                    };
                    if best.as_ref().map_or(score, |(_, lowest)| *lowest) - reached > ROUNDING {
                        best = Some((other, reached));
                    }
                }
            }
            let Some((better, reached)) = best else { break };
            sums = self.search.summed(&better);
            (measurements, score) = (better, reached);
        }
        measurements.sort_unstable();
        ChosenDesign { measurements, score, is_exhaustive: false }
    }

    fn cheapest(&self) -> f64 {
        self.purse.costs.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The score of `sums` with another measurement.
    fn with(&mut self, sums: &[Vec<f64>], place: usize) -> f64 {
        self.trial.resize_with(sums.len(), Vec::new);
        self.trial.iter_mut().zip(sums).for_each(|(trial, sum)| trial.clone_from(sum));
        self.search.add(&mut self.trial, place, 1.0);
        self.search.score_of(&self.trial)
    }

    /// Adds the measurement that helps most for its cost as long as there is money; gives the score.
    fn fill(&mut self, measurements: &mut Vec<usize>, sums: &mut [Vec<f64>]) -> f64 {
        let mut score = self.search.score_of(sums);
        loop {
            let left = self.purse.left(measurements);
            let mut best: Option<(usize, f64, f64)> = None;
            for place in 0..self.purse.costs.len() {
                let cost = self.purse.costs[place];
                if cost > left {
                    continue;
                }
                let reached = self.with(sums, place);
                let gain = (score - reached) / cost;
                if best.is_none_or(|(_, most, _)| gain > most + ROUNDING) {
                    best = Some((place, gain, reached));
                }
            }
            let Some((place, _, reached)) = best else { return score };
            measurements.push(place);
            self.search.add(sums, place, 1.0);
            score = reached;
        }
    }
}
