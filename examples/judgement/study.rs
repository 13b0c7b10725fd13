//! All records of all cells, over threads.

use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use super::{Cell, Truth, Verdict, judge};

/// Result of one record.
#[derive(Debug, Clone)]
pub(crate) struct Outcome {
    /// The truth and what was said, or why nothing was said.
    pub(crate) verdict: Result<(Truth, Verdict), String>,
    /// How long it took to say (s).
    pub(crate) seconds: f64,
}

fn outcome(cell: &Cell, record: u64) -> Outcome {
    let case = match cell.case(record) {
        Ok(case) => case,
        Err(error) => return Outcome { verdict: Err(format!("no record: {error}")), seconds: 0.0 },
    };
    let begun = Instant::now();
    let verdict = judge(&case);
    let seconds = begun.elapsed().as_secs_f64();
    Outcome { verdict: verdict.map(|verdict| (case.truth, verdict)).map_err(|error| error.to_string()), seconds }
}

/// The outcomes of the records of `cells` by their numbers, cell by cell in the order of their numbers; `done` is called
/// after each.
pub(crate) fn study(
    cells: &[Cell],
    numbers: &[Range<u64>],
    threads: usize,
    done: &(dyn Fn() + Sync),
) -> Vec<Vec<Outcome>> {
    on_each_record(cells, numbers, threads, done, outcome)
}

/// Results of `work` on each record of `cells`, in the same order.
pub(crate) fn on_each_record<T: Send>(
    cells: &[Cell],
    numbers: &[Range<u64>],
    threads: usize,
    done: &(dyn Fn() + Sync),
    work: impl Fn(&Cell, u64) -> T + Sync,
) -> Vec<Vec<T>> {
    let jobs = numbers.iter().enumerate().flat_map(|(cell, records)| records.clone().map(move |record| (cell, record)));
    let jobs: Vec<(usize, u64)> = jobs.collect();
    let next = AtomicUsize::new(0);
    let finished = Mutex::new(Vec::with_capacity(jobs.len()));
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                while let Some((cell, record)) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let result = work(&cells[*cell], *record);
                    if let Ok(mut finished) = finished.lock() {
                        finished.push((*cell, *record, result));
                    }
                    done();
                }
            });
        }
    });
    let mut finished = finished.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    finished.sort_by_key(|(cell, record, _)| (*cell, *record));
    let mut results: Vec<Vec<T>> = cells.iter().map(|_| Vec::new()).collect();
    for (cell, _, result) in finished {
        results[cell].push(result);
    }
    results
}
