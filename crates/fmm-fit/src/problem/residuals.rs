//! Least-squares problem: residuals as a function of parameters.

use std::error::Error;
use std::fmt;

use fmm_model::Parameter;

use crate::problem::block::Block;

/// A least-squares problem: residuals as a function of parameters, and their derivatives if they are known.
///
/// ```text
/// minimise  S(θ) = Σᵢ rᵢ(θ)²   subject to   lowerⱼ ≤ θⱼ ≤ upperⱼ,     i < n = len(),  j < p = parameters().len()
/// ```
///
/// An implementor promises:
///
/// 1. **Shapes.** `parameters().len()` and `len()` do not change during a fit. Every `p` has one value per
///    parameter, in that order and in the unit of the parameter. [`evaluate`](Self::evaluate) fills all `n` elements
///    of `residuals` and, if it gets one, the `n × p` elements of `jacobian`, column after column: `∂rᵢ/∂θⱼ` belongs
///    at `jacobian[j * n + i]`. A problem of [`blocks`](Self::blocks) gets those of each block instead, block after
///    block.
/// 2. **A pure function.** Equal `p` give equal bits, whatever was asked before.
/// 3. **Signed residuals**, model minus data or the reverse, divided by their standard uncertainty where this
///    differs, for which there is [`Weighted`](crate::Weighted). Absolute values have a kink where the fit is best and
///    spoil every derivative.
/// 4. **Non-finite values mean "no value here".** At a trial point the solver then goes less far; only at the
///    start are they an error. The same holds for an `Err`, whose message is kept.
/// 5. **One answer about derivatives**: [`derivatives`](Self::derivatives) says which columns `evaluate` fills. By
///    default it fills none, gets no `jacobian`, and the solver takes differences.
///
/// It may rely on:
///
/// 1. Every value lies inside the closed interval of its parameter, in finite differences too.
/// 2. A parameter with equal bounds always has that value in a fit. Only [`Sensitivity`](crate::Sensitivity), which
///    asks what the fixed values did to a fit, moves them a little.
/// 3. One call at a time, from the thread that runs the fit.
///
/// # Why it is like this
/// Methods take `&self`, so that one problem serves many fits at once and needs no interior mutability; the
/// solver owns the parameters and all large buffers. Slices instead of matrices keep every linear algebra crate
/// out of the signature. The names, units and bounds are part of the problem because an error, a report and a
/// null direction have to speak of them. One method computes residuals and derivatives because both come from one
/// simulation.
///
/// ```
/// use fmm_fit::{EvaluationError, Options, Residuals, solve};
/// use fmm_model::Parameter;
///
/// /// A cooling cup, T = a exp(−b t).
/// struct Cooling<'a> {
///     data: &'a [(f64, f64)],
///     parameters: [Parameter; 2],
/// }
///
/// impl Residuals for Cooling<'_> {
///     fn parameters(&self) -> &[Parameter] {
///         &self.parameters
///     }
///     fn len(&self) -> usize {
///         self.data.len()
///     }
///     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
///         for (r, (t, temperature)) in residuals.iter_mut().zip(self.data) {
///             *r = p[0] * (-p[1] * t).exp() - temperature;
///         }
///         Ok(())
///     }
/// }
///
/// let problem = Cooling {
///     data: &[(0.0, 80.1), (10.0, 48.4), (20.0, 29.5), (30.0, 17.8)],
///     parameters: [Parameter::new("amplitude", "a", "K"), Parameter::new("rate", "b", "1/s")],
/// };
/// let fit = solve(&problem, &[50.0, 0.01], &Options::default())?;
/// assert!(fit.outcome().is_success());
/// assert!((fit.values()[1] - 0.0501).abs() < 1e-4);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no least-squares problem",
    label = "this does not implement `Residuals`",
    note = "a formula that implements `Model` becomes a problem if you wrap it in `Automatic::<_, N>::new(model)`, N \
            being the number of its parameters; a closure if you give it to `curve_fit`, `curve` or \
            `ClosureProblem::new`"
)]
pub trait Residuals {
    /// The parameters: names, units and bounds. Equal bounds hold a parameter fixed.
    fn parameters(&self) -> &[Parameter];

    /// n, the number of residuals.
    fn len(&self) -> usize;

    /// True without residuals.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the `n` residuals at `p`, and with a `jacobian` also the derivatives `∂rᵢ/∂θⱼ`, column after column.
    ///
    /// # Errors
    /// Any reason why the model has no value, or no derivatives, at `p`.
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError>;

