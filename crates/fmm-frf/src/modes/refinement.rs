//! Poles that leave least of all lines, by variable projection.

use fmm_fit::{Derivatives, EvaluationError, Fit, Options, Residuals, solve};
use fmm_model::{Bounds, Parameter};
use fmm_record::Complex64;
use nalgebra::DMatrix;

use super::band::Band;
use super::partial_fractions::{Basis, Lines, right_side};

/// How far a fit goes: relative change of the sum of squares at its end, steps at most, and steps that sharpen it.
/// Origin: measured hammer blows, whose residuals are far above noise, so that steps shrink by a constant factor; ends
/// that differ by 10⁻¹⁰ of the sum are 10⁻⁵ √n of the uncertainties apart.
const LAST: (f64, usize, usize) = (1e-10, 40, 3);
const CHOICE: (f64, usize, usize) = (1e-5, 12, 0);

/// Nonlinear least squares for poles alone: at each trial the residues and the rest are those of the linear fit, and the
/// derivatives leave out what these take up.
///
/// The derivatives are those of Kaufman: their gradient is exact, and Jᵀ J is the information on the poles when all
/// other unknowns are free, so that its inverse is their covariance.
///
/// # References
/// G. H. Golub, V. Pereyra, "Separable nonlinear least squares: the variable projection method and its applications",
/// Inverse Problems 19 (2003) R1; L. Kaufman, BIT 15 (1975) 49.
pub(super) struct Refinement<'a> {
    pub(super) band: &'a Band,
    pub(super) lines: &'a Lines,
    /// Weights of the lines of each response, 1/u; one number for all lines of a response that has no uncertainties.
    pub(super) weights: &'a [Weights],
    parameters: Vec<Parameter>,
}

/// Weights of a response.
#[derive(Debug, Clone)]
pub(super) enum Weights {
    /// The same at all lines.
    Equal(f64),
    /// One for each line.
    Lines(Vec<f64>),
}

impl Weights {
    fn lines(&self) -> Option<&[f64]> {
        match self {
            Self::Equal(_) => None,
            Self::Lines(weights) => Some(weights),
        }
    }

    fn factor(&self) -> f64 {
        match self {
            Self::Equal(factor) => *factor,
            Self::Lines(_) => 1.0,
        }
    }

    pub(super) fn at(&self, line: usize) -> f64 {
        self.lines().map_or(self.factor(), |weights| weights[line])
    }
}

/// Linear fit of one response for known poles.
pub(super) struct Linear {
    /// Real unknowns, in the order of [`Lines`].
    pub(super) unknowns: Vec<f64>,
    /// Their covariance for residuals of unit variance, that of the poles included.
    pub(super) covariance: DMatrix<f64>,
}

impl<'a> Refinement<'a> {
    pub(super) fn new(band: &'a Band, lines: &'a Lines, weights: &'a [Weights], modes: usize) -> Self {
        let (low, high) = band.ends();
        // A pole may leave the band by the distance of some lines; farther away it belongs to the rest.
        let margin = 0.1 * (high - low) / high;
        let frequency = Bounds::new((low / high - margin).max(1e-6), 1.0 + margin).unwrap_or(Bounds::NOT_NEGATIVE);
        let parameters = (0..modes).flat_map(|mode| {
            [
                Parameter::named(format!("decay_rate_{mode}"), "δ", "1").bounded(Bounds::NOT_NEGATIVE),
                Parameter::named(format!("frequency_{mode}"), "ω", "1").bounded(frequency),
            ]
        });
        Self { band, lines, weights, parameters: parameters.collect() }
    }

    /// The fit from poles (by the band's unit) on, to the last digits or as far as a choice between modes needs.
    pub(super) fn fit(&self, poles: &[Complex64], is_last: bool) -> Option<Fit> {
        let inside =
            |value: f64, parameter: &Parameter| value.clamp(parameter.bounds().lower(), parameter.bounds().upper());
        let start: Vec<f64> = poles.iter().flat_map(|pole| [-pole.re, pole.im]).collect();
        let start: Vec<f64> = start.iter().zip(&self.parameters).map(|(value, of)| inside(*value, of)).collect();
        // Derivatives without what the linear unknowns take up are not those of differences.
        let options = Options::default().with_jacobian_check(false);
        let (tolerance, most, polish) = if is_last { LAST } else { CHOICE };
        let options = options.with_cost_tolerance(tolerance).with_max_iterations(most).with_restarts(0);
        solve(self, &start, &options.with_polish_steps(polish)).ok()
    }

