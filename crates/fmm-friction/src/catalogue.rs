//! The catalogue of all law families.

use alloc::vec;
use alloc::vec::Vec;

use crate::law::{FamilyVisitor, LawFamily};
use crate::laws::{
    AccelerationCoulomb, Berger, BoucWen, BoucWenByLevel, Coulomb, CoulombStatic, CoulombViscous, Dahl,
    ExponentialPair, GmsOf, Hyperbolic, Karnopp, LuGre, MakkarDixon, MaxwellSlipOf, PowerLaw, RegularisedStribeck,
    ShiftedMakkarDixon, Stribeck, StribeckLorentzian, Viscous,
};

macro_rules! catalogue {
    ($($law:ty),+ $(,)?) => {
        /// Results of `visitor` for every family of laws, in the order of the catalogue: from simple to general.
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
    Berger,
    Stribeck,
    StribeckLorentzian,
    Hyperbolic,
    PowerLaw,
    ExponentialPair,
    MakkarDixon,
    ShiftedMakkarDixon,
    RegularisedStribeck,
    Karnopp,
    Dahl,
    LuGre,
    BoucWen,
    BoucWenByLevel,
    MaxwellSlipOf<1>,
    MaxwellSlipOf<2>,
    MaxwellSlipOf<3>,
    MaxwellSlipOf<4>,
    GmsOf<2>,
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{LawKind, SearchRole};

    struct Facts;

    impl FamilyVisitor for Facts {
        type Output = (&'static str, LawKind, SearchRole);

        fn visit<F: LawFamily>(&mut self) -> Self::Output {
            (F::NAME, F::kind(), F::SEARCH)
        }
    }

    #[test]
    fn names_are_unique_and_lead_to_their_family() {
        let all = catalogue(&mut Facts);
        for (name, kind, role) in &all {
            assert_eq!(all.iter().filter(|(other, ..)| other == name).count(), 1, "{name}");
            assert_eq!(family_named(name, &mut Facts), Some((*name, *kind, *role)));
        }
        assert_eq!(family_named("glue", &mut Facts), None);
        let of_kind = |kind| all.iter().filter(|(_, other, _)| *other == kind).count();
        assert_eq!(of_kind(LawKind::PiecewiseLinear), 5);
        assert_eq!(of_kind(LawKind::Bristle), 5);
        assert_eq!(of_kind(LawKind::Elements), 4);
    }

    /// A search asks every family, so that none may leave its part open.
    #[test]
    fn every_family_states_its_part_in_a_search() {
        for (name, _, role) in catalogue(&mut Facts) {
            assert_ne!(role, SearchRole::UNSTATED, "{name}");
            assert_ne!(role, SearchRole::Tried(&[]), "{name}");
        }
    }
}
