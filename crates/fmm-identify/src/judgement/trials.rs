//! Trials of a search: the laws of each stage as their families state them, with the parameters that are held.

use fmm_friction::{CoulombViscous, FamilyVisitor, LawFamily, SearchRole, SearchStage, SearchTrial, catalogue};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::Experiment;
use crate::judgement::change::{with_change, with_position};
use crate::judgement::inquiry::Inquiry;
use crate::machine::Terms;
use crate::machine::term::Term;
use crate::quantities::table::Table;

impl Inquiry<'_> {
    /// Trials that the families state for a stage.
    pub(super) fn at(&self, stage: SearchStage) -> Vec<Trial> {
        let families = catalogue(&mut Families).into_iter().chain(self.families.iter().cloned());
        let of_family = |family: Family| {
            let trials = family.trials.iter().filter(move |trial| trial.stage == stage);
            trials.map(move |trial| {
                let terms = if trial.is_damped { Terms::NONE.with(Term::LinearDamping) } else { Terms::NONE };
                Trial { candidate: family.candidate.clone().with(terms), fixed: trial.fixed }
            })
        };
        families.flat_map(of_family).collect()
    }

    /// Trials of laws that change with speed, and of simple laws beside quadratic damping.
    pub(super) fn of_speed(&self) -> Vec<Trial> {
        let damped = |trial: Trial| {
            let candidate = trial.candidate.with(Terms::NONE.with(Term::QuadraticDamping));
            Trial { candidate, ..trial }
        };
        self.at(SearchStage::Simple).into_iter().map(damped).chain(self.at(SearchStage::OfSpeed)).collect()
    }

    /// Trials of all stages but that of springs with corners.
    fn all(&self) -> impl Iterator<Item = Trial> {
        let further = [SearchStage::Presliding, SearchStage::FurtherPresliding];
        let bent = Terms::NONE.with(Term::CubicSpring).with(Term::QuinticSpring);
        let simple = self.at(SearchStage::Simple);
        let bent: Vec<Trial> = simple.iter().map(|trial| trial.clone().beside(&bent)).collect();
        let first = simple.into_iter().chain(bent).chain(self.of_speed());
        first.chain(further.into_iter().flat_map(|stage| self.at(stage)))
    }

    /// The candidate of a trial, with the parameters that are held.
    pub(super) fn tried(&self, trial: &Trial, decays: &[Experiment]) -> Result<Candidate, IdentifyError> {
        let mut candidate = trial.candidate.clone();
        for (parameter, value) in trial.fixed {
            let is_given =
                self.held.iter().any(|(law, held, _)| held == parameter && is_meant(law.as_deref(), &candidate));
            if !is_given {
                candidate = candidate.holding(parameter, *value)?;
            }
        }
        let known = self.parameters(&candidate, decays)?;
        for (law, parameter, value) in &self.held {
            if is_meant(law.as_deref(), &candidate) && known.contains(parameter) {
                candidate = candidate.holding(parameter, *value)?;
            }
        }
        Ok(candidate)
    }

    /// Names of the parameters of a fit to `decays`: of the oscillator, the damping, the law, and the initial state.
    fn parameters(&self, candidate: &Candidate, decays: &[Experiment]) -> Result<Vec<String>, IdentifyError> {
        if decays.is_empty() {
            return Err(IdentifyError::no_record());
        }
        let (_, parameters) = Table::of(candidate, &self.machine, decays)?;
        Ok(parameters.iter().map(|parameter| parameter.name().to_owned()).collect())
    }

    /// Refuses a parameter that no law of the search has.
    pub(super) fn require_known(&self, decays: &[Experiment]) -> Result<(), IdentifyError> {
        let mut known = Vec::new();
        for trial in self.all() {
            let candidate = self.tried(&trial, decays)?;
            known.extend(self.parameters(&candidate, decays)?.into_iter().map(|name| (candidate.law_name(), name)));
        }
        let is_one = |(law, name): (&Option<String>, &String)| {
            known.iter().any(|(of, known)| known == name && law.as_ref().is_none_or(|law| law == of))
        };
        let Some((_, name, _)) = self.held.iter().find(|(law, name, _)| !is_one((law, name))) else { return Ok(()) };
        let mut names: Vec<String> = known.into_iter().map(|(_, name)| name).collect();
        names.sort();
        names.dedup();
        Err(IdentifyError::unknown_parameter(name, &names.join(", ")))
    }
}

/// Trials of a level and a straight line beside each of these lists of terms.
pub(super) fn beside_line(terms: &[&[Term]]) -> impl Iterator<Item = Trial> {
    let with = |terms: &&[Term]| terms.iter().fold(Terms::NONE, |terms, term| terms.with(*term));
    terms.iter().map(move |terms| Trial { candidate: Candidate::of::<CoulombViscous>().with(with(terms)), fixed: &[] })
}

/// Springs with a stop, a preload or a gap, tried if a smooth spring leaves correlated residuals.
pub(super) const CORNERS: [&[Term]; 2] = [&[Term::Stop], &[Term::Gap]];

/// True if a value that is held of `law`, or of all laws if that is `None`, is meant for the `candidate`.
fn is_meant(law: Option<&str>, candidate: &Candidate) -> bool {
    law.is_none_or(|law| candidate.law_name() == law)
}

