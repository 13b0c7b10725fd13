//! A trial: one machine under one law, by all engines.

use fmm_friction::{
    AccelerationCoulomb, Berger, BoucWen, BristleLaw, Coulomb, CoulombStatic, CoulombViscous, Dahl, ExponentialPair,
    GmsOf, Hyperbolic, Karnopp, LawFamily, LawVisitor, LuGre, MakkarDixon, MaxwellSlipOf, PiecewiseLinearLaw, PowerLaw,
    RegularisedStribeck, ShiftedMakkarDixon, SlidingLaw, Stribeck, StribeckLorentzian, Viscous,
};
use fmm_model::{Oscillator, Restoring};
use fmm_sim::{Bristle, Engine, Exact, RungeKutta, Sampling, Scenario, SimulationError, Trajectory};

use crate::draw::{Draws, Machine};
use crate::referee::{Contact, Referee};

/// A run of an engine.
pub(crate) struct Run {
    pub(crate) engine: String,
    pub(crate) balance: f64,
    /// Greatest distance from the first motion, and its time (s).
    pub(crate) apart: f64,
    pub(crate) worst: f64,
    pub(crate) compared: usize,
}

pub(crate) struct Outcome {
    pub(crate) machine: String,
    pub(crate) runs: Vec<Result<Run, (String, SimulationError)>>,
}

/// Steps of the referee for one machine.
const BUDGET: usize = 1_000_000;

type Motion = Vec<[f64; 2]>;

struct Trial<'a, L> {
    machine: &'a Machine,
    law: L,
}

/// The motion of an engine, or why there is none, with the name of the engine; the imbalance of energy comes along.
type Named = (String, Result<(Motion, f64), SimulationError>);

/// Runs and the referee's motion.
type Runs = (Vec<Named>, Option<Motion>);

impl<L: Clone> Trial<'_, L> {
    fn scenario(&self, oscillator: Oscillator) -> Scenario<f64, L> {
        let (position, velocity) = self.machine.start;
        let scenario = Scenario::new(oscillator, self.law.clone(), self.machine.load).unwrap();
        let scenario = scenario.starting_at(position, velocity).unwrap();
        self.machine.cause.excitation().into_iter().fold(scenario, Scenario::driven_by)
    }

    /// The run of the exact engine, where the machine is linear.
    fn exact(&self) -> Option<Named>
    where
        L: PiecewiseLinearLaw<f64>,
    {
        let scenario = self.scenario(self.machine.oscillator);
        let run = || outcome(Exact.run(&scenario, &self.machine.sampling()), &scenario, self.machine.amplitude);
        self.machine.oscillator.is_linear().then(|| ("exact".to_owned(), run()))
    }

    fn referee(&self, contact: Contact<'_>) -> Option<Motion> {
        let (mut referee, sampling) = (Referee::new(self.machine, contact), self.machine.sampling());
        let mut budget = BUDGET;
        (0..sampling.count()).map(|index| referee.advance(sampling.time(index), &mut budget)).collect()
    }
}

/// The greatest imbalance of energy, relative to the greatest energy and work.
fn imbalance<L: ?Sized>(motion: &Trajectory, scenario: &Scenario<f64, L>, amplitude: f64) -> f64 {
    let energies = (0..motion.times().len()).map(|index| motion.energy(scenario, index).expect("all is sampled"));
    let (kinetic, potential) = scenario.stored_energy(scenario.initial());
    let begin = kinetic + potential;
    // A motion of a hundred-thousandth of its distance from the origin shares its rounding.
    let least = 1e-10 * scenario.oscillator().stiffness() * amplitude.powi(2);
    let (mut worst, mut scale) = (0.0f64, begin.max(least));
    for energy in energies {
        let work = energy.work;
        worst = worst.max((energy.total() + work.friction + work.viscous - work.external - begin).abs());
        scale = scale.max(energy.total() + work.friction.abs() + work.viscous.abs() + work.external.abs());
    }
    worst / scale
}