    /// The derivatives that [`evaluate`](Self::evaluate) computes; it gets a `jacobian` only if there are any.
    fn derivatives(&self) -> Derivatives {
        Derivatives::None
    }

    /// True if residuals and derivatives together cost less than about twice the residuals. The solver then asks for
    /// both at every trial point, of which about one in eight is rejected, instead of coming back for the derivatives
    /// of the accepted ones.
    fn is_cheaper_combined(&self) -> bool {
        false
    }

    /// The blocks of residuals, in their order, with the parameters that each depends on; together they have all `n`
    /// residuals. Empty, the default, means one block of all residuals and all parameters.
    ///
    /// The Jacobian then has only the elements of the blocks, block after block and within each column after column,
    /// in the order of the block's parameters. A type that wraps a problem and hands on its Jacobian has to hand on
    /// its blocks too.
    fn blocks(&self) -> &[Block] {
        &[]
    }

    /// The residuals of one of the [`blocks`](Self::blocks) at `p`, so that a difference by a parameter costs only the
    /// blocks that it moves; `Ok(false)`, the default, if there is no way to get them without the others.
    ///
    /// # Errors
    /// Whatever keeps the model from having a value at `p`.
    fn block_residuals(&self, block: usize, p: &[f64], residuals: &mut [f64]) -> Result<bool, EvaluationError> {
        let _ = (block, p, residuals);
        Ok(false)
    }
}

/// Derivatives that a problem computes itself, fewest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Derivatives {
    /// None: the solver takes differences.
    None,
    /// Derivatives by the parameters that are not fixed. [`Sensitivity`](crate::Sensitivity) takes differences by the fixed ones.
    Free,
    /// Derivatives by all parameters, fixed ones included.
    All,
}

/// Hands on the shape of a problem, for a wrapper that changes values only: `forward_shape!(self => self.problem)`.
macro_rules! forward_shape {
    ($self:ident => $inner:expr) => {
        fn len(&$self) -> usize {
            $inner.len()
        }
        fn is_cheaper_combined(&$self) -> bool {
            $inner.is_cheaper_combined()
        }
        fn blocks(&$self) -> &[$crate::problem::block::Block] {
            $inner.blocks()
        }
        fn derivatives(&$self) -> $crate::problem::residuals::Derivatives {
            $inner.derivatives()
        }
    };
}

/// Hands on the values of a problem and their derivatives.
macro_rules! forward_values {
    ($self:ident => $inner:expr) => {
        fn evaluate(
            &$self,
            p: &[f64],
            residuals: &mut [f64],
            jacobian: Option<&mut [f64]>,
        ) -> Result<(), $crate::problem::residuals::EvaluationError> {
            $inner.evaluate(p, residuals, jacobian)
        }
        fn block_residuals(
            &$self,
            block: usize,
            p: &[f64],
            residuals: &mut [f64],
        ) -> Result<bool, $crate::problem::residuals::EvaluationError> {
            $inner.block_residuals(block, p, residuals)
        }
    };
}

pub(crate) use {forward_shape, forward_values};

impl<T: Residuals + ?Sized> Residuals for &T {
    forward_shape!(self => (**self));
    forward_values!(self => (**self));
    fn parameters(&self) -> &[Parameter] {
        (**self).parameters()
    }
}

/// Why a model has no value at some parameters: any error, or a sentence.
///
/// It deliberately does not implement [`Error`] itself, so that `?` turns every error into it.
///
/// ```
/// use fmm_fit::EvaluationError;
///
/// fn rate(text: &str) -> Result<f64, EvaluationError> {
///     Ok(text.parse::<f64>()?)
/// }
/// assert_eq!(rate("x").unwrap_err().to_string(), "invalid float literal");
/// assert_eq!(EvaluationError::message("no stop found").to_string(), "no stop found");
/// ```
pub struct EvaluationError(Box<dyn Error + Send + Sync>);

impl EvaluationError {
    /// An error that is only a sentence.
    pub fn message(sentence: impl Into<String>) -> Self {
        Self(sentence.into().into())
    }

    /// An error that is already in a box.
    pub fn from_boxed(error: Box<dyn Error + Send + Sync>) -> Self {
        Self(error)
    }

    /// The error in its box.
    pub fn into_boxed(self) -> Box<dyn Error + Send + Sync> {
        self.0
    }
}

impl<E: Error + Send + Sync + 'static> From<E> for EvaluationError {
    fn from(error: E) -> Self {
        Self(Box::new(error))
    }
}

impl fmt::Debug for EvaluationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.0, f)
    }
}

impl fmt::Display for EvaluationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)
    }
}
