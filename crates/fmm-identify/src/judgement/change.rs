//! Friction that varies during a record or over the position: laws with it, and the size of a change that the residuals
//! ask for.

use fmm_friction::{AccelerationCoulomb, Coulomb, CoulombViscous, LawFamily};

use crate::candidate::Candidate;
use crate::experiment::Experiment;
use crate::identification::Identification;
use crate::judgement::asked::Asked;
use crate::machine::Terms;
use crate::machine::term::Term;

/// Size of the next `term` of a change that the residuals of `found` ask for; `None` for a law that takes none, and
/// where the records do not tell.
pub(super) fn asked(found: &Identification, experiments: &[Experiment], term: Term) -> Option<Asked> {
    // In a run-down the speed falls with the time, and friction over both is one.
    if experiments.iter().any(Experiment::is_run_down) {
        return None;
    }
    let is_next = |extended: &Candidate| extended.terms.has(term) && !found.fitted.model.terms.has(term);
    let extended = with_change(&Candidate::fitted(found)).filter(is_next)?;
    Asked::of(found, experiments, &extended, term)
}

/// True if the residuals of `found` ask for a change of the friction, or for one that is not steady itself, by more
/// than `limit` standard uncertainties.
pub(crate) fn asks_for_change(found: &Identification, experiments: &[Experiment], limit: f64) -> bool {
    let term = if found.fitted.model.terms.has(Term::Change) { Term::CurvedChange } else { Term::Change };
    asked(found, experiments, term).is_some_and(|asked| asked.value.abs() > limit * asked.uncertainty)
}

impl Candidate {
    /// The law and the terms of an identification.
    pub(crate) fn fitted(found: &Identification) -> Self {
        Self { law: found.family().with_held_breakaway(), ..found.fitted.model.clone() }
    }
}

/// The `candidate` with friction that changes during the record, or whose change is curved if it has one; `None` for a
/// law with internal state and one without friction.
pub(crate) fn with_change(candidate: &Candidate) -> Option<Candidate> {
    let terms = candidate.terms.clone();
    if terms.has(Term::CurvedChange) {
        return None;
    }
    varied(candidate, if terms.has(Term::Change) { terms.with_curved_change() } else { terms.with_change() })
}

/// The `candidate` with friction that depends on the position; `None` for a law with internal state, one of two branches
/// and one without friction.
pub(crate) fn with_position(candidate: &Candidate) -> Option<Candidate> {
    if candidate.terms.has(Term::Position) || candidate.law_name() == AccelerationCoulomb::NAME {
        return None;
    }
    varied(candidate, candidate.terms.clone().with_friction_over_position())
}

/// The `candidate` with these `terms` that vary its friction, and its viscous part as damping of the machine, which
/// stays; `None` for a law with internal state and one without friction.
fn varied(candidate: &Candidate, terms: Terms) -> Option<Candidate> {
    if !candidate.law.is_of_speed() || candidate.law.level().is_none() {
        return None;
    }
    Some(match candidate.law_name() {
        CoulombViscous::NAME => Candidate::of::<Coulomb>().with(terms.with_linear_damping()),
        _ => candidate.clone().with(terms),
    })
}
