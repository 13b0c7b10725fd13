//! The thesis' Table 3: what mass, stiffness and damping do to a fitted coefficient of friction.

use fmm_fit::{Minimizer, Options, Refit, Residuals, Sensitivity, WithFixed, solve};
use fmm_friction::{Berger, Coulomb, LawFamily};
use fmm_identify::Problem;
use fmm_model::{Bounds, Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, RungeKutta, Sampling, Scenario, Thesis};
use fmm_uq::{Input, Inputs, MonteCarlo};

const LOAD: f64 = 7.2;
/// Value and printed standard uncertainty of mass (kg), stiffness (N/m) and damping (N s/m).
const MACHINE: [(&str, f64, f64); 3] =
    [("mass", 10.391, 0.0049), ("stiffness", 1982.0, 1.3), ("damping", 0.275, 0.0341)];
/// u(μ) of each row, from 256-bit derivatives of the fit and the printed uncertainties; the last row is all three.
const EXACT: [f64; 4] = [6.752e-5, 5.732e-6, 2.3764e-4, 2.4712e-4];

fn problem(engine: &impl Engine<f64, Coulomb>) -> Problem<'static> {
    let [mass, stiffness, damping] = MACHINE.map(|(_, value, _)| value);
    let machine = Oscillator::new(mass, stiffness).unwrap().with_damping(Damping::linear(damping).unwrap());
    let scenario = Scenario::new(machine, Coulomb::new(0.15).unwrap(), LOAD).unwrap().starting_at(0.0, 0.101).unwrap();
    let motion = engine.run(&scenario, &Sampling::uniform(1e-3, 1501).unwrap()).unwrap();
    let record = Record::new(0.0, 1e-3, motion.velocity().values().to_vec(), Quantity::Velocity, "m/s").unwrap();
    let mut values = MACHINE.map(|(name, value, _)| (name, value)).to_vec();
    values.extend([("normal_load", LOAD), ("coefficient", 0.15)]);
    values.extend([("initial_position", 1e-4), ("initial_velocity", 0.101)]);
    let problem = Problem::declared::<Coulomb>(&record, &values).unwrap();
    let problem = problem.free_within("coefficient", Bounds::new(0.1, 1.0).unwrap()).unwrap();
    problem.free_within("initial_position", Bounds::new(-3e-3, 3e-3).unwrap()).unwrap()
}

/// The fit prepared for other masses, stiffnesses and dampings.
fn refit<'a>(problem: &'a Problem<'static>) -> Refit<'a, Problem<'static>> {
    let fit = solve(problem, problem.values(), &Options::default()).unwrap();
    Refit::prepare(problem, &fit).unwrap().varying(&MACHINE.map(|(name, ..)| name)).unwrap()
}

fn inputs(row: usize) -> Inputs {
    let input = |(index, (name, value, u)): (usize, (&str, f64, f64))| {
        Input::new(name, value, if row == 3 || row == index { u } else { 0.0 }, "SI").unwrap()
    };
    Inputs::new(MACHINE.into_iter().enumerate().map(input)).unwrap()
}

#[test]
fn sensitivities_are_the_corrected_ones_and_obey_the_scale_identity() {
    let problem = problem(&Exact);
    let fit = solve(&problem, problem.values(), &Options::default()).unwrap();
    let sensitivity = Sensitivity::of(&problem, &fit).unwrap();
    let by = |input| sensitivity.coefficient_of("coefficient", input).unwrap();
    // Printed in the reference with four or five digits, so within half of the last one: 1.14e-4 of 4.409.
    for (input, expected) in [("mass", 0.013_779), ("stiffness", 4.409e-6), ("damping", -6.969e-3)] {
        assert!((by(input) / expected - 1.0).abs() < 1.14e-4, "{input}: {}", by(input));
    }
    let identity: f64 = MACHINE.iter().map(|(name, value, _)| value * by(name)).sum();
    // Derivatives by the implicit function theorem hold eight digits.
    assert!((identity - 0.15).abs() < 2e-9, "{identity}");
    assert!((LOAD * by("normal_load") + 0.15).abs() < 2e-9);
}

