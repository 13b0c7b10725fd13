//! Energy: what the motion has lost is what friction and damping have taken.

use crate::case::{Case, cases, energy, slid};

/// Energy of every sample plus the work of friction up to it, relative to the energy at the start.
fn balance(case: &Case) -> Vec<f64> {
    let (motion, sampling) = (case.run(), case.sampling());
    let start = case.energy();
    let samples = motion.position().values().iter().zip(motion.velocity().values()).enumerate();
    samples
        .map(|(index, (&x, &v))| {
            let work = case.friction() * slid(&motion, sampling.time(index), x);
            (energy(case, x, v) + work) / start
        })
        .collect()
}

/// An ulp of the position costs two of the energy, and up to 60 half swings add theirs, with centres at up to
/// 3 amplitudes: 60 · 2 · (1 + 3)² ulp = 4e-13.
const TOLERANCE: f64 = 1e-12;

/// Without damping, friction force times path is all that is lost.
#[test]
fn friction_takes_what_is_lost() {
    let moving = cases(1, 1600).map(|case| Case { damping: 0.0, ..case }).filter(|case| case.energy() > 0.0);
    let mut checked = 0;
    for case in moving {
        for (index, balance) in balance(&case).into_iter().enumerate() {
            let error = balance - 1.0;
            assert!(error.abs() < TOLERANCE, "sample {index}: energy and work are {error:e} of E₀ off: {case}");
        }
        checked += 1;
    }
    assert!(checked >= 1000, "{checked} cases");
}

/// With damping, energy and friction work together never grow, from any sample to the next.
#[test]
fn damping_only_takes() {
    let damped = cases(2, 2000).filter(|case| case.damping > 0.0 && case.energy() > 0.0);
    let mut checked = 0;
    for case in damped {
        // Rounding of the positions, which near critical damping is that of the large parts of which they consist.
        let slack = TOLERANCE * case.conditioning();
        let balance = balance(&case);
        assert!((balance[0] - 1.0).abs() < slack, "{} of E₀ at the start: {case}", balance[0]);
        for (index, pair) in balance.windows(2).enumerate() {
            let gain = pair[1] - pair[0];
            assert!(gain < slack, "{gain:e} of E₀ gained after sample {index}: {case}");
        }
        checked += 1;
    }
    assert!(checked >= 1000, "{checked} cases");
}
