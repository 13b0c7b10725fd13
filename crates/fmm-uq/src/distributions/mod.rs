//! Distributions: knowledge about a quantity as a probability distribution.

mod arc_sine;
pub(crate) mod beta;
mod curvilinear_trapezoid;
mod empirical;
pub(crate) mod gamma;
mod trapezoid;
mod triangle;
mod truncated_normal;

mod text;
mod values;

use crate::distributions::arc_sine::ArcSine;
use crate::distributions::beta::Beta;
use crate::distributions::curvilinear_trapezoid::CurvilinearTrapezoid;
use crate::distributions::empirical::Empirical;
use crate::distributions::trapezoid::Trapezoid;
use crate::distributions::triangle::Triangle;
use crate::distributions::truncated_normal::TruncatedNormal;
use crate::{Moments, UncertaintyError};

/// A probability distribution: those of JCGM 101:2008, Table 1, and what else quantities are known by.
///
/// | constructor | known is |
/// |---|---|
/// | [`Distribution::constant`] | the value |
/// | [`Distribution::rectangular`] | lower and upper limit |
/// | [`Distribution::curvilinear_trapezoid`] | limits that are themselves inexact |
/// | [`Distribution::trapezoid`] | a sum of two rectangular quantities |
/// | [`Distribution::triangular`] | a sum of two rectangular quantities of equal width |
/// | [`Distribution::arc_sine`] | limits between which a quantity cycles sinusoidally |
/// | [`Distribution::normal`] | estimate and standard uncertainty |
/// | [`Distribution::student_t`] | mean and standard deviation of a few observations; an expanded uncertainty with ν |
/// | [`Distribution::exponential`] | mean of a quantity that cannot be negative |
/// | [`Distribution::gamma`] | a count of events |
/// | [`Distribution::asymmetric_triangle`] | limits, and the most probable value between them |
/// | [`Distribution::beta`] | limits, and two shapes |
/// | [`Distribution::truncated_normal`] | estimate and standard uncertainty, and limits |
/// | [`Distribution::log_normal`] | a positive quantity, known to a factor |
/// | [`Distribution::poisson`] | the mean number of events, which then are counted |
/// | [`Distribution::empirical`] | values |
///
/// ```
/// use fmm_uq::Distribution;
///
/// let limits = Distribution::rectangular(-1.0, 3.0)?;
/// assert_eq!((limits.mean(), limits.quantile(0.975)?), (1.0, 2.9));
/// assert!((limits.standard_deviation() - 2.0 / 3f64.sqrt()).abs() < 1e-15);
/// assert!(Distribution::rectangular(3.0, -1.0).is_err());
/// assert_eq!(limits.to_string(), "R(-1, 3)");
/// assert!((limits.divisor() - 3f64.sqrt()).abs() < 1e-15);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    pub(crate) shape: Shape,
}

/// The valid parameters of a distribution.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Shape {
    Constant(f64),
    Rectangular { lower: f64, upper: f64 },
    CurvilinearTrapezoid(CurvilinearTrapezoid),
    Trapezoid(Trapezoid),
    ArcSine(ArcSine),
    Normal { mean: f64, standard_deviation: f64 },
    StudentT { mean: f64, scale: f64, degrees_of_freedom: f64, unit: rand_distr::StudentT<f64> },
    Exponential { mean: f64 },
    Gamma { shape: f64, scale: f64, sampler: rand_distr::Gamma<f64> },
    Triangle(Triangle),
    Beta(Beta),
    TruncatedNormal(TruncatedNormal),
    LogNormal { median: f64, deviation: f64 },
    Poisson { mean: f64, sampler: rand_distr::Poisson<f64> },
    Empirical(Empirical),
}

impl Distribution {
    /// A value that is known exactly.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] if it is not finite.
    pub fn constant(value: f64) -> Result<Self, UncertaintyError> {
        Ok(Shape::Constant(finite("value of a constant", value)?).into())
    }

