//! The set of input quantities of a measurement and how they are correlated.

mod input;
mod observations;

pub use input::{Evaluation, Input};
pub use observations::Observations;

use std::collections::HashSet;

use nalgebra::DMatrix;

use crate::error::UncertaintyError;

/// A non-empty set of inputs of different names, with their correlation matrix.
///
/// Inputs are uncorrelated unless [`Inputs::with_correlations`] says otherwise. The matrix is symmetric with a
/// unit diagonal by construction and always positive semidefinite.
///
/// In a Monte Carlo correlated normal inputs are multivariate normal, and an ensemble ([`Inputs::with_ensemble`])
/// is multivariate t. Correlated inputs of other distributions keep them under a Gaussian copula: the
/// coefficient is then that of the normal scores, from which that of the values themselves differs a little
/// (0.483 for two rectangular inputs and 0.5).
///
/// ```
/// use fmm_uq::{Input, Inputs};
///
/// let inputs = Inputs::new([
///     Input::new("V", 4.999, 0.0032, "V")?,
///     Input::new("I", 0.019_661, 9.5e-6, "A")?,
/// ])?
/// .with_correlations(&[("V", "I", -0.36)])?;
/// assert_eq!(inputs.correlation("I", "V"), Some(-0.36));
/// assert_eq!(inputs.correlation("I", "R"), None);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Inputs {
    all: Vec<Input>,
    correlation: DMatrix<f64>,
    ensembles: Vec<Ensemble>,
}

/// Inputs whose standard uncertainties come from the same observations.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ensemble {
    pub(crate) members: Vec<usize>,
    pub(crate) degrees_of_freedom: f64,
}

impl Inputs {
    /// Uncorrelated inputs, in the order in which a model receives them.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] without an input, or for a name given twice.
    pub fn new(inputs: impl IntoIterator<Item = Input>) -> Result<Self, UncertaintyError> {
        let inputs: Vec<Input> = inputs.into_iter().collect();
        if inputs.is_empty() {
            return Err(UncertaintyError::invalid("at least one input is needed, but none was given"));
        }
        for (i, input) in inputs.iter().enumerate() {
            if inputs[..i].iter().any(|earlier| earlier.name() == input.name()) {
                return Err(UncertaintyError::duplicate_name(input.name()));
            }
        }
        let correlation = DMatrix::identity(inputs.len(), inputs.len());
        Ok(Self { all: inputs, correlation, ensembles: Vec::new() })
    }

    /// The same inputs with correlation coefficients r (1) for the named pairs; other pairs keep theirs.
    ///
    /// All coefficients come in one call because half a correlation matrix need not be a possible one: with
    /// r = 0.9 for two pairs of three inputs, the third pair cannot stay at 0.
    ///
    /// Coefficients that were rounded for print may be impossible together. The error then names the eigenvalue
    /// by which they miss; take them from the observations instead.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for an unknown name, an input with itself, a pair given twice, a coefficient
    /// outside [−1, 1], or coefficients that are impossible together.
    pub fn with_correlations(mut self, coefficients: &[(&str, &str, f64)]) -> Result<Self, UncertaintyError> {
        let mut seen = HashSet::with_capacity(coefficients.len());
        for &(first, second, value) in coefficients {
            let (i, j) = (self.position(first)?, self.position(second)?);
            let pair = (i.min(j), i.max(j));
            if i == j {
                let what = format!("the correlation of `{first}` with itself is 1 and cannot be set");
                return Err(UncertaintyError::invalid(what));
            }
            if !seen.insert(pair) {
                let what = format!("the correlation of `{first}` and `{second}` is given twice");
                return Err(UncertaintyError::invalid(what));
            }
            if !(-1.0..=1.0).contains(&value) {
                let correlation = format!("correlation of `{first}` and `{second}`");
                return Err(UncertaintyError::out_of_range(&correlation, value, "in [-1, 1]"));
            }
            self.correlation[(i, j)] = value;
            self.correlation[(j, i)] = value;
        }
        let smallest_eigenvalue = self.correlation.symmetric_eigenvalues().min();
        if smallest_eigenvalue < -self.rounding() {
            return Err(UncertaintyError::invalid(format!(
                "no quantities can be correlated like this: the smallest eigenvalue of the correlation matrix is \
                 {smallest_eigenvalue:.3e}, and it must not be negative"
            )));
        }
        Ok(self)
    }

