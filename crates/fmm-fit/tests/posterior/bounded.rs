//! Posteriors that bounds cut, against quadrature in two dimensions.

use fmm_fit::posterior::{Prior, Sampler};
use fmm_fit::{Bounds, Parameter};

use crate::problems::{Linear, assert_moments, fitted, moments_by_quadrature};

/// Two damping-like columns, strongly correlated, of which the second would be negative without its bound.
fn problem() -> Linear {
    let t: Vec<f64> = (0..40).map(|i| 0.05 * f64::from(i)).collect();
    let columns = vec![t.iter().map(|t| 1.0 - 0.3 * t).collect(), t.iter().map(|t| (-t).exp()).collect::<Vec<f64>>()];
    // Fixed noise of about 0.1 from an irrational rotation.
    let noise = |i: usize| 0.35 * ((i as f64 * 0.618_033_988_75).fract() - 0.5);
    let data = (0..40).map(|i| 0.5 * columns[0][i] - 0.02 * columns[1][i] + noise(i)).collect();
    let parameters = ["friction", "damping"];
    Linear {
        columns,
        data,
        parameters: parameters.map(|name| Parameter::from(name).bounded(Bounds::NOT_NEGATIVE)).to_vec(),
    }
}

fn square(problem: &Linear, p: [f64; 2]) -> f64 {
    let residual = |i: usize| p[0] * problem.columns[0][i] + p[1] * problem.columns[1][i] - problem.data[i];
    (0..problem.data.len()).map(|i| residual(i).powi(2)).sum()
}

/// The moments to 1 %, and within the Monte Carlo error; Wald's uncertainty without the bound is far off.
#[test]
fn moments_at_a_bound_are_those_of_quadrature() {
    let problem = problem();
    let fit = fitted(&problem, &[0.4, 0.1]);
    assert!(fit.estimates()[1].status().is_at_bound(), "{fit}");
    let log_density = |p| -20.0 * square(&problem, p).ln();
    let exact = moments_by_quadrature([(0.0, 0.8), (0.0, 0.8)], log_density);
    let posterior = Sampler::default().with_draws(10_000).sample(&problem, &fit).unwrap();
    println!("{posterior}\n{exact:?}");
    assert!(posterior.warnings().is_empty(), "{posterior}");
    for (name, (mean, deviation)) in ["friction", "damping"].into_iter().zip(exact) {
        let marginal = posterior.marginal(name).unwrap();
        assert_moments(marginal, (mean, deviation));
        let share = marginal.standard_deviation() / deviation - 1.0;
        assert!(share.abs() < 0.01 && (marginal.mean() - mean).abs() < 0.01 * deviation.max(mean), "{name}: {share}");
    }
    let relaxed = fit.relaxed_covariance(0, 0).unwrap().sqrt();
    assert!(exact[0].1 < 0.8 * relaxed, "cut {} against {relaxed} without the bound", exact[0].1);
}

#[test]
fn priors_that_end_cut_like_bounds() {
    let problem = problem();
    let fit = fitted(&problem, &[0.4, 0.1]);
    let (friction, damping) = (Prior::log_normal(0.4, 0.1).unwrap(), Prior::uniform(0.05, 0.2).unwrap());
    let log_density =
        |p: [f64; 2]| -20.0 * square(&problem, p).ln() + friction.log_density(p[0]) + damping.log_density(p[1]);
    let exact = moments_by_quadrature([(0.2, 0.8), (0.05, 0.2)], log_density);
    let sampler = Sampler::default().with_prior("friction", friction).with_prior("damping", damping);
    let posterior = sampler.with_draws(3000).sample(&problem, &fit).unwrap();
    assert!(posterior.warnings().is_empty(), "{posterior}");
    for (marginal, exact) in posterior.marginals().iter().zip(exact) {
        assert_moments(marginal, exact);
    }
    let draws = posterior.marginal("damping").unwrap().draws();
    assert!(draws.iter().all(|draw| (0.05..=0.2).contains(draw)));
}
