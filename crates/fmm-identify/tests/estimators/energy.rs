//! Chapter 6 of the thesis: energy rates and turning points, with the figures of an independent recomputation.

use fmm_friction::Coulomb;
use fmm_identify::{EnergyMethod, EnergyRates, Experiment, Preparation, half_swing_losses, half_swing_losses_of};
use fmm_model::{Damping, Oscillator};
use fmm_record::{EndRule, Quantity, Record, Smoothing};
use fmm_sim::{Engine, Exact, Sampling, Scenario};

use crate::measurement::{
    DAMPING, FRICTION, INTERVAL, MASS, RELEASE, STIFFNESS, chapter_six, close, machine, noisy, statistics, velocity,
};

const REPETITIONS: u64 = 40;

fn method(smoothing: Smoothing) -> EnergyMethod {
    EnergyMethod::new(machine(DAMPING, 0.0), RELEASE).unwrap().above(0.02).unwrap().smoothed_by(smoothing)
}

/// Rows of table 3.7: standard deviation of a sample at 0, 0.01, 0.1 and 1 mm/s (N).
const TABLE: [(Smoothing, [f64; 4]); 5] = [
    (Smoothing::None, [0.0003, 0.073, 0.745, 7.40]),
    (Smoothing::MovingAverage { span: 5, ends: EndRule::Shrinking }, [0.002, 0.021, 0.209, 2.07]),
    (Smoothing::MovingAverage { span: 15, ends: EndRule::Truncated }, [0.016, 0.017, 0.072, 0.70]),
    (Smoothing::SavitzkyGolay { span: 21, degree: 3 }, [0.0003, 0.009, 0.096, 0.95]),
    (Smoothing::SavitzkyGolay { span: 41, degree: 3 }, [0.021, 0.021, 0.041, 0.35]),
];

/// All means within 0.3 % plus what the repetitions leave, all standard deviations within 20 % of the table.
#[test]
fn scatter_of_a_sample() {
    let (motion, _) = chapter_six();
    let rates = |smoothing, noise, seed| -> EnergyRates {
        method(smoothing).rates(&velocity(noisy(motion.velocity().values(), noise, seed))).unwrap()
    };
    for (smoothing, row) in TABLE {
        for (noise, printed) in [0.0, 1e-5, 1e-4, 1e-3].into_iter().zip(row) {
            let repetitions = if noise == 0.0 { 1 } else { REPETITIONS };
            let all: Vec<EnergyRates> = (0..repetitions).map(|seed| rates(smoothing, noise, seed)).collect();
            let scatter = all.iter().map(EnergyRates::scatter).sum::<f64>() / repetitions as f64;
            close(scatter, printed, 0.2, &format!("{smoothing:?}, {noise} m/s: std (N)"));
            let mean = all.iter().map(EnergyRates::mean_friction).sum::<f64>() / repetitions as f64;
            // Record means scatter by 0.025 N at most (table 3.7), 40 of them by 0.004 N.
            close(mean, FRICTION, 5e-3, &format!("{smoothing:?}, {noise} m/s: mean (N)"));
            if noise == 1e-3 {
                // White noise dominates; the record tells its own noise to a few percent.
                close(all[0].uncertainty(), scatter, 0.1, &format!("{smoothing:?}: stated uncertainty (N)"));
            }
        }
    }
}

/// Without noise 1.7500 N to 1e-4, and the law m σ/(√2 h) of the raw difference.
#[test]
fn clean_force_and_the_law_of_its_noise() {
    let (motion, _) = chapter_six();
    let clean = method(Smoothing::None).rates(&velocity(motion.velocity().values().to_vec())).unwrap();
    assert!((clean.mean_friction() - FRICTION).abs() < 1e-4, "{} N", clean.mean_friction());
    let noisy = method(Smoothing::None).rates(&velocity(noisy(motion.velocity().values(), 1e-3, 1))).unwrap();
    close(noisy.uncertainty(), MASS * 1e-3 / (2f64.sqrt() * INTERVAL), 0.05, "m σ/(√2 h) (N)");
    // Sorted by velocity: negative friction for negative velocities, then positive.
    let points = clean.points();
    assert!(points.windows(2).all(|pair| pair[0].velocity <= pair[1].velocity));
    for point in [&points[0], &points[points.len() - 1]] {
        close(point.friction, FRICTION * point.velocity.signum(), 1e-3, "friction (N)");
        let missing = point.rate_without_contact - point.rate;
        close(missing, FRICTION * point.velocity.abs(), 1e-3, "missing power (W)");
    }
}

