//! Section 9.2: laws with a state, clamps, and the next tests.

use super::{assert_complete, chapter, ours};

#[test]
fn targets() {
    let chapter = chapter("chapter_9_future");
    assert_complete(chapter, &["F1", "F2", "F3", "F4"], &[], &["presliding", "clamps", "next_tests"]);

    // 8/(3π) c₂; windows of five cycles bend the line by less than 1 %.
    let slope = ours(chapter, "F2", "slope of c over V, assembled, c₁ + c₂|v|, 1 times");
    assert!((slope / 0.437 - 1.0).abs() < 0.02, "{slope} N s²/m²");
    // Slip loses as much by Masing's rules: 0.4366 of the same windows without noise; and it softens by 0.109 %.
    let slope = ours(chapter, "F2", "slope of c over V, assembled, clamps slip, 1 times");
    assert!((slope / 0.4366 - 1.0).abs() < 0.03, "{slope} N s²/m²");
    let drift = ours(chapter, "F3", "change of f₀ from rest to 22 mm, clamps that slip");
    assert!((drift + 0.109).abs() < 0.02, "{drift} %");
    // More loads and larger displacements: at least the factor of √3 that tests of 22 mm under one load would give, and
    // no wonder.
    let gain = ours(chapter, "F4", "u(μ₀) of the best six tests over that of Table 5's six");
    assert!((0.02..0.58).contains(&gain), "{gain}");
}
