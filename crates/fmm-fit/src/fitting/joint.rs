//! Joint problem: several records that share parameters.

use std::ops::Range;

use fmm_model::{Bounds, Parameter, Rounded};

use crate::error::FitError;
use crate::problem::block::Block;
use crate::problem::residuals::{Derivatives, EvaluationError, Residuals};
use crate::result::fit::Fit;

/// Several problems as one, some of their parameters being the same in all: five repeats with one friction coefficient
/// and each its own initial state.
///
/// Parameters with a shared name become one, whatever their places in the problems; it need not occur in every problem.
/// All others become each problem's own, with its number in the name: `x0` of the second problem is `x0[2]`. Shared
/// ones come first, in the order of the names given, then those of the first problem, the second, and so on.
///
/// A shared parameter may lie where *all* problems that have it allow it: its bounds are the intersection of theirs,
/// and a problem that holds it fixed holds it fixed for all.
///
/// The residuals are those of the problems, one after the other; each problem is a [`Block`] or brings its own, so that
/// memory and work grow with the number of records, not with its square. Derivatives are exact if all problems give
/// them.
///
/// Problems of different types are joined as `Joint<&dyn Residuals>`.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{Joint, Options, Residuals, solve};
/// use fmm_model::Parameter;
///
/// /// One heating curve, T = T₀ + b t.
/// struct Heating {
///     temperatures: Vec<f64>,
///     parameters: [Parameter; 2],
/// }
/// # impl Residuals for Heating {
/// #     fn parameters(&self) -> &[Parameter] { &self.parameters }
/// #     fn len(&self) -> usize { self.temperatures.len() }
/// #     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
/// #         for (i, (r, y)) in residuals.iter_mut().zip(&self.temperatures).enumerate() {
/// #             *r = p[0] + p[1] * i as f64 - y;
/// #         }
/// #         Ok(())
/// #     }
/// # }
/// let heating = |temperatures: &[f64]| Heating {
///     temperatures: temperatures.to_vec(),
///     parameters: [Parameter::new("start", "T₀", "K"), Parameter::new("rate", "b", "K/s")],
/// };
/// let joint = Joint::new(vec![heating(&[20.1, 22.0, 23.9]), heating(&[30.0, 32.2, 34.0])], &["rate"])?;
/// let names: Vec<&str> = joint.parameters().iter().map(Parameter::name).collect();
/// assert_eq!(names, ["rate", "start[1]", "start[2]"]);
///
/// let fit = solve(&joint, &joint.start(&[[20.0, 1.0], [30.0, 1.0]])?, &Options::default())?;
/// assert!((fit.estimate("rate").unwrap().value() - 1.95).abs() < 1e-9);
/// let second = &joint.split(&fit)?[1];
/// assert_eq!(second[0], fit.estimate("start[2]").unwrap().value());
/// assert_eq!(joint.rows(1), Some(3..6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Joint<P> {
    problems: Vec<P>,
    parameters: Vec<Parameter>,
    members: Vec<Member>,
    blocks: Vec<Block>,
    /// For each block, the problem that it belongs to and its index there.
    origins: Vec<(usize, usize)>,
}

/// One problem within the whole.
#[derive(Debug, Clone)]
struct Member {
    /// For each of its parameters, the index in the whole.
    indices: Vec<usize>,
    rows: Range<usize>,
    elements: Range<usize>,
}

impl Member {
    /// Its own values among those of the whole.
    fn values(&self, p: &[f64]) -> Vec<f64> {
        self.indices.iter().map(|&index| p[index]).collect()
    }
}

