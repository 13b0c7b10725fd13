//! Minima: fits of many starts, grouped by where they end.

use crate::algebra::triangle::Triangle;
use crate::error::FitError;
use crate::result::estimate::EstimateStatus;
use crate::result::fit::Fit;
use crate::solver::outcome::Outcome;

/// Fits are the same if the difference of their values moves the residuals by less than this share of all that the
/// values move.
const SAME: f64 = 1e-6;

/// A local minimum, and how many starts led to it.
#[derive(Debug, Clone)]
pub struct Minimum {
    fit: Fit,
    triangle: Triangle,
    starts: Vec<usize>,
}

impl Minimum {
    /// The fit with the smallest sum of squares of those that ended here.
    pub fn fit(&self) -> &Fit {
        &self.fit
    }

    /// The numbers of the starts that led here, ascending; 0 is the one given.
    pub fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// True if `other` ended here too.
    fn is_same(&self, other: &Finished) -> bool {
        let estimates = self.fit.estimates();
        let free = estimates.iter().enumerate().filter(|(_, estimate)| estimate.status() != EstimateStatus::Fixed);
        let free: Vec<usize> = free.map(|(j, _)| j).collect();
        let (here, there) = (self.fit.values(), other.fit.values());
        let influence = free
            .iter()
            .enumerate()
            .map(|(column, &j)| here[j].abs().max(there[j].abs()) * self.triangle.column_norm(column));
        let tolerated = SAME * (influence.sum::<f64>() + self.fit.sum_of_squares().sqrt());
        let square: f64 = if self.fit.null_directions().is_empty() {
            let change: Vec<f64> = free.iter().map(|&j| there[j] - here[j]).collect();
            (0..free.len()).map(|row| self.triangle.row_times(row, &change).powi(2)).sum()
        } else {
            // Along a valley the values differ without end; the residuals are the same.
            self.fit.residuals().iter().zip(other.fit.residuals()).map(|(a, b)| (a - b).powi(2)).sum()
        };
        square.sqrt() <= tolerated
    }
}

/// A fit with what is needed to compare it.
#[derive(Debug)]
pub(crate) struct Finished {
    pub(crate) fit: Fit,
    pub(crate) triangle: Triangle,
}

/// All distinct minima that a search found.
#[derive(Debug, Default)]
pub struct Minima {
    found: Vec<Minimum>,
    failures: Vec<(usize, Result<Outcome, FitError>)>,
    unfinished: Option<Fit>,
    starts: usize,
}

impl Minima {
    /// The minima, the lowest first.
    pub fn minima(&self) -> &[Minimum] {
        &self.found
    }

    /// The fit of the lowest minimum; `None` if no start led to one.
    pub fn best(&self) -> Option<&Fit> {
        self.found.first().map(Minimum::fit)
    }

    /// Number of fits begun. Fewer than asked for if the search was cancelled or ran out of time.
    pub fn starts(&self) -> usize {
        self.starts
    }

    /// The starts that led to no minimum, by number, each with its other end, or with the error if the fit could not
    /// begin there.
    pub fn failures(&self) -> &[(usize, Result<Outcome, FitError>)] {
        &self.failures
    }

    /// The best of the fits that ended otherwise than at a minimum, if its sum of squares is below that of all minima:
    /// more starts, or the reason why it ended, may be worth a look.
    pub fn unfinished(&self) -> Option<&Fit> {
        let is_lower = |fit: &&Fit| self.best().is_none_or(|best| fit.sum_of_squares() < best.sum_of_squares());
        self.unfinished.as_ref().filter(is_lower)
    }

    /// The best values so far, finished or not.
    pub(crate) fn best_values(&self) -> Option<&[f64]> {
        self.unfinished().or(self.best()).map(Fit::values)
    }

    /// Takes in the next start.
    pub(crate) fn take(&mut self, finished: Result<Finished, FitError>) {
        let number = self.starts;
        self.starts += 1;
        let finished = match finished {
            Ok(finished) => finished,
            Err(error) => {
                self.failures.push((number, Err(error)));
                return;
            }
        };
        let outcome = finished.fit.outcome();
        if !outcome.is_success() {
            self.failures.push((number, Ok(outcome)));
            let is_best = |fit: &Fit| finished.fit.sum_of_squares() < fit.sum_of_squares();
            if self.unfinished.as_ref().is_none_or(is_best) {
                self.unfinished = Some(finished.fit);
            }
            return;
        }
        let Finished { fit, triangle } = match self.found.iter_mut().find(|minimum| minimum.is_same(&finished)) {
            None => finished,
            Some(same) => {
                same.starts.push(number);
                if finished.fit.sum_of_squares() < same.fit.sum_of_squares() {
                    (same.fit, same.triangle) = (finished.fit, finished.triangle);
                }
                return;
            }
        };
        self.found.push(Minimum { fit, triangle, starts: vec![number] });
    }

    /// Sorts the minima; equal ones stay in the order in which they were found.
    pub(crate) fn sort(&mut self) {
        self.found.sort_by(|a, b| a.fit.sum_of_squares().total_cmp(&b.fit.sum_of_squares()));
    }

    /// The error of the first start, if none could begin.
    pub(crate) fn refused(mut self) -> Result<Self, FitError> {
        if self.failures.len() == self.starts && self.unfinished.is_none() && !self.failures.is_empty() {
            self.failures.swap_remove(0).1?;
        }
        Ok(self)
    }
}
