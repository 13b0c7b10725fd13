//! Simulation-based calibration of a straight line.

use fmm_fit::posterior::{Calibration, Prior, Sampler};
use fmm_fit::{Bounds, EvaluationError, FitError, Parameter, ResidualVariance};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

use crate::problems::Linear;

/// Records of a line with normal noise, which is `wrong` times that of the residuals.
fn calibration(wrong: f64) -> Result<Calibration, FitError> {
    let parameters = [Parameter::from("intercept"), Parameter::from("slope").bounded(Bounds::NOT_NEGATIVE)];
    let sampler = Sampler::default()
        .with_prior("intercept", Prior::normal(1.0, 0.5)?)
        .with_prior("slope", Prior::log_normal(0.3, 0.5)?)
        .with_variance(ResidualVariance::Unit)
        .with_chains(2)
        .with_draws(150)
        .with_warm_up(100)
        .with_check_steps(0);
    let x = [0.0, 0.5, 1.0, 1.5, 2.0, 2.5];
    Calibration::of(&sampler, &parameters, 300, |p, seed| {
        let noise = Normal::new(0.0, wrong)?.sample_iter(ChaCha8Rng::seed_from_u64(seed));
        Ok::<_, EvaluationError>(Linear {
            columns: vec![vec![5.0; x.len()], x.map(|x| 5.0 * x).to_vec()],
            data: x.iter().zip(noise).map(|(x, noise)| 5.0 * (p[0] + p[1] * x) + noise).collect(),
            parameters: parameters.to_vec(),
        })
    })
}

/// Right ranks are rejected at 0.1 % in one of 500 seeds for the two of them, and noise half as large again is found.
#[test]
fn ranks_are_uniform_if_the_noise_is_right_and_not_if_it_is_wrong() {
    let right = calibration(1.0).unwrap();
    assert!(right.failures().is_empty(), "{:?}", right.failures());
    for parameter in right.parameters() {
        assert!(right.p_value(parameter.name()).unwrap() > 1e-3, "{right}");
    }
    assert_eq!(right.histogram("slope").unwrap().iter().sum::<usize>(), 300);
    let wrong = calibration(1.5).unwrap();
    assert!(wrong.p_value("intercept").unwrap() < 1e-3, "{wrong}");
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    let refused = |sampler: Sampler, records| {
        let made = |_: &[f64], _| -> Result<Linear, EvaluationError> { Err(EvaluationError::message("never")) };
        Calibration::of(&sampler, &[Parameter::from("slope")], records, made).unwrap_err().to_string()
    };
    let known = Sampler::default().with_variance(ResidualVariance::Unit);
    assert_eq!(refused(known.clone(), 10), "at least 100 records are needed, but 10 are asked for");
    assert!(refused(Sampler::default(), 100).starts_with("noise can be simulated only if it is known"));
    assert_eq!(refused(known, 100), "slope needs a prior to be drawn from; give one with a width");
}
