//! The catalogue of all law families.

use alloc::vec;
use alloc::vec::Vec;

use crate::{
    AccelerationCoulomb, Berger, BoucWen, Coulomb, CoulombStatic, CoulombViscous, Dahl, ExponentialPair, GmsOf,
    Hyperbolic, Karnopp, LawFamily, LuGre, MakkarDixon, MaxwellSlipOf, PowerLaw, RegularisedStribeck, Shifted,
    Stribeck, StribeckLorentzian, Viscous,
};

/// Action on each family of a catalogue.
pub trait FamilyVisitor {
    /// Result for a family.
    type Output;

    /// For family `F`.
    fn visit<F: LawFamily>(&mut self) -> Self::Output;
}

macro_rules! catalogue {
    ($($law:ty),+ $(,)?) => {
        /// Results of `visitor` for every family of laws, in the order of the catalogue.
        ///
        /// ```
        /// use fmm_friction::{FamilyVisitor, LawFamily, catalogue};
        ///
        /// struct Names;
        /// impl FamilyVisitor for Names {
        ///     type Output = &'static str;
        ///     fn visit<F: LawFamily>(&mut self) -> &'static str {
        ///         F::NAME
        ///     }
        /// }
        ///
        /// assert!(catalogue(&mut Names).contains(&"stribeck"));
        /// ```
        pub fn catalogue<V: FamilyVisitor>(visitor: &mut V) -> Vec<V::Output> {
            vec![$(visitor.visit::<$law>()),+]
        }

        /// Result of `visitor` for the family called `name`; `None` if there is no such family.
        pub fn family_named<V: FamilyVisitor>(name: &str, visitor: &mut V) -> Option<V::Output> {
            $(
                if name == <$law>::NAME {
                    return Some(visitor.visit::<$law>());
                }
            )+
            None
        }
    };
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
    MaxwellSlipOf<1>,
    MaxwellSlipOf<2>,
    MaxwellSlipOf<3>,
    MaxwellSlipOf<4>,
    GmsOf<2>,
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LawKind;

    struct NameAndKind;

    impl FamilyVisitor for NameAndKind {
        type Output = (&'static str, LawKind);

        fn visit<F: LawFamily>(&mut self) -> Self::Output {
            (F::NAME, F::kind())
        }
    }

    #[test]
    fn names_are_unique_and_lead_to_their_family() {
        let all = catalogue(&mut NameAndKind);
        for (name, kind) in &all {
            assert_eq!(all.iter().filter(|(other, _)| other == name).count(), 1, "{name}");
            assert_eq!(family_named(name, &mut NameAndKind), Some((*name, *kind)));
        }
        assert_eq!(family_named("glue", &mut NameAndKind), None);
        let of_kind = |kind| all.iter().filter(|(_, other)| *other == kind).count();
        assert_eq!(of_kind(LawKind::PiecewiseLinear), 5);
        assert_eq!(of_kind(LawKind::Bristle), 4);
        assert_eq!(of_kind(LawKind::Elements), 4);
    }
}
