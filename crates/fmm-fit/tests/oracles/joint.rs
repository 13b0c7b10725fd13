//! Five free vibrations with one stiffness and damping, each with its own initial state.

use std::cell::Cell;

use fmm_fit::{Block, Derivatives, EvaluationError, Fit, FitError, Joint, Minimizer, Options, Residuals, solve};
use fmm_model::{Bounds, Parameter, Scalar};
use serde_json::Value;

use crate::free_vibration::velocity;
use crate::harness::{Formula, FormulaProblem, digits, number, numbers};

struct Vibration {
    step: f64,
    data: Vec<f64>,
}

impl Formula for Vibration {
    fn residual<D: Scalar>(&self, i: usize, p: &[D]) -> D {
        (velocity(i as f64 * self.step, p[0], p[1], p[2], p[3]) - self.data[i]) * 1000.0
    }
}

fn vibration_parameters() -> Vec<Parameter> {
    [("stiffness", "k", "1/s²"), ("damping", "c", "1/s"), ("displacement", "x₀", "m"), ("velocity", "v₀", "m/s")]
        .map(|(name, symbol, unit)| Parameter::new(name, symbol, unit))
        .to_vec()
}

fn oracle() -> Value {
    let file: Value = serde_json::from_str(include_str!("../data/ode_fits.json")).unwrap();
    file["joint"].clone()
}

fn vibrations(is_exact: bool) -> Joint<FormulaProblem<Vibration>> {
    let oracle = oracle();
    let problem = |data: &Value| {
        let formula = Vibration { step: number(&oracle["dt"]), data: numbers(data) };
        FormulaProblem { count: formula.data.len(), formula, parameters: vibration_parameters(), is_exact }
    };
    let problems = oracle["data"].as_array().unwrap().iter().map(problem).collect();
    Joint::new(problems, &["stiffness", "damping"]).unwrap()
}

fn start(joint: &Joint<FormulaProblem<Vibration>>) -> Vec<f64> {
    let starts: Vec<Vec<f64>> = oracle()["start"].as_array().unwrap().iter().map(numbers).collect();
    joint.start(&starts).unwrap()
}

/// The same problem without its blocks: every residual may depend on every parameter.
struct Dense<'a, P>(&'a P);

impl<P: Residuals> Residuals for Dense<'_, P> {
    fn parameters(&self) -> &[Parameter] {
        self.0.parameters()
    }
    fn len(&self) -> usize {
        self.0.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let Some(jacobian) = jacobian else { return self.0.evaluate(p, residuals, None) };
        let blocks = self.0.blocks();
        let mut packed = vec![0.0; blocks.iter().map(|block| block.rows() * block.parameters().len()).sum()];
        self.0.evaluate(p, residuals, Some(&mut packed))?;
        jacobian.fill(0.0);
        let (mut row, mut element) = (0, 0);
        for block in blocks {
            for &j in block.parameters() {
                let first = j * self.len() + row;
                jacobian[first..first + block.rows()].copy_from_slice(&packed[element..element + block.rows()]);
                element += block.rows();
            }
            row += block.rows();
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        self.0.derivatives()
    }
}

/// Digits to which two sets of values agree, and the largest difference of those that are zero to their uncertainty, as
/// some displacements are, in uncertainties.
fn agreement(values: &[f64], reference: &[f64], uncertainties: &[f64]) -> (f64, f64) {
    let is_small = |j: &usize| reference[*j].abs() < 10.0 * uncertainties[*j];
    let (small, large): (Vec<usize>, Vec<usize>) = (0..values.len()).partition(is_small);
    let select = |from: &[f64]| large.iter().map(|&j| from[j]).collect::<Vec<_>>();
    let difference = |&j: &usize| (values[j] - reference[j]).abs() / uncertainties[j];
    (digits(&select(values), &select(reference)), small.iter().map(difference).fold(0.0, f64::max))
}

fn uncertainties(fit: &Fit) -> Vec<f64> {
    fit.estimates().iter().map(|estimate| estimate.standard_uncertainty().unwrap()).collect()
}

#[test]
fn values_and_uncertainties_are_those_of_sixty_digits() {
    let oracle = oracle();
    for is_exact in [true, false] {
        let joint = vibrations(is_exact);
        let fit = solve(&joint, &start(&joint), &Options::default()).unwrap();
        println!("{fit}");
        assert!(fit.outcome().is_success(), "{}", fit.outcome());
        let (large, small) = agreement(fit.values(), &numbers(&oracle["params"]), &numbers(&oracle["sd"]));
        println!("values agree to {large:.1} digits, those near zero to {small:e} uncertainties");
        let wanted = if is_exact { (10.0, 1e-9) } else { (8.0, 1e-6) };
        assert!(large >= wanted.0 && small <= wanted.1, "values {:?}", fit.values());
        assert!(digits(&uncertainties(&fit), &numbers(&oracle["sd"])) >= 8.0, "{:?}", uncertainties(&fit));
        assert!((fit.sum_of_squares() / number(&oracle["sumsq"]) - 1.0).abs() < 1e-12);
        assert_eq!(fit.degrees_of_freedom(), number(&oracle["dof"]) as usize);
        assert_eq!(fit.estimates()[4].name(), "displacement[2]");
        assert_eq!(fit.estimates()[4].parameter().symbol(), "x₀[2]");

        let parts = joint.split(&fit).unwrap();
        for (record, values) in parts.iter().enumerate() {
            let indices = joint.indices(record).unwrap();
            assert_eq!(indices, [0, 1, 2 + 2 * record, 3 + 2 * record]);
            assert_eq!(*values, indices.iter().map(|&index| fit.values()[index]).collect::<Vec<f64>>());
            let mut residuals = vec![0.0; 60];
            joint.problems()[record].evaluate(values, &mut residuals, None).unwrap();
            assert_eq!(fit.residuals()[joint.rows(record).unwrap()], residuals);
        }
    }
}