    /// The means of simultaneous observations, each a name, a unit and its values: correlated as the observations
    /// are, and one ensemble of n − 1 degrees of freedom (JCGM 100:2008, 5.2.3 and example H.2).
    ///
    /// JCGM 102:2011, 5.3.2 takes n − N degrees of freedom for N quantities instead, and scales that are larger by the
    /// root of (n − 1)/(n − N).
    ///
    /// # Errors
    /// Those of [`Observations::new`], [`Observations::correlation`], [`Input::new`], [`Inputs::new`] and
    /// [`Inputs::with_ensemble`].
    pub fn from_observations(quantities: &[(&str, &str, &[f64])]) -> Result<Self, UncertaintyError> {
        let observed = quantities.iter().map(|(_, _, values)| Observations::new(values));
        let observed = observed.collect::<Result<Vec<_>, _>>()?;
        let means = quantities.iter().zip(&observed).map(|((name, unit, _), mean)| Input::mean_of(*name, mean, *unit));
        let inputs = Self::new(means.collect::<Result<Vec<_>, _>>()?)?;
        let mut coefficients = Vec::new();
        for j in 0..observed.len() {
            for i in 0..j {
                coefficients.push((quantities[i].0, quantities[j].0, observed[i].correlation(&observed[j])?));
            }
        }
        let varying: Vec<&str> =
            inputs.all.iter().filter(|i| i.distribution().is_normal_or_t()).map(Input::name).collect();
        let degrees_of_freedom = observed.first().map_or(f64::INFINITY, Observations::degrees_of_freedom);
        let inputs = inputs.clone().with_correlations(&coefficients)?;
        if varying.is_empty() { Ok(inputs) } else { inputs.with_ensemble(&varying, degrees_of_freedom) }
    }

    /// The same inputs with the named ones declared an ensemble: estimates whose uncertainties rest on the same
    /// observations, of ν degrees of freedom in common.
    ///
    /// In a Monte Carlo they follow a multivariate t-distribution; their scales are their standard uncertainties and
    /// their correlations those of the set. In the GUM they count as one contribution to ν_eff, which holds also where
    /// they are correlated with each other.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for an input that is neither normal nor t, or if ν is below 1 or NaN.
    pub fn with_ensemble(mut self, names: &[&str], degrees_of_freedom: f64) -> Result<Self, UncertaintyError> {
        let mut members = Vec::with_capacity(names.len());
        for &name in names {
            let at = self.position(name)?;
            if members.contains(&at) || self.ensembles.iter().any(|other| other.members.contains(&at)) {
                return Err(UncertaintyError::invalid(format!(
                    "`{name}` is in an ensemble already; an uncertainty comes from one set of observations"
                )));
            }
            if !self.all[at].distribution().is_normal_or_t() {
                return Err(UncertaintyError::invalid(format!(
                    "`{name}` is neither normal nor t-distributed, and cannot be part of a multivariate t-distribution"
                )));
            }
            self.all[at] = self.all[at].clone().with_degrees_of_freedom(degrees_of_freedom)?;
            members.push(at);
        }
        if degrees_of_freedom.is_finite() && !members.is_empty() {
            self.ensembles.push(Ensemble { members, degrees_of_freedom });
        }
        Ok(self)
    }

    /// The names of two inputs that do not vary independently, if there are any.
    pub(crate) fn dependent_pair(&self) -> Option<(String, String)> {
        let together = self.ensembles.iter().find(|e| e.members.len() > 1).map(|e| (e.members[0], e.members[1]));
        let name = |at: usize| self.all[at].name().to_owned();
        self.correlated_pairs().next().or(together).map(|(i, j)| (name(i), name(j)))
    }

    /// A number that changes with any name, parameter or correlation, though not between runs of one build.
    pub(crate) fn fingerprint(&self) -> u64 {
        // FNV-1a of all that distinguishes two sets; the standard hasher promises no value.
        format!("{self:?}")
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
    }

    /// The ensembles, each of finite degrees of freedom.
    pub(crate) fn ensembles(&self) -> &[Ensemble] {
        &self.ensembles
    }

    /// The inputs in the order in which a model receives them.
    pub fn as_slice(&self) -> &[Input] {
        &self.all
    }

    /// Correlation coefficient of two inputs by name (1), 1 of an input with itself; `None` if a name is unknown.
    pub fn correlation(&self, first: &str, second: &str) -> Option<f64> {
        Some(self.correlation_at(self.position(first).ok()?, self.position(second).ok()?))
    }

    /// Correlation coefficient of two inputs by position.
    pub(crate) fn correlation_at(&self, i: usize, j: usize) -> f64 {
        self.correlation[(i, j)]
    }

    /// The pairs of positions whose correlation coefficient is not zero.
    pub(crate) fn correlated_pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        let pairs = (0..self.all.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
        pairs.filter(|&(i, j)| self.correlation_at(i, j) != 0.0)
    }

    /// The relative rounding error that a quadratic form with the correlation matrix may carry, which is also
    /// that of the matrix' eigenvalues.
    pub(crate) fn rounding(&self) -> f64 {
        16.0 * f64::EPSILON * self.all.len() as f64
    }

