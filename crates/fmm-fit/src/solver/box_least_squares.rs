//! Linear least squares in a box.

use crate::algebra::triangle::Triangle;

/// Place of a component of a step in its interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Inside,
    Lower,
    Upper,
}

/// The minimiser of `‖R p + q‖` subject to `lower ≤ p ≤ upper`, by active sets; `0` must be feasible.
///
/// From the best point of one face the method goes towards the best point of the next and holds what it meets.
/// At the best point of a face it releases the fixed component with the steepest descent into the box. A face is
/// left only for a strictly smaller norm, hence no face is visited twice and the method ends.
///
/// # References
/// P. B. Stark, R. L. Parker, "Bounded-variable least-squares: an algorithm and applications", Comput. Stat. 10
/// (1995) 129.
#[derive(Debug, Clone, Default)]
pub(crate) struct BoxLeastSquares {
    /// The minimiser.
    pub(crate) step: Vec<f64>,
    /// Place of each of its components. A component on a bound is there exactly.
    pub(crate) sides: Vec<Side>,
    /// The components that are inside, ascending.
    pub(crate) inside: Vec<usize>,
    /// The factor of the columns of these components.
    pub(crate) face: Triangle,
    candidate: Vec<f64>,
    block: Vec<f64>,
    best: (Vec<f64>, Vec<Side>),
}

impl BoxLeastSquares {
    pub(crate) fn solve(&mut self, triangle: &Triangle, lower: &[f64], upper: &[f64]) {
        let order = triangle.order();
        self.step.clear();
        self.step.resize(order, 0.0);
        self.sides.clear();
        self.sides.resize(order, Side::Inside);
        self.descend(triangle, lower, upper);
        let mut norm = f64::INFINITY;
        while let Some(release) = self.steepest_fixed(triangle, lower, upper) {
            let next = misfit(triangle, &self.step);
            if next >= norm {
                self.step.copy_from_slice(&self.best.0);
                self.sides.copy_from_slice(&self.best.1);
                self.minimise_on_face(triangle);
                break;
            }
            norm = next;
            self.best.0.clone_from(&self.step);
            self.best.1.clone_from(&self.sides);
            self.sides[release] = Side::Inside;
            self.descend(triangle, lower, upper);
        }
    }

    /// Goes to the minimiser of the present face or of one that bounds it.
    fn descend(&mut self, triangle: &Triangle, lower: &[f64], upper: &[f64]) {
        loop {
            self.minimise_on_face(triangle);
            let mut fraction = 1.0;
            let mut blocked = None;
            for (&j, &target) in self.inside.iter().zip(&self.candidate) {
                let (limit, side) = if target < lower[j] {
                    (lower[j], Side::Lower)
                } else if target > upper[j] {
                    (upper[j], Side::Upper)
                } else {
                    continue;
                };
                let reach = (limit - self.step[j]) / (target - self.step[j]);
                if reach < fraction || blocked.is_none() {
                    fraction = reach;
                    blocked = Some((j, limit, side));
                }
            }
            for (&j, &target) in self.inside.iter().zip(&self.candidate) {
                let goal = if blocked.is_none() { target } else { self.step[j] + fraction * (target - self.step[j]) };
                self.step[j] = goal.max(lower[j]).min(upper[j]);
            }
            match blocked {
                None => return,
                Some((j, limit, side)) => {
                    self.step[j] = limit;
                    self.sides[j] = side;
                }
            }
        }
    }

    /// The minimiser over the components inside, the others fixed where they are.
    fn minimise_on_face(&mut self, triangle: &Triangle) {
        let order = triangle.order();
        self.inside.clear();
        self.inside.extend((0..order).filter(|&j| self.sides[j] == Side::Inside));
        if self.inside.len() == order {
            self.face.copy_from(triangle);
        } else {
            let fixed = |row: usize| -> f64 {
                (row..order)
                    .filter(|&column| self.sides[column] != Side::Inside)
                    .map(|column| triangle.r(row, column) * self.step[column])
                    .sum()
            };
            self.face.select(triangle, &self.inside, |row| triangle.q(row) + fixed(row), &mut self.block);
        }
        self.candidate.clear();
        self.candidate.resize(self.inside.len(), 0.0);
        self.face.solve(&mut self.candidate);
        if self.candidate.iter().any(|value| !value.is_finite()) {
            // A singular face has no unique minimiser; staying is feasible and never worse.
            self.candidate.clear();
            self.candidate.extend(self.inside.iter().map(|&j| self.step[j]));
        }
    }

