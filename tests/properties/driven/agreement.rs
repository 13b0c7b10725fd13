//! Engines that know nothing of each other find the same motion: every event in kind and order, times, positions,
//! samples.

use fmm_model::Scalar;
use fmm_sim::{Engine, Event, EventKind, Moreau, RungeKutta, Samples, Trajectory};

use super::contact::Family;
use super::setup::{Gradient, Setup, Solver, draws, setups};

/// How far a small error anywhere carries: the sum over all numbers of a setup of how much a quantity changes when one
/// of them changes by all of itself. An engine with a relative error δ in each step is off by about δ times this.
pub(crate) struct Reach(Vec<f64>);

impl Reach {
    pub(crate) fn of(setup: &Setup) -> Self {
        let size = |(name, value): (&str, f64)| match name {
            "x₀" => value.abs().max(setup.length),
            "v₀" => value.abs().max(setup.length * setup.angular()),
            _ => value.abs(),
        };
        Self(setup.numbers().into_iter().map(size).collect())
    }

    /// The size of the number of this index.
    pub(crate) fn size(&self, direction: usize) -> f64 {
        self.0[direction]
    }

    pub(crate) fn number(&self, number: Gradient) -> f64 {
        self.0.iter().enumerate().map(|(direction, size)| (number.partial(direction) * size).abs()).sum()
    }

    pub(crate) fn sample(&self, samples: &Samples<Gradient>, index: usize) -> f64 {
        let partial = |direction| samples.partial(direction).map_or(0.0, |partials: &[f64]| partials[index]);
        self.0.iter().enumerate().map(|(direction, size)| (partial(direction) * size).abs()).sum()
    }
}

/// True if rounding may decide an event: a load within 1e-9 of the level, a zero that is only grazed, two events at
/// nearly the same time.
///
/// A load that is a level of zero is exactly so. One that meets a level exactly has come there by symmetry: an undamped
/// contact that a steady ramp breaks away comes to rest again at the load at which it has broken away, whatever its
/// level of losing speed is. Another engine is off by the error of its steps.
pub(crate) fn is_ambiguous<D: Scalar>(setup: &Setup, motion: &Trajectory<D>) -> bool {
    let near = |event: &Event<D>| {
        let decides = matches!(event.kind, EventKind::Start | EventKind::Reversal | EventKind::Stop);
        let margin = (event.load - event.static_level).abs();
        let has_level = margin > 0.0 || event.static_level > 0.0;
        event.grazing || decides && has_level && margin <= 1e-9 * setup.stiffness * setup.length
    };
    let close = |pair: &[Event<D>]| (pair[1].time.value() - pair[0].time.value()) * setup.angular() < 1e-6;
    motion.events().iter().any(near) || motion.events().windows(2).any(close)
}

/// The greatest difference between two motions, in units of how far an error reaches.
pub(crate) fn difference(setup: &Setup, exact: &Trajectory<Gradient>, other: &Trajectory) -> f64 {
    let list = |events: Vec<_>| format!("{events:?}");
    let expected: Vec<_> = exact.events().iter().map(|event| (event.kind, event.next)).collect();
    let found: Vec<_> = other.events().iter().map(|event| (event.kind, event.next)).collect();
    assert_eq!(list(found), list(expected), "events: {setup}");

    let reach = Reach::of(setup);
    let size = exact.position().values().iter().fold(setup.length, |size, x| size.max(x.abs()));
    let mut worst = 0.0f64;
    for (event, other) in exact.events().iter().zip(other.events()) {
        let late =
            (other.time - event.time.value()).abs() / (reach.number(event.time) + event.time.value()).max(1e-300);
        let off = (other.position - event.position.value()).abs() / (reach.number(event.position) + size);
        worst = worst.max(late).max(off);
    }
    for index in 0..exact.position().values().len() {
        let off = |one: &Samples<Gradient>, other: &Samples<f64>, size: f64| {
            (one.values()[index] - other.values()[index]).abs() / (reach.sample(one, index) + size)
        };
        worst = worst.max(off(exact.position(), other.position(), size));
        worst = worst.max(off(exact.velocity(), other.velocity(), size * setup.angular()));
    }
    worst
}

/// A run takes some hundred steps, each off by up to the tolerance of 3e-14 and by rounding.
pub(crate) const AGREEMENT: f64 = 1e-10;

