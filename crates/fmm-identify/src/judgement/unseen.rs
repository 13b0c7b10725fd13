//! Terms that a law leaves out (a change of its friction, a dependence on the position, damping of the machine): the
//! size that would not show, and its price.

use std::fmt;

use fmm_model::Rounded;

use crate::candidate::Candidate;
use crate::experiment::{Experiment, reference};
use crate::identification::Identification;
use crate::judgement::asked::Asked;
use crate::judgement::change::{self, with_position};
use crate::judgement::rules::{MOST_RISE, REACH, SHOWN_CHANGE, SHOWN_DAMPING};
use crate::machine::term::Term;

/// A term that the preferred law leaves out: the size that the residuals ask for by one step of least squares from the
/// fit without it, and the error of the level of friction by leaving it out.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Unseen {
    pub(crate) kind: Kind,
    /// Size of the term: a relative change of the friction with each half cycle (1), a rise of the friction from the
    /// middle to the largest deflection over its mean (1), or a damping per mass (1/s).
    pub size: f64,
    /// Its standard uncertainty, in the same unit.
    pub uncertainty: f64,
    /// Relative error of the level of friction for each unit of the size that is left out, in the inverse of that unit.
    /// Zero for a law whose level is zero.
    pub price: f64,
}

/// The term that is left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    Change,
    OverPosition,
    Damping,
}

impl Unseen {
    /// `asked` in a unit of which the fitted one has this many.
    fn of(kind: Kind, asked: &Asked, units: f64) -> Self {
        let Asked { value, uncertainty, moved } = asked;
        Self { kind, size: value * units, uncertainty: uncertainty * units, price: moved / units }
    }

    /// The change of the friction that `found`, a fit to `experiments` by a law of the sliding speed without one, leaves
    /// in its residuals; `None` for other laws, for driven motions, and where the parameters can follow it.
    ///
    /// Friction that falls during a record (wear, running in, warming) looks like less friction and more viscous
    /// damping: both follow the amplitude from cycle to cycle. Within a half cycle damping follows the speed and a
    /// change does not, which is all that tells them apart.
    pub(crate) fn change(found: &Identification, experiments: &[Experiment]) -> Option<Self> {
        let asked = change::asked(found, experiments, Term::Change)?;
        Some(Self::of(Kind::Change, &asked, 0.5 / reference(experiments).guess.frequency()))
    }

    /// The viscous damping that `found`, a fit to `experiments`, leaves out; `None` for a law with damping or without a
    /// level, where the damping of the machine is declared, and where the records do not tell.
    ///
    /// A level of friction without damping is the assumption of a law. It is well determined: damping that is fitted
    /// takes a part of the level with it, as both slow the motion down from cycle to cycle.
    pub(crate) fn damping(found: &Identification, experiments: &[Experiment]) -> Option<Self> {
        let fitted = Candidate::fitted(found);
        let damps = |term: &Term| term.is_damping() && fitted.terms.has(*term);
        let has_damping = fitted.law.has_slope() || Term::ALL.iter().any(damps) || found.machine().damping().is_some();
        if has_damping || !fitted.law.is_of_speed() || fitted.law.level().is_none() {
            return None;
        }
        let terms = fitted.terms.clone().with_linear_damping();
        let asked = Asked::of(found, experiments, &fitted.with(terms), Term::LinearDamping)?;
        Some(Self::of(Kind::Damping, &asked, 1.0))
    }

    /// The dependence of the friction on the position that `found`, a fit to `experiments`, leaves out; `None` for a
    /// law that takes none, and where the records do not tell.
    ///
    /// Friction that rises with the deflection looks like less friction and more damping, as both follow the amplitude.
    pub(crate) fn over_position(found: &Identification, experiments: &[Experiment]) -> Option<Self> {
        let extended =
            with_position(&Candidate::fitted(found)).filter(|_| !experiments.iter().any(Experiment::is_run_down))?;
        let asked = Asked::of(found, experiments, &extended, Term::Position)?;
        Some(Self::of(Kind::OverPosition, &asked, reference(experiments).deflections().largest_square))
    }

    /// True if the residuals ask for more than chance alone does in one record of 370.
    pub fn is_shown(&self) -> bool {
        let is_small = self.kind != Kind::OverPosition || self.size.abs() < MOST_RISE;
        is_small && self.size.abs() > SHOWN_CHANGE * self.uncertainty
    }