    /// The fixed component whose release lowers the norm fastest, if any does by more than rounding.
    fn steepest_fixed(&self, triangle: &Triangle, lower: &[f64], upper: &[f64]) -> Option<usize> {
        if self.inside.len() == self.step.len() {
            return None;
        }
        let order = triangle.order();
        let rest: Vec<f64> = (0..order).map(|row| triangle.row_times(row, &self.step) + triangle.q(row)).collect();
        let norm = rest.iter().map(|value| value * value).sum::<f64>().sqrt();
        let mut steepest = (0.0, None);
        for j in (0..order).filter(|&j| self.sides[j] != Side::Inside && lower[j] < upper[j]) {
            let gradient: f64 = (0..=j).map(|row| triangle.r(row, j) * rest[row]).sum();
            let inward = if self.sides[j] == Side::Lower { -gradient } else { gradient };
            let cosine = inward / (triangle.column_norm(j) * norm);
            if cosine > 1e-14 && cosine > steepest.0 {
                steepest = (cosine, Some(j));
            }
        }
        steepest.1
    }
}

/// `‖R p + q‖²`.
fn misfit(triangle: &Triangle, p: &[f64]) -> f64 {
    (0..triangle.order()).map(|row| (triangle.row_times(row, p) + triangle.q(row)).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The best of all faces: each component free, at its lower or at its upper bound.
    fn enumerate(triangle: &Triangle, lower: &[f64], upper: &[f64]) -> f64 {
        let order = triangle.order();
        let mut best = f64::INFINITY;
        for code in 0..3usize.pow(order as u32) {
            let place = |j: usize| code / 3usize.pow(j as u32) % 3;
            let bound = |j: usize| [0.0, lower[j], upper[j]][place(j)];
            let free: Vec<usize> = (0..order).filter(|&j| place(j) == 0).collect();
            let mut step: Vec<f64> = (0..order).map(bound).collect();
            let mut face = Triangle::default();
            face.select(triangle, &free, |row| triangle.q(row) + triangle.row_times(row, &step), &mut Vec::new());
            let mut inside = vec![0.0; free.len()];
            face.solve(&mut inside);
            for (&j, value) in free.iter().zip(inside) {
                step[j] = value;
            }
            let is_feasible = (0..order).all(|j| step[j] >= lower[j] && step[j] <= upper[j]);
            if is_feasible {
                best = best.min(misfit(triangle, &step));
            }
        }
        best
    }

    #[test]
    fn minimiser_is_the_best_of_all_faces() {
        // Multiples of an irrational number make well spread, reproducible entries.
        let mut seed = 0.0f64;
        let mut next = || {
            seed += 0.618_033_988_749_895;
            2.0 * seed.fract() - 1.0
        };
        let mut solver = BoxLeastSquares::default();
        let mut on_bound = 0;
        for _ in 0..300 {
            let mut triangle = Triangle::default();
            triangle.reset(4);
            let mut block: Vec<f64> = (0..30).map(|_| next()).collect();
            triangle.fold(&mut block);
            // Some components begin on a bound.
            let lower: Vec<f64> = (0..4).map(|_| (next() * 0.6).min(0.0)).collect();
            let upper: Vec<f64> = (0..4).map(|_| (next() * 0.6).max(1e-3)).collect();
            solver.solve(&triangle, &lower, &upper);
            for j in 0..4 {
                assert!(lower[j] <= solver.step[j] && solver.step[j] <= upper[j], "component {j} is outside");
                match solver.sides[j] {
                    Side::Inside => {}
                    Side::Lower => assert_eq!(solver.step[j], lower[j]),
                    Side::Upper => assert_eq!(solver.step[j], upper[j]),
                }
            }
            on_bound += 4 - solver.inside.len();
            let (found, best) = (misfit(&triangle, &solver.step), enumerate(&triangle, &lower, &upper));
            // Both are sums of a few squares of order one.
            assert!((found - best).abs() < 1e-12, "{found} instead of {best}");
        }
        assert!(on_bound > 300, "only {on_bound} components met a bound");
    }
}
