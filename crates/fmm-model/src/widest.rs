//! Work compiled for the widest vectors of the processor.

use pulp::{Arch, Simd, WithSimd};

/// Result of `work`, compiled for the widest vectors that the processor has.
///
/// A long closure must be `#[inline(always)]`: otherwise it stays a function of its own, compiled for any processor.
///
/// ```
/// let mut sum = 0.0;
/// fmm_model::widest(
///     #[inline(always)]
///     || sum = [1.0, 2.0, 3.0].iter().sum(),
/// );
/// assert_eq!(sum, 6.0);
/// ```
pub fn widest<R>(work: impl FnMut() -> R) -> R {
    Arch::new().dispatch(Wide(work))
}

/// A closure as work of pulp.
struct Wide<F>(F);

impl<R, F: FnMut() -> R> WithSimd for Wide<F> {
    type Output = R;

    #[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> R {
        (self.0)()
    }
}
