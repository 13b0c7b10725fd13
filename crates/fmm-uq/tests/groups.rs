//! Groups against certified values, other programs, and simulated laboratories.

use fmm_model::Estimated;
use fmm_uq::{AnalysisOfVariance, Consensus, Precision, RandomEffects, UncertaintyError};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn list(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

fn near(found: f64, expected: f64, relative: f64) -> bool {
    (found - expected).abs() <= relative * expected.abs()
}

/// Digits that agree, 15 at most.
fn digits(found: f64, expected: f64) -> f64 {
    if found == expected { 15.0 } else { (-((found / expected - 1.0).abs()).log10()).min(15.0) }
}

/// All eleven sets of NIST. A constant of 10⁶ or 10¹² takes the digits that f64 cannot hold beside it: of 10¹² + 0.4 four remain.
#[test]
fn certified_analyses_of_variance() {
    let document: Value = serde_json::from_str(include_str!("data/nist_strd_anova.json")).unwrap();
    let sets = document["sets"].as_array().unwrap();
    assert_eq!(sets.len(), 11);
    for set in sets {
        let groups: Vec<Vec<f64>> = match set["groups"].as_array() {
            Some(groups) => groups.iter().map(list).collect(),
            None => {
                let (constant, replicates) = (number(&set["constant"]), number(&set["replicates"]) as i32);
                let observation = |first: f64, j: i32| {
                    let tenths = first
                        + if j == 0 {
                            0.0
                        } else if j % 2 == 1 {
                            -1.0
                        } else {
                            1.0
                        };
                    // As reading the printed number rounds it.
                    format!("{constant}.{tenths}").parse::<f64>().unwrap()
                };
                let group = |first: &f64| (0..replicates).map(|j| observation(*first, j)).collect();
                list(&set["first_tenths"]).iter().map(group).collect()
            }
        };
        let found = AnalysisOfVariance::of(&groups).unwrap();
        let certified = &set["certified"];
        let (between, within) = found.mean_squares();
        let pairs = [
            (found.between(), "between_sum"),
            (found.within(), "within_sum"),
            (between, "between_mean"),
            (within, "within_mean"),
            (found.f(), "f"),
            (found.r_squared(), "r_squared"),
            (found.residual_standard_deviation(), "residual_sd"),
        ];
        let least = pairs.map(|(found, name)| digits(found, number(&certified[name]))).into_iter().fold(15.0, f64::min);
        let name = set["name"].as_str().unwrap();
        println!("{name}: {least:.1} digits");
        let needed = match name {
            "AtmWtAg" => 9.0,
            "SmLs04" | "SmLs05" | "SmLs06" => 9.5,
            "SmLs07" | "SmLs08" | "SmLs09" => 3.0,
            _ => 12.5,
        };
        assert!(least >= needed, "{name}: {least} digits");
        assert_eq!(found.degrees_of_freedom(), (number(&certified["df"][0]), number(&certified["df"][1])));
    }
}

#[test]
fn consensus_of_other_programs() {
    let document: Value = serde_json::from_str(include_str!("data/consensus.json")).unwrap();
    for case in document["cases"].as_array().unwrap() {
        let (values, variances) = (list(&case["values"]), list(&case["variances"]));
        let results: Vec<Estimated> =
            values.iter().zip(&variances).map(|(value, variance)| Estimated::new(*value, variance.sqrt())).collect();
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
            let weights: f64 = results.iter().map(|result| result.uncertainty.powi(-2)).sum();
            let mean = results.iter().map(|result| result.value * result.uncertainty.powi(-2)).sum::<f64>() / weights;
            naive += u32::from((mean - 10.0).abs() < 1.96 / weights.sqrt());
        }
        let [held, naive] = [held, naive].map(|count| f64::from(count) / f64::from(DRAWS));
        println!("{groups} groups, {between}: {held} of the intervals hold, {naive} of the weighted mean's");
        assert!((0.92..0.98).contains(&held) && naive < 0.8, "{groups} groups, {between}: {held}, {naive}");
    }
}