/// A law family and the trials that it states.
#[derive(Debug, Clone)]
pub(super) struct Family {
    candidate: Candidate,
    trials: &'static [SearchTrial],
}

/// Makes families of the catalogue values.
pub(super) struct Families;

impl FamilyVisitor for Families {
    type Output = Family;

    fn visit<F: LawFamily>(&mut self) -> Family {
        let trials = match F::SEARCH {
            SearchRole::Tried(trials) => trials,
            SearchRole::NotTried(_) => &[],
        };
        Family { candidate: Candidate::of::<F>(), trials }
    }
}

/// One fit of a search: a law with terms beside it, and the parameters that its family fixes.
#[derive(Debug, Clone)]
pub(super) struct Trial {
    pub(super) candidate: Candidate,
    fixed: &'static [(&'static str, f64)],
}

impl Trial {
    /// The same with a change and a dependence on the position, if these are among `terms` and the law takes them.
    pub(super) fn beside(self, terms: &Terms) -> Self {
        let changing = with_change(&self.candidate).filter(|_| terms.has(Term::Change));
        let candidate = changing.unwrap_or(self.candidate);
        let over_position = with_position(&candidate).filter(|_| terms.has(Term::Position));
        let candidate = over_position.unwrap_or(candidate);
        let spring = terms.iter().filter(|term| term.is_spring());
        let terms = spring.fold(candidate.terms.clone(), Terms::with);
        Self { candidate: candidate.with(terms), ..self }
    }
}

#[cfg(test)]
mod tests {
    use fmm_friction::{Berger, LawError, LawParameter, LawVisitor};
    use fmm_model::Scalar;

    use super::*;
    use crate::machine::Machine;

    fn inquiry() -> Inquiry<'static> {
        Inquiry::of(&Machine::per_unit_mass(), &[] as &[Experiment])
    }

    fn names(trials: impl IntoIterator<Item = Trial>) -> Vec<String> {
        let name = |trial: Trial| {
            let fixed = trial.fixed.iter().try_fold(trial.candidate, |law, (name, value)| law.holding(name, *value));
            fixed.unwrap().name()
        };
        trials.into_iter().map(name).collect()
    }

    /// Every law of the catalogue is tried as often as it states, or says why it is not.
    #[test]
    fn every_law_of_the_catalogue_is_searched_or_says_why_not() {
        struct Roles;
        impl FamilyVisitor for Roles {
            type Output = (&'static str, SearchRole);

            fn visit<F: LawFamily>(&mut self) -> Self::Output {
                (F::NAME, F::SEARCH)
            }
        }
        let tried = names(inquiry().all());
        for (law, role) in catalogue(&mut Roles) {
            let found = tried.iter().filter(|name| name.split([' ', ',']).next() == Some(law)).count();
            match role {
                SearchRole::Tried(trials) => assert!(found >= trials.len() && found > 0, "{law}: {found} trials"),
                SearchRole::NotTried(reason) => {
                    assert!(found == 0 && role != SearchRole::UNSTATED, "{law}: {found} trials, {reason}");
                }
            }
        }
    }

    /// Laws that simulate slowly or need a start near another law come last.
    #[test]
    fn laws_are_tried_from_simple_to_general() {
        assert_eq!(
            names(inquiry().all()),
            [
                "viscous",
                "coulomb",
                "coulomb_viscous",
                "viscous + cubic spring + quintic spring",
                "coulomb + cubic spring + quintic spring",
                "coulomb_viscous + cubic spring + quintic spring",
                "viscous + quadratic",
                "coulomb + quadratic",
                "coulomb_viscous + quadratic",
                "acceleration_coulomb + linear",
                "berger + linear",
                "stribeck, exponent = 2",
                "stribeck",
                "stribeck_lorentzian",
                "hyperbolic + linear",
                "power_law",
                "exponential_pair + linear",
                "makkar_dixon",
                "regularised_stribeck",
                "karnopp + linear",
                "dahl + linear, exponent = 1",
                "lugre, exponent = 2",
                "bouc_wen + linear, amplitude = 1",
            ]
        );
        assert_eq!(names(beside_line(&CORNERS)), ["coulomb_viscous + stop", "coulomb_viscous + gap"]);
    }

    /// A law of one's own is tried at the stage that it states, after those of the catalogue.
    #[test]
    fn a_family_of_ones_own_takes_part() {
        struct Own;
        impl LawFamily for Own {
            const NAME: &'static str = "own";
            const PARAMETERS: &'static [LawParameter] = Berger::PARAMETERS;
            const SEARCH: SearchRole = SearchRole::Tried(&[SearchStage::OfSpeed.trial().damped()]);
            type At<D: Scalar> = Berger<D>;

            fn at<D: Scalar>(values: &[D]) -> Result<Berger<D>, LawError> {
                Berger::at(values)
            }

            fn visit<D: Scalar, V: LawVisitor<D, Berger<D>>>(visitor: V) -> V::Output {
                visitor.sliding()
            }
        }
        let search = inquiry().including::<Own>();
        assert_eq!(names(search.of_speed()).last().map(String::as_str), Some("own + linear"));
    }
}
