//! Work on all threads, the end of its time, and idle memory for it.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

#[cfg(feature = "rayon")]
use rayon::prelude::*;

/// Results of `work` on each of `items`, in their order. With the feature `rayon` it goes on all threads of the current
/// pool.
pub(crate) fn on_all_threads<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Send + Sync) -> Vec<R> {
    let places: Vec<_> = items.into_iter().map(|item| Mutex::new((Some(item), None))).collect();
    for_each(places.len(), &|index| {
        let mut place = places[index].lock().unwrap_or_else(PoisonError::into_inner);
        place.1 = place.0.take().map(&work);
    });
    let result = |place: Mutex<(_, Option<R>)>| place.into_inner().unwrap_or_else(PoisonError::into_inner).1;
    places.into_iter().filter_map(result).collect()
}

/// Work on each of so many pieces, compiled once for all kinds of them.
fn for_each(count: usize, work: &(dyn Fn(usize) + Sync)) {
    #[cfg(feature = "rayon")]
    (0..count).into_par_iter().with_max_len(1).for_each(work);
    #[cfg(not(feature = "rayon"))]
    (0..count).for_each(work);
}

/// True from the `end` on.
pub(crate) fn is_past(end: Option<Instant>) -> bool {
    end.is_some_and(|end| Instant::now() >= end)
}

/// Memory of earlier work, lent to one piece of work at a time; as much as ever works at once.
#[derive(Debug)]
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

impl<T> Default for Pool<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

/// A copy of its owner has memory of its own.
impl<T> Clone for Pool<T> {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl<T: Default> Pool<T> {
    /// Works with idle memory, or new one if there is none.
    pub(crate) fn lend<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        let idle = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut memory = idle.unwrap_or_default();
        let result = work(&mut memory);
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(memory);
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn idle_memory_is_used_again_and_busy_memory_is_not() {
        let pool = Pool::<Vec<i32>>::default();
        pool.lend(|outer| {
            outer.push(1);
            pool.lend(|inner| assert!(inner.is_empty()));
        });
        let mut lengths = pool.lend(|one| pool.lend(|other| [one.len(), other.len()]));
        lengths.sort_unstable();
        assert_eq!(lengths, [0, 1]);
    }
}