    /// R(a, b): equally probable between two limits (JCGM 101:2008, 6.4.2).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless a < b and b − a is finite.
    pub fn rectangular(lower: f64, upper: f64) -> Result<Self, UncertaintyError> {
        let (lower, upper) = limits(lower, upper)?;
        Ok(Shape::Rectangular { lower, upper }.into())
    }

    /// CTrap(a, b, d): rectangular between limits that are each known to ±d (JCGM 101:2008, 6.4.3).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless 0 < d ≤ (b − a)/2.
    pub fn curvilinear_trapezoid(lower: f64, upper: f64, inexactness: f64) -> Result<Self, UncertaintyError> {
        let (lower, upper) = limits(lower, upper)?;
        let half = 0.5 * (upper - lower);
        let possible = inexactness > 0.0 && inexactness <= half;
        let d = require(possible, "inexactness of limits", inexactness, "positive and at most half their distance")?;
        Ok(Shape::CurvilinearTrapezoid(CurvilinearTrapezoid::new(lower, upper, d)).into())
    }

    /// Trap(a, b, β): a symmetric trapezoid whose top is β times its base (JCGM 101:2008, 6.4.4).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless 0 ≤ β < 1.
    pub fn trapezoid(lower: f64, upper: f64, ratio: f64) -> Result<Self, UncertaintyError> {
        let (lower, upper) = limits(lower, upper)?;
        let ratio = require((0.0..1.0).contains(&ratio), "ratio of top to base of a trapezoid", ratio, "in [0, 1)")?;
        Ok(Shape::Trapezoid(Trapezoid::new(lower, upper, ratio)).into())
    }

    /// T(a, b): a symmetric triangle (JCGM 101:2008, 6.4.5).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless a < b, with a finite distance.
    pub fn triangular(lower: f64, upper: f64) -> Result<Self, UncertaintyError> {
        Self::trapezoid(lower, upper, 0.0)
    }

    /// U(a, b): a quantity that cycles sinusoidally between two limits, at unknown phase (JCGM 101:2008, 6.4.6).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless a < b, with a finite distance.
    pub fn arc_sine(lower: f64, upper: f64) -> Result<Self, UncertaintyError> {
        let (lower, upper) = limits(lower, upper)?;
        Ok(Shape::ArcSine(ArcSine::new(lower, upper)).into())
    }

    /// N(x, u²) (JCGM 101:2008, 6.4.7).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless x is finite and u positive and finite.
    pub fn normal(mean: f64, standard_deviation: f64) -> Result<Self, UncertaintyError> {
        let (mean, standard_deviation) = (finite("mean", mean)?, positive("standard deviation", standard_deviation)?);
        Ok(Shape::Normal { mean, standard_deviation }.into())
    }

    /// t_ν(x, s²): Student's t, shifted to x and scaled by s (JCGM 101:2008, 6.4.9). ν = ∞ gives the normal.
    ///
    /// For n observations x is their mean, s their standard deviation over √n, and ν = n − 1; for an expanded
    /// uncertainty U with coverage factor k, s is U/k. The standard deviation is s √(ν/(ν − 2)), and infinite for ν ≤
    /// 2.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless x is finite, s positive and finite, and ν at least 1.
    pub fn student_t(mean: f64, scale: f64, degrees_of_freedom: f64) -> Result<Self, UncertaintyError> {
        let (mean, scale) = (finite("mean", mean)?, positive("scale of a t-distribution", scale)?);
        let nu = UncertaintyError::require_degrees_of_freedom("a t-distribution", degrees_of_freedom)?;
        if nu.is_infinite() {
            return Self::normal(mean, scale);
        }
        let unit = rand_distr::StudentT::new(nu).map_err(|_| refused("degrees of freedom", nu))?;
        Ok(Shape::StudentT { mean, scale, degrees_of_freedom: nu, unit }.into())
    }