/// A simulated method: the deviations that were put in come out, and a group that is far off or scatters more is named.
#[test]
fn precision_of_a_simulated_method() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
    let mut groups: Vec<Vec<f64>> = (0..400)
        .map(|_| {
            let of_group = 2.0 * draw();
            (0..3).map(|_| 100.0 + of_group + 0.5 * draw()).collect()
        })
        .collect();
    let found = Precision::of(&groups).unwrap();
    assert!(near(found.repeatability(), 0.5, 0.06) && near(found.between(), 2.0, 0.1), "{found:?}");
    assert!(near(found.reproducibility(), found.repeatability().hypot(found.between()), 1e-12));
    let (h, k) = (found.h(), found.k());
    let squares: f64 = h.iter().map(|h| h * h).sum();
    assert!(near(squares, 399.0, 1e-9) && k.iter().flatten().all(|k| *k >= 0.0));
    groups.truncate(8);
    let plain = Precision::of(&groups).unwrap();
    assert!(plain.grubbs().unwrap().p_value > 0.01 && plain.cochran().unwrap().p_value > 0.01, "{plain:?}");
    groups[3].iter_mut().for_each(|value| *value += 40.0);
    groups[5][1] += 20.0;
    let found = Precision::of(&groups).unwrap();
    let (grubbs, cochran) = (found.grubbs().unwrap(), found.cochran().unwrap());
    assert!(grubbs.group == 3 && grubbs.p_value < 0.01, "{grubbs:?}");
    assert!(cochran.group == 5 && cochran.p_value < 0.01, "{cochran:?}");
}

/// Critical values of the standard's tables: Grubbs 2.126 at 5 % for 8 groups, Cochran 0.680 at 5 % for 8 groups of two.
#[test]
fn critical_values_of_the_tables() {
    // Seven means at ±1 and one at the critical distance: G = x √(…) is solved for by hand of the statistic alone.
    let at = |distance: f64| {
        let means = [-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, 0.0, distance];
        Precision::of(&means.map(|mean| vec![mean, mean + 1e-9])).unwrap().grubbs().unwrap()
    };
    let critical = (0..4000).map(|i| at(1.0 + f64::from(i) * 1e-3)).find(|found| found.p_value < 0.05).unwrap();
    assert!((critical.statistic - 2.126).abs() < 2e-3, "{critical:?}");
    let at = |spread: f64| {
        let groups: Vec<Vec<f64>> = (0..8).map(|i| vec![0.0, if i == 0 { spread } else { 1.0 }]).collect();
        Precision::of(&groups).unwrap().cochran().unwrap()
    };
    let critical = (0..8000).map(|i| at(1.0 + f64::from(i) * 1e-3)).find(|found| found.p_value < 0.05).unwrap();
    assert!((critical.statistic - 0.680).abs() < 1e-3, "{critical:?}");
}

#[test]
fn what_makes_no_groups_is_refused() {
    let refused = |groups: &[Vec<f64>]| AnalysisOfVariance::of(groups).unwrap_err();
    assert!(matches!(refused(&[vec![1.0, 2.0]]), UncertaintyError::Inputs { .. }));
    assert!(matches!(refused(&[vec![1.0], vec![]]), UncertaintyError::Inputs { .. }));
    assert!(matches!(refused(&[vec![1.0], vec![2.0]]), UncertaintyError::TooFewObservations { .. }));
    assert!(matches!(refused(&[vec![1.0, f64::NAN], vec![2.0]]), UncertaintyError::OutOfRange { .. }));
    assert!(matches!(refused(&[vec![1e300, -1e300], vec![2.0]]), UncertaintyError::OutOfRange { .. }));
    for wrong in [Estimated::new(f64::NAN, 1.0), Estimated::new(1.0, 0.0), Estimated::new(1.0, f64::INFINITY)] {
        let found = Consensus::of(&[Estimated::new(1.0, 1.0), wrong], RandomEffects::default());
        assert!(matches!(found, Err(UncertaintyError::OutOfRange { .. })), "{found:?}");
    }
    let alike = Precision::of(&[[1.0, 1.0], [1.0, 1.0], [1.0, 1.0]]).unwrap();
    assert_eq!((alike.repeatability(), alike.between(), alike.analysis().f()), (0.0, 0.0, 0.0));
    assert!(alike.cochran().is_none() && alike.grubbs().is_none());
}
