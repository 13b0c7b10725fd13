//! Grubbs' test of two outliers: distribution of the two most distant of a few normal values.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};

/// The probability with which the two largest of `count` ≥ 4 normal values leave no more than a share `ratio` of the
/// squares.
///
/// With φ_n for the largest of n values, sin φ_n = (x − x̄)/√(Σ (x − x̄)² (n − 1)/n), the squares without it are
/// cos²φ_n of what they were, and it is the largest if that of the others lies lower:
///
/// ```text
/// f_n(φ) ∝ cosⁿ⁻³φ F_{n−1}(φ'),   sin φ' = √(n/(n − 2)) tan φ        F_2 = 1 for φ' ≥ π/2, else 0
/// P(G ≤ g) = ∫ f_n(φ) (F_{n−1}(φ') − F_{n−1}(arccos(√g/cos φ)))/F_{n−1}(φ') dφ
/// ```
///
/// # References
/// F. E. Grubbs, Annals of Mathematical Statistics 21 (1950) 27, <https://doi.org/10.1214/aoms/1177729885>.
pub(super) fn tail(ratio: f64, count: usize) -> f64 {
    // The angle of the largest of many values shrinks as 1/√n.
    with_cells(ratio, count, 2048 + (128.0 * (count as f64).sqrt()) as usize)
}

/// The same with this many steps of the angle.
fn with_cells(ratio: f64, count: usize, cells: usize) -> f64 {
    let step = FRAC_PI_2 / cells as f64;
    let angles: Vec<f64> = (0..=cells).map(|index| index as f64 * step).collect();
    let mut largest = Largest::of_three(step, &angles);
    for n in 4..count {
        largest = Largest::of(step, angles.iter().map(|angle| weight(*angle, n) * largest.below.at(limit(*angle, n))));
    }
    let root = ratio.max(0.0).sqrt();
    let (mut less, mut all) = (0.0, 0.0);
    for angle in angles {
        let (weight, limit) = (weight(angle, count), limit(angle, count));
        let least = if root < angle.cos() { largest.beyond.at((root / angle.cos()).acos()) } else { 1.0 };
        less += weight * (least - largest.beyond.at(limit)).max(0.0);
        all += weight * largest.below.at(limit);
    }
    (less / all).min(bound(ratio, count))
}

/// The sum of the probabilities with which each two values, above the mean of the others, leave as little. More than
/// one pair may, so that it is an upper bound; the smaller the ratio, the closer.
///
/// ```text
/// P ≤ n (n − 1)/2 (1/4 + arcsin(1/(n − 1))/2π) g^((n − 3)/2)
/// ```
fn bound(ratio: f64, count: usize) -> f64 {
    let n = count as f64;
    let pairs = 0.5 * n * (n - 1.0);
    // Both lie above the mean of the others, which is common to them.
    let above = 0.25 + (1.0 / (n - 1.0)).asin() / (4.0 * FRAC_PI_2);
    pairs * above * ratio.max(0.0).powf(0.5 * (n - 3.0))
}

/// cosⁿ⁻³φ.
fn weight(angle: f64, n: usize) -> f64 {
    angle.cos().max(0.0).powf((n - 3) as f64)
}

/// φ', the angle of the largest of the others above which it would be the largest of all.
fn limit(angle: f64, n: usize) -> f64 {
    let n = n as f64;
    ((n / (n - 2.0)).sqrt() * angle.tan()).clamp(0.0, 1.0).asin()
}

/// The angle of the largest of some values.
struct Largest {
    /// F, the probability of an angle below. It is summed from its small end: there 1 − (1 − F) would be rounding,
    /// which the next n multiplies by n/2.
    below: Curve,
    /// 1 − F, summed from its own small end.
    beyond: Curve,
}

impl Largest {
    /// Of three values: F is a straight line, as the density has a step.
    fn of_three(step: f64, angles: &[f64]) -> Self {
        let all = FRAC_PI_2 - FRAC_PI_6;
        let beyond = |angle: &f64| {
            let place = (FRAC_PI_2 - angle) / all;
            if place < 1.0 { (place.max(0.0), -step / all) } else { (1.0, 0.0) }
        };
        let beyond: Vec<(f64, f64)> = angles.iter().map(beyond).collect();
        let below = beyond.iter().map(|(value, slope)| (1.0 - value, -slope)).collect();
        Self { below: Curve { step, values: below }, beyond: Curve { step, values: beyond } }
    }

