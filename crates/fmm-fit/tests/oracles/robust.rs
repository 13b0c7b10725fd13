//! Robust fits that others computed.

use fmm_fit::{BoundedLevenbergMarquardt, Loss, Options, Residuals, Robust, solve, solve_robust};
use fmm_model::Scalar;
use serde_json::Value;

use crate::harness::{Formula, FormulaProblem, digits, number, numbers, parameters};

/// A decay with offset and five gross outliers.
struct Decay {
    t: Vec<f64>,
    y: Vec<f64>,
}

impl Formula for Decay {
    fn residual<D: Scalar>(&self, i: usize, p: &[D]) -> D {
        p[0] + p[1] * (-p[2] * self.t[i]).exp() - self.y[i]
    }
}

const LOSSES: [(&str, Loss); 6] = [
    ("linear", Loss::Squares),
    ("soft_l1", Loss::SoftL1),
    ("huber", Loss::Huber),
    ("cauchy", Loss::Cauchy),
    ("arctan", Loss::Arctan),
    ("tukey", Loss::Tukey),
];

fn files() -> (Value, Value) {
    let more = serde_json::from_str(include_str!("../data/robust_more.json")).unwrap();
    (serde_json::from_str(include_str!("../data/robust.json")).unwrap(), more)
}

fn problem(file: &Value, is_exact: bool) -> FormulaProblem<Decay> {
    let formula = Decay { t: numbers(&file["t"]), y: numbers(&file["y"]) };
    FormulaProblem { count: formula.t.len(), formula, parameters: parameters(3, &Value::Null, &Value::Null), is_exact }
}

#[test]
fn all_losses_reach_their_minimum() {
    let (file, more) = files();
    let start = numbers(&file["x0"]);
    for (name, loss) in LOSSES {
        let solution = if name == "tukey" { &more["tukey"] } else { &file["solutions"][name] };
        let reference = numbers(&solution["params"]);
        for (is_exact, wanted) in [(true, 12.0), (false, 9.0)] {
            let problem = problem(&file, is_exact);
            let scale = number(&file["scale"]);
            let fit = solve_robust(&problem, &start, loss, Some(scale), &Options::default()).unwrap();
            let cost = if loss == Loss::Squares { fit.fit().sum_of_squares() / 2.0 } else { fit.cost() };
            let values = digits(fit.values(), &reference);
            let of_cost = digits(&[cost], &[number(&solution["cost"])]);
            let uncertainties: Vec<f64> = (0..3).map(|j| fit.standard_uncertainty(j).unwrap()).collect();
            let of_uncertainties = digits(&uncertainties, &numbers(&more["standard_uncertainties"][name]));
            println!(
                "{name:<8} {values:5.1} digits, cost {of_cost:5.1}, uncertainties {of_uncertainties:5.1}, {} residuals, {}",
                fit.fit().residual_evaluations(),
                fit.fit().outcome()
            );
            assert!(fit.fit().outcome().is_success());
            // The files have 16 digits; differences are good to 1e-10 and the gradient to as much.
            assert!(values > wanted && of_cost > 12.0, "{name}: {values} digits, cost {of_cost}");
            assert!(of_uncertainties > wanted - 3.0, "{name}: {of_uncertainties} digits of the uncertainties");
            // Without the help of another loss too.
            let plain = solve(&Robust::new(&problem, loss, scale).unwrap(), &start, &Options::default()).unwrap();
            assert!(digits(plain.values(), &reference) > wanted, "{name}: {:?}", plain.values());
        }
    }
}

#[test]
fn outliers_are_found_and_count_little() {
    let (file, _) = files();
    let problem = problem(&file, true);
    let start = numbers(&file["x0"]);
    for (name, loss) in LOSSES.into_iter().skip(1) {
        for scale in [Some(0.05), None] {
            let fit = solve_robust(&problem, &start, loss, scale, &Options::default()).unwrap();
            println!("{name}: {:?}, scale {}, {:?}", fit.values(), fit.scale(), fit.outliers());
            assert_eq!(fit.outliers(), [4, 11, 23, 37, 52], "{name}");
            let (out, rest): (Vec<_>, Vec<_>) =
                fit.weights().iter().enumerate().partition(|(i, _)| [4, 11, 23, 37, 52].contains(i));
            let largest = out.iter().map(|(_, weight)| **weight).fold(0.0, f64::max);
            let smallest = rest.iter().map(|(_, weight)| **weight).fold(1.0, f64::min);
            assert!(largest < 0.15 && largest < smallest, "{name}: weights up to {largest}, others from {smallest}");
            // Least squares with these weights has the same minimum: the weighted gradient vanishes.
            let mut jacobian = vec![0.0; 3 * problem.count];
            problem.evaluate(fit.values(), &mut vec![0.0; problem.count], Some(&mut jacobian)).unwrap();
            for column in jacobian.chunks(problem.count) {
                let products = column.iter().zip(fit.residuals()).zip(fit.weights()).map(|((d, r), w)| d * r * w);
                let size: f64 = products.clone().map(f64::abs).sum();
                let gradient: f64 = products.sum();
                assert!(gradient.abs() < 1e-8 * size, "{name}: gradient {gradient} of {size}");
            }
        }
    }
}

/// Every solver takes the wrapped problem.
#[test]
fn argmin_runs_robust_problems() {
    let (file, _) = files();
    let robust = Robust::new(problem(&file, true), Loss::Cauchy, number(&file["scale"])).unwrap();
    let solver = BoundedLevenbergMarquardt::new(Options::default());
    let start = numbers(&file["x0"]);
    let run = argmin::core::Executor::new(robust, solver).configure(|state| state.param(start).max_iters(200)).run();
    let fit = run.unwrap().solver.fit().unwrap();
    assert!(digits(fit.values(), &numbers(&file["solutions"]["cauchy"]["params"])) > 12.0);
}
