//! Coordinates of a posterior: one per free parameter, without bounds, in which the posterior is nearly standard
//! normal.

use crate::algebra::definite;
use crate::posterior::transform::Transform;

/// Coordinates z about a centre, by the covariance C = A Aᵀ there.
///
/// ```text
/// ψⱼ = ψ̂ⱼ + bⱼ + sⱼ zⱼ,   bⱼ = Σ_{k < j} Aⱼₖ eₖ
/// eⱼ = zⱼ,                sⱼ = Aⱼⱼ                        for a parameter whose bounds are far
/// eⱼ = (wⱼ − bⱼ)/Aⱼⱼ,     wⱼ = (θⱼ − θ̂ⱼ)/(dθ/dψ)ⱼ         for one that a bound cuts
/// ```
///
/// Parameters that a bound cuts come first, the nearest one before the others. Where the residuals are linear in the
/// parameters, those with far bounds are normal for each value of these, about means that are linear in θ and not in
/// its logarithm: in z the two are then independent. The determinant of dψ/dz is a constant, and a sampler needs few
/// steps whatever the units and correlations.
#[derive(Debug, Clone)]
pub(super) struct Whitening {
    centre: Vec<f64>,
    /// Place of each coordinate among those of ψ, the cut ones first.
    places: Vec<usize>,
    /// A by rows, lower half, in the order of `places`.
    factor: Vec<f64>,
    cut: Vec<Cut>,
}

/// A parameter that a bound cuts.
#[derive(Debug, Clone, Copy)]
struct Cut {
    transform: Transform,
    value: f64,
    slope: f64,
    /// s.
    scale: f64,
}

/// Standard deviations within which a bound cuts (1).
const NEAR: f64 = 6.0;

impl Whitening {
    /// About `centre`, for information matrices by rows: `straight` over θ, each in units of its dθ/dψ, and `bent` over
    /// ψ. `None` unless the first is positive definite by more than rounding.
    pub(super) fn new(centre: Vec<f64>, transforms: &[Transform], straight: &[f64], bent: &[f64]) -> Option<Self> {
        let order = centre.len();
        let covariance = inverse(straight, order)?;
        // Distance from the nearer bound, in standard deviations.
        let distance = |j: usize| {
            let image = transforms[j].at(centre[j]);
            let distance = match transforms[j] {
                Transform::Identity => f64::INFINITY,
                Transform::Above(lower) => image.value - lower,
                Transform::Below(upper) => upper - image.value,
                Transform::Between(lower, upper) => (image.value - lower).min(upper - image.value),
            };
            distance / (covariance[j * order + j].sqrt() * image.slope.abs())
        };
        let mut places: Vec<usize> = (0..order).collect();
        places.sort_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        let mut factor = vec![0.0; order * order];
        for (row, &i) in places.iter().enumerate() {
            for (column, &j) in places.iter().enumerate() {
                factor[row * order + column] = covariance[i * order + j];
            }
        }
        if !definite::factor(&mut factor, order, |_| 0.0) {
            return None;
        }
        let near = places.iter().enumerate().take_while(|(_, j)| distance(**j) < NEAR);
        let cut = near.map(|(row, &j)| {
            let image = transforms[j].at(centre[j]);
            let bend = bent[j * order + j] - straight[j * order + j];
            let scale = (factor[row * order + row].powi(-2) + bend).sqrt().recip();
            Cut { transform: transforms[j], value: image.value, slope: image.slope, scale }
        });
        let cut = cut.collect();
        Some(Self { centre, places, factor, cut })
    }

    pub(super) fn order(&self) -> usize {
        self.centre.len()
    }

    /// True if a bound cuts a parameter.
    pub(super) fn has_cut(&self) -> bool {
        !self.cut.is_empty()
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.factor[row * self.order()..][..=row]
    }

    /// The ψ of `z`.
    pub(super) fn coordinates(&self, z: &[f64], psi: &mut Vec<f64>) {
        psi.clear();
        psi.extend_from_slice(&self.centre);
        let mut steps = vec![0.0; z.len()];
        for row in 0..z.len() {
            let (line, place) = (self.row(row), self.places[row]);
            let before: f64 = line[..row].iter().zip(&steps).map(|(a, e)| a * e).sum();
            if let Some(cut) = self.cut.get(row) {
                psi[place] += before + cut.scale * z[row];
                let away = (cut.transform.at(psi[place]).value - cut.value) / cut.slope;
                steps[row] = (away - before) / line[row];
            } else {
                steps[row] = z[row];
                psi[place] += before + line[row] * z[row];
            }
        }
    }

