//! Propagation, Monte Carlo and shares of the variance: inputs and trials.

use fmm_uq::{Gum, Input, Inputs, MonteCarlo, Taylor, VarianceShare, propagate};

use crate::least::Unit::{Microsecond, Millisecond, Nanosecond};
use crate::least::{least, print_row};

fn normal(count: usize) -> Inputs {
    let input = |i: usize| Input::new(format!("X{i}"), 1.0, 0.1, "1").expect("valid");
    Inputs::new((0..count).map(input)).expect("valid")
}

/// Time (s) of `trials` of the sum of so many inputs, with mean and standard deviation.
fn sum(count: usize, trials: u64) -> f64 {
    let run = MonteCarlo::new(&normal(count), trials).expect("valid");
    least(|| run.run(|x: &[f64]| x.iter().sum::<f64>()).and_then(|sample| sample.standard_uncertainty(0)).is_ok())
}

fn squares(x: &[Taylor]) -> Taylor {
    x.iter().fold(Taylor::from(0.0), |sum, x| sum + *x * *x)
}

pub(crate) fn print_rows() {
    const TRIALS: u64 = 1_000_000;
    print_row("a trial on one thread, normal inputs", Nanosecond, &[1, 2, 4, 8, 16], |count| {
        sum(count, TRIALS) / TRIALS as f64
    });
    print_row("the same, four inputs, trials", Millisecond, &[10_000, 100_000, 1_000_000, 10_000_000], |trials| {
        sum(4, trials)
    });
    let sample = MonteCarlo::new(&normal(4), TRIALS).and_then(|run| run.run(|x: &[f64]| x.iter().sum::<f64>()));
    let sample = sample.expect("no trial fails");
    print_row("interval of 95 % of a million trials", Millisecond, &["symmetric", "shortest"], |kind| match kind {
        "symmetric" => least(|| sample.symmetric_interval(0, 0.95)),
        _ => least(|| sample.shortest_interval(0, 0.95)),
    });
    let counts = [2, 4, 8, 16, 32];
    print_row("`propagate` of a sum of squares, inputs", Microsecond, &counts, |count| {
        let inputs = normal(count);
        least(|| propagate(&inputs, squares).is_ok())
    });
    print_row("the same to first order alone", Microsecond, &counts, |count| {
        let inputs = normal(count);
        least(|| Gum::new(&inputs).first_order_only().propagate(squares).is_ok())
    });
    print_row("an evaluation of `VarianceShare`, inputs", Nanosecond, &[2, 4, 8], |count| {
        let inputs = normal(count);
        let time = least(|| VarianceShare::of_all(&inputs, 100_000, 0, 0.0, |x: &[f64]| x.iter().sum::<f64>()).is_ok());
        time / (1e5 * (count + 2) as f64)
    });
}