    /// L with L Lᵀ = R for the correlation matrix R of some `members`, lower triangular, row by row.
    ///
    /// R may be singular: a column whose pivot is zero to rounding is left zero, as Cholesky's method would have it in
    /// exact numbers. nalgebra's refuses such a matrix.
    pub(crate) fn correlation_root(&self, members: &[usize]) -> Vec<Vec<f64>> {
        let n = members.len();
        let mut root = vec![vec![0.0; n]; n];
        for j in 0..n {
            let pivot = 1.0 - root[j][..j].iter().map(|l| l * l).sum::<f64>();
            if pivot <= self.rounding() {
                continue;
            }
            root[j][j] = pivot.sqrt();
            for i in j + 1..n {
                let known: f64 = root[i][..j].iter().zip(&root[j][..j]).map(|(a, b)| a * b).sum();
                root[i][j] = (self.correlation_at(members[i], members[j]) - known) / root[j][j];
            }
        }
        root
    }

    fn position(&self, name: &str) -> Result<usize, UncertaintyError> {
        self.all.iter().position(|input| input.name() == name).ok_or_else(|| {
            let known: Vec<&str> = self.all.iter().map(Input::name).collect();
            UncertaintyError::invalid(format!("there is no input `{name}`; the inputs are {}", known.join(", ")))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three() -> Inputs {
        Inputs::new(["a", "b", "c"].map(|name| Input::new(name, 1.0, 0.1, "m").unwrap())).unwrap()
    }

    #[test]
    fn names_must_be_there_and_differ() {
        assert!(matches!(Inputs::new([]), Err(UncertaintyError::Invalid { .. })));
        let twice = ["a", "a"].map(|name| Input::new(name, 1.0, 0.1, "m").unwrap());
        assert_eq!(
            Inputs::new(twice).unwrap_err().to_string(),
            "each input needs a name of its own, but `a` is given twice"
        );
        assert_eq!(
            three().with_correlations(&[("a", "d", 0.1)]).unwrap_err().to_string(),
            "there is no input `d`; the inputs are a, b, c"
        );
    }

    #[test]
    fn coefficients_are_checked_one_by_one() {
        for bad in [1.000_001, -2.0, f64::NAN, f64::INFINITY] {
            let error = three().with_correlations(&[("a", "b", bad)]).unwrap_err();
            assert!(matches!(error, UncertaintyError::Invalid { .. }), "r = {bad}: {error}");
        }
        let itself = three().with_correlations(&[("a", "a", 1.0)]);
        assert!(matches!(itself, Err(UncertaintyError::Invalid { what }) if what.contains("with itself")));
        let twice = three().with_correlations(&[("a", "b", 0.1), ("b", "a", 0.1)]);
        assert!(matches!(twice, Err(UncertaintyError::Invalid { what }) if what.contains("given twice")));
    }

    #[test]
    fn coefficients_are_checked_together() {
        // Eigenvalues 1, 1 ± 0.9 √2 without the third pair; 0.1, 0.1, 2.8 with it.
        let half = [("a", "b", 0.9), ("a", "c", 0.9)];
        match three().with_correlations(&half) {
            Err(UncertaintyError::Invalid { what }) => {
                assert!(what.contains(&format!("matrix is {:.3e}", 1.0 - 0.9 * 2f64.sqrt())), "{what}");
            }
            other => panic!("accepted or refused for the wrong reason: {other:?}"),
        }
        assert!(three().with_correlations(&[half[0], half[1], ("b", "c", 0.9)]).is_ok());
    }

    #[test]
    fn full_correlation_is_on_the_edge_and_allowed() {
        let full = [("a", "b", 1.0), ("a", "c", -1.0), ("b", "c", -1.0)];
        let inputs = three().with_correlations(&full).unwrap();
        assert_eq!((inputs.correlation("c", "a"), inputs.correlation("c", "c")), (Some(-1.0), Some(1.0)));
        assert!(three().with_correlations(&[full[0], full[1], ("b", "c", 1.0)]).is_err());
    }

    #[test]
    fn roots_of_regular_and_singular_matrices() {
        let inputs = Inputs::new(["a", "b", "c"].map(|name| Input::new(name, 0.0, 1.0, "m").unwrap())).unwrap();
        for coefficients in [[0.9, 0.3, 0.5], [1.0, -1.0, -1.0], [1.0, 0.2, 0.2], [0.0, 0.0, 0.0]] {
            let pairs = [("a", "b", coefficients[0]), ("a", "c", coefficients[1]), ("b", "c", coefficients[2])];
            let correlated = inputs.clone().with_correlations(&pairs).unwrap();
            let root = correlated.correlation_root(&[0, 1, 2]);
            for i in 0..3 {
                for j in 0..3 {
                    let product: f64 = (0..3).map(|k| root[i][k] * root[j][k]).sum();
                    // A pivot dropped at 1e-14 may leave its root, 1e-7, in the matrix; these leave nothing.
                    let error = product - correlated.correlation_at(i, j);
                    assert!(error.abs() < 1e-15, "{coefficients:?}: {error} at {i}, {j}");
                }
            }
        }
    }
}
