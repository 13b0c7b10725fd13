//! Small nonlinear least squares.

use crate::least_squares::triangle::Triangle;

/// What a Gauss-Newton iteration ends with: the parameters, and the factor of the Jacobian there.
#[derive(Debug, Clone)]
pub(crate) struct Minimum<const P: usize> {
    pub(crate) parameters: [f64; P],
    pub(crate) triangle: Triangle<P>,
}

/// Minimises a sum of squares from `start` on; none if it does not settle.
///
/// `linearise` gives, for parameters it finds possible, the factor of the rows J with the right sides −r, so that its
/// solution is the step. A step that does not lower the sum is halved.
pub(crate) fn gauss_newton<const P: usize>(
    start: [f64; P],
    linearise: impl Fn(&[f64; P]) -> Option<Triangle<P>>,
) -> Option<Minimum<P>> {
    const MOST: usize = 100;
    const HALVINGS: usize = 40;
    let mut parameters = start;
    let mut triangle = linearise(&parameters).filter(|triangle| triangle.total.is_finite())?;
    for _ in 0..MOST {
        let step = triangle.solve()?;
        // What the step could gain in a linear world, against the rounding of the sum itself.
        let is_gained = triangle.total - triangle.rest <= 1e-14 * triangle.total;
        let mut fraction = 1.0;
        let mut better = None;
        for _ in 0..HALVINGS {
            let mut trial = parameters;
            trial.iter_mut().zip(step).for_each(|(value, change)| *value += fraction * change);
            better = linearise(&trial).filter(|next| next.total < triangle.total).map(|next| (trial, next));
            if better.is_some() || is_gained {
                break;
            }
            fraction *= 0.5;
        }
        match better {
            Some(next) => (parameters, triangle) = next,
            // Nothing lower exists along the step: the minimum to rounding, if the step itself is small.
            None => return is_small(&step, &parameters).then_some(Minimum { parameters, triangle }),
        }
    }
    None
}

/// Whether a step changes nothing that matters.
fn is_small<const P: usize>(step: &[f64; P], parameters: &[f64; P]) -> bool {
    let length = |values: &[f64; P]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
    length(step) <= 1e-6 * length(parameters)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = a e^{−b x} through exact points.
    #[test]
    fn an_exponential() {
        let linearise = |&[a, b]: &[f64; 2]| {
            let mut triangle = Triangle::new();
            for i in 0..8 {
                let x = 0.25 * f64::from(i);
                let model = (-b * x).exp();
                triangle.add([model, -a * x * model], 3.0 * (-1.7 * x).exp() - a * model);
            }
            Some(triangle)
        };
        let [a, b] = gauss_newton([1.0, 0.2], linearise).unwrap().parameters;
        assert!((a - 3.0).abs() < 1e-12 && (b - 1.7).abs() < 1e-12, "{a} e^(-{b} x)");
    }

    #[test]
    fn what_runs_away_does_not_settle() {
        // e^p has no smallest value.
        let linearise = |&[p]: &[f64; 1]| {
            let mut triangle = Triangle::new();
            triangle.add([p.exp()], -p.exp());
            triangle.add([0.0], 1.0);
            Some(triangle)
        };
        assert!(gauss_newton([1.0], linearise).is_none());
    }
}
