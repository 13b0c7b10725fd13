//! How far out the two largest of a few normal values lie by chance.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};

/// The probability with which the two largest of `count` ≥ 4 normal values leave no more than a share `ratio` of the squares.
///
/// With φ_n for the largest of n values, sin φ_n = (x − x̄)/√(Σ (x − x̄)² (n − 1)/n), the squares without it are cos²φ_n of
/// what they were, and it is the largest if that of the others lies lower:
///
/// ```text
/// f_n(φ) ∝ cosⁿ⁻³φ F_{n−1}(φ'),   sin φ' = √(n/(n − 2)) tan φ        F_2 = 1 for φ' ≥ π/2, else 0
/// P(G ≤ g) = ∫ f_n(φ) (F_{n−1}(φ') − F_{n−1}(arccos(√g/cos φ)))/F_{n−1}(φ') dφ
/// ```
///
/// # References
/// F. E. Grubbs, Annals of Mathematical Statistics 21 (1950) 27, <https://doi.org/10.1214/aoms/1177729885>.
pub(super) fn tail(ratio: f64, count: usize) -> f64 {
    // The largest of many values lies within angles of 1/√n.
    let cells = (256.0 * (count as f64).sqrt()).ceil() as usize;
    let grid = Grid { step: FRAC_PI_2 / cells as f64, cells };
    // 1 − F_3, which is a straight line.
    let mut beyond: Vec<f64> =
        grid.angles().map(|angle| ((FRAC_PI_2 - angle) / (FRAC_PI_2 - FRAC_PI_6)).clamp(0.0, 1.0)).collect();
    for n in 4..count {
        let density: Vec<f64> =
            grid.angles().map(|angle| weight(angle, n) * (1.0 - grid.at(&beyond, limit(angle, n)))).collect();
        beyond = grid.beyond(&density);
    }
    let root = ratio.max(0.0).sqrt();
    let (mut less, mut all) = (0.0, 0.0);
    for angle in grid.angles() {
        let weight = weight(angle, count);
        let above = grid.at(&beyond, limit(angle, count));
        let least = if root < angle.cos() { grid.at(&beyond, (root / angle.cos()).acos()) } else { 1.0 };
        less += weight * (least - above).max(0.0);
        all += weight * (1.0 - above);
    }
    (less / all).min(bound(ratio, count))
}

/// The sum of the probabilities with which each two values, above the mean of the others, leave as little. More than one pair
/// may, so that it is an upper bound; the smaller the ratio, the closer.
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

/// Angles from 0 to π/2 in equal steps.
struct Grid {
    step: f64,
    cells: usize,
}

impl Grid {
    fn angles(&self) -> impl Iterator<Item = f64> {
        let step = self.step;
        (0..=self.cells).map(move |index| index as f64 * step)
    }

    /// What lies beyond each angle of this density, over all of it; by the trapezoidal rule from the far end, where it is
    /// small.
    fn beyond(&self, density: &[f64]) -> Vec<f64> {
        let mut sum = 0.0;
        let mut beyond = vec![0.0; density.len()];
        for index in (0..self.cells).rev() {
            sum += 0.5 * (density[index] + density[index + 1]);
            beyond[index] = sum;
        }
        beyond.iter().map(|part| part / sum).collect()
    }

    /// Between the angles.
    fn at(&self, values: &[f64], angle: f64) -> f64 {
        let place = (angle / self.step).clamp(0.0, self.cells as f64);
        let index = (place as usize).min(self.cells - 1);
        let part = place - index as f64;
        values[index] * (1.0 - part) + values[index + 1] * part
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
    fn all_ratios_together_are_certain() {
        for count in [4, 7, 30, 300] {
            let found = tail(1.0, count);
            assert!((found - 1.0).abs() < 1e-9, "{count} values: {found}");
            assert_eq!(tail(0.0, count), 0.0, "{count} values");
        }
    }
}
