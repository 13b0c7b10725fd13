//! Fits of a search without a bent spring that the law which is left does not need.

use fmm_model::Unit;

use super::{Found, Run};
use crate::candidate::Candidate;
use crate::finding::Finding;
use crate::identification::Identification;
use crate::judgement::Judgement;
use crate::judgement::rules::SHOWN;
use crate::threads::{is_past, on_all_threads};

impl Run<'_, '_> {
    /// Adds fits by the laws that are left beside a bent spring, without it, where they do not show it. The spring was
    /// asked for beside all friction that is a function of the speed; what is more than that may do without.
    pub(super) fn fit_without_spring(&self, found: &mut Found) {
        if !found.beside.has_spring() || is_past(self.end) {
            return;
        }
        let Some(judgement) = Judgement::of(&found.candidates, &found.identifications) else { return };
        let is_spare = |(place, known): &(usize, &Identification)| {
            judgement.is_left(*place) && known.fitted.model.terms.has_spring() && !shows_spring(known)
        };
        let bases: Vec<&Identification> =
            found.identifications.iter().enumerate().filter(is_spare).map(|(_, known)| known).collect();
        let fit = |base: &Identification| {
            let bent = Candidate::fitted(base);
            let candidate = Candidate { terms: bent.terms.without_spring(), ..bent };
            let spared = self.fit_to_end(&candidate, &base.fitted)?;
            Some((candidate, spared))
        };
        let spared: Vec<_> = on_all_threads(bases, fit).into_iter().flatten().collect();
        let (candidates, identifications) = spared.into_iter().unzip();
        found.add(Found { candidates, identifications, ..Found::default() });
    }
}

/// One of the terms of the spring lies outside of the range of chance about zero. A fit that has not ended shows none.
fn shows_spring(found: &Identification) -> bool {
    if !found.fit().outcome().is_success() {
        return false;
    }
    let springs = found.fitted.model.terms.of_spring();
    let lies_outside = |spring: &Finding| {
        spring.unbounded_uncertainty().is_none_or(|uncertainty| spring.value().abs() > SHOWN * uncertainty)
    };
    springs.parameters(&Unit::default()).any(|spring| found.finding(spring.name()).is_none_or(lies_outside))
}
