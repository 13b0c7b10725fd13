//! Memory that is used again.

use std::sync::{Mutex, PoisonError};

/// Memory of earlier work, lent to one piece of work at a time; as much as ever works at once.
#[derive(Debug)]
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

impl<T> Default for Pool<T> {
    fn default() -> Self {
        Self(Mutex::default())
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
