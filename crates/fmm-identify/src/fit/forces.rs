//! Fit of forces along motions: start values, and the best end of the fits from them.

use fmm_fit::{EvaluationError, Fit, Options, Outcome, solve_observed};
use fmm_friction::Role;

use crate::error::IdentifyError;
use crate::experiment::force::ForceRecord;
use crate::experiment::force::direction::mean_friction;
use crate::fit::stages::{Begin, Observer, lowest};
use crate::law::dimension::{Scales, is_force};
use crate::linear_algebra::Span;
use crate::problem::Problem;
use crate::problem::force::ForceProblem;
use crate::problem::starts::Fitted;
use crate::residuals::structure::ResidualStructure;

/// Sharpness of the bends of a law over the typical one in a free vibration (1).
const SHARPNESS: [f64; 7] = [1.0, 0.1, 0.3, 3.0, 10.0, 30.0, 100.0];
/// Delays that are looked at, to either side of none.
const DELAYS: i32 = 20;
/// Share by which levels fall at most where they are set (1).
const LARGEST_FALL: f64 = 0.9;
/// Starts that are fitted, the nearest to the records first.
const MOST_STARTS: usize = 3;

/// Iterations after which a fit that has not ended creeps.
const MOST_ITERATIONS: usize = 100;

/// The best fit of a `problem` of these `forces`, begun where the records say or at the starts that `begin` has. A fit
/// that leaves only noise ends the search; one that cannot begin leaves the others.
pub(crate) fn fit_forces(
    problem: &Problem<'_>,
    forces: &ForceProblem<'_>,
    begin: Begin<'_>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, IdentifyError> {
    let (law, records) = (forces.law(), forces.records());
    let options = options.clone().with_max_iterations(options.max_iterations().min(MOST_ITERATIONS));
    let starts = if let Begin::From(starts) = begin {
        lowest(problem, starts(problem), MOST_STARTS)
    } else {
        let beginnings: Option<Vec<ForceRecord>> = records.iter().map(ForceRecord::beginning).collect();
        let begun = match &beginnings {
            Some(beginnings) => Some(Problem::of(&problem.candidate(), problem.machine, beginnings)?),
            None => None,
        };
        let begun = begun.as_ref().unwrap_or(problem);
        let found = begun.forces().map_or_else(|| Ok(Vec::new()), |forces| starts(&forces));
        found.map_err(|error| IdentifyError::simulation(law.name, error))?
    };
    let (mut best, mut failure): (Option<Fit>, _) = (None, None);
    for start in starts {
        let fit = match solve_observed(problem, &start, &options, |progress| observer(progress)) {
            Ok(fit) => fit,
            Err(source) => {
                failure = Some(IdentifyError::Fit { law: law.name, source });
                continue;
            }
        };
        let is_noise = !ResidualStructure::of(&fit, records).is_structured();
        let is_cancelled = fit.outcome() == Outcome::Cancelled;
        if best.as_ref().is_none_or(|best| fit.sum_of_squares() < best.sum_of_squares()) {
            best = Some(fit);
        }
        if is_cancelled || is_noise && best.as_ref().is_some_and(|best| best.outcome().is_success()) {
            break;
        }
    }
    let nothing = || IdentifyError::missing("a model without a parameter cannot be fitted");
    best.ok_or_else(|| failure.unwrap_or_else(nothing))
}

/// Values that the law of `forces` typically has in such records, its bends at each of several places.
fn typical(forces: &ForceProblem<'_>) -> Vec<Vec<f64>> {
    let law = forces.law();
    let mut positions = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut speed, mut load, mut count): (f64, f64, usize) = (0.0, 0.0, 0);
    for record in forces.records() {
        for position in record.positions() {
            positions = (positions.0.min(*position), positions.1.max(*position));
        }
        speed = record.velocities().iter().fold(speed, |speed, velocity| speed.max(velocity.abs()));
        load += record.loads.as_ref().map_or(record.len() as f64, |loads| loads.iter().sum());
        count += record.len();
    }
    let friction = level(forces) * count as f64 / load.max(f64::MIN_POSITIVE);
    let length = 0.5 * (positions.1 - positions.0);
    // A tenth of the force at the highest speed is viscous.
    let scales = |sharpness| Scales { length, speed, friction, damping: 0.1 * friction / speed, sharpness };
    let has_bends = law.fitted().any(|parameter| law.bends(parameter));
    let sharpnesses = SHARPNESS.into_iter().take(if has_bends { SHARPNESS.len() } else { 1 });
    let of_sharpness = |sharpness| {
        let mut values: Vec<f64> = law.fitted().map(|parameter| scales(sharpness).typical(law, parameter)).collect();
        values.resize(forces.parameters.len(), 0.0);
        for (place, deflection) in forces.first_deflections() {
            values[place] = deflection;
        }
        for (value, parameter) in values.iter_mut().zip(forces.parameters) {
            *value = parameter.bounds().clamp(*value);
        }
        values
    };
    sharpnesses.map(of_sharpness).collect()
}

