//! Optimal designs whose places and shares are known in closed form.
//!
//! Sources: A. C. Atkinson, A. N. Donev, R. D. Tobias, "Optimum Experimental Designs, with SAS", Oxford University
//! Press 2007, sections 6.5, 9.4, 10 and 11.3 (polynomials: D-optimal places are the ends and the zeros of the
//! derivative of a Legendre polynomial, with equal shares); P. G. Hoel, A. Levine, Ann. Math. Stat. 35 (1964) 1553,
//! <https://doi.org/10.1214/aoms/1177700379> (extrapolation); G. E. P. Box, H. L. Lucas, Biometrika 46 (1959) 77,
//! <https://doi.org/10.1093/biomet/46.1-2.77> (exponential decay).

use fmm_fit::design::{DesignCase, DesignCriterion, DesignSearch, Information};

/// A polynomial of this degree at each of the places.
fn polynomial(degree: i32, places: &[f64]) -> Vec<Information> {
    let row = |x: &f64| (0..=degree).map(|power| x.powi(power)).collect::<Vec<f64>>();
    places.iter().map(|x| Information::of_rows(degree as usize + 1, &row(x)).unwrap()).collect()
}

/// Places of the chosen candidates with how many measurements each gets.
fn chosen(search: &DesignSearch, places: &[f64], measurements: usize) -> Vec<(f64, usize)> {
    let best = search.best(measurements).unwrap();
    best.counts().iter().map(|(place, count)| (places[*place], *count)).collect()
}

fn grid(first: i32, last: i32, parts: f64) -> Vec<f64> {
    (first..=last).map(|i| f64::from(i) / parts).collect()
}

#[test]
fn d_optimal_polynomials() {
    let fifth = 0.2f64.sqrt();
    for (degree, measurements, expected) in [
        (1, 6, vec![(-1.0, 3), (1.0, 3)]),
        (2, 9, vec![(-1.0, 3), (0.0, 3), (1.0, 3)]),
        (3, 8, vec![(-1.0, 2), (-fifth, 2), (fifth, 2), (1.0, 2)]),
        (4, 5, vec![(-1.0, 1), (-(3.0f64 / 7.0).sqrt(), 1), (0.0, 1), ((3.0f64 / 7.0).sqrt(), 1), (1.0, 1)]),
    ] {
        let mut places = grid(-20, 20, 20.0);
        places.extend([-fifth, fifth, -(3.0f64 / 7.0).sqrt(), (3.0f64 / 7.0).sqrt()]);
        places.sort_by(f64::total_cmp);
        let case = DesignCase::of_all(Information::none(degree as usize + 1), polynomial(degree, &places)).unwrap();
        let search = DesignSearch::new(vec![case], DesignCriterion::Determinant).unwrap();
        assert_eq!(chosen(&search, &places, measurements), expected, "degree {degree}");
    }
}

/// ln u by D of the straight line with n/2 measurements at either end: det V = n⁻².
#[test]
fn the_score_is_the_uncertainty() {
    let case = |combinations| DesignCase::new(Information::none(2), polynomial(1, &[-1.0, 1.0]), combinations).unwrap();
    let unit = || vec![vec![1.0, 0.0], vec![0.0, 1.0]];
    let search = |combinations, criterion| DesignSearch::new(vec![case(combinations)], criterion).unwrap();
    // The ridge is a share of 1e-10 of a candidate.
    for criterion in [DesignCriterion::Determinant, DesignCriterion::MeanVariance] {
        let score = search(unit(), criterion).score(&[0, 0, 0, 1, 1, 1]).unwrap();
        assert!((score + 0.5 * 6f64.ln()).abs() < 1e-9, "{score}");
    }
    // At one end alone only the sum is determined.
    assert!(search(unit(), DesignCriterion::MeanVariance).score(&[1, 1]).unwrap() > 10.0);
    let sum = search(vec![vec![1.0, 1.0]], DesignCriterion::MeanVariance).score(&[1, 1]).unwrap();
    assert!((sum + 0.5 * 2f64.ln()).abs() < 1e-9, "{sum}");
}

/// A parabola by A: a quarter at either end and half in the middle.
#[test]
fn a_optimal_parabola() {
    let places = grid(-10, 10, 10.0);
    let case = DesignCase::of_all(Information::none(3), polynomial(2, &places)).unwrap();
    let search = DesignSearch::new(vec![case], DesignCriterion::MeanVariance).unwrap();
    assert_eq!(chosen(&search, &places, 8), [(-1.0, 2), (0.0, 4), (1.0, 2)]);
}

