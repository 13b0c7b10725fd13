//! The closed interval in which a parameter may lie.

use crate::ModelError;

/// A closed interval `lower ≤ value ≤ upper`; either end may be infinite.
///
/// ```
/// use fmm_model::Bounds;
///
/// let bounds = Bounds::new(0.0, 1.0)?;
/// assert!(bounds.contains(1.0) && !bounds.contains(1.5));
/// assert_eq!(bounds.clamp(1.5), 1.0);
/// assert!(Bounds::new(1.0, 0.0).is_err());
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    lower: f64,
    upper: f64,
}

impl Bounds {
    /// Every real number.
    pub const UNBOUNDED: Self = Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
    /// Zero and all positive numbers.
    pub const NOT_NEGATIVE: Self = Self { lower: 0.0, upper: f64::INFINITY };
    /// All positive numbers down to the smallest normal one: an interval must be closed, and zero is not positive.
    pub const POSITIVE: Self = Self { lower: f64::MIN_POSITIVE, upper: f64::INFINITY };

    /// The interval from `lower` to `upper`; equal ends hold a parameter fixed.
    ///
    /// # Errors
    /// [`ModelError::InvertedBounds`] if `lower > upper`, if an end is NaN, or if no finite value fits between them.
    pub fn new(lower: f64, upper: f64) -> Result<Self, ModelError> {
        if lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY {
            Ok(Self { lower, upper })
        } else {
            Err(ModelError::InvertedBounds { lower, upper })
        }
    }

    /// The same interval from `lower` on; an end beyond the upper one becomes the upper one.
    ///
    /// With [`at_most`](Self::at_most) this makes bounds that are constants:
    ///
    /// ```
    /// use fmm_model::Bounds;
    ///
    /// const EXPONENT: Bounds = Bounds::POSITIVE.at_least(0.5).at_most(2.0);
    /// assert_eq!(EXPONENT, Bounds::new(0.5, 2.0)?);
    /// # Ok::<(), fmm_model::ModelError>(())
    /// ```
    #[must_use]
    pub const fn at_least(self, lower: f64) -> Self {
        Self { lower: self.lower.max(lower).min(self.upper), upper: self.upper }
    }

    /// The same interval up to `upper`; an end below the lower one becomes the lower one.
    #[must_use]
    pub const fn at_most(self, upper: f64) -> Self {
        Self { lower: self.lower, upper: self.upper.min(upper).max(self.lower) }
    }

    /// The lower end, possibly −∞.
    pub const fn lower(&self) -> f64 {
        self.lower
    }

    /// The upper end, possibly +∞.
    pub const fn upper(&self) -> f64 {
        self.upper
    }

    /// Whether `value` lies in the interval; NaN never does.
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }

    /// The point of the interval nearest to `value`.
    pub fn clamp(&self, value: f64) -> f64 {
        value.max(self.lower).min(self.upper)
    }

    /// Whether the interval is a single point, which holds the parameter fixed.
    pub fn is_fixed(&self) -> bool {
        self.lower == self.upper
    }
}