fn outcome<L: ?Sized>(
    motion: Result<Trajectory, SimulationError>,
    scenario: &Scenario<f64, L>,
    amplitude: f64,
) -> Result<(Motion, f64), SimulationError> {
    let motion = motion?;
    let balance = imbalance(&motion, scenario, amplitude);
    let pairs = motion.position().values().iter().zip(motion.velocity().values());
    Ok((pairs.map(|(x, v)| [*x, *v]).collect(), balance))
}

fn by_steps<L: SlidingLaw<f64>>(scenario: &Scenario<f64, L>, sampling: &Sampling, amplitude: f64) -> Vec<Named> {
    let scenario: &Scenario<f64, dyn SlidingLaw<f64> + '_> = scenario;
    let run = |tolerance: f64| {
        let motion = RungeKutta::new(tolerance).unwrap().run(scenario, sampling);
        (format!("runge_kutta {tolerance:e}"), outcome(motion, scenario, amplitude))
    };
    vec![run(3e-14), run(1e-13)]
}

fn by_bristles<L: BristleLaw<f64>>(scenario: &Scenario<f64, L>, sampling: &Sampling, amplitude: f64) -> Vec<Named> {
    let scenario: &Scenario<f64, dyn BristleLaw<f64> + '_> = scenario;
    let run = |tolerance: f64| {
        let motion = Bristle::new(tolerance).unwrap().run(scenario, sampling);
        (format!("bristle {tolerance:e}"), outcome(motion, scenario, amplitude))
    };
    vec![run(1e-12), run(1e-10)]
}

impl<L: Clone> LawVisitor<f64, L> for Trial<'_, L> {
    type Output = Runs;

    fn sliding(self) -> Runs
    where
        L: SlidingLaw<f64>,
    {
        if self.machine.has_belt_on_bent_spring() {
            return (Vec::new(), None);
        }
        let runs = by_steps(&self.scenario(self.machine.oscillator), &self.machine.sampling(), self.machine.amplitude);
        let has_referee = !self.law.depends_on_acceleration() && self.law.capture_speed() == 0.0;
        let referee = if has_referee { self.referee(Contact::Sliding(&self.law)) } else { None };
        (runs, referee)
    }

    fn piecewise_linear(self) -> Runs
    where
        L: PiecewiseLinearLaw<f64> + SlidingLaw<f64>,
    {
        let exact = self.exact();
        let (mut runs, referee) = self.sliding();
        runs.extend(exact);
        (runs, referee)
    }

    fn bristle(self) -> Runs
    where
        L: BristleLaw<f64>,
    {
        let runs =
            by_bristles(&self.scenario(self.machine.oscillator), &self.machine.sampling(), self.machine.amplitude);
        (runs, self.referee(Contact::Bristle(&self.law)))
    }

    fn elements(self) -> Runs
    where
        L: PiecewiseLinearLaw<f64> + BristleLaw<f64>,
    {
        let exact = self.exact();
        let (mut runs, referee) = self.bristle();
        runs.extend(exact);
        (runs, referee)
    }
}

fn of<F: LawFamily>(machine: &Machine, values: &[f64]) -> Outcome {
    let law = F::at::<f64>(values).unwrap_or_else(|error| panic!("{}: {error}", F::NAME));
    let (runs, referee) = F::visit(Trial { machine, law });
    let first =
        referee.or_else(|| runs.iter().find_map(|(_, run)| run.as_ref().ok().map(|(motion, _)| motion.clone())));
    let sampling = machine.sampling();
    let first = first.unwrap_or_default();
    let scale = |component: usize| {
        let usual = [1.0, machine.angular][component] * machine.amplitude;
        first.iter().map(|state| state[component].abs()).fold(0.1 * usual, f64::max)
    };
    let scales = [0, 1].map(scale);
    let compare = |(engine, run): Named| match run {
        Ok((motion, balance)) => {
            let (mut apart, mut worst) = (0.0f64, 0.0);
            for (index, (one, other)) in motion.iter().zip(&first).enumerate() {
                for component in 0..2 {
                    let off = (one[component] - other[component]).abs() / scales[component];
                    if off > apart {
                        (apart, worst) = (off, sampling.time(index));
                    }
                }
            }
            Ok(Run { engine, balance, apart, worst, compared: motion.len() })
        }
        Err(error) => Err((engine, error)),
    };
    let runs = runs.into_iter().map(compare).collect();
    Outcome { machine: format!("{} {values:?} {machine:?}", F::NAME), runs }
}