    /// Student's t of given mean and standard deviation, instead of its scale s = u √((ν − 2)/ν).
    ///
    /// The GUM counts degrees of freedom apart: it takes s for the standard uncertainty of this distribution.
    ///
    /// # Errors
    /// Those of [`Distribution::student_t`]; [`UncertaintyError::OutOfRange`] for ν ≤ 2, which has no standard
    /// deviation.
    pub fn student_t_of_deviation(
        mean: f64,
        standard_deviation: f64,
        degrees_of_freedom: f64,
    ) -> Result<Self, UncertaintyError> {
        let nu = UncertaintyError::require_degrees_of_freedom("a t-distribution", degrees_of_freedom)?;
        require(nu > 2.0, "degrees of freedom of a standard deviation", nu, "above 2")?;
        let ratio = if nu.is_infinite() { 1.0 } else { ((nu - 2.0) / nu).sqrt() };
        Self::student_t(mean, positive("standard deviation", standard_deviation)? * ratio, nu)
    }

    /// T(a, m, b): a triangle between two limits with its top at the mode m, which may be at a limit.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless a ≤ m ≤ b.
    pub fn asymmetric_triangle(lower: f64, mode: f64, upper: f64) -> Result<Self, UncertaintyError> {
        let (lower, upper) = limits(lower, upper)?;
        let mode = require((lower..=upper).contains(&mode), "mode of a triangle", mode, "between its limits")?;
        Ok(Shape::Triangle(Triangle::new(lower, mode, upper)).into())
    }

    /// Beta(α, β) on [a, b], with density proportional to (x − a)^(α−1) (b − x)^(β−1).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless both shapes are positive and
    /// finite.
    pub fn beta(first_shape: f64, second_shape: f64, lower: f64, upper: f64) -> Result<Self, UncertaintyError> {
        let name = "shape of a beta distribution";
        let shapes = (positive(name, first_shape)?, positive(name, second_shape)?);
        let beta = Beta::new(shapes, limits(lower, upper)?).ok_or_else(|| refused(name, first_shape))?;
        Ok(Shape::Beta(beta).into())
    }

    /// N(x, u²), cut off at two limits; one of them may be infinite.
    ///
    /// Its mean and standard deviation are those between the limits, not x and u.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless a < b, x is finite, and u positive and finite, or if the limits leave no
    /// more than some 1e-290 of the distribution.
    pub fn truncated_normal(
        mean: f64,
        standard_deviation: f64,
        lower: f64,
        upper: f64,
    ) -> Result<Self, UncertaintyError> {
        let (mean, u) = (finite("mean", mean)?, positive("standard deviation", standard_deviation)?);
        if !(lower < upper) {
            return Err(UncertaintyError::limits_out_of_order(lower, upper));
        }
        let (parameter, must_be) = ("mean of a truncated normal distribution", "nearer to its limits");
        let none = || UncertaintyError::out_of_range(parameter, mean, must_be);
        Ok(Shape::TruncatedNormal(TruncatedNormal::new(mean, u, (lower, upper)).ok_or_else(none)?).into())
    }

    /// A positive quantity whose logarithm is normal: ln(x/m) has the standard deviation σ, so that a σ of 0.1 is a
    /// factor of about 1.1.
    ///
    /// ```text
    /// E = m e^(σ²/2),   u = E √(e^(σ²) − 1)
    /// ```
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless median m and σ are positive and finite, and so are E and u.
    pub fn log_normal(median: f64, deviation_of_logarithm: f64) -> Result<Self, UncertaintyError> {
        let median = positive("median of a log-normal distribution", median)?;
        let deviation = positive("standard deviation of a logarithm", deviation_of_logarithm)?;
        let distribution = Self::from(Shape::LogNormal { median, deviation });
        positive("standard deviation of a log-normal distribution", distribution.standard_deviation())?;
        Ok(distribution)
    }

