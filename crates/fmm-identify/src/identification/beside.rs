//! An identification beside another of the same records: misfit, and findings with one meaning.

use crate::finding::Finding;
use crate::identification::Identification;

/// Standard deviations of a sum of squares that are no more than chance (1), which white noise exceeds once in 700
/// times.
const BY_CHANCE: f64 = 3.0;

impl Identification {
    /// True if every sample that counts for this fit counts for `other` as well.
    pub(crate) fn counts_within(&self, other: &Self) -> bool {
        if self.places().is_none() {
            return true;
        }
        let [own, theirs] = [self, other].map(Self::residuals_at_samples);
        own.iter().zip(&theirs).all(|(own, theirs)| own.is_none() || theirs.is_some())
    }

    /// Sum of squares of this fit at the samples that count for it and for `other`.
    pub(crate) fn squares_within(&self, other: &Self) -> f64 {
        if self.places().is_none() {
            return self.fitted.fit.sum_of_squares();
        }
        let [own, theirs] = [self, other].map(Self::residuals_at_samples);
        let both = own.iter().zip(&theirs).filter_map(|(own, theirs)| theirs.and(*own));
        both.map(|residual| residual * residual).sum()
    }

    /// Sums of squares of this fit and of `other` at the samples that count for both, each with what it leaves at the
    /// samples that count for it alone beyond what it leaves at the others: a law that says a force where the contact
    /// rests is judged by it there as well, but neither gains nor loses by its noise.
    fn squares_beside(&self, other: &Self) -> [f64; 2] {
        let at_samples = [self, other].map(Self::residuals_at_samples);
        [0, 1].map(|one| {
            let pairs = at_samples[one].iter().zip(&at_samples[1 - one]);
            let sum = |of_both: bool| {
                let chosen = pairs.clone().filter(|(_, other)| other.is_some() == of_both);
                let squares = chosen.filter_map(|(own, _)| own.map(|residual| residual * residual));
                squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0))
            };
            let ((both, count), (alone, further)) = (sum(true), sum(false));
            let usual = both / f64::max(count, 1.0);
            // So much do the squares of white noise sum to, by chance.
            let by_chance = usual * (further + BY_CHANCE * (2.0 * further).sqrt());
            both + f64::max(alone - by_chance, 0.0)
        })
    }

    /// Sum of squares of this fit less that of `other`, over the samples that count for both, with what each leaves at
    /// samples of its own beyond its noise.
    pub(crate) fn excess_beside(&self, other: &Self) -> f64 {
        let floor = self.floor().max(other.floor());
        let [own, theirs] = if self.places().is_none() {
            [self, other].map(|one| one.fitted.fit.sum_of_squares())
        } else {
            self.squares_beside(other)
        };
        own.max(floor) - theirs.max(floor)
    }

    /// Residuals of this fit less those of `other`, one for each residual of the other; zero where one does not count.
    fn residuals_less(&self, other: &Self) -> Vec<f64> {
        let [own, theirs] = [self, other].map(Self::residuals_at_samples);
        let less =
            |(own, theirs): (&Option<f64>, &Option<f64>)| own.zip(*theirs).map_or(0.0, |(own, theirs)| own - theirs);
        let all: Vec<f64> = own.iter().zip(&theirs).map(less).collect();
        other.places().map_or(all.clone(), |places| places.iter().map(|place| all[*place]).collect())
    }

    /// Excess of this fit over that by `other`, in variances of the noise that the residuals of the other show in the
    /// direction in which the laws differ (1), and the degrees of freedom with which that variance is known.
    pub(crate) fn misfit_beside(&self, other: &Self) -> (f64, f64) {
        let floor = self.floor().max(other.floor());
        let excess = self.excess_beside(other);
        let difference = self.residuals_less(other);
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