    /// Of the density but for a factor.
    fn of(step: f64, density: impl Iterator<Item = f64>) -> Self {
        let density: Vec<f64> = density.collect();
        let cells = density.len() - 1;
        let part = |index: usize| {
            let (here, next) = (density[index], density[index + 1]);
            // By the cubic through four angles, as errors add up over all n, and the straight line where that ends.
            let cubic = || (13.0 * (here + next) - density[index - 1] - density[index + 2]) / 24.0;
            if (1..cells - 1).contains(&index) { cubic().max(0.0) } else { 0.5 * (here + next) }
        };
        let parts: Vec<f64> = (0..cells).map(part).collect();
        let sums = |parts: &mut dyn Iterator<Item = &f64>| {
            let mut sum = 0.0;
            let rest = parts.map(|part| {
                sum += part;
                sum
            });
            std::iter::once(0.0).chain(rest).collect::<Vec<f64>>()
        };
        let (below, mut beyond) = (sums(&mut parts.iter()), sums(&mut parts.iter().rev()));
        beyond.reverse();
        let all = below[cells];
        let curve = |sums: Vec<f64>, sign: f64| {
            let values = sums.iter().zip(&density).map(|(sum, density)| (sum / all, sign * density / all)).collect();
            Curve { step, values }
        };
        Self { below: curve(below, 1.0), beyond: curve(beyond, -1.0) }
    }
}

/// A function of angles from 0 to π/2 in equal steps, which does not turn.
struct Curve {
    step: f64,
    /// With its derivative times the step.
    values: Vec<(f64, f64)>,
}

impl Curve {
    /// By the cubic of values and derivatives.
    fn at(&self, angle: f64) -> f64 {
        let cells = self.values.len() - 1;
        let place = (angle / self.step).clamp(0.0, cells as f64);
        let index = (place as usize).min(cells - 1);
        let part = place - index as f64;
        let ((here, first), (next, last)) = (self.values[index], self.values[index + 1]);
        let rest = 1.0 - part;
        let straight = here * rest + next * part;
        let rise = next - here;
        let bent = part * rest * (rest * (first - rise) - part * (last - rise));
        (straight + bent).clamp(here.min(next), here.max(next))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_ratios_approach_the_bound() {
        for count in [4, 5, 8, 20, 60] {
            // At which the bound is 1e-6.
            let ratio = (1e-6 / bound(1.0, count)).powf(2.0 / (count as f64 - 3.0));
            let found = tail(ratio, count);
            println!("{count}: {found:e}");
            assert!(found <= 1.000_001e-6 && found > 0.5e-6, "{count} values, G = {ratio}: {found}");
        }
    }

    #[test]
    fn finer_steps_change_little() {
        let change = |count: usize, probability: f64| {
            let ratio = (probability / bound(1.0, count)).powf(2.0 / (count as f64 - 3.0));
            let (found, finer) = (tail(ratio, count), with_cells(ratio, count, 1 << 15));
            println!("{count} values, G = {ratio}: {found}, finer {finer}: {:.1e}", found / finer - 1.0);
            (found / finer - 1.0).abs()
        };
        for count in [4, 5, 8, 12, 40] {
            for probability in [1e-3, 0.01, 0.05, 0.3] {
                let found = change(count, probability);
                assert!(found < 3e-4, "{count} values: {found}");
            }
        }
        let found = change(300, 1e-3);
        assert!(found < 2e-3, "300 values: {found}");
    }

    #[test]
    fn samples_of_sixty_values() {
        // How many of two million samples drawn with NumPy leave as little; each count with its standard deviation.
        for (ratio, share) in [(0.62, 0.000_277), (0.65, 0.001_017), (0.708, 0.009_780_5), (0.755, 0.049_99)] {
            let (found, drawn) = (tail(ratio, 60), (share * 2e6_f64).sqrt() / 2e6);
            println!("G = {ratio}: {found}, {share} ± {drawn}");
            assert!((found - share).abs() < 3.0 * drawn, "G = {ratio}: {found}, drawn {share} ± {drawn}");
        }
    }

    #[test]
    fn all_ratios_together_are_certain() {
        for count in [4, 7, 30, 300] {
            let found = tail(1.0, count);
            assert!((found - 1.0).abs() < 1e-9, "{count} values: {found}");
            assert_eq!(tail(0.0, count), 0.0, "{count} values");
        }
    }
}
