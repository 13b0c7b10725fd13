//! Chapter 5: modal parameters, and what a coefficient of friction inherits from them.

use fmm_thesis::Chapter;

use super::{assert_complete, chapter, ours};

fn modal() -> &'static Chapter {
    chapter("chapter_5_modal")
}

fn monte_carlo() -> &'static Chapter {
    chapter("chapter_5_monte_carlo")
}

fn near(chapter: &Chapter, id: &str, quantity: &str, reference: f64, tolerance: f64) {
    let value = ours(chapter, id, quantity);
    assert!((value - reference).abs() <= tolerance, "{id}, {quantity}: {value} instead of {reference} ± {tolerance}");
}

fn at_most(chapter: &Chapter, id: &str, quantity: &str, limit: f64) {
    let value = ours(chapter, id, quantity);
    assert!(value <= limit, "{id}, {quantity}: {value} above {limit}");
}

#[test]
fn modal_parameters_are_complete() {
    let ids = ["A8", "A10", "B1", "B2", "B3", "B5", "C1", "C2", "C3", "C4", "C5", "C16"];
    let errata = ["E5", "E6", "E7", "E8", "E9", "E23", "E24", "E30"];
    assert_complete(modal(), &ids, &errata, &["figure_10", "figure_8", "figure_9", "figure_12"]);
}

#[test]
fn printed_numbers_of_the_machine() {
    // √(k/m)/2π of the printed k and m to eleven digits.
    near(modal(), "A8", "natural frequency", 2.198_078_935_2, 1e-9);
    // Half of the printed digit.
    near(modal(), "A10", "s(c) of mean c", 12.4, 0.05);
    // Half a percent: nine rows that are rounded to 0.001 N s/m.
    near(modal(), "B1", "slope of c over V", 0.437, 0.005 * 0.437);
    near(modal(), "B1", "intercept of c over V", 0.2005, 0.005 * 0.2005);
    // The digits of the reference.
    near(modal(), "B1", "R² of c over V", 0.9972, 5e-5);
    near(modal(), "B2", "s(m)", 0.004_87, 5e-6);
    near(modal(), "B2", "s(k)", 1.33, 5e-3);
    // Not those of Table 2, by −0.5 % and +6.5 %.
    near(modal(), "B3", "mean c", 0.2737, 5e-5);
    near(modal(), "B3", "s(c)", 0.0363, 5e-5);
    // The scatter of the product itself.
    near(modal(), "B5", "mean of m k over Table 1", 20_599.0, 8.0);
}

#[test]
fn mass_stiffness_and_damping_are_not_separable() {
    // Whole numbers, and zeros to the rounding of 5000 residuals.
    near(modal(), "C5", "rank of the Jacobian in m, k, c, x₀", 3.0, 0.0);
    at_most(modal(), "C5", "smallest over largest singular value", 1e-7);
    at_most(modal(), "C5", "change of the residuals if m, k, c are halved or doubled", 0.0);
    // With one of them known the others come back: to the tolerance of the search, and to the steps of the Euler
    // motion.
    at_most(modal(), "C4", "error of m with k held, exact motion", 1e-6);
    at_most(modal(), "C4", "error of c with k held, exact motion", 1e-6);
    at_most(modal(), "C4", "error of m with k held, thesis' Euler motion", 3e-5);
    at_most(modal(), "C4", "error of c with k held, thesis' Euler motion", 2e-5);
}

#[test]
fn damping_grows_with_velocity() {
    // 0.1 %: records without noise, fitted without error of the motion; four digits of the reference.
    near(modal(), "C1", "slope of five-cycle fits, c₂ = 0.5148", 0.4372, 0.001 * 0.4372);
    near(modal(), "C2", "slope of five-cycle fits, c₂ = 0.437 as in A5", 0.3711, 0.001 * 0.3711);
    // The scatter of Table 1 about its own line is 0.0018 N s/m.
    at_most(modal(), "C3", "rms of Table 1's c from five-cycle fits", 2.5e-3);
    // 1 %: other seeds of 0.01 mm/s of noise move the slope by up to 0.4 %.
    near(modal(), "C16", "slope of A2's logarithmic decrement", 0.437, 0.01 * 0.437);
}

#[test]
fn monte_carlo_is_complete() {
    assert_complete(monte_carlo(), &["A9", "A10", "A15", "A16", "C6"], &["E10", "E11", "E12", "E26"], &["figure_11"]);
}

#[test]
fn table_3() {
    // Half of the last printed digit.
    near(monte_carlo(), "A9", "u_c from column 3", 2.454, 5e-4);
    near(monte_carlo(), "A10", "column 5, c over k", 3.442, 5e-4);
    // 1 %: what the printed digits and the scatter of 100 000 trials leave.
    near(monte_carlo(), "A15", "u(μ) by damping, exact derivatives", 236.0, 2.36);
    near(monte_carlo(), "A15", "u(μ) by all, exact derivatives", 248.0, 2.48);
    // The four digits of 256-bit derivatives.
    near(monte_carlo(), "A15", "u(μ) by stiffness, golden", 5.732, 1e-3);
    // Derivatives through the stop hold eight digits.
    near(monte_carlo(), "A16", "m ∂μ/∂m + k ∂μ/∂k + c ∂μ/∂c", 0.15, 1e-8);
    // 5000 fits scatter by 1 %; four times that.
    near(monte_carlo(), "C6", "u(μ) by stiffness, refits of the exact motion", 5.732, 0.04 * 5.732);
    near(monte_carlo(), "C6", "u(μ) by all, refits of the exact motion", 247.1, 0.04 * 247.1);
    // A few hundred fits scatter by 4 %; that the grid triples the effect of k shows all the same.
    let euler = ours(monte_carlo(), "C6", "u(μ) by stiffness, refits of the thesis' motion");
    assert!(euler > 10.0, "{euler}");
}
