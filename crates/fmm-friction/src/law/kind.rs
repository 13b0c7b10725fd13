//! Kinds of laws, and the visitor that treats each.

use fmm_model::Scalar;

use crate::law::{BristleLaw, PiecewiseLinearLaw, SlidingLaw};

/// Action on a law `L` of number type `D` according to its kind. It has one method for each kind;
/// [`LawFamily::visit`](crate::LawFamily::visit) calls the one of the family.
///
/// Within a method the law has the trait of its kind. An engine, a plot or a report that must treat kinds differently
/// writes each case once, for all families and all number types, users' laws among them.
///
/// ```
/// use fmm_friction::{BristleLaw, LawFamily, LawVisitor, LuGre, SlidingLaw, Stribeck};
///
/// /// Number of values that a law remembers.
/// struct Memory<'a, L>(&'a L);
///
/// impl<L> LawVisitor<f64, L> for Memory<'_, L> {
///     type Output = usize;
///     fn sliding(self) -> usize
///     where
///         L: SlidingLaw<f64>,
///     {
///         0
///     }
///     fn bristle(self) -> usize
///     where
///         L: BristleLaw<f64>,
///     {
///         self.0.states()
///     }
/// }
///
/// assert_eq!(Stribeck::visit(Memory(&Stribeck::new(0.2, 0.3, 0.01, 1.0, 0.0)?)), 0);
/// assert_eq!(LuGre::visit(Memory(&LuGre::new(0.2, 0.3, 0.01, 1.0, 1e5, 300.0, 0.0)?)), 1);
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
pub trait LawVisitor<D: Scalar, L>: Sized {
    /// Result for a law.
    type Output;

    /// Result for a law of the sliding speed.
    fn sliding(self) -> Self::Output
    where
        L: SlidingLaw<D>;

    /// Result for a law of the sliding speed that is a level plus a slope; by default like any law of the speed.
    fn piecewise_linear(self) -> Self::Output
    where
        L: PiecewiseLinearLaw<D> + SlidingLaw<D>,
    {
        self.sliding()
    }

    /// Result for a law with internal state.
    fn bristle(self) -> Self::Output
    where
        L: BristleLaw<D>;

    /// For a law whose internal state is that of elements which hold or slide; by default like any law with internal
    /// state.
    fn elements(self) -> Self::Output
    where
        L: PiecewiseLinearLaw<D> + BristleLaw<D>,
    {
        self.bristle()
    }
}

/// Kind of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LawKind {
    /// A law of the sliding speed ([`SlidingLaw`]).
    Sliding,
    /// A law of the sliding speed that is a level plus a slope ([`PiecewiseLinearLaw`]).
    PiecewiseLinear,
    /// A law with internal state ([`BristleLaw`]).
    Bristle,
    /// A law with internal state that consists of elements which hold or slide ([`PiecewiseLinearLaw`] and
    /// [`BristleLaw`]).
    Elements,
}

/// Asks a family for its kind.
pub(crate) struct KindOf;

impl<D: Scalar, L> LawVisitor<D, L> for KindOf {
    type Output = LawKind;

    fn sliding(self) -> LawKind
    where
        L: SlidingLaw<D>,
    {
        LawKind::Sliding
    }

    fn piecewise_linear(self) -> LawKind
    where
        L: PiecewiseLinearLaw<D> + SlidingLaw<D>,
    {
        LawKind::PiecewiseLinear
    }

    fn bristle(self) -> LawKind
    where
        L: BristleLaw<D>,
    {
        LawKind::Bristle
    }

    fn elements(self) -> LawKind
    where
        L: PiecewiseLinearLaw<D> + BristleLaw<D>,
    {
        LawKind::Elements
    }
}

/// Asks a law for its coefficient of steady sliding.
pub(crate) struct SteadyCoefficient<'a, D, L> {
    pub(crate) law: &'a L,
    pub(crate) speed: D,
    pub(crate) losing: bool,
}

impl<D: Scalar, L> LawVisitor<D, L> for SteadyCoefficient<'_, D, L> {
    type Output = Option<D>;

    fn sliding(self) -> Option<D>
    where
        L: SlidingLaw<D>,
    {
        let Self { law, speed, losing } = self;
        Some(if losing { law.coefficient_losing_speed(speed) } else { law.coefficient(speed) })
    }

    fn bristle(self) -> Option<D>
    where
        L: BristleLaw<D>,
    {
        self.law.steady_coefficient(self.speed)
    }
}
