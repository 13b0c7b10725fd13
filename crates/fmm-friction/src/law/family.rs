//! A law at every number type: the family.

use alloc::vec::Vec;
use core::fmt::Debug;

use fmm_model::Scalar;

use crate::law::kind::{KindOf, LawKind, LawVisitor, SteadyCoefficient};
use crate::law::parameter::{LawParameter, checked, exactly};
use crate::law::{LawError, SearchRole};

/// Action on each family of a catalogue.
pub trait FamilyVisitor {
    /// Result for a family.
    type Output;

    /// Result for family `F`.
    fn visit<F: LawFamily>(&mut self) -> Self::Output;
}

/// Another law that a law becomes at some values of its parameters, without its viscous part.
///
/// ```text
/// Stribeck:  δ = 1 → Berger;  μ_s = μ_c → Coulomb
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpecialCase {
    law: &'static str,
    needed: &'static [(&'static str, f64)],
    restricted: &'static [(&'static str, f64)],
}

impl SpecialCase {
    /// The law called `law`, whatever values the other parameters have; limits, such as a stiffness without bound,
    /// count too.
    pub const fn of(law: &'static str) -> Self {
        Self { law, needed: &[], restricted: &[] }
    }

    /// The law called `law`, where the parameters named in `needed` have these values, or come close to one that is
    /// infinite. A parameter that can take the value always is not listed.
    pub const fn at(law: &'static str, needed: &'static [(&'static str, f64)]) -> Self {
        Self { law, needed, restricted: &[] }
    }

    /// The law called `law`, but only with these values of parameters of its own.
    pub const fn only(law: &'static str, restricted: &'static [(&'static str, f64)]) -> Self {
        Self { law, needed: &[], restricted }
    }

    /// Name of the other law.
    pub const fn law(&self) -> &'static str {
        self.law
    }

    /// Names and values of parameters of the other law to which the case is restricted.
    pub const fn restricted(&self) -> &'static [(&'static str, f64)] {
        self.restricted
    }

    /// Names of parameters and the values that they must have.
    pub const fn needed(&self) -> &'static [(&'static str, f64)] {
        self.needed
    }
}

/// A law at every number type: maps `Law<f64>` to `Law<D>` and a slice of values to a law.
///
/// A fit names a law once, `identify::<Coulomb>`, and builds it at plain numbers for residuals and at dual numbers for
/// the Jacobian.
pub trait LawFamily: 'static {
    /// Name of the law, `snake_case`.
    const NAME: &'static str;

    /// The law's parameters, in the order in which [`at`](Self::at) takes their values.
    const PARAMETERS: &'static [LawParameter];

    /// The laws that this one becomes at some values of its parameters, apart from its viscous part. Special cases of
    /// special cases are not listed. A comparison of laws finds the more general of two laws by it.
    const SPECIAL_CASES: &'static [SpecialCase] = &[];

    /// Trials of the family in a search for the law of a record, or the reason why there is none.
    const SEARCH: SearchRole = SearchRole::UNSTATED;

    /// The law at number type `D`.
    type At<D: Scalar>: Clone + Debug;

    /// The law with the given parameter values.
    ///
    /// # Errors
    /// [`LawError`] if the number of values is not that of [`PARAMETERS`](Self::PARAMETERS), or if a value is
    /// not finite, out of bounds, or contradicts another ([`LawError::Contradiction`]).
    fn at<D: Scalar>(values: &[D]) -> Result<Self::At<D>, LawError>;

    /// Result of `visitor` for laws of this family's kind. An implementor calls the one method of [`LawVisitor`] that
    /// matches its laws.
    fn visit<D: Scalar, V: LawVisitor<D, Self::At<D>>>(visitor: V) -> V::Output;

    /// Kind of the family's laws.
    fn kind() -> LawKind {
        Self::visit::<f64, _>(KindOf)
    }

    /// Friction coefficient (1) of steady sliding by `law` at `speed` ≥ 0 (m/s), in the limit of a speed that grows
    /// slowly or, if it is `losing`, falls; `None` for laws with internal state and without a closed form.
    fn steady_coefficient<D: Scalar>(law: &Self::At<D>, speed: D, losing: bool) -> Option<D> {
        Self::visit(SteadyCoefficient { law, speed, losing })
    }

    /// A family of the same laws by parameters that a fit finds in fewer steps; `None`, the default, for a family that
    /// is fitted by its own parameters. No parameter of either may be a [`LevelAbove`](crate::Role::LevelAbove) or a
    /// [`Breakaway`](crate::Role::Breakaway).
    fn reparametrisation<V: FamilyVisitor>(visitor: &mut V) -> Option<Reparametrisation<V::Output>> {
        let _ = visitor;
        None
    }

    /// The `values` one by one, exactly as many as the law has parameters and each within its bounds. The method
    /// [`at`](Self::at) of a user's law begins with this call.
    ///
    /// ```
    /// use fmm_friction::{Coulomb, LawError, LawFamily};
    ///
    /// let [coefficient] = Coulomb::checked(&[0.2])?;
    /// assert_eq!(coefficient, 0.2);
    /// assert!(matches!(Coulomb::checked::<1, f64>(&[0.2, 0.1]), Err(LawError::WrongCount { got: 2, .. })));
    /// assert!(matches!(Coulomb::checked::<1, f64>(&[-0.2]), Err(LawError::OutOfBounds { .. })));
    /// # Ok::<(), LawError>(())
    /// ```
    ///
    /// # Errors
    /// [`LawError::WrongCount`] and [`LawError::OutOfBounds`].
    fn checked<const N: usize, D: Scalar>(values: &[D]) -> Result<[D; N], LawError> {
        checked(Self::PARAMETERS, exactly(Self::NAME, values)?)
    }
}

