//! Least time of a call, and a row of such times.

use std::fmt::Display;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// How long one call is repeated.
const WHILE: Duration = Duration::from_millis(300);
/// Calls that are timed together are no shorter than this (s), beside which reading the clock is nothing.
const TOGETHER: f64 = 2e-5;

/// True if the bench is only tried, as `cargo test --benches` does.
pub(crate) fn is_trial() -> bool {
    !std::env::args().any(|argument| argument == "--bench")
}

/// Least time (s) of a call of `work` over many calls; of two calls in a trial.
pub(crate) fn least<T>(mut work: impl FnMut() -> T) -> f64 {
    let mut time = |calls: usize| {
        let begin = Instant::now();
        for _ in 0..calls {
            black_box(work());
        }
        begin.elapsed().as_secs_f64() / calls as f64
    };
    let first = time(1).min(time(1));
    if is_trial() {
        return first;
    }
    let calls = (TOGETHER / first).ceil().clamp(1.0, 1e4) as usize;
    let (begin, mut best, mut runs) = (Instant::now(), f64::INFINITY, 0);
    while begin.elapsed() < WHILE || runs < 5 {
        best = best.min(time(calls));
        runs += 1;
    }
    best
}

/// Prints the times (s) of `cases` in `unit`, with two significant digits; of the first case alone in a trial.
pub(crate) fn print_row<C: Copy + Display>(what: &str, unit: Unit, cases: &[C], mut time: impl FnMut(C) -> f64) {
    let cases = if is_trial() { &cases[..1] } else { cases };
    let times: Vec<String> = cases.iter().map(|&case| two_digits(time(case) / unit.seconds())).collect();
    let cases: Vec<String> = cases.iter().map(ToString::to_string).collect();
    println!("| {what}: {} | {} {} |", cases.join(", "), times.join(", "), unit.symbol());
}

/// A unit of time.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Unit {
    Nanosecond,
    Microsecond,
    Millisecond,
}

impl Unit {
    const fn seconds(self) -> f64 {
        match self {
            Self::Nanosecond => 1e-9,
            Self::Microsecond => 1e-6,
            Self::Millisecond => 1e-3,
        }
    }

    const fn symbol(self) -> &'static str {
        match self {
            Self::Nanosecond => "ns",
            Self::Microsecond => "µs",
            Self::Millisecond => "ms",
        }
    }
}

fn two_digits(value: f64) -> String {
    let place = value.abs().max(1e-12).log10().floor() - 1.0;
    if place < 0.0 {
        format!("{value:.*}", -place as usize)
    } else {
        format!("{}", (value / 10f64.powf(place)).round() * 10f64.powf(place))
    }
}
