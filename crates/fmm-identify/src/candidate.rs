//! Law with its terms, chosen by name at run time.

use fmm_friction::{
    Coulomb, CoulombViscous, FamilyVisitor, LawFamily, OwnLaw, SpecialCase, Viscous, catalogue, family_named,
};

use crate::error::IdentifyError;
use crate::law::Law;
use crate::machine::Terms;
use crate::machine::term::Term;

/// A law family as a value, with terms beside it, so that laws can be chosen at run time and compared in one list.
#[derive(Debug, Clone)]
pub struct Candidate {
    pub(crate) law: Law,
    pub(crate) terms: Terms,
}

/// Makes candidates of families.
struct Candidates;

impl FamilyVisitor for Candidates {
    type Output = Candidate;

    fn visit<F: LawFamily>(&mut self) -> Candidate {
        Candidate::of::<F>()
    }
}

impl Candidate {
    /// The candidate of family `F`, which may be a law of one's own.
    pub const fn of<F: LawFamily>() -> Self {
        Self { law: Law::of::<F>(), terms: Terms::NONE }
    }

    /// The candidate of a law that is known at run time only. Its simulations take longer than those of a family.
    pub fn own(law: &'static OwnLaw) -> Self {
        Self { law: Law::own(law), terms: Terms::NONE }
    }

    /// The same law with `terms` beside it.
    #[must_use]
    pub fn with(self, terms: Terms) -> Self {
        Self { terms, ..self }
    }

    /// The same law with a delay of a force behind its motion of at most `longest` (s), positive or negative. The term
    /// `delay` alone looks for at most twenty samples.
    ///
    /// # Errors
    /// [`IdentifyError::OutOfRange`] if it is not positive and finite.
    pub fn with_delay_up_to(mut self, longest: f64) -> Result<Self, IdentifyError> {
        if !(longest > 0.0 && longest.is_finite()) {
            return Err(IdentifyError::not_allowed("the longest delay of a force (s)", longest, "positive"));
        }
        self.terms = self.terms.with_delay_up_to(longest);
        Ok(self)
    }

    /// The same law with the fitted parameter called `name` fixed at `value`, in the unit in which it would be fitted.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] if the value is not finite.
    pub fn holding(mut self, name: &str, value: f64) -> Result<Self, IdentifyError> {
        self.terms = self.terms.holding(name, value)?;
        Ok(self)
    }

    /// Viscous, Coulomb, and both: the three with which a [`search`](crate::search) begins.
    pub const fn standard() -> [Self; 3] {
        [Self::of::<Viscous>(), Self::of::<Coulomb>(), Self::of::<CoulombViscous>()]
    }

    /// Every law of the [catalogue](fmm_friction::catalogue()).
    pub fn catalogue() -> Vec<Self> {
        catalogue(&mut Candidates)
    }

    /// The law called `name` in the [`catalogue`](Self::catalogue), with the [terms](Terms) that follow it after plus
    /// signs: damping (`linear`, `quadratic`, `cubic`, `any sign`); for vibrations `power`, `cubic spring`, `quintic
    /// spring`, `stop`, `gap`; for a force along a motion `zero`, `inertia`, `stiffness`, `gravity`, `asymmetry`, `load
    /// offset`, `channels`, `delay`.
    ///
    /// ```
    /// use fmm_identify::Candidate;
    ///
    /// assert_eq!(Candidate::named("berger + quadratic")?.name(), "berger + quadratic");
    /// assert_eq!(Candidate::named("coulomb+linear+any sign")?.name(), "coulomb + linear of any sign");
    /// assert_eq!(Candidate::named("viscous+cubic_spring")?.name(), "viscous + cubic spring");
    /// assert_eq!(Candidate::named("dahl + gravity + linear + zero")?.name(), "dahl + linear + zero + gravity");
    /// assert!(Candidate::named("coulomb + air").is_err());
    /// # Ok::<(), fmm_identify::IdentifyError>(())
    /// ```
    ///
    /// # Errors
    /// [`IdentifyError::UnknownName`], with the names there are.
    pub fn named(name: &str) -> Result<Self, IdentifyError> {
        Self::named_among(name, &[])
    }

