//! Chapter 6: the force of the example from energy rates, clean and noisy.

use super::{assert_complete, chapter, ours};

#[test]
fn targets() {
    let chapter = chapter("chapter_6_energy");
    let figures = ["figure_13", "figure_14", "figure_15", "figure_16", "figure_17"];
    assert_complete(chapter, &["A11", "C12"], &["E14", "E17"], &figures);

    // Central differences at 1 kHz are off by (ω h)²/6 of 20 N, odd about the middle of a half swing.
    let force = |direction: &str| ours(chapter, "A11", &format!("rate difference over velocity, {direction}"));
    assert!((force("positive") - 1.75).abs() < 1e-4, "{} N", force("positive"));
    assert!((force("negative") + 1.75).abs() < 1e-4, "{} N", force("negative"));

    // 200 records of 1000 samples tell a standard deviation to well below 1 %; m σ/(√2 h) is 7.35 N, the reference 7.40
    // N.
    let raw = ours(chapter, "C12", "std of F of a sample, not smoothed, 1 mm/s");
    assert!((raw / 7.35 - 1.0).abs() < 0.02, "{raw} N");

    // Better than the unweighted weak form of the reference, 0.006 N.
    let weak = ours(chapter, "C12", "std of F, weak form, of a record, position unknown, 1 mm/s");
    assert!(weak < 0.006, "{weak} N");
}
