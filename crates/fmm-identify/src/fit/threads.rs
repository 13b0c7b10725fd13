//! Work on all threads.

#[cfg(feature = "rayon")]
use rayon::prelude::*;

/// What `work` makes of each of `items`, in their order. With the feature `rayon` it goes on all threads of the current
/// pool.
pub(crate) fn on_all_threads<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Send + Sync) -> Vec<R> {
    #[cfg(feature = "rayon")]
    return items.into_par_iter().with_max_len(1).map(work).collect();
    #[cfg(not(feature = "rayon"))]
    items.into_iter().map(work).collect()
}
