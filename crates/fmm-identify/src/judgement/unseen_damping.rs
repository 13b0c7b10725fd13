//! Viscous damping that a law without any leaves out: the size that would not show, and its price.

use std::fmt;

use crate::candidate::Candidate;
use crate::experiment::Experiment;
use crate::identification::Identification;
use crate::judgement::asked::Asked;
use crate::judgement::rules::{REACH, SHOWN_DAMPING};
use crate::machine::term::Term;

/// Viscous damping per mass beside a law that has none, on a machine of which none is known.
///
/// A level of friction without damping is the assumption of a law. It is well determined: damping that is fitted takes
/// a part of the level with it, as both slow the motion down from cycle to cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UnseenDamping {
    /// c/m that the residuals ask for (1/s), and its standard uncertainty.
    pub(crate) per_mass: f64,
    pub(crate) uncertainty: f64,
    /// Relative error of the level of friction over the damping that is left out (s).
    pub(crate) price: f64,
}

impl UnseenDamping {
    /// The damping that `found`, a fit to `experiments`, leaves out; `None` for a law with damping or without a level,
    /// where the damping of the machine is declared, and where the records do not tell.
    pub(crate) fn of(found: &Identification, experiments: &[Experiment]) -> Option<Self> {
        let fitted = Candidate::fitted(found);
        let damps = |term: &Term| term.is_damping() && fitted.terms.has(*term);
        let has_damping = fitted.law.has_slope() || Term::ALL.iter().any(damps) || found.machine().damping().is_some();
        if has_damping || !fitted.law.is_of_speed() || fitted.law.level().is_none() {
            return None;
        }
        let terms = fitted.terms.clone().with_linear_damping();
        let asked = Asked::of(found, experiments, &fitted.with(terms), Term::LinearDamping)?;
        Some(Self { per_mass: asked.value, uncertainty: asked.uncertainty, price: asked.moved })
    }

    /// The largest damping (1/s) that the records would not show: that above which it would be preferred, or that up to
    /// which this one may reach.
    pub(crate) fn largest_unseen(&self) -> f64 {
        (SHOWN_DAMPING * self.uncertainty).max(self.per_mass + REACH * self.uncertainty)
    }
}

impl fmt::Display for UnseenDamping {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (unseen, moved) = (self.largest_unseen(), self.largest_unseen() * self.price.abs());
        if moved > 1.0 {
            return f.write_str("if the machine has no viscous damping (the record hardly tells)");
        }
        write!(f, "if the machine has no viscous damping ({unseen:.1e} 1/s would not show")?;
        if moved > 0.0 {
            write!(f, ", and would move its level by {:.1} %", 100.0 * moved)?;
        }
        f.write_str(")")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Damping of 2 u that is not preferred may be one of 4 u; one of nothing would be preferred from 2.5 u on.
    #[test]
    fn damping_that_would_not_show_reaches_beyond_the_best_value() {
        for (found, expected) in [(0.0, 2.5e-3), (2e-3, 4e-3), (-2e-3, 2.5e-3)] {
            let damping = UnseenDamping { per_mass: found, uncertainty: 1e-3, price: -20.0 };
            assert!((damping.largest_unseen() - expected).abs() < 1e-12, "{damping:?}");
        }
        let damping = UnseenDamping { per_mass: 0.0, uncertainty: 1e-3, price: -20.0 };
        let said =
            "if the machine has no viscous damping (2.5e-3 1/s would not show, and would move its level by 5.0 %)";
        assert_eq!(damping.to_string(), said);
    }
}
