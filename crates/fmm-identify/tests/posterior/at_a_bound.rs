//! The machine of the thesis with a small viscous part, which the bound at zero cuts, against quadrature.

use fmm_fit::posterior::Sampler;
use fmm_fit::{Options, Residuals, solve};
use fmm_friction::CoulombViscous;
use fmm_identify::Problem;
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, Sampling, Scenario};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

/// m (kg), k (N/m), load (N), release (m), as in the thesis; the viscous part is less than its own uncertainty.
const MACHINE: [(&str, f64); 3] = [("mass", 10.391), ("stiffness", 1982.0), ("normal_load", 7.2)];
const VISCOUS: f64 = 0.007;
/// White noise (m/s), with which μ has a standard uncertainty of 2.67e-3 without the bound; with it 1.41e-3 by
/// quadrature.
const NOISE: f64 = 2.2e-3;

fn record() -> Record {
    let machine = Oscillator::new(10.391, 1982.0).unwrap();
    let scenario = Scenario::new(machine, CoulombViscous::new(0.15, VISCOUS).unwrap(), 7.2).unwrap();
    let scenario = scenario.starting_at(0.015, 0.0).unwrap();
    let motion = Exact.run(&scenario, &Sampling::uniform(1e-3, 1501).unwrap()).unwrap();
    let noise = Normal::new(0.0, NOISE).unwrap().sample_iter(ChaCha8Rng::seed_from_u64(3));
    let values = motion.velocity().values().iter().zip(noise).map(|(v, noise)| v + noise).collect();
    Record::new(0.0, 1e-3, values, Quantity::Velocity, "m/s").unwrap()
}

/// Points of the quadrature in each direction.
const POINTS: usize = 90;

/// Moments to 1 % of those by the midpoint rule on a grid, σ integrated out as in the sampler.
#[test]
fn moments_are_those_of_quadrature() {
    let record = record();
    let law = [("coefficient", 0.15), ("viscous", VISCOUS), ("initial_position", 0.015)];
    let problem = Problem::declared::<CoulombViscous>(&record, &[MACHINE.as_slice(), &law].concat()).unwrap();
    let problem = problem.free("coefficient").unwrap().free("viscous").unwrap();
    let fit = solve(&problem, problem.values(), &Options::default()).unwrap();
    let place = |name: &str| problem.parameters().iter().position(|parameter| parameter.name() == name).unwrap();
    let (mu, viscous) = (place("coefficient"), place("viscous"));
    println!("{fit}");
    let wald = fit.relaxed_covariance(mu, mu).unwrap().sqrt();

    let posterior = Sampler::default().with_draws(8000).sample(&problem, &fit).unwrap();
    println!("{posterior}");
    assert!(posterior.warnings().is_empty(), "{posterior}");

    let (mut p, mut residuals) = (problem.values().to_vec(), vec![0.0; problem.len()]);
    let centre = posterior.marginal("coefficient").unwrap();
    let reach = 7.0 * centre.standard_deviation();
    let highest = 2.0 * posterior.marginal("viscous").unwrap().quantile(0.9999).unwrap();
    let mut sums = [0.0; 5];
    for i in 0..POINTS {
        for j in 0..POINTS {
            let share = |i: usize| (i as f64 + 0.5) / POINTS as f64;
            p[mu] = centre.mean() + reach * (2.0 * share(i) - 1.0);
            p[viscous] = highest * share(j);
            problem.evaluate(&p, &mut residuals, None).unwrap();
            let square: f64 = residuals.iter().map(|r| r * r).sum();
            let weight = (-0.5 * residuals.len() as f64 * (square / fit.sum_of_squares()).ln()).exp();
            let [x, y] = [p[mu], p[viscous]];
            for (sum, term) in sums.iter_mut().zip([1.0, x, y, x * x, y * y]) {
                *sum += weight * term;
            }
        }
    }
    for (name, first, second) in [("coefficient", sums[1], sums[3]), ("viscous", sums[2], sums[4])] {
        let mean = first / sums[0];
        let deviation = (second / sums[0] - mean * mean).sqrt();
        let marginal = posterior.marginal(name).unwrap();
        println!(
            "{name}: quadrature {mean:.6} ± {deviation:.4e}, sampler {:.6} ± {:.4e}, Wald {wald:.4e}",
            marginal.mean(),
            marginal.standard_deviation()
        );
        let off = marginal.standard_deviation() / deviation - 1.0;
        assert!(off.abs() < 0.01, "deviation of {name} off by {:.2} %", 100.0 * off);
        assert!((marginal.mean() - mean).abs() < 0.01 * deviation.max(mean.abs()), "mean of {name}: {mean}");
    }
    assert!(centre.standard_deviation() < 0.8 * wald, "the bound cuts: {} against {wald}", centre.standard_deviation());
}