    /// The number of events that are counted where λ are expected: whole numbers of variance λ.
    ///
    /// What q counted events say of λ is [`Distribution::gamma`] of shape q + 1.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless λ is positive and at most 1e15, where numbers are still whole.
    pub fn poisson(mean: f64) -> Result<Self, UncertaintyError> {
        let name = "mean of a Poisson distribution";
        let mean = require(mean > 0.0 && mean <= 1e15, name, mean, "positive and at most 1e15")?;
        let sampler = rand_distr::Poisson::new(mean).map_err(|_| refused(name, mean))?;
        Ok(Shape::Poisson { mean, sampler }.into())
    }

    /// Ex(1/x): a quantity that cannot be negative and of which no more than an estimate x is known
    /// (JCGM 101:2008, 6.4.10).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless x is positive and finite.
    pub fn exponential(mean: f64) -> Result<Self, UncertaintyError> {
        Ok(Shape::Exponential { mean: positive("mean of an exponential distribution", mean)? }.into())
    }

    /// G(α, β) with density proportional to x^(α−1) e^(−x/β). The mean number of events of which q were counted has
    /// G(q + 1, 1) (JCGM 101:2008, 6.4.11).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless both are positive and finite.
    pub fn gamma(shape: f64, scale: f64) -> Result<Self, UncertaintyError> {
        let (shape, scale) = (positive("shape of a gamma distribution", shape)?, positive("scale", scale)?);
        let sampler =
            rand_distr::Gamma::new(shape, scale).map_err(|_| refused("shape of a gamma distribution", shape))?;
        Ok(Shape::Gamma { shape, scale, sampler }.into())
    }

    /// Equal probability for each of `values`.
    ///
    /// # Errors
    /// [`UncertaintyError::TooFewObservations`] without a value; [`UncertaintyError::OutOfRange`] if a value or the
    /// standard deviation is not finite; [`UncertaintyError::NoAnswer`] if the values differ by so little that their
    /// squares are lost.
    pub fn empirical(values: &[f64]) -> Result<Self, UncertaintyError> {
        if values.is_empty() {
            return Err(UncertaintyError::TooFewObservations { found: 0, needed: 1 });
        }
        for &value in values {
            finite("value of an empirical distribution", value)?;
        }
        Moments::of_values(values).require_squares(values, "the values of an empirical distribution")?;
        let empirical = Empirical::new(values.to_vec());
        finite("standard deviation of an empirical distribution", empirical.standard_deviation())?;
        Ok(Shape::Empirical(empirical).into())
    }

    /// Expectation; the centre of Student's t, which for ν = 1 has no expectation.
    pub fn mean(&self) -> f64 {
        match &self.shape {
            Shape::Constant(value) => *value,
            Shape::Rectangular { lower, upper } => 0.5 * lower + 0.5 * upper,
            Shape::CurvilinearTrapezoid(shape) => shape.mean(),
            Shape::Trapezoid(shape) => shape.mean(),
            Shape::ArcSine(shape) => shape.mean(),
            Shape::Normal { mean, .. }
            | Shape::StudentT { mean, .. }
            | Shape::Exponential { mean }
            | Shape::Poisson { mean, .. } => *mean,
            Shape::Triangle(shape) => shape.mean(),
            Shape::Beta(shape) => shape.mean(),
            Shape::TruncatedNormal(shape) => shape.mean(),
            Shape::LogNormal { median, deviation } => median * (0.5 * deviation * deviation).exp(),
            Shape::Gamma { shape, scale, .. } => shape * scale,
            Shape::Empirical(shape) => shape.mean(),
        }
    }

