//! Loops compiled for the widest vectors of the processor that runs them.

use pulp::Arch;

/// Runs `kernel` with the widest vectors this processor has.
///
/// A build for baseline x86-64 knows vectors of two numbers only; the loops that write samples are compiled a second time
/// for four and eight, and this chooses. Operations are not reordered or fused, so that the digits are the same either way.
#[expect(clippy::inline_always, reason = "only what is inlined is compiled for the wide vectors")]
#[inline(always)]
pub(crate) fn widest(kernel: impl FnOnce()) {
    Arch::new().dispatch(kernel);
}
