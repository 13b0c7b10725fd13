//! Random machines with corners and bent springs, free and forced, under all laws: every engine against a referee that
//! shares nothing with them but the formulas of law and machine, against itself at another tolerance, and against the
//! balance of energy.

mod cases;
mod draw;
mod referee;
mod trial;

use crate::draw::Draws;
use crate::trial::trial;

/// Greatest imbalance of energy, relative to the greatest energy (1).
const BALANCE: f64 = 1e-9;

/// Greatest difference of two motions, relative to the greatest position and velocity (1).
const APART: f64 = 1e-8;

fn check(seeds: std::ops::Range<u64>) {
    let mut failures = Vec::new();
    let (mut balance, mut apart) = (0.0f64, 0.0f64);
    let mut compared = 0;
    for seed in seeds.clone() {
        let outcome = trial(&mut Draws::new(seed));
        for run in &outcome.runs {
            match run {
                Ok(run) => {
                    compared += run.compared;
                    balance = balance.max(run.balance);
                    apart = apart.max(run.apart);
                    if !(run.balance <= BALANCE && run.apart <= APART) {
                        failures.push(format!(
                            "seed {seed}: {}: balance {:.1e}, apart {:.1e} at {:.4} s: {}",
                            run.engine, run.balance, run.apart, run.worst, outcome.machine
                        ));
                    }
                }
                Err((engine, error)) => failures.push(format!("seed {seed}: {engine}: {error}: {}", outcome.machine)),
            }
        }
    }
    println!(
        "{seeds:?}: {compared} comparisons, balance {balance:.1e}, apart {apart:.1e}, {} failures",
        failures.len()
    );
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn engines_agree_on_machines_with_corners() {
    check(0..150);
}

/// The figure that is published.
#[test]
#[ignore = "takes minutes"]
fn engines_agree_on_two_thousand_machines() {
    check(0..2000);
}