    /// Standard deviation; infinite for Student's t with ν ≤ 2. For t it is larger than the scale by √(ν/(ν − 2)).
    pub fn standard_deviation(&self) -> f64 {
        match &self.shape {
            Shape::Constant(_) => 0.0,
            Shape::Rectangular { lower, upper } => (upper - lower) / 12f64.sqrt(),
            Shape::CurvilinearTrapezoid(shape) => shape.standard_deviation(),
            Shape::Trapezoid(shape) => shape.standard_deviation(),
            Shape::ArcSine(shape) => shape.standard_deviation(),
            Shape::Normal { standard_deviation, .. } => *standard_deviation,
            Shape::StudentT { scale, degrees_of_freedom: nu, .. } => {
                if *nu > 2.0 {
                    scale * (nu / (nu - 2.0)).sqrt()
                } else {
                    f64::INFINITY
                }
            }
            Shape::Exponential { mean } => *mean,
            Shape::Triangle(shape) => shape.standard_deviation(),
            Shape::Beta(shape) => shape.standard_deviation(),
            Shape::TruncatedNormal(shape) => shape.standard_deviation(),
            Shape::LogNormal { deviation, .. } => self.mean() * (deviation * deviation).exp_m1().sqrt(),
            Shape::Poisson { mean, .. } => mean.sqrt(),
            Shape::Gamma { shape, scale, .. } => shape.sqrt() * scale,
            Shape::Empirical(shape) => shape.standard_deviation(),
        }
    }

    /// The smallest and the largest value possible.
    pub(crate) fn limits(&self) -> (f64, f64) {
        match &self.shape {
            Shape::Constant(value) => (*value, *value),
            Shape::Rectangular { lower, upper } => (*lower, *upper),
            Shape::CurvilinearTrapezoid(shape) => shape.limits(),
            Shape::Trapezoid(shape) => shape.limits(),
            Shape::ArcSine(shape) => shape.limits(),
            Shape::Normal { .. } | Shape::StudentT { .. } => (f64::NEG_INFINITY, f64::INFINITY),
            Shape::Exponential { .. } | Shape::Gamma { .. } | Shape::LogNormal { .. } | Shape::Poisson { .. } => {
                (0.0, f64::INFINITY)
            }
            Shape::Triangle(shape) => (shape.parameters().0, shape.parameters().2),
            Shape::Beta(shape) => shape.limits(),
            Shape::TruncatedNormal(shape) => shape.limits(),
            Shape::Empirical(shape) => shape.limits(),
        }
    }

    /// The standard uncertainty that the GUM takes: the standard deviation, but the scale of Student's t, whose
    /// degrees of freedom the GUM counts apart.
    pub fn standard_uncertainty(&self) -> f64 {
        match &self.shape {
            Shape::StudentT { scale, .. } => *scale,
            _ => self.standard_deviation(),
        }
    }

    /// ν of Student's t (1), infinite for all others.
    pub fn degrees_of_freedom(&self) -> f64 {
        match &self.shape {
            Shape::StudentT { degrees_of_freedom, .. } => *degrees_of_freedom,
            _ => f64::INFINITY,
        }
    }
}

impl From<Shape> for Distribution {
    fn from(shape: Shape) -> Self {
        Self { shape }
    }
}

fn limits(lower: f64, upper: f64) -> Result<(f64, f64), UncertaintyError> {
    if lower < upper && (upper - lower).is_finite() {
        Ok((lower, upper))
    } else {
        Err(UncertaintyError::limits_out_of_order(lower, upper))
    }
}

fn require(
    possible: bool,
    parameter: &'static str,
    value: f64,
    must_be: &'static str,
) -> Result<f64, UncertaintyError> {
    if possible { Ok(value) } else { Err(UncertaintyError::out_of_range(parameter, value, must_be)) }
}

fn finite(parameter: &'static str, value: f64) -> Result<f64, UncertaintyError> {
    require(value.is_finite(), parameter, value, "finite")
}

fn positive(parameter: &'static str, value: f64) -> Result<f64, UncertaintyError> {
    require(value > 0.0 && value.is_finite(), parameter, value, "positive and finite")
}

fn refused(parameter: &'static str, value: f64) -> UncertaintyError {
    UncertaintyError::out_of_range(parameter, value, "in the range that can be sampled")
}
