//! Linear models with normal residuals, whose posteriors are Student's t or normal.

use fmm_fit::ResidualVariance;
use fmm_fit::posterior::{Prior, Sampler};
use fmm_model::coverage_factor;

use crate::problems::{assert_moments, fitted, line};

/// With a flat prior and Jeffreys' for σ the marginal of each coefficient is Student's t with n − p degrees of freedom
/// about the estimate with its standard uncertainty, and ν s²/σ² is χ² with ν (Gelman et al., "Bayesian Data Analysis",
/// section 14.2).
#[test]
fn a_straight_line_has_students_t() {
    let problem = line();
    let fit = fitted(&problem, &[0.0, 1.0]);
    let posterior = Sampler::default().with_draws(5000).sample(&problem, &fit).unwrap();
    assert!(posterior.warnings().is_empty(), "{posterior}");
    let freedom = fit.degrees_of_freedom() as f64;
    for estimate in fit.estimates() {
        let marginal = posterior.marginal(estimate.name()).unwrap();
        let u = estimate.standard_uncertainty().unwrap();
        assert_moments(marginal, (estimate.value(), u * (freedom / (freedom - 2.0)).sqrt()));
        let (low, high) = marginal.interval(0.9).unwrap();
        let reach = coverage_factor(0.9, freedom).unwrap() * u;
        // Standard error of a 5 % quantile: √(0.05·0.95/n)/density, the density of t(10) there being 0.0786/u.
        let error = (0.05 * 0.95 / marginal.tail_effective_size()).sqrt() / 0.0786 * u;
        for (end, expected) in [(low, estimate.value() - reach), (high, estimate.value() + reach)] {
            assert!((end - expected).abs() < 4.0 * error, "{}: {end} for {expected} ± {error}", estimate.name());
        }
    }
    let s2 = fit.residual_standard_deviation().unwrap().powi(2);
    let precision =
        posterior.noise().iter().map(|(sigma, _)| s2 / (sigma * sigma)).sum::<f64>() / posterior.len() as f64;
    // The mean of χ²/ν with its standard error √(2/(ν n)) at independent draws, of which these are nearly as good.
    let error =
        (2.0 / (freedom * posterior.marginal("residual_standard_deviation").unwrap().bulk_effective_size())).sqrt();
    assert!((precision - 1.0).abs() < 4.0 * error, "{precision} ± {error}");
}

/// Residuals of standard deviation 1 and a normal prior of the slope: the posterior is normal, its precision the sum of
/// both.
#[test]
fn a_normal_prior_adds_its_precision() {
    let problem = line();
    let fit = fitted(&problem, &[0.0, 1.0]);
    let (prior_mean, prior_u) = (1.01, 0.0008);
    let sampler = Sampler::default().with_draws(5000).with_variance(ResidualVariance::Unit);
    let prior = Prior::normal(prior_mean, prior_u).unwrap();
    let posterior = sampler.with_prior("slope", prior).sample(&problem, &fit).unwrap();
    assert!(posterior.marginal("residual_standard_deviation").is_none());
    // Of the slope alone the data say estimate and variance C₂₂; the intercept follows by its regression on the slope.
    let c = |i, j| fit.unit_covariance(i, j).unwrap();
    let precision = 1.0 / c(1, 1) + prior_u.powi(-2);
    let slope = (fit.values()[1] / c(1, 1) + prior_mean * prior_u.powi(-2)) / precision;
    let regression = c(0, 1) / c(1, 1);
    let intercept = fit.values()[0] + regression * (slope - fit.values()[1]);
    let variance = c(0, 0) - regression * c(0, 1) + regression * regression / precision;
    assert_moments(posterior.marginal("slope").unwrap(), (slope, precision.sqrt().recip()));
    assert_moments(posterior.marginal("intercept").unwrap(), (intercept, variance.sqrt()));
}

#[test]
fn a_posterior_is_that_of_its_seed() {
    let problem = line();
    let fit = fitted(&problem, &[0.0, 1.0]);
    let sampler = Sampler::default().with_draws(200).with_check_steps(100);
    let posterior = sampler.sample(&problem, &fit).unwrap();
    assert_eq!(posterior, sampler.sample(&problem, &fit).unwrap());
    assert_ne!(posterior, sampler.clone().with_seed(1).sample(&problem, &fit).unwrap());
    #[cfg(feature = "rayon")]
    assert_eq!(posterior, sampler.sample_parallel(&problem, &fit).unwrap());
}
