//! Chapter 8: receptance against impulse, odd harmonics, one coefficient from three levels.

use super::{assert_complete, chapter, ours};

#[test]
fn targets() {
    let chapter = chapter("chapter_8_impact");
    let figures: Vec<String> = (30..=42).map(|number| format!("figure_{number}")).collect();
    let figures: Vec<&str> = figures.iter().map(String::as_str).collect();
    assert_complete(chapter, &["A17", "A18", "A19", "C13", "C14", "C15"], &["E29", "E32", "E34"], &figures);

    // 9.81 m/s² and three digits of the mass.
    assert!((ours(chapter, "A17", "normal load") - 6.6708).abs() < 1e-9);

    // The shape of the pulse and the place of the lines are worth 0.6 %.
    for (level, expected) in [("450", 3.510), ("1000", 5.034), ("1450", 5.787)] {
        let peak = ours(chapter, "C13", &format!("largest receptance, {level} N"));
        assert!((peak / expected - 1.0).abs() < 0.01, "{level} N: {peak} mm/N");
    }
    assert!(ours(chapter, "C13", "receptance over impulse, R²") > 0.9999);

    // A square wave of finite length: 20 log₁₀ n to 0.1 dB at the medium level.
    for order in [3.0f64, 5.0, 7.0, 9.0] {
        let level = ours(chapter, "C14", &format!("friction force at {order} f₀ by that at f₀, 1000"));
        assert!((level + 20.0 * order.log10()).abs() < 0.2, "{order}: {level} dB");
    }

    // Noise of 0.5 mm/s leaves some 0.005 % of the coefficient, and more than that is allowed, whichever the level.
    for level in ["450", "1000", "1450"] {
        let mu = ours(chapter, "C15", &format!("μ from complex mobility, 1 Hz to 4 Hz, {level}"));
        assert!((mu / 0.113 - 1.0).abs() < 1e-3, "{level} N: {mu}");
        // The formula leaves viscous damping out, 1.3 % to 2.9 %.
        let dry = ours(chapter, "C15", &format!("μ from the peak by π J/(8 F m ω), {level}"));
        assert!((0.01..0.03).contains(&(dry / 0.113 - 1.0)), "{level} N: {dry}");
    }
}
