//! Models side by side: figures against statsmodels, and verdicts.

use fmm_fit::{
    ComparisonOptions, Contender, Criterion, Doubt, ModelTable, Polynomial, ResidualCount, Verdict, Weighting,
};

const Y: [f64; 12] = [1.1, 1.4, 2.2, 2.3, 3.1, 3.2, 4.3, 4.4, 5.5, 5.6, 6.9, 7.2];

fn polynomial(name: &str, order: usize) -> Contender {
    let x: Vec<f64> = (0..12).map(|i| 0.5 * f64::from(i)).collect();
    let fit = Polynomial::fit(&x, &Y, order, Weighting::Equal).unwrap();
    Contender::of_regression(name, fit.regression())
}

fn polynomials() -> [Contender; 4] {
    [
        polynomial("mean", 0),
        polynomial("line", 1).containing("mean"),
        polynomial("parabola", 2).containing("line").containing("mean"),
        polynomial("cubic", 3).containing("parabola"),
    ]
}

fn all() -> ComparisonOptions {
    ComparisonOptions::default().counting(ResidualCount::All)
}

/// Sums of squares and F-test of statsmodels 0.15, OLS; criteria by their formulas from these.
#[test]
fn figures_are_those_of_statsmodels() {
    let table = ModelTable::of(&polynomials(), all()).unwrap();
    let expected = [
        (46.406_666_666_666_67, 21.563_771_060_746_26, 21.200_251_026_988_926),
        (0.864_778_554_778_555_3, -22.562_261_527_796_99, -24.107_541_578_432_99),
        (0.573_016_983_016_983, -22.786_673_170_372_566, -26.561_332_285_506_282),
        (0.572_822_732_822_732_4, -16.505_027_520_648_312, -24.080_494_271_708_31),
    ];
    for (row, (sum, akaike, bayesian)) in table.rows().iter().zip(expected) {
        // The reference sums are rounded at ε times the 200 of Σ y².
        assert!((row.sum_of_squares - sum).abs() < 1e-12, "{}: S = {}", row.name, row.sum_of_squares);
        assert!((row.corrected_akaike - akaike).abs() < 1e-10, "{}: AICc = {}", row.name, row.corrected_akaike);
        assert!((row.bayesian - bayesian).abs() < 1e-10, "{}: BIC = {}", row.name, row.bayesian);
    }
    let test = table.tests().iter().find(|test| (test.restricted, test.full) == (1, 2)).unwrap();
    assert!((test.f - 4.582_506_668_526).abs() < 1e-9 && (test.p_value - 0.060_953_898_263_9).abs() < 1e-9, "{test:?}");
    assert_eq!(test.degrees_of_freedom, (1, 9.0));
    let weights: f64 = table.rows().iter().map(|row| row.weight).sum();
    assert!((weights - 1.0).abs() < 1e-15);
    let text = table.to_string();
    assert!(text.contains("parabola against its special case line: F(1, 9.0) = 4.583, p = 6.10e-2"), "{text}");
    let rows: Vec<&str> = text.lines().skip(2).take(5).collect();
    assert!(rows.iter().all(|row| row.chars().count() == rows[0].chars().count()), "not aligned:\n{text}");
    assert!(rows[1].trim_start().starts_with("parabola"), "the best is not the first:\n{text}");
}

#[test]
fn what_is_close_is_not_decided() {
    let table = ModelTable::of(&polynomials(), all()).unwrap();
    let Verdict::Undecided { preferred, doubts } = table.verdict() else { panic!("{table}") };
    assert_eq!(*preferred, 1, "the line is the simplest of the close ones: {table}");
    let rivals: Vec<usize> = doubts
        .iter()
        .filter_map(|doubt| if let Doubt::TooClose { rival, .. } = doubt { Some(*rival) } else { None })
        .collect();
    assert_eq!(rivals, [2], "{table}");
    assert!(table.to_string().contains("parabola scores better by 0.2 with more parameters"), "{table}");
    // Of mean and line alone it is clear.
    let two = [polynomial("mean", 0), polynomial("line", 1).containing("mean")];
    let table = ModelTable::of(&two, all()).unwrap();
    let Verdict::Decided { winner: 1, lead: Some(lead) } = table.verdict() else { panic!("{table}") };
    assert!((lead - 44.126_032_588_543_25).abs() < 1e-9, "lead {lead}");
    assert!(table.to_string().contains("the data decide for line by 44.1"), "{table}");
    let bayesian = ModelTable::of(&polynomials(), all().by(Criterion::Bayesian)).unwrap();
    assert_eq!(bayesian.verdict().preferred(), 1, "{bayesian}");
}

