//! Derivatives through all kinds of events, in every number of a law, a machine and a force, against differences.

use fmm_model::Scalar;
use fmm_sim::{Event, EventKind, Mode, RungeKutta, Samples, Sampling, Trajectory};

use super::agreement::{Reach, is_ambiguous};
use super::contact::Family;
use super::setup::{Gradient, Setup, Solver, setups};

/// Part of a number by which it is changed for a difference in a motion that changes as much as its numbers. The time
/// of an event near a turning point goes with the root of a number, so that the range of a motion that changes Q times
/// as much is 1/Q² of that.
const STEP: f64 = 1e-2;

/// Motions that change more than this often as much as their numbers are left to the agreement of the engines.
const LIVELIEST: f64 = 30.0;

/// Laws that are steep without a corner, so that a contact hardly moves at last: its speed is no measure of time, and
/// the steps keep the error of the motion, but not that of derivatives, which vary faster. Their relative error was
/// 1.3e-2 at worst.
const STEEP: f64 = 5e-2;

/// The motion with derivatives, and what is needed to judge them.
struct Judge<'a> {
    setup: &'a Setup,
    solver: Solver,
    sampling: Sampling,
    exact: Trajectory<Gradient>,
    reach: Reach,
    /// Largest distance (m).
    length: f64,
    /// Part of a number by which it is changed.
    step: f64,
    /// Rounding of a run, and for a stepped one what its steps change, in units of how far an error reaches.
    noise: f64,
}

/// Central differences over two widths, at −2, −1, 1 and 2 steps: of fourth order, and how much the widths differ.
fn difference(values: [f64; 4], step: f64) -> (f64, f64) {
    let (wide, narrow) = ((values[3] - values[0]) / (4.0 * step), (values[2] - values[1]) / (2.0 * step));
    ((4.0 * narrow - wide) / 3.0, (narrow - wide).abs())
}

type Events = Vec<(EventKind, Mode)>;

fn kinds<D: Scalar>(motion: &Trajectory<D>) -> Events {
    motion.events().iter().map(|event| (event.kind, event.next)).collect()
}

impl<'a> Judge<'a> {
    /// None if rounding decides an event or the motion is too lively.
    fn new(setup: &'a Setup, solver: Solver) -> Option<Self> {
        let sampling = setup.sampling(23);
        let (exact, plain) = (setup.gradient(solver, &sampling), setup.motion(solver, &sampling));
        for (dual, plain) in [(exact.position(), plain.position()), (exact.velocity(), plain.velocity())] {
            assert_eq!(dual.values(), plain.values(), "values with derivatives and without: {setup}");
        }
        let reach = Reach::of(setup);
        let length = exact.position().values().iter().fold(setup.length, |size, x| size.max(x.abs()));
        let events = exact
            .events()
            .iter()
            .map(|event| (reach.number(event.time) * setup.angular()).max(reach.number(event.position) / length));
        let samples = (0..sampling.count()).map(|index| {
            let velocity = reach.sample(exact.velocity(), index) / setup.angular();
            reach.sample(exact.position(), index).max(velocity) / length
        });
        let liveliness = events.chain(samples).fold(1.0, f64::max);
        let noise = if solver == Solver::Exact { 1e-11 } else { 1e-10 };
        let step = STEP / liveliness.powi(2);
        let usable = liveliness < LIVELIEST && !is_ambiguous(setup, &exact);
        usable.then_some(Self { setup, solver, sampling, exact, reach, length, step, noise })
    }

    /// The motion with the number of `direction` changed by `change`.
    fn changed(&self, direction: usize, change: f64) -> Option<Trajectory> {
        let mut index = 0;
        let number = |_, value| {
            index += 1;
            if index == direction + 1 { value + change } else { value }
        };
        self.setup.run(self.solver, &self.sampling, number)?.ok()
    }

    /// True if the number `name` can be changed by two steps of `step` to either side.
    fn has_room(name: &str, value: f64, step: f64) -> bool {
        let signed = matches!(name, "x₀" | "φ" | "peak" | "rate" | "amplitude" | "base amplitude" | "v_b");
        step > 0.0 && (signed || value.abs() >= 3.0 * step)
    }

