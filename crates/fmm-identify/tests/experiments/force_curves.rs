//! Force along a motion without a law: friction over the speed, loops, onsets of sliding.

use fmm_identify::ForceRecord;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Friction over the speed without a law: passes at five speeds to and fro, with noise that remembers half of itself.
#[test]
fn friction_over_speed_holds_what_it_states() {
    let (speeds, pass) = ([0.01, 0.02, 0.04, 0.08, 0.16], 120);
    let truth = |speed: f64| 3.0 + 2.0 * (-speed / 0.02f64).exp() + 5.0 * speed;
    let (mut inside, mut all) = (0, 0);
    for seed in 0..60 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (mut velocities, mut forces, mut noise) = (vec![], vec![], 0.0);
        for at in 0..40 * pass {
            let round = at / pass;
            let speed = speeds[round / 2 % speeds.len()];
            let sign = if round % 2 == 0 { 1.0 } else { -1.0 };
            let draw: f64 = StandardNormal.sample(&mut random);
            noise = 0.5 * noise + 0.1 * draw;
            velocities.push(sign * speed);
            forces.push(sign * truth(speed) + 0.7 + noise);
        }
        let times: Vec<f64> = (0..velocities.len()).map(|i| 1e-3 * i as f64).collect();
        let record = ForceRecord::of_velocities(&times, &velocities, &forces).unwrap();
        let bins = record.friction_over_speed(5);
        assert_eq!(bins.len(), 5);
        for (bin, speed) in bins.iter().zip(speeds) {
            assert_eq!((bin.speed, bin.samples), (speed, 8 * pass));
            for (found, truth) in [(bin.friction, truth(speed)), (bin.offset.unwrap(), 0.7)] {
                all += 1;
                inside += u32::from((found.value - truth).abs() < 1.96 * found.uncertainty);
            }
        }
    }
    let share = f64::from(inside) / f64::from(all);
    assert!((0.92..0.98).contains(&share), "{inside} of {all}");
}

/// Cycles and onsets of Dahl's friction along a slow motion beside a spring, against what the law says of them, and how
/// often their uncertainty holds it.
#[test]
fn loops_and_onsets_hold_what_the_law_says() {
    let (level, stiffness, spring, zero, noise) = (5.0, 2e4, 100.0, 0.4, 0.02);
    // A triangle of 2 mm at 1 mm/s: presliding of 0.25 mm.
    let times: Vec<f64> = (0..20_000).map(|i| 1e-3 * f64::from(i)).collect();
    let triangle = |time: f64| {
        let phase = (0.25 * time).rem_euclid(1.0);
        if phase < 0.5 { (2e-3 * (2.0 * phase), 1e-3) } else { (2e-3 * (2.0 - 2.0 * phase), -1e-3) }
    };
    let (positions, velocities): (Vec<f64>, Vec<f64>) = times.iter().map(|t| triangle(*t)).unzip();
    let mut deflection: f64 = 0.0;
    let mut friction = vec![0.0];
    for pair in positions.windows(2) {
        let (way, towards) = ((pair[1] - pair[0]).abs(), level * (pair[1] - pair[0]).signum());
        deflection = towards - (towards - deflection) * (-stiffness * way / level).exp();
        friction.push(deflection);
    }
    // z' = σ v (1 − z sgn v/F): from ∓F tanh(σ s/2F), where each way ends, z comes near ±F as e^(−σ s/F).
    let reach = 2e-3;
    let (rate, turned) = (stiffness * reach / level, level * f64::tanh(0.5 * stiffness * reach / level));
    let loss = 2.0 * (level * reach - (level + turned) * level / stiffness * (1.0 - f64::exp(-rate)));
    let (mut inside, mut all) = (0, 0);
    for seed in 0..40 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut force = |(x, friction): (&f64, &f64)| {
            let draw: f64 = StandardNormal.sample(&mut random);
            friction + spring * x + zero + noise * draw
        };
        let forces: Vec<f64> = positions.iter().zip(&friction).map(&mut force).collect();
        let record = ForceRecord::of_positions(&times, &positions, &forces).unwrap();
        let record = record.with_velocities(&velocities).unwrap();
        let loops = record.loops();
        assert_eq!(loops.len(), 7);
        for cycle in &loops[1..] {
            assert!((cycle.energy.value / loss - 1.0).abs() < 2e-3, "{} J for {loss} J", cycle.energy.value);
            assert!((cycle.friction.value * 2.0 * reach / loss - 1.0).abs() < 3e-3);
            all += 1;
            inside += u32::from((cycle.energy.value - loss).abs() < 2.0 * cycle.energy.uncertainty);
        }
        let onsets = record.onsets();
        assert!(onsets.len() >= 9, "{onsets:?}");
        assert!((onsets[0].stiffness.value / (stiffness + spring) - 1.0).abs() < 0.1, "{:?}", onsets[0]);
        for onset in &onsets[1..] {
            assert!((onset.stiffness.value / (2.0 * stiffness) - 1.0).abs() < 0.15, "{onset:?}");
            let slid = zero * onset.direction + spring * if onset.direction > 0.0 { 1.5e-3 } else { -0.5e-3 };
            assert!((onset.sliding.value - level - slid).abs() < 0.1, "{onset:?}");
            assert!((onset.displacement / (level / stiffness) - 1.0).abs() < 0.2, "{onset:?}");
        }
    }
    let share = f64::from(inside) / f64::from(all);
    assert!(share > 0.9, "{inside} of {all} energies within two uncertainties");
}

/// The breakaway of a pull after a rest, and that a rest alone is none.
#[test]
fn a_pull_breaks_away_once() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let times: Vec<f64> = (0..3000).map(|i| 1e-3 * f64::from(i)).collect();
    let position = |t: f64| if t < 1.0 { 0.0 } else { 2e-5 * (t - 1.0) };
    let force = |x: f64| if x < 6e-6 { 1.5e6 * x } else { 6.0 + 3.0 * (-(x - 6e-6) / 2e-6).exp() };
    let positions: Vec<f64> = times.iter().map(|t| position(*t)).collect();
    let mut noisy = |x: &f64| {
        let draw: f64 = StandardNormal.sample(&mut random);
        force(*x) + 0.02 * draw
    };
    let forces: Vec<f64> = positions.iter().map(&mut noisy).collect();
    let onsets = ForceRecord::of_positions(&times, &positions, &forces).unwrap().onsets();
    assert_eq!(onsets.len(), 1, "{onsets:?}");
    let onset = onsets[0];
    assert!((onset.stiffness.value / 1.5e6 - 1.0).abs() < 5.0 * onset.stiffness.uncertainty / 1.5e6, "{onset:?}");
    assert!((onset.breakaway.value - 9.0).abs() < 0.1 && (onset.sliding.value - 6.0).abs() < 0.05, "{onset:?}");
}
