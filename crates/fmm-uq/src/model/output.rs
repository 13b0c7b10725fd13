//! Output of a model: the types it may return.

use std::error::Error;

use crate::Taylor;

/// Result of a model: a number, an array or a vector of them, or a `Result` of one of these.
///
/// `D` is the number type: `f64` for a Monte Carlo and for differences, [`Taylor`] for exact derivatives. Thus the same
/// formula, generic in `D: Scalar`, serves them all.
///
/// ```
/// use fmm_uq::ModelOutput;
///
/// let mut values = Vec::new();
/// assert!(Ok::<_, String>([1.0, 2.0]).append_to(&mut values).is_ok());
/// assert_eq!(values, [1.0, 2.0]);
/// assert!(Err::<f64, _>("no root").append_to(&mut values).is_err());
/// ```
pub trait ModelOutput<D> {
    /// Appends the outputs in their order, or gives the reason why there are none.
    ///
    /// # Errors
    /// The model's own.
    fn append_to(self, outputs: &mut Vec<D>) -> Result<(), Box<dyn Error + Send + Sync>>;
}

impl ModelOutput<Self> for f64 {
    #[inline]
    fn append_to(self, outputs: &mut Vec<Self>) -> Result<(), Box<dyn Error + Send + Sync>> {
        outputs.push(self);
        Ok(())
    }
}

impl ModelOutput<Self> for Taylor {
    #[inline]
    fn append_to(self, outputs: &mut Vec<Self>) -> Result<(), Box<dyn Error + Send + Sync>> {
        outputs.push(self);
        Ok(())
    }
}

impl<D, const N: usize> ModelOutput<D> for [D; N] {
    #[inline]
    fn append_to(self, outputs: &mut Vec<D>) -> Result<(), Box<dyn Error + Send + Sync>> {
        outputs.extend(self);
        Ok(())
    }
}

impl<D> ModelOutput<D> for Vec<D> {
    #[inline]
    fn append_to(self, outputs: &mut Vec<D>) -> Result<(), Box<dyn Error + Send + Sync>> {
        outputs.extend(self);
        Ok(())
    }
}

impl<D, T: ModelOutput<D>, E: Into<Box<dyn Error + Send + Sync>>> ModelOutput<D> for Result<T, E> {
    #[inline]
    fn append_to(self, outputs: &mut Vec<D>) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.map_err(Into::into)?.append_to(outputs)
    }
}
