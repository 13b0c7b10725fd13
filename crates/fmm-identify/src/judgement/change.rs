//! Change of the friction during a record: the size that the residuals ask for, and the price of leaving it out.

use std::fmt;

use fmm_friction::{Coulomb, CoulombViscous, LawFamily};

use crate::candidate::Candidate;
use crate::experiment::{Experiment, reference};
use crate::identification::Identification;
use crate::judgement::asked::Asked;
use crate::judgement::rules::{REACH, SHOWN_CHANGE};
use crate::machine::term::Term;

/// Change of the friction during the records, for each half cycle, beside a law that has none.
///
/// Friction that falls during a record (wear, running in, warming) looks like less friction and more viscous damping:
/// both follow the amplitude from cycle to cycle. Within a half cycle damping follows the speed and a change does not,
/// which is all that tells them apart. The estimate is one step of least squares from the fit without a change.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FrictionChange {
    /// w, relative change of the friction for each half cycle (1). Negative: it falls.
    pub per_half_cycle: f64,
    /// Standard uncertainty of w (1).
    pub uncertainty: f64,
    /// Relative error of the level of friction over the change that causes it (1): a change of w that is left out moves
    /// the level by this times w of itself. Zero for a law whose level is zero.
    pub price: f64,
}

impl FrictionChange {
    /// The change that `found`, a fit to `experiments` by a law of the sliding speed without one, leaves in its
    /// residuals; `None` for other laws, for driven motions, and where the parameters can follow it.
    pub(crate) fn of(found: &Identification, experiments: &[Experiment]) -> Option<Self> {
        let Asked { value, uncertainty, moved } = asked(found, experiments, Term::Change)?;
        // From a second to a half cycle.
        let half_cycle = 0.5 / reference(experiments).guess.frequency();
        Some(Self {
            per_half_cycle: value * half_cycle,
            uncertainty: uncertainty * half_cycle,
            price: moved / half_cycle,
        })
    }

    /// True if chance alone makes a change as large in one record of 370.
    pub fn is_shown(&self) -> bool {
        self.per_half_cycle.abs() > SHOWN_CHANGE * self.uncertainty
    }

    /// The largest change for each half cycle (1) that the records would not show: that above which a change would be
    /// named, or that up to which this one may reach.
    pub fn largest_unseen(&self) -> f64 {
        (SHOWN_CHANGE * self.uncertainty).max(self.per_half_cycle.abs() + REACH * self.uncertainty)
    }
}

impl fmt::Display for FrictionChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| 100.0 * share;
        if self.is_shown() {
            let word = if self.per_half_cycle < 0.0 { "falls" } else { "grows" };
            let (change, u) = (percent(self.per_half_cycle.abs()), percent(self.uncertainty));
            return write!(
                f,
                "its residuals ask for friction that {word} by {change:.2} % ± {u:.2} % with each half cycle"
            );
        }
        let (unseen, moved) = (self.largest_unseen(), self.largest_unseen() * self.price.abs());
        if unseen.max(moved) > 1.0 {
            return f.write_str("if the friction is steady (the record hardly tells)");
        }
        write!(
            f,
            "if the friction is steady (a change of {:.2} % with each half cycle would not show",
            percent(unseen)
        )?;
        if moved > 0.0 {
            write!(f, ", and would move its level by {:.1} %", percent(moved))?;
        }
        f.write_str(")")
    }
}

/// Size of the next `term` of a change that the residuals of `found` ask for; `None` for a law that takes none, and
/// where the records do not tell.
fn asked(found: &Identification, experiments: &[Experiment], term: Term) -> Option<Asked> {
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

/// The `candidate` with friction that changes during the record, or whose change is curved if it has one, and its
/// viscous part as damping of the machine, which stays; `None` for a law with internal state and one without friction.
pub(crate) fn with_change(candidate: &Candidate) -> Option<Candidate> {
    let terms = candidate.terms.clone();
    if !candidate.law.is_of_speed() || candidate.law.level().is_none() || terms.has(Term::CurvedChange) {
        return None;
    }
    let terms = if terms.has(Term::Change) { terms.with_curved_change() } else { terms.with_change() };
    Some(match candidate.law_name() {
        CoulombViscous::NAME => Candidate::of::<Coulomb>().with(terms.with_linear_damping()),
        _ => candidate.clone().with(terms),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A change of 2.9 u that is not named may be one of 4.9 u; one of nothing would be named from 3 u on.
    #[test]
    fn what_would_not_show_reaches_beyond_the_best_value() {
        let unseen = |w: f64| FrictionChange { per_half_cycle: w, uncertainty: 1e-3, price: 2.0 }.largest_unseen();
        for (w, expected) in [(0.0, 3e-3), (0.9e-3, 3e-3), (2.9e-3, 4.9e-3), (-2.9e-3, 4.9e-3)] {
            assert!((unseen(w) - expected).abs() < 1e-12, "{w}: {}", unseen(w));
        }
    }
}
