//! Linear response of a ring-down to a change of its friction: by it a law is tried without simulating its motion.

use fmm_fit::{EvaluationError, Options, Residuals, solve};
use fmm_model::{Parameter, Restoring};
use fmm_record::Quantity;
use fmm_sim::{Channels, Sampling, Trajectory};

use crate::law::along::{Alignment, MeasuredMotion, SampleLocation, locations};
use crate::linear_algebra::Span;
use crate::machine::term::Term;
use crate::problem::Problem;
use crate::threads::on_all_threads;

/// Samples of a period that are enough to follow friction along it.
const SAMPLES_PER_SWING: f64 = 64.0;
/// A fit to the response only has to come near: the response itself is so good.
const ENOUGH: f64 = 1e-4;
const MOST_ITERATIONS: usize = 40;

/// Response of a record to another law, to first order about a motion by Coulomb and viscous friction.
///
/// ```text
/// δx″ + (c/m) δx′ + ω₀² δx = −δF/m,    δx′ times (ω₀²|x| − F/m)/(ω₀²|x| + F/m) at each turning point
/// ```
///
/// δF is the friction of the other law along the known motion less that of the simple one. Oscillator, initial state
/// and offset follow by their own derivatives.
pub(crate) struct Response<'a> {
    /// Friction of the other law.
    problem: &'a Problem<'a>,
    motion: MeasuredMotion,
    locations: Vec<SampleLocation>,
    /// F/m of the simple law along the motion.
    friction: Vec<f64>,
    /// Factor of δx′ at the end of each step (1).
    turns: Vec<f64>,
    /// Transition of the state over a step, and by a constant force.
    step: [[f64; 2]; 2],
    by_force: [f64; 2],
    /// ω₀² (1/s²) and c/m (1/s).
    stiffness: f64,
    damping: f64,
    /// Samples of the motion that are compared, and their residuals by the simple law.
    rows: Vec<usize>,
    residuals: Vec<f64>,
    /// Places of what is beside the law among the parameters of the simple fit, and the derivatives by it.
    beside: Vec<usize>,
    span: Span,
    /// Parameters of the simple fit.
    values: Vec<f64>,
}

impl<'a> Response<'a> {
    /// True if there is one: of one free vibration on a linear spring under a constant load.
    pub(crate) fn exists(problem: &Problem<'_>) -> bool {
        let [decay] = problem.experiments() else { return false };
        problem.table.oscillator == 1
            && problem.machine.restoring() == Restoring::Linear
            && !problem.has_spring()
            && ![Term::Change, Term::Position].into_iter().any(|term| problem.table.terms.has(term))
            && decay.drive().is_none()
            && decay.first_corner().is_none()
            && decay.record().is_equally_spaced()
            && decay.load_factor() == 1.0
    }

    /// Response of the record of `problem` about the fit of `simple`, by Coulomb and viscous friction, with these
    /// `values`; `None` where none [exists](Self::exists), or the motion is too short.
    pub(crate) fn of(problem: &'a Problem<'a>, simple: &Problem<'_>, values: &[f64]) -> Option<Self> {
        let decay = problem.experiments().first().filter(|_| Self::exists(problem))?;
        let record = decay.record();
        let interval = record.interval();
        let stride = ((values[0] * interval * SAMPLES_PER_SWING).recip() as usize).max(1);
        let count = record.len().div_ceil(stride);
        let sampling = Sampling::uniform(stride as f64 * interval, count).ok()?.keeping(Channels::All);
        let mut trajectory = Trajectory::new();
        simple.trace(values, &sampling, &mut trajectory).ok()?;
        let end =
            trajectory.rest().map_or(count, |rest| (rest.time / (stride as f64 * interval)) as usize + 1).min(count);
        let series = |samples: &[f64]| samples[..end].to_vec();
        let motion = MeasuredMotion {
            times: (0..end).map(|i| i as f64 * stride as f64 * interval).collect(),
            positions: series(trajectory.position().values()),
            velocities: series(trajectory.velocity().values()),
            accelerations: series(trajectory.acceleration().values()),
            rest_speed: 0.0,
        };
        if end < 3 {
            return None;
        }
        let (level, damping) = (values[1], values[2]);
        let stiffness = (2.0 * std::f64::consts::PI * values[0]).powi(2);
        let friction = motion.velocities.iter().map(|v| level * sign(*v) + damping * v).collect();
        let turn = |pair: (&[f64], &f64)| {
            let (velocities, position) = pair;
            let force = stiffness * position.abs();
            if velocities[0] * velocities[1] < 0.0 { ((force - level) / (force + level)).max(0.0) } else { 1.0 }
        };
        let turns = motion.velocities.windows(2).zip(&motion.positions).map(turn).collect();
        let (step, by_force) = transition(stiffness, damping, stride as f64 * interval);

        let first = simple.table.shared;
        let beside: Vec<usize> = std::iter::once(0).chain(first..values.len()).collect();
        let whole = simple.columns(values, &beside).ok()?;
        let mut left = vec![0.0; simple.len()];
        simple.evaluate(values, &mut left, None).ok()?;
        let kept = decay.kept().iter().cloned().flatten().enumerate();
        let compared: Vec<(usize, usize)> =
            kept.filter(|(_, sample)| sample % stride == 0 && sample / stride < end).collect();
        let thinned = |column: &Vec<f64>| compared.iter().map(|(row, _)| column[*row]).collect::<Vec<_>>();
        let mut places_of = Vec::new();
        locations(&motion, 0..end, 0.0, &mut places_of);
        Some(Self {
            problem,
            motion,
            locations: places_of,
            friction,
            turns,
            step,
            by_force,
            stiffness,
            damping,
            rows: compared.iter().map(|(_, sample)| sample / stride).collect(),
            residuals: thinned(&left),
            beside,
            span: Span::of(whole.iter().map(thinned).collect()),
            values: values.to_vec(),
        })
    }

