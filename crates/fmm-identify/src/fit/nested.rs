//! Starts of a fit at the end of one by a special case of the law.

use crate::fit::forces::typical;
use crate::problem::Problem;
use crate::problem::starts::Fitted;

/// Starts for a `problem` of forces where the fit of a `special` case of its law has ended: all that both have is as it
/// was found, and the rest as it typically is, or zero.
pub(crate) fn nested_starts(problem: &Problem<'_>, special: &Fitted) -> Vec<Vec<f64>> {
    let typical = problem.forces().map_or_else(Vec::new, |forces| typical(&forces));
    typical.iter().map(|start| problem.nested(special, start)).collect()
}

#[cfg(test)]
mod tests {
    use fmm_fit::Residuals;

    use super::*;
    use crate::candidate::Candidate;
    use crate::experiment::force::ForceRecord;
    use crate::judgement::Inquiry;
    use crate::machine::Machine;

    /// A general law begins at the sum of squares with which its special case ended.
    #[test]
    fn a_general_law_begins_where_its_special_case_ended() {
        let times: Vec<f64> = (0..600).map(|i| 0.01 * f64::from(i)).collect();
        let of = |value: &dyn Fn(f64) -> f64| -> Vec<f64> { times.iter().map(|time| value(*time)).collect() };
        let velocities = of(&|t| 0.06 * (3.0 * t).cos());
        let forces = of(&|t| {
            let v = 0.06 * (3.0 * t).cos();
            v.signum() * (3.0 + (-v.abs() / 0.02).exp()) + 20.0 * v + 0.05 * (1e4 * t * t).sin()
        });
        let record = [ForceRecord::of_positions(&times, &of(&|t| 0.02 * (3.0 * t).sin()), &forces)
            .and_then(|record| record.with_velocities(&velocities))
            .unwrap()];
        for (special, general) in [
            ("coulomb", "coulomb + linear"),
            ("coulomb + linear", "coulomb + linear + zero + asymmetry"),
            ("coulomb_viscous", "stribeck"),
            ("coulomb + linear", "berger + linear"),
            ("dahl", "dahl + linear + zero"),
        ] {
            let [special, general] = [special, general].map(|name| Candidate::named(name).unwrap());
            let found = Inquiry::of(&Machine::per_unit_mass(), &record).candidate(&special).unwrap();
            let problem = Problem::of(&general, Machine::per_unit_mass(), &record).unwrap();
            let mut residuals = vec![0.0; problem.len()];
            let mut sum = |start: &Vec<f64>| {
                problem.evaluate(start, &mut residuals, None).unwrap();
                residuals.iter().map(|residual| residual * residual).sum::<f64>()
            };
            let least = nested_starts(&problem, &found.fitted).iter().map(&mut sum).fold(f64::INFINITY, f64::min);
            let ratio = least / found.fit().sum_of_squares();
            assert!((ratio - 1.0).abs() < 1e-9, "{} in {}: {ratio}", special.name(), general.name());
        }
    }
}