    /// The factorisations of all responses, each with those that it serves; responses without uncertainties share one.
    fn for_each_basis(&self, poles: &[Complex64], mut serve: impl FnMut(usize, &Basis)) -> Option<()> {
        let mut shared: Option<Basis> = None;
        for (index, weights) in self.weights.iter().enumerate() {
            let own;
            let basis = match weights.lines() {
                None => &*shared.get_or_insert_with(|| Basis::of(self.lines, poles, None)),
                lines => {
                    own = Basis::of(self.lines, poles, lines);
                    &own
                }
            };
            if !basis.is_determined() {
                return None;
            }
            serve(index, basis);
        }
        Some(())
    }

    /// Slopes of the model of a response by all parameters, weighted as its lines are but for the common factor.
    fn slopes(&self, index: usize, poles: &[Complex64], unknowns: &[f64]) -> DMatrix<f64> {
        let count = self.lines.len();
        let mut slopes = DMatrix::zeros(2 * count, 2 * poles.len());
        for (mode, pole) in poles.iter().enumerate() {
            let residue = Complex64::new(unknowns[2 * mode], unknowns[2 * mode + 1]);
            for line in 0..count {
                let weight = self.weights[index].lines().map_or(1.0, |weights| weights[line]);
                for (part, slope) in self.lines.slopes(line, *pole, residue).into_iter().enumerate() {
                    slopes[(line, 2 * mode + part)] = weight * slope.re;
                    slopes[(count + line, 2 * mode + part)] = weight * slope.im;
                }
            }
        }
        slopes
    }

    /// The linear fits of all responses for the poles of a `fit`.
    pub(super) fn linear(&self, fit: &Fit) -> Option<Vec<Linear>> {
        let poles = poles(fit.values());
        let size = fit.values().len();
        // A pole that the lines do not determine has none; whoever asks the fit for it knows.
        let covariance = DMatrix::from_fn(size, size, |i, j| fit.unit_covariance(i, j).unwrap_or(0.0));
        let mut found = Vec::with_capacity(self.weights.len());
        self.for_each_basis(&poles, |index, basis| {
            let right = right_side(&self.band.channels[index], self.weights[index].lines());
            let unknowns = basis.solve(&basis.project(&right));
            let unknowns: Vec<f64> = (0..unknowns.nrows()).map(|i| unknowns[(i, 0)]).collect();
            let slopes = self.slopes(index, &poles, &unknowns);
            let influence = basis.solve(&basis.project(&slopes));
            let factor = self.weights[index].factor().powi(-2);
            let covariance = basis.covariance() * factor + &influence * &covariance * influence.transpose();
            found.push(Linear { unknowns, covariance });
        })?;
        Some(found)
    }
}

/// Poles of values of the parameters.
pub(super) fn poles(values: &[f64]) -> Vec<Complex64> {
    values.chunks_exact(2).map(|pair| Complex64::new(-pair[0], pair[1])).collect()
}

impl Residuals for Refinement<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        2 * self.lines.len() * self.weights.len()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let (poles, rows, total) = (poles(p), 2 * self.lines.len(), self.len());
        let mut jacobian = jacobian;
        let done = self.for_each_basis(&poles, |index, basis| {
            let factor = self.weights[index].factor();
            let mut left = right_side(&self.band.channels[index], self.weights[index].lines());
            let projection = basis.project(&left);
            basis.take_out(&mut left, &projection);
            let range = index * rows..(index + 1) * rows;
            for (row, residual) in residuals[range.clone()].iter_mut().enumerate() {
                *residual = -factor * left[(row, 0)];
            }
            if let Some(jacobian) = jacobian.as_deref_mut() {
                let unknowns = basis.solve(&projection);
                let unknowns: Vec<f64> = (0..unknowns.nrows()).map(|i| unknowns[(i, 0)]).collect();
                let mut slopes = self.slopes(index, &poles, &unknowns);
                let projection = basis.project(&slopes);
                basis.take_out(&mut slopes, &projection);
                for (column, values) in jacobian.chunks_exact_mut(total).enumerate() {
                    for (row, value) in values[range.clone()].iter_mut().enumerate() {
                        *value = factor * slopes[(row, column)];
                    }
                }
            }
        });
        done.ok_or_else(|| EvaluationError::message("two poles are the same"))
    }

    fn derivatives(&self) -> Derivatives {
        Derivatives::All
    }

    fn is_cheaper_combined(&self) -> bool {
        true
    }
}
