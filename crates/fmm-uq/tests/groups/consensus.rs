//! Consensus against published results and other programs, and how often its interval holds.

use fmm_model::Estimated;
use fmm_uq::{Consensus, RandomEffects};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;

use crate::{document, list, near, number};

fn results(case: &Value) -> Vec<Estimated> {
    let (values, variances) = (list(&case["values"]), list(&case["variances"]));
    values.iter().zip(&variances).map(|(value, variance)| Estimated::new(*value, variance.sqrt())).collect()
}

/// Four digits after the point, as printed.
const PRINTED: f64 = 0.000_05 * 1.000_001;

fn printed(found: f64, expected: &Value, what: &str) {
    assert!((found - number(expected)).abs() <= PRINTED, "{what}: {found}, printed {expected}");
}

#[test]
fn consensus_of_other_programs() {
    let document = document(include_str!("../data/consensus.json"));
    for case in document["cases"].as_array().unwrap() {
        let results = results(case);
        for (effects, name) in
            [(RandomEffects::MandelPaule, "mandel_paule"), (RandomEffects::DerSimonianLaird, "der_simonian_laird")]
        {
            let (found, expected) = (Consensus::of(&results, effects).unwrap(), &case[name]);
            let variance = found.between().powi(2);
            assert!((variance - number(&expected["tau2"])).abs() < 1e-9 * (1.0 + variance), "{case}: {found:?}");
            assert!(near(found.mean().value, number(&expected["mean"]), 1e-10), "{case}: {found:?}");
            let wider = number(&expected["se"]).max(number(&expected["hksj_se"]));
            assert!(near(found.mean().uncertainty, wider, 1e-9), "{case}: {found:?}");
            assert!(near(found.q(), number(&expected["q"]), 1e-10), "{case}: {found:?}");
            assert!((found.i_squared() - number(&expected["i2"]).max(0.0)).abs() < 1e-10, "{case}: {found:?}");
        }
    }
}

/// Few groups with an effect of their own: the interval holds, that of the weighted mean without the effects does not.
#[test]
fn intervals_of_few_groups_hold() {
    const DRAWS: u32 = 2000;
    for (groups, between) in [(3, 1.0), (4, 2.0), (6, 1.0), (6, 0.5)] {
        let mut random = ChaCha8Rng::seed_from_u64(groups);
        let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
        let (mut held, mut naive) = (0, 0);
        for _ in 0..DRAWS {
            let result = |index: u64| {
                let u = 0.3 + 0.1 * index as f64;
                Estimated::new(10.0 + between * draw() + u * draw(), u)
            };
            let results: Vec<Estimated> = (0..groups).map(result).collect();
            let consensus = Consensus::of(&results, RandomEffects::default()).unwrap();
            let interval = consensus.interval(0.95).unwrap();
            held += u32::from((interval.low..interval.high).contains(&10.0));
            // The usual interval with these effects, which is never the wider.
            let all: f64 =
                results.iter().map(|result| (result.uncertainty.powi(2) + consensus.between().powi(2)).recip()).sum();
            assert!(interval.width() > 2.0 * 1.96 / all.sqrt(), "{consensus:?}");
            let plain = consensus.without_effects();
            naive += u32::from((plain.value - 10.0).abs() < 1.96 * plain.uncertainty);
        }
        let [held, naive] = [held, naive].map(|count| f64::from(count) / f64::from(DRAWS));
        println!("{groups} groups, {between}: {held} of the intervals hold, {naive} of the weighted mean's");
        assert!((0.92..0.98).contains(&held) && naive < 0.8, "{groups} groups, {between}: {held}, {naive}");
    }
}

#[test]
fn published_results() {
    let document = document(include_str!("../data/consensus_published.json"));
    let [bcg, clasp, raudenbush] = [0, 1, 2].map(|index| &document["cases"][index]);

    let found = Consensus::of(&results(bcg), RandomEffects::DerSimonianLaird).unwrap();
    let expected = &bcg["der_simonian_laird"];
    printed(found.between().powi(2), &expected["tau2"], "bcg, τ²");
    printed(found.mean().value, &expected["mean"], "bcg, mean");
    printed(found.q(), &bcg["q"], "bcg, Q");
    printed(found.i_squared(), &bcg["i2"], "bcg, I²");
    // Never narrower than the usual interval.
    let interval = found.interval(0.95).unwrap();
    assert!(interval.low < number(&expected["low_normal"]) && interval.high > number(&expected["high_normal"]));

    for (effects, name) in
        [(RandomEffects::DerSimonianLaird, "der_simonian_laird"), (RandomEffects::MandelPaule, "mandel_paule")]
    {
        let (found, expected) = (Consensus::of(&results(clasp), effects).unwrap(), &clasp[name]);
        printed(found.between(), &expected["tau"], "clasp, τ");
        printed(found.mean().value, &expected["mean"], "clasp, mean");
        assert!(found.mean().uncertainty >= number(&expected["se"]) - PRINTED, "clasp: {found:?}");
    }
    // By Mandel and Paule q is 1, and nothing widens.
    let found = Consensus::of(&results(clasp), RandomEffects::MandelPaule).unwrap();
    printed(found.mean().uncertainty, &clasp["mandel_paule"]["se"], "clasp, uncertainty");

    let found = Consensus::of(&results(raudenbush), RandomEffects::DerSimonianLaird).unwrap();
    let (expected, interval) = (&raudenbush["der_simonian_laird"], found.interval(0.95).unwrap());
    printed(found.between().powi(2), &expected["tau2"], "raudenbush, τ²");
    printed(found.mean().value, &expected["mean"], "raudenbush, mean");
    printed(found.mean().uncertainty, &expected["hartung_knapp_se"], "raudenbush, uncertainty");
    printed(interval.low, &expected["low"], "raudenbush, low end");
    printed(interval.high, &expected["high"], "raudenbush, high end");
}