    /// Like [`named`](Self::named), among the `own` laws before those of the catalogue.
    ///
    /// # Errors
    /// [`IdentifyError::UnknownName`], with the names there are.
    pub fn named_among(name: &str, own: &[&'static OwnLaw]) -> Result<Self, IdentifyError> {
        let mut parts = name.split('+').map(str::trim);
        let law = parts.next().unwrap_or_default();
        let known = || {
            let own = own.iter().map(|law| law.name());
            own.chain(Self::catalogue().iter().map(|candidate| candidate.law.name)).collect::<Vec<_>>().join(", ")
        };
        let own_law = own.iter().find(|own| own.name() == law);
        let found = own_law.map(|law| Self::own(law)).or_else(|| family_named(law, &mut Candidates));
        let found = found.ok_or_else(|| IdentifyError::UnknownName {
            what: format!(
                "there is no law called {law:?}{}; the laws are: {}",
                meant(law, known().split(", ")),
                known()
            ),
        })?;
        let mut terms = Terms::NONE;
        for term in parts {
            terms = match Term::named(&term.replace('_', " ")) {
                Some(term) => terms.with(term),
                None if term == "any sign" => terms.with_damping_of_any_sign(),
                None => {
                    return Err(IdentifyError::UnknownName {
                        what: format!(
                            "there is no term called {term:?} to put beside a law{}; the terms are: {}, any sign",
                            meant(term, Term::names()),
                            Term::names().collect::<Vec<_>>().join(", ")
                        ),
                    });
                }
            };
        }
        Ok(found.with(terms))
    }

    /// Name of the law, with the terms beside it.
    pub fn name(&self) -> String {
        self.terms.name(self.law.name)
    }

    /// True if this law is a special case of `other`: some values of the parameters of `other` make it this one.
    pub(crate) fn is_nested_in(&self, other: &Self) -> bool {
        let viscous = |candidate: &Self| candidate.law.has_slope() || candidate.terms.has_linear_damping();
        let further = || Term::ALL.into_iter().filter(|term| *term != Term::LinearDamping);
        let damped =
            viscous(self) <= viscous(other) && further().all(|term| self.terms.has(term) <= other.terms.has(term));
        damped
            && self.is_dry_case_of(other)
            && !(self.holds_as(other)
                && other.is_dry_case_of(self)
                && viscous(self) == viscous(other)
                && further().all(|term| self.terms.has(term) == other.terms.has(term)))
    }

    /// True if linear damping is the only difference between the two.
    pub(crate) fn differs_by_damping(&self, other: &Self) -> bool {
        let viscous = |candidate: &Self| candidate.law.has_slope() || candidate.terms.has_linear_damping();
        let others = |candidate: &Self| Term::ALL.map(|term| !term.is_damping() && candidate.terms.has(term));
        self.law.dry_name() == other.law.dry_name()
            && viscous(self) != viscous(other)
            && others(self) == others(other)
            && self.holds_as(other)
    }

    /// True if both fix the same parameters at the same values.
    fn holds_as(&self, other: &Self) -> bool {
        self.terms.held().count() == other.terms.held().count()
            && self.terms.held().all(|held| other.terms.held().any(|theirs| theirs == held))
    }

    /// True if the part of this law that does not grow with the speed is that of `other` for some values of its
    /// parameters.
    fn is_dry_case_of(&self, other: &Self) -> bool {
        // What the other holds, this one must hold as well.
        let held = |name: &str| self.terms.held().find(|(held, _)| *held == name).map(|(_, value)| value);
        let (own, theirs) = (self.law.dry_name(), other.law.dry_name());
        if own == theirs {
            return other.terms.held().all(|(name, value)| held(name) == Some(value));
        }
        // No friction but the damping is a case of every law with levels that may vanish.
        if own.is_none() {
            return true;
        }
        let catalogue = Self::catalogue();
        let allowed = |case: &SpecialCase| {
            let free = |(name, value): &(&str, f64)| other.terms.held().all(|(held, at)| held != *name || at == *value);
            case.needed().iter().all(free) && case.restricted().iter().all(|(name, value)| held(name) == Some(*value))
        };
        other.law.special_cases.iter().filter(|case| allowed(case)).any(|case| {
            Some(case.law()) == own
                || catalogue.iter().any(|between| between.law.name == case.law() && self.is_dry_case_of(between))
        })
    }

    /// The same with static levels fitted.
    pub(crate) fn with_breakaway(&self) -> Self {
        Self { law: self.law.with_breakaway(), ..self.clone() }
    }

    pub(crate) fn parameter_count(&self) -> usize {
        let beside = self.terms.iter().count();
        (self.law.parameters.len() + beside).saturating_sub(self.terms.held().count())
    }

    /// Name of the law alone.
    pub fn law_name(&self) -> &'static str {
        self.law.name
    }
}

/// Letters that may differ from a name that is meant.
const SLIPS: usize = 2;

/// Question after the nearest of the `known` names, where one is near.
fn meant<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let near = known.map(|known| (strsim::damerau_levenshtein(&name.to_lowercase(), known), known));
    let near = near.filter(|(slips, known)| *slips <= SLIPS && *slips < known.len() / 2);
    near.min().map_or_else(String::new, |(_, known)| format!(" (is {known} meant?)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistyped_law_or_term_gets_the_nearest_name() {
        let refused = |name: &str| Candidate::named(name).unwrap_err().to_string();
        assert!(refused("colomb").starts_with("there is no law called \"colomb\" (is coulomb meant?); the laws are: "));
        assert!(refused("stribek + linear").contains("(is stribeck meant?)"));
        assert!(refused("coulomb + qaudratic").contains("beside a law (is quadratic meant?); the terms are: "));
        assert!(!refused("friction").contains("meant"));
    }

    /// Bouc-Wen's law is Dahl's where the exponent of the latter is 1, and nowhere else.
    #[test]
    fn dahl_is_a_case_of_bouc_wen_with_exponent_one() {
        let full = Candidate::named("bouc_wen+linear").unwrap().holding("amplitude", 1.0).unwrap();
        let free = Candidate::named("dahl+linear").unwrap();
        let [one, two] = [1.0, 2.0].map(|exponent| free.clone().holding("exponent", exponent).unwrap());
        assert!(one.is_nested_in(&full));
        assert!(!two.is_nested_in(&full) && !free.is_nested_in(&full) && !full.is_nested_in(&one));
    }
}