impl<P: Residuals> Joint<P> {
    /// Joins `problems`; parameters of the names `shared` are the same in all of them.
    ///
    /// # Errors
    /// [`FitError`] without a problem, for a name that no problem has or that stands twice, and for a shared
    /// parameter whose units differ or whose bounds have no value in common.
    pub fn new(problems: Vec<P>, shared: &[&str]) -> Result<Self, FitError> {
        if problems.is_empty() {
            return Err(FitError::count("a joint fit needs at least one problem"));
        }
        let mut parameters = Vec::new();
        for (place, name) in shared.iter().enumerate() {
            if shared[..place].contains(name) {
                return Err(name_twice(name));
            }
            parameters.push(common(&problems, name)?);
        }
        let (mut members, mut blocks, mut origins) = (Vec::new(), Vec::new(), Vec::new());
        let (mut row, mut element) = (0, 0);
        for (number, problem) in problems.iter().enumerate() {
            let own = problem.parameters();
            let mut indices = Vec::with_capacity(own.len());
            for (place, parameter) in own.iter().enumerate() {
                if own[..place].iter().any(|before| before.name() == parameter.name()) {
                    return Err(name_twice(parameter.name()));
                }
                if let Some(index) = shared.iter().position(|name| *name == parameter.name()) {
                    indices.push(index);
                } else {
                    indices.push(parameters.len());
                    let numbered = |text: &str| format!("{text}[{}]", number + 1);
                    let (name, symbol) = (numbered(parameter.name()), numbered(parameter.symbol()));
                    let of_problem = Parameter::named(name, symbol, parameter.unit().to_owned());
                    parameters.push(of_problem.bounded(parameter.bounds()));
                }
            }
            let before = (row, element);
            let whole = [Block::new(problem.len(), (0..own.len()).collect::<Vec<_>>())];
            let parts = if problem.blocks().is_empty() { &whole } else { problem.blocks() };
            for (index, part) in parts.iter().enumerate() {
                let columns: Option<Vec<usize>> = part.parameters().iter().map(|&j| indices.get(j).copied()).collect();
                let columns = columns.ok_or_else(|| {
                    FitError::problem(format!(
                        "block {index} of problem {number} names a parameter that the problem does not have"
                    ))
                })?;
                element += part.rows() * columns.len();
                blocks.push(Block::new(part.rows(), columns));
                origins.push((number, index));
            }
            row += problem.len();
            members.push(Member { indices, rows: before.0..row, elements: before.1..element });
        }
        Ok(Self { problems, parameters, members, blocks, origins })
    }

    /// The problems, as they were given.
    pub fn problems(&self) -> &[P] {
        &self.problems
    }

    /// Start values for all from those of each problem: of a shared parameter the mean, moved into its bounds.
    ///
    /// # Errors
    /// [`FitError::Count`] unless there is one value per problem and parameter.
    pub fn start<S: AsRef<[f64]>>(&self, starts: &[S]) -> Result<Vec<f64>, FitError> {
        if starts.len() != self.problems.len() {
            let (starts, problems) = (starts.len(), self.problems.len());
            return Err(FitError::count(format!("there are {starts} starts for {problems} problems")));
        }
        let mut sums = vec![(0.0, 0.0); self.parameters.len()];
        for (number, (member, start)) in self.members.iter().zip(starts).enumerate() {
            let (values, parameters) = (start.as_ref(), member.indices.len());
            if values.len() != parameters {
                return Err(FitError::count(format!(
                    "the start of problem {number} has {} values, but the problem has {parameters} parameters",
                    values.len()
                )));
            }
            for (&index, value) in member.indices.iter().zip(values) {
                sums[index].0 += value;
                sums[index].1 += 1.0;
            }
        }
        let mean = |((sum, count), parameter): (&(f64, f64), &Parameter)| parameter.bounds().clamp(sum / count);
        Ok(sums.iter().zip(&self.parameters).map(mean).collect())
    }

    /// For each problem the values of its parameters in `fit`, which must be one of this problem, in its own order and
    /// shared ones included.
    ///
    /// # Errors
    /// [`FitError::OtherFit`] if the numbers of parameters or residuals are not those of this problem.
    pub fn split(&self, fit: &Fit) -> Result<Vec<Vec<f64>>, FitError> {
        fit.require_of(self)?;
        Ok(self.members.iter().map(|member| member.values(fit.values())).collect())
    }

    /// For each parameter of a problem the index in the joint fit, for its uncertainty and correlations; `None` for a
    /// number that is none of a problem.
    pub fn indices(&self, problem: usize) -> Option<&[usize]> {
        self.members.get(problem).map(|member| member.indices.as_slice())
    }

    /// Range of the residuals of a problem among all; `None` for a number that is none of a problem.
    pub fn rows(&self, problem: usize) -> Option<Range<usize>> {
        self.members.get(problem).map(|member| member.rows.clone())
    }
}

fn name_twice(name: &str) -> FitError {
    FitError::problem(format!("the name {name} stands twice; names tell the parameters of a joint fit apart"))
}

