//! A law that takes part in a comparison.

use std::ops::ControlFlow;

use fmm_fit::{Options, Progress};
use fmm_friction::{
    AccelerationCoulomb, Berger, BoucWen, Coulomb, CoulombStatic, CoulombViscous, Dahl, ExponentialPair, Hyperbolic,
    Karnopp, LawParameter, LuGre, MakkarDixon, PowerLaw, RegularisedStribeck, Role, Shifted, Stribeck,
    StribeckLorentzian, Viscous,
};
use fmm_sim::Simulated;

use crate::identification::identify_by;
use crate::law::Law;
use crate::terms::{LINEAR, QUADRATIC};
use crate::{Identification, IdentifyError, Machine, RingDown, Terms};

/// An observer of trial steps that may end the fit.
pub(crate) type Observer<'a> = dyn FnMut(&Progress<'_>) -> ControlFlow<()> + 'a;

/// A law family as a value, with terms beside it, so that laws can be chosen at run time and compared in one list.
#[derive(Debug, Clone)]
pub struct Candidate {
    law: Law,
    terms: Terms,
}

macro_rules! catalogue {
    ($($law:ty),+ $(,)?) => {
        /// Every law that can be identified.
        pub fn catalogue() -> Vec<Self> {
            vec![$(Self::of::<$law>()),+]
        }
    };
}

impl Candidate {
    /// The candidate of family `F`, which may be a law of one's own.
    pub const fn of<F: Simulated>() -> Self {
        Self { law: Law::of::<F>(), terms: Terms::NONE }
    }

    /// The same law with `terms` beside it.
    #[must_use]
    pub fn with(self, terms: Terms) -> Self {
        Self { terms, ..self }
    }

    /// The same law with the fitted parameter called `name` held at `value`, in the unit in which it would be fitted.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] if the value is not finite.
    pub fn holding(mut self, name: &str, value: f64) -> Result<Self, IdentifyError> {
        self.terms = self.terms.holding(name, value)?;
        Ok(self)
    }

    /// Viscous, Coulomb, and both: the three that a ring-down is compared by when nothing else is asked for.
    pub const fn standard() -> [Self; 3] {
        [Self::of::<Viscous>(), Self::of::<Coulomb>(), Self::of::<CoulombViscous>()]
    }

    catalogue!(
        Viscous,
        Coulomb,
        CoulombStatic,
        CoulombViscous,
        AccelerationCoulomb,
        Stribeck,
        StribeckLorentzian,
        Hyperbolic,
        Berger,
        PowerLaw,
        ExponentialPair,
        Karnopp,
        MakkarDixon,
        Shifted<MakkarDixon>,
        RegularisedStribeck,
        Dahl,
        LuGre,
        BoucWen,
    );

    /// The law called `name` in the [`catalogue`](Self::catalogue), with the terms that follow it after plus signs.
    ///
    /// ```
    /// use fmm_identify::Candidate;
    ///
    /// assert_eq!(Candidate::named("berger + quadratic")?.name(), "berger + quadratic");
    /// assert_eq!(Candidate::named("coulomb+linear+any sign")?.name(), "coulomb + linear of any sign");
    /// assert!(Candidate::named("coulomb + cubic").is_err());
    /// # Ok::<(), fmm_identify::IdentifyError>(())
    /// ```
    ///
    /// # Errors
    /// [`IdentifyError::UnknownLaw`] and [`IdentifyError::UnknownTerm`], with the names there are.
    pub fn named(name: &str) -> Result<Self, IdentifyError> {
        let catalogue = Self::catalogue();
        let mut parts = name.split('+').map(str::trim);
        let law = parts.next().unwrap_or_default();
        let known = || catalogue.iter().map(|candidate| candidate.law.name).collect::<Vec<_>>().join(", ");
        let found = catalogue.iter().find(|candidate| candidate.law.name == law).cloned();
        let found = found.ok_or_else(|| IdentifyError::UnknownLaw { name: law.to_owned(), known: known() })?;
        let mut terms = Terms::NONE;
        for term in parts {
            terms = match term {
                "linear" => terms.with_linear_damping(),
                "quadratic" => terms.with_quadratic_damping(),
                "any sign" => terms.with_damping_of_any_sign(),
                _ => return Err(IdentifyError::UnknownTerm { name: term.to_owned() }),
            };
        }
        Ok(found.with(terms))
    }

    /// Name of the law, with the terms beside it.
    pub fn name(&self) -> String {
        self.terms.name(self.law.name)
    }

    /// Names and roles of all parameters, of the law and beside it.
    fn all_parameters(&self) -> Vec<(&str, Role)> {
        // A linear damping is the viscous part of a law by another name.
        let name = |parameter: &'static LawParameter| match parameter.role() {
            Role::Slope => (LINEAR, Role::Slope),
            role => (parameter.parameter().name(), role),
        };
        let linear = self.terms.has_linear_damping().then_some((LINEAR, Role::Slope));
        let quadratic = self.terms.has_quadratic_damping().then_some((QUADRATIC, Role::Shape));
        self.law.parameters.iter().map(name).chain(linear).chain(quadratic).collect()
    }

    /// Whether this law is a special case of `other`: every parameter of it is one of the other's, in the same role.
    pub(crate) fn is_nested_in(&self, other: &Self) -> bool {
        let (own, theirs) = (self.all_parameters(), other.all_parameters());
        own.len() < theirs.len() && own.iter().all(|parameter| theirs.contains(parameter))
    }

    pub(crate) fn parameter_count(&self) -> usize {
        self.all_parameters().len() - self.terms.held().count()
    }

    pub(crate) fn identify(
        &self,
        machine: &Machine,
        decays: &[RingDown],
        options: &Options,
        observer: &mut Observer<'_>,
    ) -> Result<Identification, IdentifyError> {
        identify_by(self.law, machine, &self.terms, decays, options, observer)
    }
}
