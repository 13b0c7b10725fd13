//! Start values of a fit of forces along motions.

use fmm_fit::{EvaluationError, Residuals};
use fmm_friction::Role;

use crate::force::ForceRecord;
use crate::force::problem::ForceProblem;
use crate::law::dimension::{Scales, is_force};
use crate::linear_algebra::inverse_of_products;

/// How much more sharply a law may bend than it typically does in a free vibration.
const SHARPNESS: [f64; 7] = [1.0, 0.1, 0.3, 3.0, 10.0, 30.0, 100.0];
/// Delays that are looked at, to either side of none.
const DELAYS: i32 = 20;
/// Share by which levels fall at most where they are set (1).
const LARGEST_FALL: f64 = 0.9;
/// Starts that are fitted, the nearest to the records first.
const MOST_STARTS: usize = 3;

/// Values to begin a fit of `problem` with, the nearest to the records first.
pub(crate) fn starts(problem: &ForceProblem<'_>) -> Result<Vec<Vec<f64>>, EvaluationError> {
    let law = problem.law();
    let mut positions = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut speed, mut load, mut count): (f64, f64, usize) = (0.0, 0.0, 0);
    for record in problem.records() {
        for position in record.positions() {
            positions = (positions.0.min(*position), positions.1.max(*position));
        }
        speed = record.velocities().iter().fold(speed, |speed, velocity| speed.max(velocity.abs()));
        load += record.loads.as_ref().map_or(record.len() as f64, |loads| loads.iter().sum());
        count += record.len();
    }
    let friction = level(problem) * count as f64 / load.max(f64::MIN_POSITIVE);
    let length = 0.5 * (positions.1 - positions.0);
    // A tenth of the force at the highest speed is viscous.
    let scales = |sharpness| Scales { length, speed, friction, damping: 0.1 * friction / speed, sharpness };
    let has_bends = law.fitted().any(|parameter| law.bends(parameter));
    let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
    for sharpness in SHARPNESS.into_iter().take(if has_bends { SHARPNESS.len() } else { 1 }) {
        let mut values: Vec<f64> = law.fitted().map(|parameter| scales(sharpness).typical(law, parameter)).collect();
        values.resize(problem.parameters().len(), 0.0);
        for (place, deflection) in problem.first_deflections() {
            values[place] = deflection;
        }
        for (value, parameter) in values.iter_mut().zip(problem.parameters()) {
            *value = parameter.bounds().clamp(*value);
        }
        found.push(levelled(problem, values)?);
    }
    let nearest = |found: &mut Vec<(f64, Vec<f64>)>| found.sort_by(|a, b| a.0.total_cmp(&b.0));
    nearest(&mut found);
    if let Some(place) = problem.delay().filter(|place| !problem.parameters()[*place].bounds().is_fixed()) {
        let longest = problem.parameters()[place].bounds().upper();
        // First over all delays, then between those that are looked at: where friction jumps, no derivative leads
        // there.
        for width in [longest, longest / f64::from(DELAYS)] {
            let best = found[0].1.clone();
            for step in (-DELAYS..=DELAYS).filter(|step| *step != 0) {
                let mut values = best.clone();
                values[place] += width * f64::from(step) / f64::from(DELAYS + 1);
                if problem.parameters()[place].bounds().contains(values[place]) {
                    found.push(levelled(problem, values)?);
                }
            }
            nearest(&mut found);
        }
    }
    found.truncate(MOST_STARTS);
    Ok(found.into_iter().map(|(_, values)| values).collect())
}

/// Half the difference between the mean forces of the two directions.
fn level(problem: &ForceProblem<'_>) -> f64 {
    let mean = |sign: f64| {
        let (mut sum, mut count) = (0.0, 0_usize);
        for record in problem.records() {
            for (force, velocity) in record.forces().iter().zip(record.velocities()) {
                if velocity * sign > record.motion.rest_speed {
                    sum += force;
                    count += 1;
                }
            }
        }
        (count > 0).then(|| sum / count as f64)
    };
    let level = match (mean(1.0), mean(-1.0)) {
        (Some(forth), Some(back)) => 0.5 * (forth - back),
        (Some(forth), None) => forth,
        (None, Some(back)) => -back,
        (None, None) => 0.0,
    };
    let all = problem.records().iter().flat_map(ForceRecord::forces);
    level.max(1e-3 * all.fold(0.0, |largest, force| force.abs().max(largest)))
}

/// The sum of squares and `values` with what the force is proportional to, all levels together, set to what fits best.
fn levelled(problem: &ForceProblem<'_>, mut values: Vec<f64>) -> Result<(f64, Vec<f64>), EvaluationError> {
    let first = problem.first_shape();
    let (residuals, mut columns) = problem.linear(&values)?;
    let is_free = |j: usize| !problem.parameters()[j].bounds().is_fixed();
    let levels: Vec<bool> = problem.law().fitted().map(|parameter| is_proportional(parameter.role())).collect();
    let is_level = |j: &usize| levels[*j] && is_free(*j);
    if !(0..first).any(|j| is_level(&j)) {
        columns[0].fill(0.0);
    }
    for (i, column) in columns.iter_mut().enumerate().skip(1) {
        if !is_free(first + i - 1) {
            column.fill(0.0);
        }
    }
    let inverse = inverse_of_products(&columns);
    let products: Vec<f64> =
        columns.iter().map(|column| column.iter().zip(&residuals).map(|(a, r)| a * r).sum()).collect();
    let step = |i: usize| -> f64 {
        inverse[i * columns.len()..][..columns.len()].iter().zip(&products).map(|(a, b)| a * b).sum()
    };
    // A level that would vanish is kept in sight.
    let steps: Vec<f64> =
        (0..columns.len()).map(|i| if i == 0 { step(i).min(LARGEST_FALL) } else { step(i) }).collect();
    for j in (0..first).filter(is_level) {
        values[j] *= 1.0 - steps[0];
    }
    for (value, step) in values[first..].iter_mut().zip(&steps[1..]) {
        *value -= step;
    }
    for (value, parameter) in values.iter_mut().zip(problem.parameters()) {
        *value = parameter.bounds().clamp(*value);
    }
    let left =
        |row: usize| residuals[row] - columns.iter().zip(&steps).map(|(column, step)| step * column[row]).sum::<f64>();
    Ok(((0..residuals.len()).map(|row| left(row).powi(2)).sum(), values))
}

/// Whether a role is proportional to friction, the viscous part included.
fn is_proportional(role: Role) -> bool {
    is_force(role) || role == Role::Slope
}