/// The laws of another family, by other parameters.
#[derive(Debug, Clone, Copy)]
pub struct Reparametrisation<O> {
    /// Result of the visitor for the family.
    pub family: O,
    /// Values of the other's parameters for values of its own.
    pub values: fn(&[f64]) -> Result<Vec<f64>, LawError>,
}

/// A law at one number type, with that type and its family.
///
/// It lets a function that takes a law know its family, and a scenario with its law have one number type, so that
/// `Coulomb::new(Dual::from(0.2))` needs no annotation. A family of one's own says it in three lines:
///
/// ```
/// # use fmm_friction::{Coulomb, FamilyMember, LawError, LawFamily, LawParameter, LawVisitor, SlidingLaw};
/// # use fmm_model::Scalar;
/// # #[derive(Debug, Clone)]
/// # struct Sticky<D = f64>(Coulomb<D>);
/// # impl LawFamily for Sticky {
/// #     const NAME: &'static str = "sticky";
/// #     const PARAMETERS: &'static [LawParameter] = Coulomb::PARAMETERS;
/// #     type At<D: Scalar> = Sticky<D>;
/// #     fn at<D: Scalar>(values: &[D]) -> Result<Sticky<D>, LawError> {
/// #         Coulomb::at(values).map(Sticky)
/// #     }
/// #     fn visit<D: Scalar, V: LawVisitor<D, Sticky<D>>>(visitor: V) -> V::Output {
/// #         visitor.sliding()
/// #     }
/// # }
/// # impl<D: Scalar> SlidingLaw<D> for Sticky<D> {
/// #     fn coefficient(&self, speed: D) -> D {
/// #         self.0.coefficient(speed)
/// #     }
/// #     fn breakaway(&self) -> D {
/// #         self.0.breakaway()
/// #     }
/// # }
/// impl<D: Scalar> FamilyMember for Sticky<D> {
///     type Number = D;
///     type Family = Sticky;
/// }
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` belongs to no family of laws",
    label = "this does not implement `FamilyMember`",
    note = "a law that implements `SlidingLaw` alone is simulated by the engine `RungeKutta`, one that implements \
            `BristleLaw` by `Bristle`; `simulate`, which chooses the engine, also asks for `LawFamily` and \
            `FamilyMember`"
)]
pub trait FamilyMember: Sized {
    /// The number type.
    type Number: Scalar;

    /// The family, whose member at this number type the law is.
    type Family: LawFamily<At<Self::Number> = Self>;
}

/// A law that is a fixed list of numbers: its struct, its validating constructor and its [`LawFamily`].
///
/// After the name stands its kind, the method of [`LawVisitor`](crate::LawVisitor) that takes it. Each field stands
/// beside the parameter that it is. The braces after the constructor hold the conditions between several
/// parameters. `Scalar`, `LawError`, `LawFamily` and `LawParameter` must be in scope, as the documents refer to them.
macro_rules! law_family {
    (
        $(#[$law_doc:meta])*
        pub struct $law:ident, $name:literal, $kind:ident {
            $($field:ident: $parameter:expr,)+
        }

        $(#[$new_doc:meta])*
        pub fn $new:ident { $($condition:tt)* }
        $(fitted by $other:ident)?
        $(special cases [$($case:expr),+])?
        $(tried [$($trial:expr),+])?
        $(not tried $reason:literal)?
    ) => {
        $(#[$law_doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $law<D = f64> {
            $(pub(crate) $field: D,)+
        }

        impl<D: Scalar> $law<D> {
            $(#[$new_doc])*
            pub fn $new($($field: D),+) -> Result<Self, LawError> {
                let [$($field),+] = $crate::law::parameter::checked($law::PARAMETERS, [$($field),+])?;
                $($condition)*
                Ok(Self { $($field),+ })
            }

            /// The values of the law's parameters, in the order of [`LawFamily::PARAMETERS`].
            pub fn values(&self) -> [D; $law::PARAMETERS.len()] {
                [$(self.$field),+]
            }
        }

        impl LawFamily for $law {
            const NAME: &'static str = $name;
            const PARAMETERS: &'static [LawParameter] = &[$($parameter),+];
            $(const SPECIAL_CASES: &'static [$crate::law::SpecialCase] = &[$($case),+];)?
            $(const SEARCH: $crate::law::SearchRole = $crate::law::SearchRole::Tried(&[$($trial),+]);)?
            $(const SEARCH: $crate::law::SearchRole = $crate::law::SearchRole::NotTried($reason);)?
            type At<D: Scalar> = $law<D>;

            fn at<D: Scalar>(values: &[D]) -> Result<$law<D>, LawError> {
                let [$($field),+] = $crate::law::parameter::exactly(Self::NAME, values)?;
                $law::$new($($field),+)
            }

            fn visit<D: Scalar, V: $crate::law::LawVisitor<D, $law<D>>>(visitor: V) -> V::Output {
                visitor.$kind()
            }
            $(
                fn reparametrisation<V: $crate::law::FamilyVisitor>(visitor: &mut V) -> Option<$crate::law::Reparametrisation<V::Output>> {
                    let values: fn(&[f64]) -> _ = |values| Ok($other::at(values)?.values().to_vec());
                    Some($crate::law::Reparametrisation { family: visitor.visit::<$other>(), values })
                }
            )?
        }

        impl<D: Scalar> $crate::law::FamilyMember for $law<D> {
            type Number = D;
            type Family = $law;
        }
    };
}

pub(crate) use law_family;