    /// The ends of the fits to the response from `starts`, the best first, for a fit to the record itself.
    pub(crate) fn followed(&self, starts: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let options = Options::default()
            .with_max_iterations(MOST_ITERATIONS)
            .with_cost_tolerance(ENOUGH)
            .with_polish_steps(0)
            .with_restarts(0)
            .with_jacobian_check(false);
        let layout = &self.problem.table;
        let of_law = layout.oscillator..layout.shared;
        let fits = on_all_threads(starts.iter().collect(), |start| solve(self, &start[of_law.clone()], &options).ok());
        let mut ends: Vec<(f64, Vec<f64>)> = Vec::with_capacity(starts.len());
        for fit in fits.into_iter().flatten() {
            let square = fit.sum_of_squares();
            if ends.iter().any(|(other, _)| (square - other).abs() <= ENOUGH * other) {
                continue;
            }
            if let Some(end) = self.with_rest(fit.values()) {
                ends.push((square, end));
            }
        }
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.into_iter().map(|(_, values)| values).collect()
    }

    /// The values of a fit to the record, of which damping and law have these values.
    fn with_rest(&self, of_law: &[f64]) -> Option<Vec<f64>> {
        let changed = self.changed(of_law).ok()?;
        let steps = self.span.steps(&changed);
        let moved = |place: usize| {
            let step = self.beside.iter().position(|beside| *beside == place).map_or(0.0, |at| steps[at]);
            self.values[place] - step
        };
        let own = self.beside[1..].iter().map(|place| moved(*place));
        let values: Vec<f64> = std::iter::once(moved(0)).chain(of_law.iter().copied()).chain(own).collect();
        let bounded = values.iter().zip(self.problem.parameters());
        Some(bounded.map(|(value, parameter)| parameter.bounds().clamp(*value)).collect())
    }

    /// Residuals that the record is expected to have, what is beside the law unchanged.
    fn changed(&self, of_law: &[f64]) -> Result<Vec<f64>, EvaluationError> {
        let layout = &self.problem.table;
        let law = &layout.family;
        let alignment = Alignment {
            motion: &self.motion,
            delay: 0.0,
            has_delay: false,
            deflection: 0.0,
            first: 0,
            locations: &self.locations,
        };
        let mut friction = Vec::with_capacity(self.friction.len());
        law.members.along(&law.values(&of_law[layout.law - layout.oscillator..]), alignment, &mut friction)?;
        let terms = &layout.terms;
        let beside = |term: Term| terms.place(term).map_or(0.0, |place| of_law[place]);
        let [linear, quadratic, cubic, power, exponent] =
            [Term::LinearDamping, Term::QuadraticDamping, Term::CubicDamping, Term::PowerDamping, Term::PowerExponent]
                .map(beside);
        let mut rows = self.rows.iter().zip(&self.residuals).peekable();
        let mut residuals = Vec::with_capacity(self.rows.len());
        let mut state = [0.0, 0.0];
        for (sample, velocity) in self.motion.velocities.iter().enumerate() {
            let speed = velocity.abs();
            let damping = (linear + (quadratic + cubic * speed) * speed) * velocity;
            let damping = if power > 0.0 { damping + power * speed.powf(exponent) * sign(*velocity) } else { damping };
            let change = friction[sample] + damping - self.friction[sample];
            while let Some((_, residual)) = rows.next_if(|(row, _)| **row == sample) {
                residuals.push(residual + self.seen(state, change));
            }
            let [x, v] = state;
            let moved = |i: usize| self.step[i][0] * x + self.step[i][1] * v - self.by_force[i] * change;
            state = [moved(0), moved(1)];
            if let Some(turn) = self.turns.get(sample) {
                state[1] *= turn;
            }
        }
        Ok(residuals)
    }

