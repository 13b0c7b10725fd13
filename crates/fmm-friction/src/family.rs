//! A law as a family over its number types, and the vocabulary of its parameters.

use alloc::borrow::ToOwned;
use alloc::vec::Vec;
use core::fmt::Debug;

use fmm_model::{Bounds, Parameter, Scalar};

use crate::kind::{KindOf, SteadyCoefficient};
use crate::{FamilyVisitor, LawError, LawKind, LawVisitor, SearchRole};

/// Role of a parameter in the friction force. It says in which form the parameter remains when the normal
/// load and the mass are unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Role {
    /// A coefficient, or one per length or power of the speed: the force is proportional to it and to the normal load.
    Level,
    /// A coefficient that the law adds to its first [`Level`](Self::Level) at rest, and which vanishes with speed.
    Excess,
    /// A coefficient that may not lie below the first [`Level`](Self::Level) of the law. A fit takes their difference,
    /// which has a simple bound.
    LevelAbove,
    /// A coefficient per speed: proportional to the load, and inseparable from linear damping of the machine.
    Slope,
    /// A coefficient that the load must exceed to leave rest, not below the sliding level. A free decay depends on it
    /// only in where it stops.
    Breakaway,
    /// Anything that does not scale with the force, such as a speed at which the law bends.
    Shape,
}

/// A parameter of a law and its role.
#[derive(Debug, Clone, PartialEq)]
pub struct LawParameter {
    parameter: Parameter,
    role: Role,
    typical: f64,
}

impl LawParameter {
    /// A parameter with its role.
    pub const fn new(parameter: Parameter, role: Role) -> Self {
        Self { parameter, role, typical: 1.0 }
    }

    /// The same parameter with a start value for fits, relative to the scales of the motion (1). The scale of a
    /// coefficient (or of its excess over another) is the Coulomb coefficient with the same losses, that of a speed the
    /// largest speed, that of a length the amplitude, and that of a pure number 1. The start value is 1 unless it is
    /// set.
    #[must_use]
    pub const fn typically(mut self, relative: f64) -> Self {
        self.typical = relative;
        self
    }

    /// A coefficient, not negative (1).
    pub(crate) const fn level(name: &'static str, symbol: &'static str) -> Self {
        Self::not_negative(name, symbol, "1", Role::Level)
    }

    /// A coefficient that is not below the first level (1).
    pub(crate) const fn level_above(name: &'static str, symbol: &'static str) -> Self {
        Self::not_negative(name, symbol, "1", Role::LevelAbove)
    }

    /// A static level, not negative (1).
    pub(crate) const fn breakaway(name: &'static str, symbol: &'static str) -> Self {
        Self::not_negative(name, symbol, "1", Role::Breakaway)
    }

    /// A coefficient per speed, not negative (s/m).
    pub(crate) const fn slope(name: &'static str, symbol: &'static str) -> Self {
        Self::not_negative(name, symbol, "s/m", Role::Slope)
    }

    /// A parameter of unit `unit` that is not negative.
    pub(crate) const fn not_negative(name: &'static str, symbol: &'static str, unit: &'static str, role: Role) -> Self {
        Self::new(Parameter::new(name, symbol, unit).bounded(Bounds::NOT_NEGATIVE), role)
    }

    /// A parameter of unit `unit` that is positive.
    pub(crate) const fn positive(name: &'static str, symbol: &'static str, unit: &'static str, role: Role) -> Self {
        Self::new(Parameter::new(name, symbol, unit).bounded(Bounds::POSITIVE), role)
    }

    /// Name, symbol, unit and bounds.
    pub const fn parameter(&self) -> &Parameter {
        &self.parameter
    }

    /// Role in the friction force.
    pub const fn role(&self) -> Role {
        self.role
    }

    /// A value to begin a fit at, relative to the scales of the motion (1).
    pub const fn typical(&self) -> f64 {
        self.typical
    }

    /// Passes `value` through if it lies within the parameter's bounds.
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] otherwise, and for NaN and infinity.
    pub fn check<D: Scalar>(&self, value: D) -> Result<D, LawError> {
        let bounds = self.parameter.bounds();
        if value.value().is_finite() && bounds.contains(value.value()) {
            Ok(value)
        } else {
            Err(LawError::OutOfBounds {
                parameter: self.parameter.name().to_owned(),
                value: value.value(),
                unit: self.parameter.unit().to_owned(),
                lower: bounds.lower(),
                upper: bounds.upper(),
            })
        }
    }
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

    /// The law called `law`, where the parameters named in `needed` have these values. A parameter that can take the
    /// value always is not listed.
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
/// This is what lets a fit name a law once, `identify::<Coulomb>`, and build it at plain numbers for residuals
/// and at dual numbers for the Jacobian.
pub trait LawFamily: 'static {
    /// Name of the law, `snake_case`.
    const NAME: &'static str;

    /// The law's parameters, in the order in which [`at`](Self::at) takes their values.
    const PARAMETERS: &'static [LawParameter];

    /// The laws that this one becomes at some values of its parameters, not counting its viscous part, and not counting
    /// what those laws become in turn. A comparison of laws reads off it which of two is the more general.
    const SPECIAL_CASES: &'static [SpecialCase] = &[];

    /// Trials of the family in a search for the law of a record, or the reason why there is none.
    const SEARCH: SearchRole = SearchRole::UNSTATED;

    /// The law at number type `D`.
    type At<D: Scalar>: Clone + Debug;

    /// The law with the given parameter values.
    ///
    /// # Errors
    /// [`LawError`] if the number of values is not that of [`PARAMETERS`](Self::PARAMETERS), or if a value is
    /// not finite, out of bounds, or contradicts another ([`LawError::Condition`] unless another variant fits).
    fn at<D: Scalar>(values: &[D]) -> Result<Self::At<D>, LawError>;

    /// Result of `visitor` for laws of this family's kind. An implementor calls the one method of [`LawVisitor`] that
    /// matches its laws.
    fn visit<D: Scalar, V: LawVisitor<D, Self::At<D>>>(visitor: V) -> V::Output;

    /// Kind of the family's laws.
    fn kind() -> LawKind {
        Self::visit::<f64, _>(KindOf)
    }

    /// Friction coefficient (1) of steady sliding by `law` at `speed` ≥ 0 (m/s), in the limit of a speed that grows
    /// slowly or, if it is `losing`, falls; `None` for laws with internal state that do not say it.
    fn steady_coefficient<D: Scalar>(law: &Self::At<D>, speed: D, losing: bool) -> Option<D> {
        Self::visit(SteadyCoefficient { law, speed, losing })
    }

    /// A family of the same laws by parameters that a fit finds in fewer steps; `None`, the default, for one that is
    /// fitted by its own. No parameter of either may be a [`LevelAbove`](Role::LevelAbove) or a
    /// [`Breakaway`](Role::Breakaway).
    fn recast<V: FamilyVisitor>(visitor: &mut V) -> Option<Recast<V::Output>> {
        let _ = visitor;
        None
    }

    /// The `values` one by one, exactly as many as the law has parameters and each within its bounds: how
    /// [`at`](Self::at) of a law of one's own begins.
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