/// Starts for a `problem` of forces where the fit of a `special` case of its law has ended: all that both have is as it
/// was found, and the rest as it typically is, or zero.
pub(crate) fn nested_starts(problem: &Problem<'_>, special: &Fitted) -> Vec<Vec<f64>> {
    let typical = problem.forces().map_or_else(Vec::new, |forces| typical(&forces));
    typical.iter().map(|start| problem.nested(special, start)).collect()
}

/// Values to begin a fit of `forces` with, the nearest to the records first. Those at which the law has no value are
/// left out, unless there are no others.
fn starts(forces: &ForceProblem<'_>) -> Result<Vec<Vec<f64>>, EvaluationError> {
    let mut failure = None;
    let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
    for values in typical(forces) {
        match levelled(forces, values) {
            Ok(start) => found.push(start),
            Err(error) => failure = Some(error),
        }
    }
    if let (true, Some(error)) = (found.is_empty(), failure) {
        return Err(error);
    }
    let nearest = |found: &mut Vec<(f64, Vec<f64>)>| found.sort_by(|a, b| a.0.total_cmp(&b.0));
    nearest(&mut found);
    if let Some(place) = forces.forces.delay.filter(|place| !forces.parameters[*place].bounds().is_fixed()) {
        let longest = forces.parameters[place].bounds().upper();
        // First over all delays, then between those that are looked at: where friction jumps, no derivative leads
        // there.
        for width in [longest, longest / f64::from(DELAYS)] {
            let best = found[0].1.clone();
            for step in (-DELAYS..=DELAYS).filter(|step| *step != 0) {
                let mut values = best.clone();
                values[place] += width * f64::from(step) / f64::from(DELAYS + 1);
                if forces.parameters[place].bounds().contains(values[place]) {
                    found.extend(levelled(forces, values));
                }
            }
            nearest(&mut found);
        }
    }
    found.truncate(MOST_STARTS);
    Ok(found.into_iter().map(|(_, values)| values).collect())
}

/// Friction in the mean of the way, of a size that counts beside the largest force.
fn level(forces: &ForceProblem<'_>) -> f64 {
    let all = forces.records().iter().flat_map(ForceRecord::forces);
    let least = 1e-3 * all.fold(0.0, |largest, force| force.abs().max(largest));
    mean_friction(forces.records()).unwrap_or(0.0).max(least)
}

/// The sum of squares, and `values` with all levels by one factor and the shapes set to the best fit.
fn levelled(forces: &ForceProblem<'_>, mut values: Vec<f64>) -> Result<(f64, Vec<f64>), EvaluationError> {
    let first = forces.forces.first_shape;
    let (residuals, mut columns) = forces.linear(&values)?;
    let is_free = |j: usize| !forces.parameters[j].bounds().is_fixed();
    let levels: Vec<bool> = forces.law().fitted().map(|parameter| is_proportional(parameter.role())).collect();
    let is_level = |j: &usize| levels[*j] && is_free(*j);
    if !(0..first).any(|j| is_level(&j)) {
        columns[0].fill(0.0);
    }
    for (i, column) in columns.iter_mut().enumerate().skip(1) {
        if !is_free(first + i - 1) {
            column.fill(0.0);
        }
    }
    let span = Span::of(columns);
    let mut steps = span.steps(&residuals);
    // A level that would vanish is kept in sight.
    steps[0] = steps[0].min(LARGEST_FALL);
    for j in (0..first).filter(is_level) {
        values[j] *= 1.0 - steps[0];
    }
    for (value, step) in values[first..].iter_mut().zip(&steps[1..]) {
        *value -= step;
    }
    for (value, parameter) in values.iter_mut().zip(forces.parameters) {
        *value = parameter.bounds().clamp(*value);
    }
    let left = |row: usize| {
        residuals[row] - span.columns.iter().zip(&steps).map(|(column, step)| step * column[row]).sum::<f64>()
    };
    Ok(((0..residuals.len()).map(|row| left(row).powi(2)).sum(), values))
}

/// True for a role that is proportional to friction, the viscous part included.
fn is_proportional(role: Role) -> bool {
    is_force(role) || role == Role::Slope
}

#[cfg(test)]
mod tests {
    use fmm_fit::Residuals;

    use super::*;
    use crate::candidate::Candidate;
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
