//! A law that takes part in a comparison.

use std::ops::ControlFlow;

use fmm_fit::{Options, Progress};
use fmm_friction::{Coulomb, CoulombStatic, CoulombViscous, LawParameter, Viscous};
use fmm_sim::Simulated;

use crate::identification::identify_observed;
use crate::{Identification, IdentifyError, Machine, RingDown};

/// An observer of trial steps that may end the fit.
pub(crate) type Observer<'a> = dyn FnMut(&Progress<'_>) -> ControlFlow<()> + 'a;

/// A law family as a value, so that laws can be chosen at run time and compared in one list.
#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    name: &'static str,
    parameters: &'static [LawParameter],
    identify: fn(&Machine, &[RingDown], &Options, &mut Observer<'_>) -> Result<Identification, IdentifyError>,
}

impl Candidate {
    /// The candidate of family `F`, which may be a law of one's own.
    pub const fn of<F: Simulated>() -> Self {
        Self { name: F::NAME, parameters: F::PARAMETERS, identify: |m, d, o, f| identify_observed::<F>(m, d, o, f) }
    }

    /// Viscous, Coulomb, and both: the three that a ring-down is compared by when nothing else is asked for.
    pub const fn standard() -> [Self; 3] {
        [Self::of::<Viscous>(), Self::of::<Coulomb>(), Self::of::<CoulombViscous>()]
    }

    /// Every law that can be identified.
    pub const fn catalogue() -> [Self; 4] {
        [Self::of::<Viscous>(), Self::of::<Coulomb>(), Self::of::<CoulombStatic>(), Self::of::<CoulombViscous>()]
    }

    /// The law called `name` in the [`catalogue`](Self::catalogue).
    ///
    /// # Errors
    /// [`IdentifyError::UnknownLaw`], with the names there are.
    pub fn named(name: &str) -> Result<Self, IdentifyError> {
        let catalogue = Self::catalogue();
        catalogue.into_iter().find(|candidate| candidate.name == name).ok_or_else(|| IdentifyError::UnknownLaw {
            name: name.to_owned(),
            known: catalogue.map(|candidate| candidate.name).join(", "),
        })
    }

    /// Name of the law.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// Whether this law is a special case of `other`: every parameter of it is one of the other's, in the same role.
    pub(crate) fn is_nested_in(&self, other: &Self) -> bool {
        let same =
            |a: &LawParameter, b: &LawParameter| a.parameter().name() == b.parameter().name() && a.role() == b.role();
        self.parameters.len() < other.parameters.len()
            && self.parameters.iter().all(|own| other.parameters.iter().any(|theirs| same(own, theirs)))
    }

    pub(crate) fn parameter_count(&self) -> usize {
        self.parameters.len()
    }

    pub(crate) fn identify(
        &self,
        machine: &Machine,
        decays: &[RingDown],
        options: &Options,
        observer: &mut Observer<'_>,
    ) -> Result<Identification, IdentifyError> {
        (self.identify)(machine, decays, options, observer)
    }
}