/// The parameter called `name` of all problems that have it.
fn common<P: Residuals>(problems: &[P], name: &str) -> Result<Parameter, FitError> {
    let all = || problems.iter().flat_map(Residuals::parameters).filter(|parameter| parameter.name() == name);
    let first = all()
        .next()
        .ok_or_else(|| FitError::unknown_name(format!("no problem has a parameter called {name} to share")))?;
    if let Some(other) = all().find(|parameter| parameter.unit() != first.unit()) {
        return Err(FitError::problem(format!(
            "the shared parameter {name} is in {} in one problem and in {} in another; give it one unit",
            first.unit(),
            other.unit()
        )));
    }
    let lower = all().map(|parameter| parameter.bounds().lower()).fold(f64::NEG_INFINITY, f64::max);
    let upper = all().map(|parameter| parameter.bounds().upper()).fold(f64::INFINITY, f64::min);
    let bounds = Bounds::new(lower, upper);
    let bounds = bounds.map_err(|_| {
        let [lower, upper] = [lower, upper].map(Rounded::every_digit);
        let what = "as the problems ask";
        FitError::problem(format!(
            "no value of the shared parameter {name} is at least {lower} and at most {upper}, {what}"
        ))
    })?;
    Ok(first.clone().bounded(bounds))
}

impl<P: Residuals> Residuals for Joint<P> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        self.members.last().map_or(0, |member| member.rows.end)
    }

    fn evaluate(
        &self,
        p: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) -> Result<(), EvaluationError> {
        for (problem, member) in self.problems.iter().zip(&self.members) {
            let own = jacobian.as_deref_mut().map(|jacobian| &mut jacobian[member.elements.clone()]);
            problem.evaluate(&member.values(p), &mut residuals[member.rows.clone()], own)?;
        }
        Ok(())
    }

    fn derivatives(&self) -> Derivatives {
        self.problems.iter().map(Residuals::derivatives).min().unwrap_or(Derivatives::None)
    }

    fn is_cheaper_combined(&self) -> bool {
        self.problems.iter().all(Residuals::is_cheaper_combined)
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn block_residuals(&self, block: usize, p: &[f64], residuals: &mut [f64]) -> Result<bool, EvaluationError> {
        let (number, index) = self.origins[block];
        let (problem, values) = (&self.problems[number], self.members[number].values(p));
        if problem.blocks().is_empty() {
            problem.evaluate(&values, residuals, None)?;
            Ok(true)
        } else {
            problem.block_residuals(index, &values, residuals)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::minimizer::Minimizer;
    use crate::solver::options::Options;

    const ROWS: usize = 45_000;

    /// Two waves that all records share and two of each record.
    struct Waves {
        parameters: [Parameter; 4],
        is_exact: bool,
    }

    impl Residuals for Waves {
        fn parameters(&self) -> &[Parameter] {
            &self.parameters
        }
        fn len(&self) -> usize {
            ROWS
        }
        fn evaluate(
            &self,
            p: &[f64],
            residuals: &mut [f64],
            jacobian: Option<&mut [f64]>,
        ) -> Result<(), EvaluationError> {
            for (i, r) in residuals.iter_mut().enumerate() {
                let (sin, cos) = (1e-3 * i as f64).sin_cos();
                *r = p[0] * sin + p[1] * cos + p[2] * sin * cos + p[3] - 1.0 - sin;
            }
            if let Some(jacobian) = jacobian {
                for (j, column) in jacobian.chunks_exact_mut(ROWS).enumerate() {
                    for (i, element) in column.iter_mut().enumerate() {
                        let (sin, cos) = (1e-3 * i as f64).sin_cos();
                        *element = [sin, cos, sin * cos, 1.0][j];
                    }
                }
            }
            Ok(())
        }
        fn derivatives(&self) -> Derivatives {
            if self.is_exact { Derivatives::Free } else { Derivatives::None }
        }
    }

    #[test]
    fn memory_grows_with_the_elements_of_the_blocks() {
        for is_exact in [true, false] {
            let parameters = ["a", "b", "c", "d"].map(|name| Parameter::new(name, name, "1"));
            let record = |_| Waves { parameters: parameters.clone(), is_exact };
            let joint = Joint::new((0..5).map(record).collect(), &["a", "b"]).unwrap();
            let mut minimizer = Minimizer::new(Options::default());
            assert!(minimizer.minimize(&joint, &[0.5; 12]).unwrap().is_success());
            let residuals = minimizer.current.residuals.capacity() + minimizer.trial.residuals.capacity();
            let used = minimizer.evaluator.buffered() + residuals;
            // Four columns and three times the residuals: here, at a trial point, and those that come with derivatives
            // or at a neighbour; not the twelve columns of the whole. A block of the factorisation is small beside.
            let expected = 5 * ROWS * (4 + 3);
            assert!((expected..expected + 10_000).contains(&used), "{used} numbers instead of {expected}");
        }
    }
}
