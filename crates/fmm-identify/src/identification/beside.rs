//! An identification beside another of the same records: misfit, and findings with one meaning.

use crate::finding::Finding;
use crate::identification::Identification;

impl Identification {
    /// Residuals of this fit, and of `other`, at the samples that count for both; zero elsewhere.
    fn residuals_beside(&self, other: &Self) -> [Vec<f64>; 2] {
        let counts = |row: usize| [self, other].iter().all(|one| one.counts().is_none_or(|counts| counts[row]));
        [self, other].map(|one| {
            let residuals = one.fitted.fit.residuals().iter().enumerate();
            residuals.map(|(row, residual)| if counts(row) { *residual } else { 0.0 }).collect()
        })
    }

    /// True if the same samples count for this fit and for `other`.
    pub(crate) fn counts_as(&self, other: &Self) -> bool {
        self.counts() == other.counts()
    }

    /// Sum of squares of this fit less that of `other`, over the samples that count for both.
    pub(crate) fn excess_beside(&self, other: &Self) -> f64 {
        let floor = self.floor().max(other.floor());
        let [own, theirs] = if self.counts_as(other) {
            [self, other].map(|one| one.fitted.fit.sum_of_squares())
        } else {
            self.residuals_beside(other).map(|residuals| residuals.iter().map(|residual| residual * residual).sum())
        };
        own.max(floor) - theirs.max(floor)
    }

    /// Excess of this fit over that by `other`, in variances of the noise that the residuals of the other show in the
    /// direction in which the laws differ (1), and the degrees of freedom with which that variance is known.
    pub(crate) fn misfit_beside(&self, other: &Self) -> (f64, f64) {
        let floor = self.floor().max(other.floor());
        let excess = self.excess_beside(other);
        let [own, theirs] = self.residuals_beside(other);
        let difference: Vec<f64> = own.iter().zip(&theirs).map(|(own, theirs)| own - theirs).collect();
        let rounding = floor / difference.len().max(1) as f64;
        let variance = (other.covariance.noise.variance_along(&difference) * other.spread()).max(rounding);
        let freedom = 2.0 * other.covariance.noise.ordinates_along(&difference);
        let misfit = if excess > 0.0 && variance > 0.0 { excess / variance } else { 0.0 };
        (misfit, freedom.min(other.fitted.fit.degrees_of_freedom() as f64).max(1.0))
    }

    /// The findings that mean the same in both, each with that of `other`: what has the same name, and the sliding
    /// levels, which laws name as they like.
    pub(crate) fn common_findings<'a>(&'a self, other: &'a Self) -> Vec<(&'a Finding, &'a Finding)> {
        let (own, theirs) = (self.level_names(), other.level_names());
        let same = |finding: &'a Finding| {
            let name = finding.parameter().name();
            let at = own.iter().position(|level| level == name);
            let counterpart = at.map_or(name, |at| theirs.get(at).map_or(name, String::as_str));
            other.finding(counterpart).map(|theirs| (finding, theirs))
        };
        self.findings.iter().filter_map(same).collect()
    }
}

/// The identification with the smallest residuals.
pub(crate) fn closest<'a>(identifications: impl IntoIterator<Item = &'a Identification>) -> Option<&'a Identification> {
    identifications.into_iter().min_by(|a, b| a.rms_residual().total_cmp(&b.rms_residual()))
}
