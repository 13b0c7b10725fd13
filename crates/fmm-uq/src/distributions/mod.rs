//! Distributions: knowledge about a quantity as a probability distribution.

mod quantiles;
mod text;
mod values;
mod ziggurat;

use std::f64::consts::SQRT_2;
use std::sync::Arc;

use fmm_model::Rounded;

pub(crate) use ziggurat::Ziggurat;

use crate::error::UncertaintyError;
use crate::moments::Moments;

/// A probability distribution: those of JCGM 101:2008, Table 1, and a few more.
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
/// | [`Distribution::log_normal`] | a positive quantity, known to a factor |
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
    shape: Shape,
    mean: f64,
    standard_deviation: f64,
    /// The smallest and the largest value possible.
    limits: (f64, f64),
}

/// Family of a distribution, with the parameters that its moments and limits do not say.
#[derive(Debug, Clone, PartialEq)]
enum Shape {
    Constant,
    Rectangular,
    /// Half the distance of the limits, each of which is known to ± `inexactness`.
    CurvilinearTrapezoid {
        half_width: f64,
        inexactness: f64,
    },
    /// Half base and half top.
    Trapezoid {
        base: f64,
        top: f64,
    },
    ArcSine {
        amplitude: f64,
    },
    Normal,
    StudentT {
        scale: f64,
        degrees_of_freedom: f64,
        unit: rand_distr::StudentT<f64>,
    },
    Exponential,
    Gamma {
        shape: f64,
        scale: f64,
        sampler: rand_distr::Gamma<f64>,
    },
    Triangle {
        mode: f64,
    },
    Beta {
        shapes: (f64, f64),
        sampler: rand_distr::Beta<f64>,
    },
    LogNormal {
        median: f64,
        deviation: f64,
    },
    /// The values, ascending; copies share them.
    Empirical(Arc<[f64]>),
}

/// Limits of a quantity that may have any value.
const UNLIMITED: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
/// Limits of a quantity that cannot be negative.
const NOT_NEGATIVE: (f64, f64) = (0.0, f64::INFINITY);

impl Distribution {
    const fn new(shape: Shape, mean: f64, standard_deviation: f64, limits: (f64, f64)) -> Self {
        Self { shape, mean, standard_deviation, limits }
    }

    /// A finite value that is known exactly.
    pub(crate) const fn of_constant(value: f64) -> Self {
        Self::new(Shape::Constant, value, 0.0, (value, value))
    }

    /// The normal distribution of a finite mean and a positive, finite standard deviation.
    pub(crate) const fn of_normal(mean: f64, standard_deviation: f64) -> Self {
        Self::new(Shape::Normal, mean, standard_deviation, UNLIMITED)
    }

    /// A value that is known exactly.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] if it is not finite.
    pub fn constant(value: f64) -> Result<Self, UncertaintyError> {
        Ok(Self::of_constant(finite("value of a constant", value)?))
    }

    /// R(a, b): equally probable between two limits (JCGM 101:2008, 6.4.2).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless a < b and b − a is finite.
    pub fn rectangular(lower: f64, upper: f64) -> Result<Self, UncertaintyError> {
        let (lower, upper) = limits(lower, upper)?;
        let (mean, deviation) = (0.5 * lower + 0.5 * upper, (upper - lower) / 12f64.sqrt());
        Ok(Self::new(Shape::Rectangular, mean, deviation, (lower, upper)))
    }

    /// CTrap(a, b, d): rectangular between limits that are each known to ±d (JCGM 101:2008, 6.4.3).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless 0 < d ≤ (b − a)/2.
    pub fn curvilinear_trapezoid(lower: f64, upper: f64, inexactness: f64) -> Result<Self, UncertaintyError> {
        let (lower, upper) = limits(lower, upper)?;
        let half_width = 0.5 * (upper - lower);
        let possible = inexactness > 0.0 && inexactness <= half_width;
        require(possible, "inexactness of limits", inexactness, "positive and at most half their distance")?;
        // The root of (b − a)²/12 + d²/9.
        let (mean, deviation) = (0.5 * lower + 0.5 * upper, (half_width / 3f64.sqrt()).hypot(inexactness / 3.0));
        let reach = half_width + inexactness;
        let shape = Shape::CurvilinearTrapezoid { half_width, inexactness };
        Ok(Self::new(shape, mean, deviation, (mean - reach, mean + reach)))
    }

    /// Trap(a, b, β): a symmetric trapezoid whose top is β times its base (JCGM 101:2008, 6.4.4).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless 0 ≤ β < 1.
    pub fn trapezoid(lower: f64, upper: f64, ratio: f64) -> Result<Self, UncertaintyError> {
        let (lower, upper) = limits(lower, upper)?;
        let ratio = require((0.0..1.0).contains(&ratio), "ratio of top to base of a trapezoid", ratio, "in [0, 1)")?;
        let (mean, base) = (0.5 * lower + 0.5 * upper, 0.5 * (upper - lower));
        let top = ratio * base;
        // The root of (b − a)² (1 + β²)/24.
        let deviation = base.hypot(top) / 6f64.sqrt();
        Ok(Self::new(Shape::Trapezoid { base, top }, mean, deviation, (mean - base, mean + base)))
    }

