//! The equation of motion integrated by its power series, with nothing in common with the closed form.

use crate::case::Case;

/// Terms of the series; with steps of at most half a unit the next is below 0.5²⁰/20! < 1e-24.
const TERMS: usize = 20;

/// The state (m, m/s) a time `elapsed` (s) after (`position`, `velocity`), sliding in the sense `sign`:
///
/// ```text
/// x″ = −2ζ x′ − x − s N μ/k   in the time θ = ω₀ t,   x_{n+2} = −(2ζ (n+1) x_{n+1} + x_n + s N μ/k [n = 0])/((n+1)(n+2))
/// ```
pub(crate) fn advance(case: &Case, sign: f64, (position, velocity): (f64, f64), elapsed: f64) -> (f64, f64) {
    let (angular, ratio) = (case.angular(), case.damping_ratio());
    let shift = sign * case.friction() / case.stiffness;
    let span = angular * elapsed;
    let steps = (2.0 * span * (1.0 + 2.0 * ratio)).ceil().max(1.0);
    let step = span / steps;
    let (mut x, mut v) = (position, velocity / angular);
    for _ in 0..steps as usize {
        let mut terms = [0.0; TERMS];
        (terms[0], terms[1]) = (x, v);
        for n in 0..TERMS - 2 {
            let next = (n + 1) as f64;
            let force = 2.0 * ratio * next * terms[n + 1] + terms[n] + if n == 0 { shift } else { 0.0 };
            terms[n + 2] = -force / (next * (next + 1.0));
        }
        (x, v) = (0.0, 0.0);
        for n in (0..TERMS).rev() {
            x = x * step + terms[n];
            if n > 0 {
                v = v * step + n as f64 * terms[n];
            }
        }
    }
    (x, v * angular)
}