/// With position and acceleration of the model there is nothing to differentiate: 1.75 N to rounding.
#[test]
fn a_model_motion_has_its_friction_exactly() {
    let (motion, _) = chapter_six();
    let (x, v) = (motion.position().values(), motion.velocity().values());
    let acceleration = |(x, v): (&f64, &f64)| -(STIFFNESS * x + DAMPING * v + FRICTION * v.signum()) / MASS;
    let acceleration: Vec<f64> = x.iter().zip(v).map(acceleration).collect();
    let rates = method(Smoothing::None).rates_of_motion(&velocity(v.to_vec()), x, &acceleration).unwrap();
    assert!((rates.mean_friction() - FRICTION).abs() < 1e-12 && rates.scatter() < 1e-12, "{}", rates.scatter());
    assert!(method(Smoothing::None).rates_of_motion(&velocity(v.to_vec()), x, &acceleration[1..]).is_err());
}

/// Each half swing by the energies at its ends: 0.0005, 0.004 and 0.04 N as a mean over the half swings.
#[test]
fn friction_of_each_half_swing() {
    const REPETITIONS: u64 = 200;
    let (motion, times) = chapter_six();
    let losses = |noise: f64, seed: u64| {
        let record = velocity(noisy(motion.velocity().values(), noise, seed));
        half_swing_losses(&record, &machine(DAMPING, 0.0), RELEASE, &times).unwrap()
    };
    let clean = losses(0.0, 0);
    assert_eq!(clean.len(), 6);
    for (half_swing, turn) in clean.iter().zip([-0.01, 8.207e-3, -6.419e-3, 4.636e-3, -2.859e-3, 1.087e-3]) {
        assert!((half_swing.turns.0 - turn).abs() < 1e-6, "turning point {} m against {turn} m", half_swing.turns.0);
        // The trapezoidal rule over the kink of the velocity is off by h² F/4m at most.
        assert!((half_swing.friction.value - FRICTION).abs() < 4e-4, "{} N", half_swing.friction.value);
    }
    for (noise, printed) in [(1e-5, 0.0005), (1e-4, 0.004), (1e-3, 0.040)] {
        let all: Vec<_> = (0..REPETITIONS).map(|seed| losses(noise, seed)).collect();
        let mut deviations = 0.0;
        for j in 0..clean.len() {
            let (mean, deviation) = statistics(&all.iter().map(|losses| losses[j].friction.value).collect::<Vec<_>>());
            let stated = all.iter().map(|losses| losses[j].friction.uncertainty).sum::<f64>() / REPETITIONS as f64;
            // 200 repetitions tell a standard deviation to 5 %.
            close(deviation, stated, 0.2, &format!("half swing {j} at {noise} m/s: std (N)"));
            assert!((mean - FRICTION).abs() < 4e-4 + 0.3 * deviation, "half swing {j}: {mean} N");
            deviations += deviation / clean.len() as f64;
        }
        close(deviations, printed, 0.2, &format!("{noise} m/s: std (N)"));
    }
}

/// Nothing known of the position, and an offset: both quantities, with damping that counts.
#[test]
fn half_swings_of_a_prepared_record() {
    let machine = Oscillator::per_unit_mass(2.0).unwrap().with_damping(Damping::linear(0.05).unwrap());
    let scenario = Scenario::new(machine, Coulomb::new(0.1).unwrap(), 1.0).unwrap();
    let motion = Exact.run(&scenario.starting_at(0.02, 0.0).unwrap(), &Sampling::uniform(1e-3, 3000).unwrap()).unwrap();
    for (values, quantity, unit) in [
        (motion.velocity().values(), Quantity::Velocity, "m/s"),
        (motion.position().values(), Quantity::Displacement, "m"),
    ] {
        let values = noisy(values, 1e-6, 1).iter().map(|value| value + 0.003).collect();
        let record = Record::new(0.0, 1e-3, values, quantity, unit).unwrap();
        let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        let losses = half_swing_losses_of(&decay, &machine).unwrap();
        assert!(losses.len() >= 6, "{quantity}: {} half swings", losses.len());
        for half_swing in &losses[1..losses.len() - 1] {
            close(half_swing.friction.value, 0.1, 0.02, &format!("{quantity}: F/m (m/s²) {half_swing:?}"));
            assert!(half_swing.damped > 0.0 && half_swing.damped < half_swing.loss);
        }
    }
}