/// Residuals that come forty at a time tell a fortieth of what they seem to.
#[test]
fn correlated_residuals_count_once() {
    let slow = |i: usize| (((i / 40) * 7919 + 13) % 101) as f64 / 101.0 - 0.5;
    let small: Vec<f64> = (0..2000).map(slow).collect();
    let large: Vec<f64> = small.iter().map(|r| 1.03 * r).collect();
    let contenders = || [Contender::new("simple", &large, 2), Contender::new("rich", &small, 3)];
    let naive = ModelTable::of(&contenders(), all()).unwrap();
    // n ln 1.03² − 2 = 116 in favour, were they independent.
    assert!(naive.rows()[0].difference > 110.0 && naive.verdict().is_decided(), "{naive}");
    let honest = ModelTable::of(&contenders(), ComparisonOptions::default()).unwrap();
    assert!(honest.counted() < 100.0, "{}", honest.counted());
    assert_eq!(honest.verdict().preferred(), 0, "{honest}");
    assert!(!honest.verdict().is_decided(), "{honest}");
    let given =
        ModelTable::of(&contenders(), ComparisonOptions::default().counting(ResidualCount::Given(50.0))).unwrap();
    assert_eq!(given.counted(), 50.0);
}

#[test]
fn a_parameter_without_effect_is_no_rival_and_a_missed_minimum_is_seen() {
    let small: Vec<f64> = (0..50).map(|i| f64::from((i * 37) % 50) / 50.0 - 0.49).collect();
    let large: Vec<f64> = small.iter().map(|r| 1.5 * r).collect();
    let same = [Contender::new("plain", &small, 2), Contender::new("at bound", &small, 2).containing("plain")];
    let table = ModelTable::of(&same, all()).unwrap();
    assert_eq!(*table.verdict(), Verdict::Decided { winner: 0, lead: None }, "{table}");
    assert!(table.to_string().contains("plain has no rival"));
    let missed = [Contender::new("plain", &small, 2), Contender::new("general", &large, 3).containing("plain")];
    let table = ModelTable::of(&missed, all()).unwrap();
    let Verdict::Undecided { preferred: 0, doubts } = table.verdict() else { panic!("{table}") };
    assert_eq!(doubts.as_slice(), [Doubt::MissedMinimum { contender: 1, special: 0 }]);
    assert!(table.tests().is_empty());
}

#[test]
fn exact_data_are_ranked_first() {
    let exact = [Contender::new("exact", &[0.0; 20], 2), Contender::new("other", &[0.1; 20], 2)];
    let table = ModelTable::of(&exact, all()).unwrap();
    assert_eq!(table.verdict().preferred(), 0);
    assert!(table.rows().iter().all(|row| row.corrected_akaike.is_finite()), "{table}");
}

#[test]
fn what_cannot_be_compared_is_named() {
    let contender = |name: &str, count: usize| Contender::new(name, &vec![1.0; count], 2);
    let error = |contenders: &[Contender]| ModelTable::of(contenders, all()).unwrap_err();
    assert_eq!(error(&[]).to_string(), "there is no model to compare");
    assert!(error(&[contender("a", 9), contender("a", 9)]).to_string().contains("two models are called a"));
    assert!(error(&[contender("a", 9), contender("b", 8)]).to_string().contains("b has 8 residuals instead of 9"));
    assert!(error(&[contender("a", 9).containing("c")]).to_string().contains("contain c"));
    assert!(error(&[contender("a", 4)]).to_string().contains("2 parameters for 4 residuals"));
    assert!(error(&[Contender::new("a", &[f64::NAN; 9], 1)]).to_string().contains("not finite"));
    let bad = ComparisonOptions::default().counting(ResidualCount::Given(f64::NAN));
    let bad = ModelTable::of(&[contender("a", 9)], bad).unwrap_err();
    assert!(bad.to_string().contains("the number of residuals that count must be"), "{bad}");
}