/// The greatest share of ambiguous setups, which is that of the viscous law: motions that die away turn at any small
/// load.
const AMBIGUOUS: f64 = 0.033;

#[test]
fn exact_and_stepped_motion_agree() {
    let (engine, sets) = (Solver::RungeKutta(RungeKutta::default()), draws(1000));
    for &family in Family::AFFINE {
        let mut checked = 0;
        for setup in setups(3, family, true, sets) {
            let sampling = setup.sampling(37);
            let exact = setup.gradient(Solver::Exact, &sampling);
            if is_ambiguous(&setup, &exact) {
                continue;
            }
            let error = difference(&setup, &exact, &setup.motion(engine, &sampling));
            assert!(error < AGREEMENT, "{error:e} of what an error of each number would do: {setup}");
            checked += 1;
        }
        // Counts scatter by their root.
        let expected = AMBIGUOUS * sets as f64;
        let left_out = (sets - checked) as f64;
        assert!(left_out <= expected + 3.0 * expected.sqrt(), "{family:?}: {left_out} of {sets} are ambiguous");
    }
}

/// The root of the mean square of the difference of positions, over the greatest position.
fn distance(one: &Trajectory, other: &Trajectory, stride: usize) -> f64 {
    let pairs = one.position().values().iter().zip(other.position().values().iter().step_by(stride));
    let (mut square, mut size) = (0.0, f64::MIN_POSITIVE);
    for (one, other) in pairs {
        square += (one - other).powi(2);
        size = one.abs().max(size);
    }
    (square / one.position().values().len() as f64).sqrt() / size
}

/// The time stepping has order 1, with single errors that scatter as events snap to the grid: over four halvings of the
/// step the geometric mean of many setups is far from 0 and not above the order 2 that the rule has without events.
#[test]
fn time_stepping_converges_to_the_exact_motion() {
    for family in [Family::Coulomb, Family::CoulombStatic, Family::CoulombViscous] {
        let (mut orders, mut count) = (0.0, 0.0);
        for setup in setups(4, family, true, 60) {
            // A force that jumps between two steps costs an error of order 1 of its own, events or not.
            let sampling = setup.sampling(2000);
            let exact = setup.motion(Solver::Exact, &sampling);
            if is_ambiguous(&setup, &exact) {
                continue;
            }
            let scenario = setup.scenario(|_, value| value).unwrap();
            let stepped = |factor: usize| Moreau::default().run(&scenario, &setup.sampling(2000 * factor)).unwrap();
            let errors = [distance(&exact, &stepped(1), 1), distance(&exact, &stepped(16), 16)];
            assert!(errors[1] < 2e-3, "{errors:?} of the amplitude: {setup}");
            if errors[0] > 1e-12 {
                orders += (errors[0] / errors[1]).log2() / 4.0;
                count += 1.0;
            }
        }
        let order = orders / count;
        assert!(count >= 40.0 && (0.8..2.1).contains(&order), "{family:?}: order {order} over {count} setups");
        println!("{order}");
    }
}

/// The error falls as the tolerance does, to the 8/9th power at worst: each step ends with an error of the ninth order
/// where its estimate is of the eighth.
#[test]
fn the_error_follows_the_tolerance() {
    let (loose, tight) = (1e-8, 1e-12);
    let (mut slopes, mut count) = (0.0, 0.0);
    for setup in setups(5, Family::CoulombStatic, true, 200) {
        let sampling = setup.sampling(37);
        let exact = setup.gradient(Solver::Exact, &sampling);
        if is_ambiguous(&setup, &exact) {
            continue;
        }
        let errors = [loose, tight].map(|tolerance| {
            let motion = setup.motion(Solver::RungeKutta(RungeKutta::new(tolerance).unwrap()), &sampling);
            let same = motion.events().len() == exact.events().len();
            if same { difference(&setup, &exact, &motion) } else { f64::NAN }
        });
        if errors[0] > 1e-9 && errors[1] > 0.0 {
            slopes += (errors[0] / errors[1]).log10() / 4.0;
            count += 1.0;
        }
    }
    let slope = slopes / count;
    assert!(
        count > 100.0 && (0.75..1.1).contains(&slope),
        "the error falls as the tolerance to the {slope}, {count} setups"
    );
    println!("{slope} {count}");
}
