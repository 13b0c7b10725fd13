//! Work for the widest vectors of the processor.

use pulp::{Simd, WithSimd};

/// Work to be compiled for the vectors that there are.
///
/// A bare closure is not enough: a function around it makes one call of it, and is compiled for any processor if it is
/// long. fmm-sim has the same: neither uses the other, and what both use shall not bring pulp to those who only want a
/// law.
pub(crate) struct Wide<F>(pub(crate) F);

impl<R, F: FnMut() -> R> WithSimd for Wide<F> {
    type Output = R;

    #[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> R {
        (self.0)()
    }
}