#[test]
fn refits_have_the_uncertainties_of_the_reference() {
    let problem = problem(&Exact);
    let refit = refit(&problem);
    let trials = 20_000;
    for (row, exact) in EXACT.into_iter().enumerate() {
        let run = MonteCarlo::new(&inputs(row), trials).unwrap().with_seed(1);
        let sample = run.run(|x| refit.estimates(x)).unwrap();
        let u = sample.standard_uncertainty(0).unwrap();
        // The standard error of a standard deviation is u/√(2 M); five of them, and half a percent for what is not
        // linear.
        let tolerance = exact * (5.0 / (2.0 * trials as f64).sqrt() + 0.005);
        assert!((u - exact).abs() < tolerance, "row {row}: {u:e} instead of {exact:e}");
        assert!((sample.estimate(0).unwrap() - 0.15).abs() < 5.0 * exact / (trials as f64).sqrt() + 1e-6);
    }
}

#[test]
fn a_refit_ends_where_a_fit_does_whoever_asked_before() {
    let problem = problem(&Exact);
    let refit = refit(&problem);
    // Up to ten standard uncertainties away.
    let away =
        |i: usize| MACHINE.map(|(_, value, u)| value + u * 10.0 * ((i as f64 * 0.618_034 * value).fract() - 0.5));
    let first: Vec<Vec<f64>> = (0..40).map(|i| refit.estimates(&away(i)).unwrap()).collect();
    for (i, estimates) in first.iter().enumerate().rev() {
        assert_eq!(&refit.estimates(&away(i)).unwrap(), estimates, "refit {i} depends on the others");
        let held = WithFixed::new(&problem, away(i).into_iter().enumerate()).unwrap();
        let mut start = problem.values().to_vec();
        start[..3].copy_from_slice(&away(i));
        let mut minimizer = Minimizer::new(Options::default());
        assert!(minimizer.minimize(&held, &start).unwrap().is_success());
        let places = ["coefficient", "initial_position"]
            .map(|name| problem.parameters().iter().position(|parameter| parameter.name() == name).unwrap());
        // Of a coefficient of 0.15 and a position of some 0.1 mm.
        for ((value, place), tolerance) in estimates.iter().zip(places).zip([1e-9, 1e-11]) {
            let expected = minimizer.values()[place];
            assert!((value - expected).abs() < tolerance, "refit {i}: {value} instead of {expected}");
        }
    }
    let unknown = Refit::prepare(&problem, &solve(&problem, problem.values(), &Options::default()).unwrap()).unwrap();
    let error = unknown.varying(&["mass", "coefficient"]).unwrap_err().to_string();
    assert!(
        error.starts_with("\"coefficient\" was not fixed in the fit; the fixed parameters are: mass, stiffness,"),
        "{error}"
    );
    assert!(refit.estimates(&[1.0]).is_err());
    assert!(refit.estimates(&[f64::NAN, 1982.0, 0.275]).is_err());
    assert!(refit.estimates(&[-10.0, 1982.0, 0.275]).is_err());
}

#[test]
fn the_thesis_motion_is_refitted_without_derivatives() {
    let problem = problem(&Thesis::A3).by_thesis::<Coulomb>();
    let fit = solve(&problem, problem.values(), &Options::default()).unwrap();
    assert!(!fit.has_exact_jacobian());
    // From its start the thesis ends within 1e-4 of the truth: the sum of squares jumps.
    assert!((fit.estimate("coefficient").unwrap().value() - 0.15).abs() < 1e-4);
}