    /// T(a, b): a symmetric triangle (JCGM 101:2008, 6.4.5).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless a < b, with a finite distance.
    pub fn triangular(lower: f64, upper: f64) -> Result<Self, UncertaintyError> {
        Self::trapezoid(lower, upper, 0.0)
    }

    /// U(a, b): a quantity that cycles sinusoidally between two limits, at unknown phase (JCGM 101:2008, 6.4.6).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless a < b, with a finite distance.
    pub fn arc_sine(lower: f64, upper: f64) -> Result<Self, UncertaintyError> {
        let (lower, upper) = limits(lower, upper)?;
        let (mean, amplitude) = (0.5 * lower + 0.5 * upper, 0.5 * (upper - lower));
        Ok(Self::new(Shape::ArcSine { amplitude }, mean, amplitude / SQRT_2, (mean - amplitude, mean + amplitude)))
    }

    /// N(x, u²) (JCGM 101:2008, 6.4.7).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless x is finite and u positive and finite.
    pub fn normal(mean: f64, standard_deviation: f64) -> Result<Self, UncertaintyError> {
        let (mean, standard_deviation) = (finite("mean", mean)?, positive("standard deviation", standard_deviation)?);
        Ok(Self::of_normal(mean, standard_deviation))
    }

    /// t_ν(x, s²): Student's t, shifted to x and scaled by s (JCGM 101:2008, 6.4.9). ν = ∞ gives the normal.
    ///
    /// For n observations x is their mean, s their standard deviation over √n, and ν = n − 1; for an expanded
    /// uncertainty U with coverage factor k, s is U/k. The standard deviation is s √(ν/(ν − 2)), and infinite for ν ≤
    /// 2.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless x is finite, s positive and finite, and ν at least 1.
    pub fn student_t(mean: f64, scale: f64, degrees_of_freedom: f64) -> Result<Self, UncertaintyError> {
        let (mean, scale) = (finite("mean", mean)?, positive("scale of a t-distribution", scale)?);
        let nu = UncertaintyError::require_degrees_of_freedom("a t-distribution", degrees_of_freedom)?;
        if nu.is_infinite() {
            return Self::normal(mean, scale);
        }
        let unit = rand_distr::StudentT::new(nu).map_err(|_| refused("degrees of freedom", nu))?;
        let deviation = if nu > 2.0 { scale * (nu / (nu - 2.0)).sqrt() } else { f64::INFINITY };
        Ok(Self::new(Shape::StudentT { scale, degrees_of_freedom: nu, unit }, mean, deviation, UNLIMITED))
    }

    /// T(a, m, b): a triangle between two limits with its top at the mode m, which may be at a limit.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless a ≤ m ≤ b.
    pub fn asymmetric_triangle(lower: f64, mode: f64, upper: f64) -> Result<Self, UncertaintyError> {
        let (lower, upper) = limits(lower, upper)?;
        let mode = require((lower..=upper).contains(&mode), "mode of a triangle", mode, "between its limits")?;
        let (p, q) = (mode - lower, upper - mode);
        let (mean, whole) = (mode + ((lower - mode) + (upper - mode)) / 3.0, p + q);
        // The root of (p² + p q + q²)/18.
        let deviation = whole * ((1.0 - (p / whole) * (q / whole)) / 18.0).sqrt();
        Ok(Self::new(Shape::Triangle { mode }, mean, deviation, (lower, upper)))
    }

    /// Beta(α, β) on [a, b], with density proportional to (x − a)^(α−1) (b − x)^(β−1).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless both shapes are positive and
    /// finite.
    pub fn beta(first_shape: f64, second_shape: f64, lower: f64, upper: f64) -> Result<Self, UncertaintyError> {
        let name = "shape of a beta distribution";
        let (a, b) = (positive(name, first_shape)?, positive(name, second_shape)?);
        let (lower, upper) = limits(lower, upper)?;
        let sampler = rand_distr::Beta::new(a, b).map_err(|_| refused(name, first_shape))?;
        let whole = a + b;
        // (b − a) √(α β/(α + β + 1))/(α + β).
        let deviation = (upper - lower) * (a / whole * (b / whole) / (whole + 1.0)).sqrt();
        let mean = lower + (upper - lower) * (a / whole);
        Ok(Self::new(Shape::Beta { shapes: (a, b), sampler }, mean, deviation, (lower, upper)))
    }