/// Results that do not differ beyond their uncertainties: the interval holds, and more often than it says.
#[test]
fn intervals_of_groups_that_are_alike_hold() {
    const DRAWS: u32 = 2000;
    for groups in [3, 4, 6] {
        let mut random = ChaCha8Rng::seed_from_u64(100 + groups);
        let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
        let mut held = 0;
        for _ in 0..DRAWS {
            let results: Vec<Estimated> = (0..groups)
                .map(|index| 0.3 + 0.1 * index as f64)
                .map(|u| Estimated::new(10.0 + u * draw(), u))
                .collect();
            let interval = Consensus::of(&results, RandomEffects::default()).unwrap().interval(0.95).unwrap();
            held += u32::from((interval.low..interval.high).contains(&10.0));
        }
        println!("{groups} groups that are alike: {held} of {DRAWS} intervals hold");
        assert!(held >= DRAWS * 95 / 100, "{groups} groups: {held} of {DRAWS}");
    }
}

/// The effect of each group adds up, and the one that is far off is the one without which the rest agree.
#[test]
fn influences_of_the_groups() {
    let document = document(include_str!("../data/consensus.json"));
    let results = results(&document["cases"][0]);
    let found = Consensus::of(&results, RandomEffects::MandelPaule).unwrap();
    let all: f64 = found.weights().iter().sum();
    assert!(near(all, 1.0, 1e-14), "weights add up to {all}");
    for index in 0..results.len() {
        let without = found.without(index).unwrap();
        let others: Vec<Estimated> =
            results.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, result)| *result).collect();
        assert_eq!(without, Consensus::of(&others, RandomEffects::MandelPaule).unwrap());
    }
}

/// n results alike with a shared contribution c: u² = u_own²/n + c²; an input of one result in n adds (c/n)².
#[test]
fn what_is_shared_does_not_average_out() {
    for count in [2_u32, 6, 1000] {
        let n = f64::from(count);
        let results = vec![Estimated::new(10.0, 0.3); count as usize];
        let plain = Consensus::of(&results, RandomEffects::default()).unwrap();
        let mut of_one = vec![0.0; count as usize];
        of_one[1] = 0.2;
        let found = plain.clone().with_shared(&[vec![0.5; count as usize], of_one]).unwrap();
        let square = 0.09 / n + 0.25 + 0.04 / (n * n);
        assert!(near(found.mean().uncertainty, square.sqrt(), 1e-13), "{found:?}");
        assert!(near(found.degrees_of_freedom(), (n - 1.0) * (square * n / 0.09).powi(2), 1e-12), "{found:?}");
        assert!(near(found.shared_uncertainty(), (0.25 + 0.04 / (n * n)).sqrt(), 1e-13), "{found:?}");
        assert!(near(found.shared()[0], 0.5, 1e-13) && near(found.shared()[1], 0.2 / n, 1e-13), "{found:?}");
        assert_eq!((found.mean().value, found.between()), (plain.mean().value, plain.between()));
        assert_eq!((found.q(), found.p_value(), found.i_squared()), (plain.q(), plain.p_value(), plain.i_squared()));
    }
    // Contributions of one input to two results of equal weight with opposite signs cancel, those of two inputs do not.
    let pair = Consensus::of(&[Estimated::new(1.0, 0.1); 2], RandomEffects::default()).unwrap();
    assert_eq!(pair.clone().with_shared(&[vec![0.5, -0.5]]).unwrap().shared_uncertainty(), 0.0);
    let apart = pair.with_shared(&[vec![0.5, 0.0], vec![0.0, -0.5]]).unwrap();
    assert!(near(apart.shared_uncertainty(), 0.5_f64.sqrt() / 2.0, 1e-14), "{apart:?}");
    // Results that differ: τ² of Mandel and Paule is s² − u² where all u are alike, so that u² = s²/n + c².
    let differ = [1.0, 2.0, 6.0].map(|value| Estimated::new(value, 0.1));
    let found = Consensus::of(&differ, RandomEffects::MandelPaule).unwrap().with_shared(&[vec![2.0; 3]]).unwrap();
    assert!(near(found.mean().uncertainty, (7.0_f64 / 3.0 + 4.0).sqrt(), 1e-12), "{found:?}");
    // Each is missing once, and what it shared goes with it.
    let without = found.without(2).unwrap();
    assert!(near(without.shared_uncertainty(), 2.0, 1e-14), "{without:?}");
}