#[test]
fn blocks_change_nothing_but_rounding() {
    for is_exact in [true, false] {
        let joint = vibrations(is_exact);
        let fit = solve(&joint, &start(&joint), &Options::default()).unwrap();
        let dense = solve(&Dense(&joint), &start(&joint), &Options::default()).unwrap();
        // Both at the minimum to rounding times the condition, of some hundred; to the error of differences without
        // derivatives.
        let (large, small) = agreement(fit.values(), dense.values(), &uncertainties(&dense));
        let wanted = if is_exact { (10.0, 1e-9) } else { (8.0, 1e-6) };
        assert!(large >= wanted.0 && small <= wanted.1, "{:?} and {:?}", fit.values(), dense.values());
        let wanted = if is_exact { 11.0 } else { 8.0 };
        let agreement = digits(&uncertainties(&fit), &uncertainties(&dense));
        assert!(agreement >= wanted, "uncertainties agree to {agreement:.1} digits");
        assert_eq!((fit.rank(), fit.outcome().is_success()), (dense.rank(), dense.outcome().is_success()));
        if !is_exact {
            // A difference by an initial state costs one record of five: 2 + 10/5 instead of 12.
            let (few, many) = (fit.residual_evaluations(), dense.residual_evaluations());
            assert!(few * 2 < many, "{few} evaluations with blocks, {many} without");
        }
    }
}

/// A problem of blocks that can only be evaluated together, with a hole beyond a stiffness.
struct Together<'a>(&'a Joint<FormulaProblem<Vibration>>, Cell<usize>);

impl Residuals for Together<'_> {
    fn parameters(&self) -> &[Parameter] {
        self.0.parameters()
    }
    fn len(&self) -> usize {
        self.0.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        self.1.set(self.1.get() + 1);
        self.0.evaluate(p, residuals, None)
    }
    fn blocks(&self) -> &[Block] {
        self.0.blocks()
    }
}

#[test]
fn blocks_that_come_only_together_are_differenced_too() {
    let joint = vibrations(false);
    let apart = solve(&joint, &start(&joint), &Options::default()).unwrap();
    let together = Together(&joint, Cell::new(0));
    let fit = solve(&together, &start(&joint), &Options::default().with_jacobian_check(false)).unwrap();
    assert_eq!(fit.values(), apart.values());
    assert_eq!(together.1.get(), fit.residual_evaluations());
}

#[test]
fn a_joint_problem_joins_others_and_itself() {
    // Two and three records joined to joint problems, and these to one of five.
    let oracle = oracle();
    let problem = |record: usize| {
        let formula = Vibration { step: number(&oracle["dt"]), data: numbers(&oracle["data"][record]) };
        FormulaProblem { count: 60, formula, parameters: vibration_parameters(), is_exact: true }
    };
    let shared = ["stiffness", "damping"];
    let first = Joint::new(vec![problem(0), problem(1)], &shared).unwrap();
    let second = Joint::new(vec![problem(2), problem(3), problem(4)], &shared).unwrap();
    let nested = Joint::<&dyn Residuals>::new(vec![&first, &second], &["damping", "stiffness"]).unwrap();
    assert_eq!(nested.blocks().len(), 5);
    assert_eq!(nested.parameters()[10].name(), "displacement[3][2]");
    let flat = start(&vibrations(true));
    let start = nested.start(&[&flat[..6], &[&flat[..2], &flat[6..]].concat()[..]]).unwrap();
    let fit = solve(&nested, &start, &Options::default()).unwrap();
    let mut expected = numbers(&oracle["params"]);
    expected.swap(0, 1);
    assert!(digits(fit.values(), &expected) >= 10.0, "values {:?}", fit.values());
}

/// One residual, in parameters that a test chooses.
#[derive(Debug)]
struct Simple(Vec<Parameter>);

impl Residuals for Simple {
    fn parameters(&self) -> &[Parameter] {
        &self.0
    }
    fn len(&self) -> usize {
        3
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        residuals.iter_mut().enumerate().for_each(|(i, r)| *r = p.iter().sum::<f64>() - i as f64);
        Ok(())
    }
}