/// A family of the same laws as another one, by other parameters.
#[derive(Debug, Clone, Copy)]
pub struct Recast<O> {
    /// What the visitor made of the family.
    pub family: O,
    /// Values of the other's parameters for values of its own.
    pub values: fn(&[f64]) -> Result<Vec<f64>, LawError>,
}

/// A law at one number type: which type that is, and the family that it is a member of.
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
    note = "a law that implements `SlidingLaw` alone is simulated by the engine `RungeKutta`, one that implements `BristleLaw` by `Bristle`; \
            `simulate`, which chooses the engine, also asks for `LawFamily` and `FamilyMember`"
)]
pub trait FamilyMember: Sized {
    /// The number type.
    type Number: Scalar;

    /// The family, whose member at this number type the law is.
    type Family: LawFamily<At<Self::Number> = Self>;
}

/// Takes exactly as many values as the law has parameters.
pub(crate) fn exactly<const N: usize, D: Scalar>(law: &'static str, values: &[D]) -> Result<[D; N], LawError> {
    <[D; N]>::try_from(values).map_err(|_| LawError::WrongCount { law, expected: N, got: values.len() })
}

/// The values, each within the bounds of its parameter.
pub(crate) fn checked<const N: usize, D: Scalar>(
    parameters: &[LawParameter],
    values: [D; N],
) -> Result<[D; N], LawError> {
    for (parameter, value) in parameters.iter().zip(values) {
        parameter.check(value)?;
    }
    Ok(values)
}

/// Checks that a static level is not below the sliding level at zero speed.
pub(crate) fn static_not_below<D: Scalar>(sliding: D, breakaway: D) -> Result<(), LawError> {
    if breakaway.value() < sliding.value() {
        return Err(LawError::StaticBelowSliding { breakaway: breakaway.value(), sliding: sliding.value() });
    }
    Ok(())
}

/// A law that is a fixed list of numbers: its struct, its validating constructor and its [`LawFamily`].
///
/// After the name stands its kind, the method of [`LawVisitor`](crate::LawVisitor) that takes it. Each field stands
/// beside the parameter that it is. The braces after the constructor hold what must be true of several parameters
/// together. `Scalar`, `LawError`, `LawFamily` and `LawParameter` must be in scope, as the documents refer to them.
macro_rules! law_family {
    (
        $(#[$law_doc:meta])*
        pub struct $law:ident, $name:literal, $kind:ident {
            $($field:ident: $parameter:expr,)+
        }

        $(#[$new_doc:meta])*
        pub fn $new:ident { $($condition:tt)* }
        $(fitted by $recast:ident)?
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
                let [$($field),+] = $crate::family::checked($law::PARAMETERS, [$($field),+])?;
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
            $(const SPECIAL_CASES: &'static [$crate::SpecialCase] = &[$($case),+];)?
            $(const SEARCH: $crate::SearchRole = $crate::SearchRole::Tried(&[$($trial),+]);)?
            $(const SEARCH: $crate::SearchRole = $crate::SearchRole::NotTried($reason);)?
            type At<D: Scalar> = $law<D>;

            fn at<D: Scalar>(values: &[D]) -> Result<$law<D>, LawError> {
                let [$($field),+] = $crate::family::exactly(Self::NAME, values)?;
                $law::$new($($field),+)
            }

            fn visit<D: Scalar, V: $crate::LawVisitor<D, $law<D>>>(visitor: V) -> V::Output {
                visitor.$kind()
            }
            $(
                fn recast<V: $crate::FamilyVisitor>(visitor: &mut V) -> Option<$crate::Recast<V::Output>> {
                    let values: fn(&[f64]) -> _ = |values| Ok($recast::at(values)?.values().to_vec());
                    Some($crate::Recast { family: visitor.visit::<$recast>(), values })
                }
            )?
        }

        impl<D: Scalar> $crate::FamilyMember for $law<D> {
            type Number = D;
            type Family = $law;
        }
    };
}

pub(crate) use law_family;
