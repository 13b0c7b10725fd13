//! Two engines with nothing in common: the thesis' Euler steps approach the exact motion in first order.

use fmm_friction::CoulombStatic;
use fmm_sim::{Engine, Exact, Sampling, Thesis};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

use crate::case::{Case, cases, exactly};

/// An underdamped machine that makes several half swings and comes to rest with a decision that steps do not turn.
fn swinging(case: Case, random: &mut ChaCha8Rng) -> Option<Case> {
    let angular = case.angular();
    let case = Case {
        damping: random.random_range(0.0..0.03) * 2.0 * (case.stiffness * case.mass).sqrt(),
        // The appendix takes a start against the positive direction for a reversal, and stops it inside the stick zone.
        velocity: case.velocity.abs(),
        interval: TAU / angular / 500.0,
        count: 6 * 500,
        ..case
    };
    let force = case.stiffness * case.amplitude() / random.random_range(8.0..16.0);
    let sliding = force / case.normal_load;
    let case = Case { sliding, breakaway: sliding * random.random_range(1.0..1.3), ..case };
    let motion = exactly(&case, &case.scenario(), &case.sampling());
    // The first step of the appendix is half a step off in phase, 1/80 at the coarsest; margins are several times that.
    let clear = motion.events().iter().skip(1).all(|event| event.margin().abs() > 0.15);
    (clear && motion.rest().is_some() && motion.half_cycles() >= 3).then_some(case)
}

#[test]
fn thesis_engine_converges_to_the_exact_motion() {
    const HALVINGS: u32 = 5;
    let mut random = ChaCha8Rng::seed_from_u64(101);
    let usable = cases(101, 1000).filter(|case| case.normal_load > 0.0 && case.amplitude() > 0.0);
    let mut checked = 0;
    for case in usable.filter_map(|case| swinging(case, &mut random)).take(12) {
        let law = || CoulombStatic::new(case.sliding, case.breakaway).unwrap();
        let exact = Exact.run(&case.with_law(law()), &case.sampling()).unwrap();
        let errors: Vec<f64> = (0..=HALVINGS)
            .map(|halving| {
                let stride = 1 << halving;
                let sampling = Sampling::uniform(case.interval / stride as f64, (case.count - 1) * stride + 1).unwrap();
                let euler = Thesis::A3.run(&case.with_law(law()), &sampling).unwrap();
                let errors = (0..case.count).map(|index| {
                    let position = euler.position().values()[index * stride] - exact.position().values()[index];
                    let velocity = euler.velocity().values()[index * stride] - exact.velocity().values()[index];
                    position.abs().max(velocity.abs() / case.angular())
                });
                errors.fold(0.0, f64::max) / case.amplitude()
            })
            .collect();
        let order = (errors[0] / errors[HALVINGS as usize]).log2() / f64::from(HALVINGS);
        // Events snap to the grid, so that single errors scatter by up to a factor of two: 2 · 1/5 in the order.
        assert!((order - 1.0).abs() < 0.4, "order {order}, errors {errors:?} of the amplitude: {case}");
        checked += 1;
    }
    assert_eq!(checked, 12, "cases");
}
