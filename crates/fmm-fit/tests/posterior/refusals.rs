//! Refusals: problems and options without a posterior.

use fmm_fit::posterior::{Prior, Sampler};
use fmm_fit::{Bounds, FitError, Parameter};

use crate::problems::{Linear, fitted, line};

fn refusal(problem: &Linear, sampler: &Sampler) -> String {
    let fit = fitted(problem, &vec![1.0; problem.parameters.len()]);
    sampler.sample(problem, &fit).unwrap_err().to_string()
}

#[test]
fn what_cannot_be_sampled_is_refused() {
    let (problem, sampler) = (line(), Sampler::default());
    let prior = Prior::normal(1.0, 0.1).unwrap();
    let by = |sampler| refusal(&problem, &sampler);
    assert_eq!(
        by(sampler.clone().with_prior("gradient", prior)),
        "there is no free parameter called gradient; those of the problem are: intercept, slope"
    );
    assert_eq!(by(sampler.clone().with_chains(1)), "at least 2 chains are needed, but 1 are asked for");
    assert_eq!(by(sampler.clone().with_draws(0)), "at least 100 draws of a chain are needed, but 0 are asked for");
    let exact = Linear { data: problem.columns[1].clone(), ..line() };
    let fit = fitted(&exact, &[0.0, 1.0]);
    assert!(matches!(sampler.sample(&exact, &fit), Err(FitError::Undetermined { .. })));
    assert!(matches!(sampler.sample(&Linear { data: vec![1.0; 3], ..line() }, &fit), Err(FitError::OtherFit { .. })));
}

/// Two columns that are one: nothing tells them apart, unless a prior knows one of them.
#[test]
fn an_open_direction_is_named_and_a_prior_closes_it() {
    let mut problem = line();
    problem.columns[0] = problem.columns[1].clone();
    let refused = refusal(&problem, &Sampler::default());
    assert!(refused.contains("intercept") && refused.contains("slope"), "{refused}");
    let fit = fitted(&problem, &[1.0, 1.0]);
    let prior = Prior::normal(0.2, 0.01).unwrap();
    let posterior = Sampler::default().with_prior("intercept", prior).sample(&problem, &fit).unwrap();
    let slope = posterior.marginal("slope").unwrap();
    assert!((slope.mean() - 0.8).abs() < 0.01 && (slope.standard_deviation() - 0.01).abs() < 0.001, "{posterior}");
}

#[test]
fn a_prior_beyond_the_bounds_is_refused() {
    let mut problem = line();
    problem.parameters[1] = Parameter::from("slope").bounded(Bounds::new(0.5, 2.0).unwrap());
    let sampler = Sampler::default().with_prior("slope", Prior::uniform(3.0, 4.0).unwrap());
    assert_eq!(refusal(&problem, &sampler), "the prior of slope has no value within its bounds, [0.5, 2]");
}