    /// Compares the derivatives in one number with differences; false if events come, go or change on the way.
    fn column_agrees(&self, direction: usize) -> bool {
        let Self { setup, exact, reach, length, .. } = self;
        let (name, value) = setup.numbers()[direction];
        let step = reach.size(direction) * self.step;
        if !Self::has_room(name, value, step) {
            return false;
        }
        let runs = [-2.0, -1.0, 1.0, 2.0].map(|multiple| self.changed(direction, multiple * step));
        let [Some(a), Some(b), Some(c), Some(d)] = runs else { return false };
        let runs = [a, b, c, d];
        if runs.iter().any(|run| kinds(run) != kinds(exact)) {
            return false;
        }
        // Between the earliest and the latest of an event the runs are in different modes.
        let jumps: Vec<_> = (1..exact.events().len())
            .map(|index| {
                let times = runs.iter().map(|run| run.events()[index].time).chain([exact.events()[index].time.value()]);
                times.fold((f64::INFINITY, 0.0f64), |(first, last), time| (first.min(time), last.max(time)))
            })
            .collect();
        // A kink of the force is one of the time of an event.
        let knots = setup.knots();
        let slack = if name == "duration" { 2.0 * step } else { 0.0 };
        let kinked =
            |(first, last): &(f64, f64)| knots.iter().any(|knot| (first - slack..=last + slack).contains(knot));
        if jumps.iter().any(kinked) {
            return false;
        }
        let agree = |what: &str, time: f64, derivative: f64, values: [f64; 4], size: f64| {
            let (expected, spread) = difference(values, step);
            // The widths differ by three times the error of second order; that of fourth order is smaller.
            let slack = if setup.is_steep() { STEEP * expected.abs() } else { 0.0 };
            let (error, allowed) = (derivative - expected, spread + slack + self.noise * size / step);
            assert!(
                error.abs() <= allowed,
                "∂{what}/∂{name} at {time} s is {derivative:e}, not {expected:e}: {error:e} off, {allowed:e} allowed: {setup}"
            );
        };
        for (index, event) in exact.events().iter().enumerate() {
            let time = event.time.value();
            let values = |part: fn(&Event) -> f64| [0, 1, 2, 3].map(|run: usize| part(&runs[run].events()[index]));
            let (t, x) = (event.time.partial(direction), event.position.partial(direction));
            agree("t of an event", time, t, values(|event| event.time), reach.number(event.time) + time);
            agree("x of an event", time, x, values(|event| event.position), reach.number(event.position) + length);
        }
        for index in 0..self.sampling.count() {
            let time = self.sampling.time(index);
            if jumps.iter().any(|(first, last)| (*first..=*last).contains(&time))
                || kinked(&(time - slack, time + slack)) && slack > 0.0
            {
                continue;
            }
            let column = |what, samples: &Samples<Gradient>, of: fn(&Trajectory) -> &Samples<f64>, size: f64| {
                let values = [0, 1, 2, 3].map(|run: usize| of(&runs[run]).values()[index]);
                let partial = samples.partial(direction).unwrap()[index];
                agree(what, time, partial, values, reach.sample(samples, index) + size);
            };
            column("x", exact.position(), Trajectory::position, *length);
            column("v", exact.velocity(), Trajectory::velocity, length * setup.angular());
        }
        true
    }
}

/// Checks many setups of each family; at least half of the columns and some events of each kind must be among them.
fn check(solver: Solver, families: &[Family], linear: bool, sets: usize) {
    let (mut columns, mut passed) = (0, 0);
    let mut met =
        [EventKind::Reversal, EventKind::Stop, EventKind::Breakaway, EventKind::BranchChange].map(|kind| (kind, 0));
    for &family in families {
        for setup in setups(6, family, linear, sets) {
            let Some(judge) = Judge::new(&setup, solver) else { continue };
            for direction in 0..setup.numbers().len() {
                columns += 1;
                passed += i32::from(judge.column_agrees(direction));
            }
            for (kind, count) in &mut met {
                *count += judge.exact.events().iter().filter(|event| event.kind == *kind).count();
            }
        }
    }
    println!("{passed} of {columns}; {met:?}");
    assert!(2 * passed >= columns && met.iter().all(|(_, count)| *count >= 20), "{passed} of {columns}, {met:?}");
}

#[test]
fn exact_derivatives_are_those_of_the_motion() {
    check(Solver::Exact, Family::EXACT, true, 60);
}

#[test]
fn stepped_derivatives_are_those_of_the_motion() {
    check(Solver::RungeKutta(RungeKutta::default()), Family::SLIDING, false, 40);
}
