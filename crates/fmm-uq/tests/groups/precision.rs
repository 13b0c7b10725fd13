//! Repeatability and reproducibility, and the groups that stand out.

use fmm_uq::{Precision, UncertaintyError};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::{document, groups, list, near, number};

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

/// Critical values of the standard's tables: Grubbs 2.126 at 5 % for 8 groups, Cochran 0.680 at 5 % for 8 groups of
/// two.
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

/// Glucose in serum of five materials by eight laboratories, the example of ASTM E691. Of the first material the
/// laboratories differ by less than their repeatability lets expect.
#[test]
fn glucose_in_serum() {
    let document = document(include_str!("../data/precision.json"));
    for case in document["glucose"].as_array().unwrap() {
        let found = Precision::of(&groups(&case["groups"])).unwrap();
        let material = &case["material"];
        assert!(near(found.mean(), number(&case["mean"]), 1e-14), "material {material}: {}", found.mean());
        assert!(near(found.repeatability(), number(&case["s_r"]), 1e-11), "material {material}: {found:?}");
        let variance = number(&case["s_l2"]);
        // A difference of two variances keeps the digits of the larger.
        let rounding = 1e-11 * number(&case["s_R"]).powi(2);
        assert!((found.between_variance() - variance).abs() < rounding, "material {material}: {found:?}");
        assert!((found.between().powi(2) - variance.max(0.0)).abs() < rounding, "material {material}: {found:?}");
        assert!(near(found.reproducibility(), number(&case["s_R"]), 1e-11), "material {material}: {found:?}");
        for (h, expected) in found.h().into_iter().zip(list(&case["h"])) {
            assert!((h - expected).abs() < 1e-10, "material {material}: h {h}, not {expected}");
        }
        for (k, expected) in found.k().into_iter().zip(list(&case["k"])) {
            assert!((k.unwrap() - expected).abs() < 1e-10, "material {material}: k {k:?}, not {expected}");
        }
        let cochran = found.cochran().unwrap();
        assert!(near(cochran.statistic, number(&case["cochran"]), 1e-10), "material {material}: {cochran:?}");
        assert!(near(found.analysis().f(), number(&case["f"]), 1e-10), "material {material}: {found:?}");
        assert!(near(found.analysis().p_value(), number(&case["p_value"]), 1e-9), "material {material}: {found:?}");
        let grubbs = found.grubbs().unwrap();
        let largest = list(&case["h"]).into_iter().map(f64::abs).fold(0.0, f64::max);
        assert!(near(grubbs.statistic, largest, 1e-10), "material {material}: {grubbs:?}");
        println!("material {material}: {grubbs:?}, {cochran:?}");
    }
    assert!(number(&document["glucose"][0]["s_l2"]) < 0.0);
}

#[test]
fn between_groups_of_unequal_numbers() {
    let document = document(include_str!("../data/precision.json"));
    let case = &document["unbalanced"];
    let found = Precision::of(&groups(&case["groups"])).unwrap();
    let variance = number(&case["s_l2"]);
    assert!(near(found.between_variance(), variance, 1e-10), "{}, not {variance}", found.between_variance());
    // Two of the laboratories have one observation.
    assert_eq!(found.k().iter().flatten().count(), 6);
}

/// With unequal numbers, and where it is often negative, the variance between groups is right in the mean.
#[test]
fn variance_between_groups_has_no_bias() {
    const DRAWS: u32 = 20_000;
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
    let (mut sum, mut squares, mut negative) = (0.0, 0.0, 0);
    for _ in 0..DRAWS {
        let laboratories: Vec<Vec<f64>> = [1, 2, 3, 3, 8]
            .into_iter()
            .map(|count| {
                let of_group = 0.5 * draw();
                (0..count).map(|_| of_group + draw()).collect()
            })
            .collect();
        let found = Precision::of(&laboratories).unwrap();
        negative += u32::from(found.between_variance() < 0.0);
        assert_eq!(found.between(), found.between_variance().max(0.0).sqrt());
        sum += found.between_variance();
        squares += found.between_variance().powi(2);
    }
    let mean = sum / f64::from(DRAWS);
    let uncertainty = ((squares / f64::from(DRAWS) - mean * mean) / f64::from(DRAWS)).sqrt();
    println!("{mean} ± {uncertainty}, of 0.25; {negative} of {DRAWS} below 0");
    assert!((mean - 0.25).abs() < 4.0 * uncertainty, "{mean} ± {uncertainty}, of 0.25");
}

/// Limits of h and k by other distributions than those of the code.
#[test]
fn limits_of_h_and_k() {
    let document = document(include_str!("../data/precision.json"));
    for case in document["limits"].as_array().unwrap() {
        let (count, observations) = (number(&case["groups"]) as usize, number(&case["observations"]) as usize);
        let laboratories: Vec<Vec<f64>> = (0..count)
            .map(|group| (0..observations).map(|index| (group * 7 % 5) as f64 + (index % 3) as f64).collect())
            .collect();
        let (found, level) = (Precision::of(&laboratories).unwrap(), number(&case["level"]));
        let (h, k) = (found.h_limit(level).unwrap(), found.k_limit(observations, level).unwrap());
        assert!(near(h, number(&case["h"]), 1e-10) && near(k, number(&case["k"]), 1e-10), "{case}: {h}, {k}");
    }
    let two = Precision::of(&[[1.0, 2.0], [4.0, 5.0]]).unwrap();
    assert!(matches!(two.h_limit(0.95), Err(UncertaintyError::NoAnswer { .. })));
    assert!(matches!(two.k_limit(1, 0.95), Err(UncertaintyError::Invalid { .. })));
    assert!(matches!(two.k_limit(2, 1.0), Err(UncertaintyError::Invalid { .. })));
    let one_spread = Precision::of(&[vec![1.0, 2.0], vec![4.0], vec![5.0]]).unwrap();
    assert!(matches!(one_spread.k_limit(2, 0.95), Err(UncertaintyError::NoAnswer { .. })));
    assert!(one_spread.cochran().is_none());
}
