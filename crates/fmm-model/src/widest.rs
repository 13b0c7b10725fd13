//! Loops compiled for the widest vectors of the processor that runs them.

use pulp::Arch;

/// Runs `kernel` with the widest vectors this processor has.
///
/// A build for baseline x86-64 knows vectors of two numbers only. What is inlined into the kernel is compiled a second
/// time for vectors of four, and this chooses when it runs. Operations are neither reordered nor fused, so that the
/// digits are the same either way. The choice costs some nanoseconds: it is for loops over samples, not for scalars.
///
/// ```
/// use fmm_model::widest;
///
/// let (mut y, x) = ([1.0; 1000], [2.0; 1000]);
/// widest(
///     #[inline(always)]
///     || y.iter_mut().zip(&x).for_each(|(y, x)| *y += 0.5 * x),
/// );
/// assert_eq!(y, [2.0; 1000]);
/// ```
#[expect(clippy::inline_always, reason = "only what is inlined is compiled for the wide vectors")]
#[inline(always)]
pub fn widest<R>(kernel: impl FnOnce() -> R) -> R {
    Arch::new().dispatch(kernel)
}