/// One error in all results of a campaign, drawn anew for each: the interval holds, that of results taken for
/// independent does not.
#[test]
fn intervals_of_results_that_share_an_error_hold() {
    const CAMPAIGNS: u32 = 2000;
    for (count, between, shared) in [(3, 0.5, 0.5), (6, 0.5, 0.25), (6, 0.5, 1.0), (6, 0.3, 0.5), (20, 0.2, 0.5)] {
        let mut random = ChaCha8Rng::seed_from_u64(200 + count);
        let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
        let (mut held, mut independent) = (0, 0);
        for _ in 0..CAMPAIGNS {
            let error = shared * draw();
            let owns = (0..count).map(|index| 0.2 + 0.2 * index as f64 / count as f64);
            let results: Vec<Estimated> =
                owns.map(|u| Estimated::new(10.0 + error + between * draw() + u * draw(), u)).collect();
            let holds = |consensus: Consensus| {
                let interval = consensus.interval(0.95).unwrap();
                u32::from((interval.low..interval.high).contains(&10.0))
            };
            let contributions = vec![shared; results.len()];
            let consensus = Consensus::of(&results, RandomEffects::default()).unwrap();
            held += holds(consensus.with_shared(&[contributions]).unwrap());
            let whole: Vec<Estimated> =
                results.iter().map(|own| Estimated::new(own.value, own.uncertainty.hypot(shared))).collect();
            independent += holds(Consensus::of(&whole, RandomEffects::default()).unwrap());
        }
        let [held, independent] = [held, independent].map(|count| f64::from(count) / f64::from(CAMPAIGNS));
        println!(
            "{count} results, {between} between, {shared} shared: {held} of the intervals hold, {independent} if taken for independent"
        );
        // Student's t of three results hides it.
        assert!((0.92..0.98).contains(&held) && (count < 6 || independent < 0.9), "{count}: {held}, {independent}");
    }
}

/// Large constants, uncertainties of very different sizes, and units that are far from 1.
#[test]
fn extreme_results() {
    let runs = [(0.25, 0.125), (0.5, 0.125), (1.0, 0.25), (-0.25, 0.5)];
    let consensus = |shift: f64, scale: f64, effects| {
        Consensus::of(&runs.map(|(value, u)| Estimated::new(shift + scale * value, scale * u)), effects).unwrap()
    };
    for effects in [RandomEffects::MandelPaule, RandomEffects::DerSimonianLaird] {
        let plain = consensus(0.0, 1.0, effects);
        let shifted = consensus(2_f64.powi(40), 1.0, effects);
        assert!(near(shifted.q(), plain.q(), 1e-12) && near(shifted.between(), plain.between(), 1e-12), "{shifted:?}");
        // Squares of the weights are beyond f64 here.
        for scale in [1e-140, 1e140] {
            let scaled = consensus(0.0, scale, effects);
            assert!(near(scaled.q(), plain.q(), 1e-12), "{scaled:?}");
            assert!(near(scaled.between(), scale * plain.between(), 1e-12), "{scaled:?} and {plain:?}");
            assert!(near(scaled.mean().uncertainty, scale * plain.mean().uncertainty, 1e-12), "{scaled:?}");
        }
        // Uncertainties that are nothing beside the differences: the mean of the values and its standard deviation.
        let found = Consensus::of(&[1.0, 2.0, 6.0].map(|value| Estimated::new(value, 1e-150)), effects).unwrap();
        assert!(near(found.mean().value, 3.0, 1e-14) && near(found.between(), 7_f64.sqrt(), 1e-12), "{found:?}");
        assert!(near(found.mean().uncertainty, (7.0_f64 / 3.0).sqrt(), 1e-12), "{found:?}");
        assert_eq!((found.p_value(), found.i_squared()), (0.0, 1.0));
        // One that is known far better than two others, all of one value.
        let found = Consensus::of(&[1e-9, 1.0, 1.0].map(|u| Estimated::new(5.0, u)), effects).unwrap();
        assert!(found.between() == 0.0 && found.q() == 0.0 && near(found.mean().uncertainty, 1e-9, 1e-12), "{found:?}");
    }
    // One that is known far better: Q = 2·3², and DerSimonian and Laird's denominator is 2 to all digits.
    let far = [(0.0, 1e-9), (3.0, 1.0), (-3.0, 1.0)].map(|(value, u)| Estimated::new(value, u));
    let found = Consensus::of(&far, RandomEffects::DerSimonianLaird).unwrap();
    assert!(near(found.between().powi(2), (18.0 - 2.0) / 4.0, 1e-12), "{found:?}");
}