    /// Change of the record by a change of the state and of the friction per mass.
    fn seen(&self, state: [f64; 2], change: f64) -> f64 {
        match self.problem.experiments()[0].record().quantity() {
            Quantity::Displacement => state[0],
            Quantity::Acceleration => -self.stiffness * state[0] - self.damping * state[1] - change,
            _ => state[1],
        }
    }
}

impl Residuals for Response<'_> {
    fn parameters(&self) -> &[Parameter] {
        let layout = &self.problem.table;
        &self.problem.parameters()[layout.oscillator..layout.shared]
    }

    fn len(&self) -> usize {
        self.rows.len()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        residuals.copy_from_slice(&self.changed(p)?);
        self.span.take_out(residuals);
        Ok(())
    }
}

fn sign(velocity: f64) -> f64 {
    if velocity == 0.0 { 0.0 } else { velocity.signum() }
}

/// Transition of position and velocity of a damped vibration over a time (ω₀² and c/m given), and of a constant
/// acceleration of one.
fn transition(stiffness: f64, damping: f64, time: f64) -> ([[f64; 2]; 2], [f64; 2]) {
    let decay = 0.5 * damping;
    let angular = (stiffness - decay * decay).max(1e-12 * stiffness).sqrt();
    let (sin, cos) = (angular * time).sin_cos();
    let (kept, ratio) = ((-decay * time).exp(), decay / angular);
    let step = [
        [kept * (cos + ratio * sin), kept * sin / angular],
        [-kept * stiffness * sin / angular, kept * (cos - ratio * sin)],
    ];
    (step, [(1.0 - step[0][0]) / stiffness, step[0][1]])
}

#[cfg(test)]
mod tests {
    use fmm_friction::CoulombViscous;
    use fmm_model::Oscillator;
    use fmm_record::Record;
    use fmm_sim::{Scenario, simulate_into};

    use super::*;
    use crate::candidate::Candidate;
    use crate::experiment::{Experiment, Preparation};
    use crate::machine::Machine;

    /// Level and damping of [`CoulombViscous`] per unit mass.
    const TRUTH: [f64; 2] = [0.3, 0.1];

    /// Difference of the response to a change of each value of the law from the derivatives of the simulated
    /// motion, as a share of these (1), in a record of this `quantity`.
    fn differences(quantity: Quantity, unit: &str) -> [f64; 2] {
        let law = CoulombViscous::new(TRUTH[0], TRUTH[1]).unwrap();
        let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
        let mut motion = Trajectory::new();
        let sampling = Sampling::uniform(1e-3, 2000).unwrap();
        simulate_into::<CoulombViscous<f64>, _>(
            &scenario.starting_at(0.03, 0.0).unwrap(),
            &sampling,
            None,
            &mut motion,
        )
        .unwrap();
        let channel = if quantity == Quantity::Velocity { motion.velocity() } else { motion.position() };
        let record = Record::new(0.0, 1e-3, channel.values().to_vec(), quantity, unit).unwrap();
        let decays = [Experiment::ring_down(&record, &Preparation::default()).unwrap()];
        let problem = Problem::of(&Candidate::of::<CoulombViscous>(), Machine::per_unit_mass(), &decays).unwrap();
        let values: Vec<f64> = [2.0, TRUTH[0], TRUTH[1], 0.03].into_iter().chain([0.0; 2]).collect();
        let response = Response::of(&problem, &problem, &values).unwrap();
        let same = response.changed(&TRUTH).unwrap();
        let exact = problem.columns(&values, &[1, 2]).unwrap();
        let kept = decays[0].kept().iter().cloned().flatten();
        let place: Vec<usize> = {
            let all: Vec<usize> = kept.collect();
            let stride = response.motion.times[1] / 1e-3;
            let sample = |row: &usize| (*row as f64 * stride).round() as usize;
            response.rows.iter().map(|row| all.binary_search(&sample(row)).unwrap()).collect()
        };
        [0, 1].map(|index| {
            let mut values = TRUTH;
            values[index] += 1.0;
            let changed = response.changed(&values).unwrap();
            let (mut difference, mut whole) = (0.0, 0.0);
            for ((changed, same), place) in changed.iter().zip(&same).zip(&place) {
                difference += (changed - same - exact[index][*place]).powi(2);
                whole += exact[index][*place].powi(2);
            }
            (difference / whole).sqrt()
        })
    }

    /// Friction is held from one sample to the next, of which a swing has at least 64: what it does comes less than a
    /// 64th of a swing late, which is a phase of 2π/64.
    #[test]
    fn the_response_is_the_derivative_of_the_motion() {
        let most = std::f64::consts::TAU / SAMPLES_PER_SWING;
        for (quantity, unit) in [(Quantity::Velocity, "m/s"), (Quantity::Displacement, "m")] {
            let found = differences(quantity, unit);
            assert!(found.iter().all(|difference| *difference < most), "{quantity:?}: {found:?}");
        }
    }
}