/// Draws a machine and a law, and runs it by all engines that take it.
pub(crate) fn trial(draws: &mut Draws) -> Outcome {
    let mut machine = Machine::draw(draws);
    let speed = machine.amplitude * machine.angular;
    let level = machine.friction / machine.load;
    let dry = level.max(1e-6 * machine.oscillator.stiffness() * machine.amplitude / machine.load);
    let above = dry * draws.between(1.0, 2.0);
    let slow = speed * draws.decades(1e-5, 1.0);
    let viscous = [0.0, 0.1 * dry / speed][draws.one_of(2)];
    let exponent = [1.0, 2.0, draws.between(0.5, 2.0)][draws.one_of(3)];
    let stiff = dry / (machine.amplitude * draws.decades(1e-5, 1.0));
    let mass = machine.oscillator.mass();
    let critical = 2.0 * (machine.load * stiff * mass).sqrt() / machine.load;
    let bristles = [0.0, critical * draws.decades(0.01, 1.0)][draws.one_of(2)];
    match draws.one_of(22) {
        0 => of::<Viscous>(&machine, &[viscous]),
        1 => of::<Coulomb>(&machine, &[level]),
        2 => of::<CoulombStatic>(&machine, &[dry, above]),
        3 => of::<CoulombViscous>(&machine, &[level, viscous]),
        4 => of::<AccelerationCoulomb>(&machine, &[above, dry]),
        5 => of::<AccelerationCoulomb>(&machine, &[dry, above]),
        6 => of::<Berger>(&machine, &[dry, above - dry, 1.0 / slow]),
        7 => of::<Stribeck>(&machine, &[dry, above, slow, exponent.max(1.0), viscous]),
        8 => of::<StribeckLorentzian>(&machine, &[dry, above, slow, viscous]),
        9 => of::<Hyperbolic>(&machine, &[above, 1.0 / slow]),
        10 => {
            let root = [1.0, draws.between(0.5, 1.0)][draws.one_of(2)];
            of::<PowerLaw>(&machine, &[dry / speed.powf(root), root, above])
        }
        11 => of::<ExponentialPair>(&machine, &[dry, above, 1.0 / slow, 3.0 / slow]),
        12 => of::<MakkarDixon>(&machine, &[0.3 * dry, 5.0 / slow, 1.0 / slow, dry, 5.0 / slow, viscous]),
        13 => of::<ShiftedMakkarDixon>(&machine, &[0.3 * dry, 300.0 / speed, 3.0 / speed, dry, 30.0 / speed, viscous]),
        14 => of::<RegularisedStribeck>(&machine, &[above, dry, 0.1 * speed, viscous]),
        15 => of::<Karnopp>(&machine, &[dry, above, 0.03 * speed]),
        16 => of::<Dahl>(&machine, &[dry, stiff, [1.0, draws.between(0.5, 2.0)][draws.one_of(2)]]),
        17 => of::<LuGre>(&machine, &[dry, above, slow, exponent.max(1.0), stiff, bristles, viscous]),
        18 => {
            let [beta, gamma] = [stiff / dry * 0.6, stiff / dry * 0.4];
            of::<BoucWen>(&machine, &[stiff, 1.0, beta, gamma, 1.0])
        }
        19 => of::<MaxwellSlipOf<2>>(&machine, &[stiff, 0.6 * dry, 0.2 * stiff, 0.4 * dry]),
        20 => {
            let attraction = dry * machine.angular * draws.decades(0.3, 30.0);
            of::<GmsOf<2>>(
                &machine,
                &[dry, above, slow, exponent.max(1.0), viscous, attraction, stiff, 0.2 * stiff, 0.7],
            )
        }
        _ => {
            machine.oscillator = machine.oscillator.with_restoring(Restoring::Linear);
            of::<MaxwellSlipOf<3>>(&machine, &[stiff, 0.5 * dry, 0.3 * stiff, 0.3 * dry, 0.1 * stiff, 0.2 * dry])
        }
    }
}