    /// The largest size that the records would not show: that above which the term would be preferred, or that up to
    /// which this one may reach.
    pub fn largest_unseen(&self) -> f64 {
        let (least, size) = match self.kind {
            Kind::Damping => (SHOWN_DAMPING, self.size),
            Kind::Change | Kind::OverPosition => (SHOWN_CHANGE, self.size.abs()),
        };
        (least * self.uncertainty).max(size + REACH * self.uncertainty)
    }
}

impl fmt::Display for Unseen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (unseen, moved) = (self.largest_unseen(), self.largest_unseen() * self.price.abs());
        let percent = |share: f64| 100.0 * share;
        let (size, u) = (percent(self.size.abs()), percent(self.uncertainty));
        let falls = self.size < 0.0;
        match self.kind {
            Kind::Change if self.is_shown() => {
                let word = if falls { "falls" } else { "grows" };
                return write!(
                    f,
                    "its residuals ask for friction that {word} by {size:.2} % ± {u:.2} % with each half cycle"
                );
            }
            Kind::OverPosition if self.is_shown() => {
                let word = if falls { "falls" } else { "rises" };
                return write!(
                    f,
                    "its residuals ask for friction that {word} by {size:.0} % ± {u:.0} % towards the largest \
                     deflection"
                );
            }
            _ => {}
        }
        f.write_str(match self.kind {
            Kind::Change => "if the friction is steady (",
            Kind::OverPosition => "if it is the same at all positions (",
            Kind::Damping => "if the machine has no viscous damping (",
        })?;
        let is_share = self.kind != Kind::Damping;
        if moved > 1.0 || is_share && unseen > 1.0 {
            return f.write_str("the record hardly tells)");
        }
        match self.kind {
            Kind::Change => write!(f, "a change of {:.2} % with each half cycle", percent(unseen))?,
            Kind::OverPosition => write!(f, "{:.1} % more at the largest deflection", percent(unseen))?,
            Kind::Damping => write!(f, "{} 1/s", Rounded::significant(unseen, 2))?,
        }
        f.write_str(" would not show")?;
        if moved > 0.0 {
            write!(f, ", and would move its level by {:.1} %", percent(moved))?;
        }
        f.write_str(")")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A change of 2.9 u that is not named may be one of 4.9 u; one of nothing would be named from 3 u on.
    #[test]
    fn what_would_not_show_reaches_beyond_the_best_value() {
        let unseen = |w: f64| Unseen { kind: Kind::Change, size: w, uncertainty: 1e-3, price: 2.0 }.largest_unseen();
        for (w, expected) in [(0.0, 3e-3), (0.9e-3, 3e-3), (2.9e-3, 4.9e-3), (-2.9e-3, 4.9e-3)] {
            assert!((unseen(w) - expected).abs() < 1e-12, "{w}: {}", unseen(w));
        }
    }

    /// Damping of 2 u that is not preferred may be one of 4 u; one of nothing would be preferred from 2.5 u on.
    #[test]
    fn damping_that_would_not_show_reaches_beyond_the_best_value() {
        for (found, expected) in [(0.0, 2.5e-3), (2e-3, 4e-3), (-2e-3, 2.5e-3)] {
            let damping = Unseen { kind: Kind::Damping, size: found, uncertainty: 1e-3, price: -20.0 };
            assert!((damping.largest_unseen() - expected).abs() < 1e-12, "{damping:?}");
        }
        let damping = Unseen { kind: Kind::Damping, size: 0.0, uncertainty: 1e-3, price: -20.0 };
        let said =
            "if the machine has no viscous damping (0.0025 1/s would not show, and would move its level by 5.0 %)";
        assert_eq!(damping.to_string(), said);
    }

    #[test]
    fn friction_over_the_position_is_said_as_it_is_seen() {
        let of = |size: f64, uncertainty: f64| Unseen { kind: Kind::OverPosition, size, uncertainty, price: -0.2 };
        let said = "if it is the same at all positions (6.0 % more at the largest deflection would not show, and would \
                    move its level by 1.2 %)";
        assert_eq!(of(-0.01, 0.02).to_string(), said);
        let said = "its residuals ask for friction that falls by 10 % ± 2 % towards the largest deflection";
        assert_eq!(of(-0.1, 0.02).to_string(), said);
        assert_eq!(of(5.6, 1.2).to_string(), "if it is the same at all positions (the record hardly tells)");
        assert_eq!(of(0.1, 0.9).to_string(), "if it is the same at all positions (the record hardly tells)");
    }
}