/// A straight line carried on to x₀ outside [−1, 1]: shares (x₀ ∓ 1)/2x₀ at −1 and 1, and u² = x₀²/n.
#[test]
fn c_optimal_extrapolation() {
    let places = grid(-10, 10, 10.0);
    let at_two = vec![vec![1.0, 2.0]];
    let case = DesignCase::new(Information::none(2), polynomial(1, &places), at_two).unwrap();
    let search = DesignSearch::new(vec![case], DesignCriterion::MeanVariance).unwrap();
    assert_eq!(chosen(&search, &places, 8), [(-1.0, 2), (1.0, 6)]);
    assert!((search.best(8).unwrap().score() - 0.5 * (4.0f64 / 8.0).ln()).abs() < 1e-9);
}

/// a exp(−b t) from t = 0 on: half at 0, half at 1/b; of b alone with a known, all at 1/b.
#[test]
fn locally_optimal_exponential_decay() {
    let (a, b) = (2.0, 0.5);
    let times = grid(0, 80, 10.0);
    let row = |t: &f64| [(-b * t).exp(), -a * t * (-b * t).exp()];
    let candidates: Vec<Information> = times.iter().map(|t| Information::of_rows(2, &row(t)).unwrap()).collect();
    let case = DesignCase::of_all(Information::none(2), candidates.clone()).unwrap();
    let search = DesignSearch::new(vec![case], DesignCriterion::Determinant).unwrap();
    assert_eq!(chosen(&search, &times, 6), [(0.0, 3), (2.0, 3)]);
    let known = Information::none(2).with_known(0, 1e-6).unwrap();
    let case = DesignCase::new(known, candidates, vec![vec![0.0, 1.0]]).unwrap();
    let search = DesignSearch::new(vec![case], DesignCriterion::MeanVariance).unwrap();
    assert_eq!(chosen(&search, &times, 3), [(2.0, 3)]);
}

/// exp(−b t), where b may be 1 or 3. After one measurement ln u(b) = −ln t + b t: the mean over both is least at 1/2,
/// and the larger, which is that of 3, at 1/3.
#[test]
fn robust_designs_of_an_exponential_decay() {
    let times = grid(1, 200, 100.0);
    let case = |b: f64| {
        let candidates = times.iter().map(|t| Information::of_rows(1, &[t * (-b * t).exp()]).unwrap()).collect();
        DesignCase::of_all(Information::none(1), candidates).unwrap()
    };
    let cases = || vec![case(1.0), case(3.0)];
    let mean = DesignSearch::new(cases(), DesignCriterion::Determinant).unwrap();
    assert_eq!(chosen(&mean, &times, 1), [(0.5, 1)]);
    let worst = DesignSearch::new(cases(), DesignCriterion::Determinant).unwrap().for_worst_case();
    assert_eq!(chosen(&worst, &times, 1), [(0.33, 1)]);
}

/// A long and dear measurement is worth its cost where one is better than several cheap ones.
#[test]
fn a_budget_is_spent_where_it_tells_most() {
    // u² = 1 at a cost of 1, and 1/5 at a cost of 3.
    let candidates = vec![Information::of_rows(1, &[1.0]).unwrap(), Information::of_rows(1, &[5f64.sqrt()]).unwrap()];
    let case = DesignCase::of_all(Information::none(1), candidates).unwrap();
    let search = DesignSearch::new(vec![case], DesignCriterion::MeanVariance).unwrap();
    assert_eq!(search.best_within(&[1.0, 3.0], 7.0).unwrap().counts(), [(0, 1), (1, 2)]);
    assert_eq!(search.best_within(&[1.0, 6.0], 7.0).unwrap().counts(), [(0, 7)]);
}

/// The best of many sets is found from any seed.
#[test]
fn the_seed_does_not_matter() {
    let places = grid(-50, 50, 50.0);
    let case = DesignCase::of_all(Information::none(4), polynomial(3, &places)).unwrap();
    let search = DesignSearch::new(vec![case], DesignCriterion::Determinant).unwrap();
    let scores: Vec<f64> = (1..4).map(|seed| search.clone().with_seed(seed).best(7).unwrap().score()).collect();
    assert!(scores.iter().all(|score| (score - scores[0]).abs() < 1e-9), "{scores:?}");
}
