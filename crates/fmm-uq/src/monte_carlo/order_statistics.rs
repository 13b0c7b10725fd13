//! The smallest and largest of many values, without sorting all of them.

/// Values that are looked at to guess where a tail begins.
const PROBES: usize = 4096;

/// The `count` smallest values, ascending. `count` must not exceed their number.
pub(crate) fn smallest(values: &[f64], count: usize) -> Vec<f64> {
    let mut tail = tail(values, count, |value| value);
    tail.sort_unstable_by(f64::total_cmp);
    tail
}

/// The `count` largest values, ascending. `count` must not exceed their number.
pub(crate) fn largest(values: &[f64], count: usize) -> Vec<f64> {
    let mut tail = tail(values, count, |value| -value);
    tail.sort_unstable_by(|a, b| b.total_cmp(a));
    for value in &mut tail {
        *value = -*value;
    }
    tail
}

/// The `rank`th smallest value, counted from 1 and at most their number.
pub(crate) fn ranked(values: &[f64], rank: usize) -> f64 {
    let from_above = values.len() - rank + 1;
    if rank <= from_above {
        tail(values, rank, |value| value)[rank - 1]
    } else {
        -tail(values, from_above, |value| -value)[from_above - 1]
    }
}

/// The `count` smallest of the values under a `key`, the largest of them last and the others in no order.
fn tail(values: &[f64], count: usize, key: impl Fn(f64) -> f64) -> Vec<f64> {
    if count == 0 {
        return Vec::new();
    }
    // Room for the margin of the guess, twice over.
    let most = 2 * count + values.len() / 128;
    let mut tail = threshold(values, count, &key).map_or_else(Vec::new, |limit| below(values, limit, most, &key));
    // The guess may have been too low or too high, or there was none.
    if tail.len() < count {
        tail = values.iter().map(|&value| key(value)).collect();
    }
    tail.select_nth_unstable_by(count - 1, f64::total_cmp);
    tail.truncate(count);
    tail
}

/// The values under a `key` that do not exceed a limit; `None` if there are more than `most`.
fn below(values: &[f64], limit: f64, most: usize, key: impl Fn(f64) -> f64) -> Vec<f64> {
    let (mut found, mut count) = (vec![0.0; most + 1], 0);
    for &value in values {
        // Written always and counted if wanted: which of them are cannot be guessed, and a branch would be.
        let value = key(value);
        found[count] = value;
        count += usize::from(value <= limit);
        if count > most {
            return Vec::new();
        }
    }
    found.truncate(count);
    found
}

/// A value that very likely exceeds the `count` smallest but not many more: from every nth value, with a margin of
/// five standard deviations of their number below it.
fn threshold(values: &[f64], count: usize, key: impl Fn(f64) -> f64) -> Option<f64> {
    if values.len() < 8 * PROBES {
        return None;
    }
    let mut probes: Vec<f64> =
        values.iter().step_by(values.len() / PROBES).take(PROBES).map(|&value| key(value)).collect();
    let share = count as f64 / values.len() as f64 * PROBES as f64;
    let at = (share + 5.0 * share.sqrt() + 10.0) as usize;
    if at >= probes.len() {
        return None;
    }
    Some(*probes.select_nth_unstable_by(at, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_are_those_of_the_sorted_values() {
        // A multiplicative generator, then the same values in order, where the probes mislead.
        let mut state = 1_u64;
        let mut values: Vec<f64> = (0..50_000)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 33) as f64 - 1e9
            })
            .collect();
        for _ in 0..2 {
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            for count in [1, 17, 1250, 25_000, 49_999, 50_000] {
                assert_eq!(smallest(&values, count), sorted[..count]);
                assert_eq!(largest(&values, count), sorted[50_000 - count..]);
                assert_eq!(ranked(&values, count), sorted[count - 1]);
            }
            values = sorted;
        }
    }

    #[test]
    fn equal_values_are_no_obstacle() {
        let values = vec![1.5; 40_000];
        assert_eq!(ranked(&values, 1000), 1.5);
        assert_eq!(smallest(&values, 3), [1.5; 3]);
    }
}