    /// A positive quantity whose logarithm is normal: ln(x/m) has the standard deviation σ, so that a σ of 0.1 is a
    /// factor of about 1.1.
    ///
    /// ```text
    /// E = m e^(σ²/2),   u = E √(e^(σ²) − 1)
    /// ```
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless median m and σ are positive and finite, and so are E and u.
    pub fn log_normal(median: f64, deviation_of_logarithm: f64) -> Result<Self, UncertaintyError> {
        let median = positive("median of a log-normal distribution", median)?;
        let deviation = positive("standard deviation of a logarithm", deviation_of_logarithm)?;
        let mean = median * (0.5 * deviation * deviation).exp();
        let u = mean * (deviation * deviation).exp_m1().sqrt();
        positive("standard deviation of a log-normal distribution", u)?;
        Ok(Self::new(Shape::LogNormal { median, deviation }, mean, u, NOT_NEGATIVE))
    }

    /// Ex(1/x): a quantity that cannot be negative and of which no more than an estimate x is known
    /// (JCGM 101:2008, 6.4.10).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless x is positive and finite.
    pub fn exponential(mean: f64) -> Result<Self, UncertaintyError> {
        let mean = positive("mean of an exponential distribution", mean)?;
        Ok(Self::new(Shape::Exponential, mean, mean, NOT_NEGATIVE))
    }

    /// G(α, β) with density proportional to x^(α−1) e^(−x/β). The mean number of events of which q were counted has
    /// G(q + 1, 1) (JCGM 101:2008, 6.4.11).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless both are positive and finite.
    pub fn gamma(shape: f64, scale: f64) -> Result<Self, UncertaintyError> {
        let (shape, scale) = (positive("shape of a gamma distribution", shape)?, positive("scale", scale)?);
        let sampler =
            rand_distr::Gamma::new(shape, scale).map_err(|_| refused("shape of a gamma distribution", shape))?;
        let (mean, deviation) = (shape * scale, shape.sqrt() * scale);
        Ok(Self::new(Shape::Gamma { shape, scale, sampler }, mean, deviation, NOT_NEGATIVE))
    }

    /// Equal probability for each of `values`.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] without a value, or if a value or the standard deviation is not finite;
    /// [`UncertaintyError::NoAnswer`] if the values differ by so little that their squares are lost.
    pub fn empirical(values: &[f64]) -> Result<Self, UncertaintyError> {
        if values.is_empty() {
            return Err(UncertaintyError::too_few_observations(0, 1));
        }
        for &value in values {
            finite("value of an empirical distribution", value)?;
        }
        Moments::of_values(values).require_squares(values, "the values of an empirical distribution")?;
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let (moments, limits) = (Moments::of_values(&sorted), (sorted[0], sorted[sorted.len() - 1]));
        // The values are the whole distribution and no sample of it: n, not n − 1.
        let deviation = (moments.sum_of_squares() / sorted.len() as f64).sqrt();
        finite("standard deviation of an empirical distribution", deviation)?;
        Ok(Self::new(Shape::Empirical(sorted.into()), moments.mean(), deviation, limits))
    }

    /// Expectation; the centre of Student's t, which for ν = 1 has no expectation.
    pub const fn mean(&self) -> f64 {
        self.mean
    }

    /// Standard deviation; infinite for Student's t with ν ≤ 2. For t it is larger than the scale by √(ν/(ν − 2)).
    pub const fn standard_deviation(&self) -> f64 {
        self.standard_deviation
    }

    /// The smallest and the largest value possible.
    pub(crate) const fn limits(&self) -> (f64, f64) {
        self.limits
    }

    pub(crate) const fn is_constant(&self) -> bool {
        matches!(self.shape, Shape::Constant)
    }

    pub(crate) const fn is_normal(&self) -> bool {
        matches!(self.shape, Shape::Normal)
    }

    pub(crate) const fn is_normal_or_t(&self) -> bool {
        matches!(self.shape, Shape::Normal | Shape::StudentT { .. })
    }

    /// The standard uncertainty that the GUM takes: the standard deviation, but the scale of Student's t, whose
    /// degrees of freedom the GUM counts separately.
    pub const fn standard_uncertainty(&self) -> f64 {
        match &self.shape {
            Shape::StudentT { scale, .. } => *scale,
            _ => self.standard_deviation,
        }
    }

    /// ν of Student's t (1), infinite for all others.
    pub const fn degrees_of_freedom(&self) -> f64 {
        match &self.shape {
            Shape::StudentT { degrees_of_freedom, .. } => *degrees_of_freedom,
            _ => f64::INFINITY,
        }
    }
}

fn limits(lower: f64, upper: f64) -> Result<(f64, f64), UncertaintyError> {
    if lower < upper && (upper - lower).is_finite() {
        Ok((lower, upper))
    } else {
        let (lower, upper) = (Rounded::every_digit(lower), Rounded::every_digit(upper));
        let what = "must lie below the upper limit";
        Err(UncertaintyError::invalid(format!(
            "the lower limit {lower} {what} {upper}, and their distance must be finite"
        )))
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
