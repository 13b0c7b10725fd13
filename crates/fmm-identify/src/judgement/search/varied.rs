//! Fits of a search with friction that varies: during the records, or over the position.

use fmm_friction::{Coulomb, LawFamily};

use super::{Found, Run};
use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::fit::stages::Begin;
use crate::identification::Identification;
use crate::judgement::Judgement;
use crate::judgement::change::{asks_for_change, with_change, with_position};
use crate::judgement::rules::{ASKED_CHANGE, MOST_ITERATIONS_OF_CHANGE};
use crate::judgement::unseen::Unseen;
use crate::machine::term::Term;
use crate::threads::is_past;

impl Run<'_, '_> {
    /// Adds a fit with friction that changes during the records, if the residuals of one of `found` show a change.
    pub(super) fn fit_changes(
        &self,
        found: &mut Found,
        base: fn(&Found) -> Option<&Identification>,
    ) -> Result<(), IdentifyError> {
        if is_past(self.end) {
            return Ok(());
        }
        let is_shown = |base: &&Identification| asks_for_change(base, self.decays, ASKED_CHANGE);
        // Where the damping of the machine is known, a change of the friction may be all that is left of it.
        let has_damping = self.inquiry.machine.damping().is_some();
        let is_dry = |known: &&Identification| has_damping && known.family().name == Coulomb::NAME;
        let dry = found.identifications.iter().find(is_dry);
        let Some(base) = base(found).filter(is_shown).or(dry.filter(is_shown)) else { return Ok(()) };
        // A law that falls with the speed may have taken a part of the change: the simple law is asked as well.
        let simple = found.simple().filter(|simple| simple.law() != base.law());
        let bases: Vec<Identification> = std::iter::once(base).chain(simple).cloned().collect();
        for base in &bases {
            let changed =
                self.fit_change(found, base)?.filter(|changed| asks_for_change(changed, self.decays, ASKED_CHANGE));
            if let Some(changed) = changed {
                self.fit_change(found, &changed)?;
            }
        }
        Ok(())
    }

    /// Adds a fit of the simple law with friction that depends on the position, if its residuals show that: it is one
    /// more explanation beside all others, on which none of them is built.
    pub(super) fn fit_over_position(&self, found: &mut Found) -> Result<(), IdentifyError> {
        let is_shown =
            |base: &&Identification| Unseen::over_position(base, self.decays).is_some_and(|unseen| unseen.is_shown());
        let Some(base) = found.simple().filter(|_| !is_past(self.end)).filter(is_shown) else { return Ok(()) };
        let Some(candidate) = with_position(&Candidate::fitted(base)) else { return Ok(()) };
        let begin = Begin::Extended(&base.fitted);
        let options = self.limited(found, MOST_ITERATIONS_OF_CHANGE);
        let identifications = vec![self.inquiry.fit(&candidate, self.decays.into(), begin, &options, None)?];
        found.add(Found { candidates: vec![candidate], identifications, ..Found::default() });
        Ok(())
    }

    /// Replaces the laws that are left by the same with friction that changes, where it is known how little it does.
    pub(super) fn allow_changes(&self, found: &mut Found) -> Result<(), IdentifyError> {
        let Some(judgement) = Judgement::of(&found.candidates, &found.identifications) else { return Ok(()) };
        let left = (0..found.candidates.len()).filter(|place| judgement.is_left(*place));
        let bases: Vec<Identification> = left.map(|place| found.identifications[place].clone()).collect();
        let can_change = |base: &&Identification| with_change(&Candidate::fitted(base)).is_some();
        for base in bases.iter().filter(|base| !base.fitted.model.terms.has(Term::Change)).filter(can_change) {
            let place = found.identifications.iter().position(|known| known.law() == base.law());
            if let Some(place) = place {
                found.candidates.remove(place);
                found.identifications.remove(place);
            }
            self.fit_change(found, base)?;
        }
        Ok(())
    }

    /// Adds the fit by the law of `base` with the next term of a change, begun at the end of `base`, and gives it.
    fn fit_change(&self, found: &mut Found, base: &Identification) -> Result<Option<Identification>, IdentifyError> {
        let Some(candidate) = with_change(&Candidate::fitted(base)) else { return Ok(None) };
        let begin = Begin::Extended(&base.fitted);
        let options = self.limited(found, MOST_ITERATIONS_OF_CHANGE);
        let is_curved = candidate.terms.has(Term::CurvedChange);
        let end = self.end.filter(|_| is_curved);
        let changed = self.inquiry.fit(&candidate, self.decays.into(), begin, &options, end)?;
        // A change that ends at once, or never, is none that slows down.
        if is_curved && !changed.fit().outcome().is_success() {
            return Ok(None);
        }
        found.add(Found { candidates: vec![candidate], identifications: vec![changed.clone()], ..Found::default() });
        Ok(Some(changed))
    }
}