#[test]
fn what_a_problem_cannot_have_is_said() {
    let record = Record::new(0.0, 1e-3, vec![0.0; 100], Quantity::Velocity, "m/s").unwrap();
    let problem = |values: &[(&str, f64)]| Problem::declared::<Coulomb>(&record, values).map_err(|e| e.to_string());
    let complete = [("mass", 1.0), ("stiffness", 100.0), ("coefficient", 0.1)];
    assert!(problem(&complete).is_ok());
    assert_eq!(problem(&complete[..2]).unwrap_err(), "coefficient must be given a value");
    let wrong = |name, value| problem(&[complete.as_slice(), &[(name, value)]].concat()).unwrap_err();
    assert!(wrong("weight", 1.0).contains("no parameter called \"weight\""));
    assert!(wrong("mass", -1.0).contains("mass cannot be held at -1"));
    assert!(wrong("damping", f64::NAN).contains("damping"));
    assert!(problem(&complete).unwrap().free("friction").is_err());
    assert!(problem(&complete).unwrap().free_within("mass", Bounds::new(2.0, 3.0).unwrap()).is_err());
    let force = Record::new(0.0, 1e-3, vec![0.0; 100], Quantity::Force, "N").unwrap();
    assert!(Problem::declared::<Coulomb>(&force, &complete).is_err());
}

/// Refits of the Berger law: foreseen or not they end at the same place, and a coarser motion moves them by far less
/// than the machine's uncertainty does.
#[test]
fn berger_refits_are_the_same_foreseen_and_coarser() {
    let law = [("coefficient", 0.228), ("excess_coefficient", 0.261), ("decay", 2.852)];
    let machine = [("mass", 10.391), ("stiffness", 1982.0), ("damping", 0.275), ("normal_load", 14.0)];
    let values = [law.as_slice(), &machine, &[("initial_position", 0.016)]].concat();
    let sampling = Sampling::uniform(1e-3, 1501).unwrap();
    let oscillator = Oscillator::new(10.391, 1982.0).unwrap().with_damping(Damping::linear(0.275).unwrap());
    let scenario = Scenario::new(oscillator, Berger::at(&law.map(|(_, value)| value)).unwrap(), 14.0).unwrap();
    let motion = RungeKutta::default().run(&scenario.starting_at(0.016, 0.0).unwrap(), &sampling).unwrap();
    let record = Record::new(0.0, 1e-3, motion.velocity().values().to_vec(), Quantity::Velocity, "m/s").unwrap();
    let problem = || {
        let free = ["coefficient", "excess_coefficient", "decay", "initial_position"];
        let problem = Problem::declared::<Berger>(&record, &values).unwrap();
        free.iter().fold(problem, |problem, name| problem.free(name).unwrap())
    };
    let estimates = |problem: Problem<'static>, expecting: bool| {
        let fit = solve(&problem, problem.values(), &Options::default()).unwrap();
        let refit = Refit::prepare(&problem, &fit).unwrap().varying(&["mass", "damping"]).unwrap();
        let refit = if expecting { refit.expecting(&[0.0049, 0.0341]).unwrap() } else { refit };
        [[10.395, 0.30], [10.380, 0.24]].map(|machine| refit.estimates(&machine).unwrap())
    };
    let plain = estimates(problem(), false);
    // What mass and damping make of each estimate.
    let uncertainties = [0.042, 0.040, 0.54, 1.3e-5];
    for (name, others, most) in [
        ("foreseen", estimates(problem(), true), 1e-5),
        ("coarser", estimates(problem().with_tolerance(1e-9).unwrap(), true), 3e-5),
    ] {
        for (other, plain) in others.iter().zip(&plain) {
            for ((other, plain), u) in other.iter().zip(plain).zip(uncertainties) {
                assert!((other - plain).abs() < most * u, "{name}: {other}, not {plain}");
            }
        }
    }
    for tolerance in [0.0, 0.1, f64::NAN] {
        assert!(problem().with_tolerance(tolerance).is_err(), "{tolerance}");
    }
}