    /// Overwrites a gradient by ψ, at these coordinates, with the one by z.
    pub(super) fn gradient(&self, psi: &[f64], gradient: &mut [f64]) {
        let order = self.order();
        // Derivatives by the steps e, gathered from the last row up.
        let mut by_steps = vec![0.0; order];
        let mut by_z = vec![0.0; order];
        for row in (0..order).rev() {
            let (line, place) = (self.row(row), self.places[row]);
            let onwards = if let Some(cut) = self.cut.get(row) {
                let by_step = by_steps[row] / line[row];
                let slope = cut.transform.at(psi[place]).slope / cut.slope;
                let by_psi = gradient[place] + by_step * slope;
                by_z[row] = cut.scale * by_psi;
                by_psi - by_step
            } else {
                by_z[row] = by_steps[row] + line[row] * gradient[place];
                gradient[place]
            };
            by_steps[..row].iter_mut().zip(line).for_each(|(by, a)| *by += onwards * a);
        }
        gradient.copy_from_slice(&by_z);
    }
}

/// The inverse of a matrix whose rows may differ by any factor.
fn inverse(matrix: &[f64], order: usize) -> Option<Vec<f64>> {
    let scales: Vec<f64> = (0..order).map(|j| matrix[j * order + j].sqrt()).collect();
    let scaled = |(index, element): (usize, &f64)| element / (scales[index / order] * scales[index % order]);
    let unit: Vec<f64> = matrix.iter().enumerate().map(scaled).collect();
    let inverse = definite::inverse(&unit, order)?;
    Some(inverse.iter().enumerate().map(scaled).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_are_those_of_differences() {
        let transforms =
            [Transform::Identity, Transform::Above(0.0), Transform::Identity, Transform::Between(-1.0, 2.0)];
        let straight = [
            [4.0, 1.0, -0.5, 0.3], //
            [1.0, 3.0, 0.8, -0.6],
            [-0.5, 0.8, 2.0, 0.1],
            [0.3, -0.6, 0.1, 5.0],
        ];
        let whitening =
            Whitening::new(vec![0.3, -0.2, 1.0, 0.4], &transforms, straight.as_flattened(), straight.as_flattened())
                .unwrap();
        assert_eq!((whitening.places.as_slice(), whitening.cut.len()), ([1, 3, 0, 2].as_slice(), 2));
        // Any function of ψ with a gradient.
        let function = |psi: &[f64]| psi.iter().enumerate().map(|(j, psi)| (psi * (1.0 + j as f64)).sin()).sum::<f64>();
        let z = [0.5, -0.7, 1.1, 0.2];
        let mut psi = Vec::new();
        whitening.coordinates(&z, &mut psi);
        let mut gradient: Vec<f64> =
            psi.iter().enumerate().map(|(j, psi)| (1.0 + j as f64) * (psi * (1.0 + j as f64)).cos()).collect();
        let at = psi.clone();
        whitening.gradient(&at, &mut gradient);
        for j in 0..4 {
            let mut moved = |step: f64| {
                let mut z = z;
                z[j] += step;
                whitening.coordinates(&z, &mut psi);
                function(&psi)
            };
            let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            // Truncation 1e-10/6 of third derivatives of up to 100, rounding 1e-15/1e-5.
            assert!((gradient[j] - difference).abs() < 1e-8, "by z[{j}]: {} and {difference}", gradient[j]);
        }
    }

    /// With nothing cut the covariance of ψ over standard normal z is the inverse of the information.
    #[test]
    fn whole_coordinates_have_the_covariance_of_the_information() {
        let information = [4.0, 1.0, 1.0, 3.0];
        let whitening = Whitening::new(vec![0.0, 0.0], &[Transform::Identity; 2], &information, &information).unwrap();
        let mut psi = Vec::new();
        let mut covariance = [0.0; 4];
        for z in [[1.0, 0.0], [0.0, 1.0]] {
            whitening.coordinates(&z, &mut psi);
            definite::add_square(&mut covariance, &psi, 1.0);
        }
        for (element, expected) in covariance.iter().zip([3.0, -1.0, -1.0, 4.0]) {
            assert!((element - expected / 11.0).abs() < 1e-15, "{covariance:?}");
        }
        assert!(Whitening::new(vec![0.0; 2], &[Transform::Identity; 2], &[1.0; 4], &[1.0; 4]).is_none());
    }
}