#[test]
fn problems_that_disagree_are_refused_by_name() {
    let mass = |unit: &'static str, lower, upper| {
        Parameter::new("mass", "m", unit).bounded(Bounds::new(lower, upper).unwrap())
    };
    let message = |first: &Parameter, second: &Parameter, shared: &[&str]| {
        let problems = vec![Simple(vec![first.clone()]), Simple(vec![second.clone()])];
        Joint::new(problems, shared).unwrap_err().to_string()
    };
    let kilogram = mass("kg", 0.0, 2.0);
    assert_eq!(
        message(&kilogram, &mass("g", 0.0, 2.0), &["mass"]),
        "the shared parameter mass is in kg in one problem and in g in another; give it one unit"
    );
    assert_eq!(
        message(&kilogram, &mass("kg", 3.0, 4.0), &["mass"]),
        "no value of the shared parameter mass is at least 3 and at most 2, as the problems ask"
    );
    assert_eq!(message(&kilogram, &kilogram, &["load"]), "no problem has a parameter called load to share");
    assert!(matches!(
        Joint::new(vec![Simple(vec![kilogram.clone()])], &["mass", "mass"]),
        Err(FitError::Problem { .. })
    ));
    assert!(matches!(Joint::<Simple>::new(vec![], &[]), Err(FitError::Count { .. })));

    // Bounds are cut, and a value fixed in one is fixed in all.
    for (other, expected) in [(mass("kg", 1.0, 5.0), (1.0, 2.0)), (mass("kg", 1.5, 1.5), (1.5, 1.5))] {
        let joint = Joint::new(vec![Simple(vec![kilogram.clone()]), Simple(vec![other])], &["mass"]).unwrap();
        let bounds = joint.parameters()[0].bounds();
        assert_eq!((bounds.lower(), bounds.upper()), expected);
        assert_eq!(joint.start(&[[0.1], [1.2]]).unwrap(), [0.65f64.clamp(expected.0, expected.1)]);
        assert_eq!(joint.start(&[[0.1]]).unwrap_err().to_string(), "there are 1 starts for 2 problems");
        let short = joint.start(&[vec![0.1], vec![]]).unwrap_err().to_string();
        assert_eq!(short, "the start of problem 1 has 0 values, but the problem has 1 parameters");
    }
    let joint = Joint::new(vec![Simple(vec![kilogram.clone()])], &["mass"]).unwrap();
    let two = Simple(vec![kilogram.clone(), Parameter::new("load", "N", "N")]);
    let other = solve(&two, &[1.0, 1.0], &Options::default()).unwrap();
    assert!(matches!(joint.split(&other), Err(FitError::OtherFit { .. })));
}

/// A record of 45 000 samples.
struct Long(Vibration, Vec<Parameter>);

impl Residuals for Long {
    fn parameters(&self) -> &[Parameter] {
        &self.1
    }
    fn len(&self) -> usize {
        self.0.data.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        residuals.iter_mut().enumerate().for_each(|(i, r)| *r = self.0.residual(i, p));
        if let Some(jacobian) = jacobian {
            assert_eq!(jacobian.len(), 4 * self.len(), "four columns of 45 000 samples are stored for a record");
            let p: Vec<_> = p.iter().enumerate().map(|(j, value)| fmm_model::Dual::<4>::variable(*value, j)).collect();
            for i in 0..self.len() {
                let r = self.0.residual(i, &p);
                for j in 0..4 {
                    jacobian[j * self.len() + i] = r.partial(j);
                }
            }
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}

#[test]
fn five_long_records_need_four_columns_each() {
    let truth = [190.0, 0.03];
    let record = |number: usize| {
        let velocity_at = |i: usize| velocity(i as f64 * 1e-3, truth[0], truth[1], 0.001 * number as f64, 0.1);
        let noise = |i: usize| 1e-3 * ((i * 2_654_435_761 + number) % 65_536) as f64 / 65_536.0 - 0.5e-3;
        let data = (0..45_000).map(|i| velocity_at(i) + noise(i)).collect();
        Long(Vibration { step: 1e-3, data }, vibration_parameters())
    };
    let joint = Joint::new((0..5).map(record).collect(), &["stiffness", "damping"]).unwrap();
    let start = joint.start(&[[189.9, 0.02, 0.0, 0.1]; 5]).unwrap();
    let mut minimizer = Minimizer::new(Options::default());
    assert!(minimizer.minimize(&joint, &start).unwrap().is_success());
    let fit = minimizer.fit().unwrap();
    for (value, (estimate, truth)) in fit.estimates().iter().zip(truth).map(|(e, t)| (e.value(), (e, t))) {
        let error = (value - truth) / estimate.standard_uncertainty().unwrap();
        assert!(error.abs() < 4.0, "{} is {error} standard uncertainties off", estimate.name());
    }
    let elements: usize = joint.blocks().iter().map(|block| block.rows() * block.parameters().len()).sum();
    assert_eq!((joint.len(), joint.parameters().len(), elements), (225_000, 12, 900_000));
}
