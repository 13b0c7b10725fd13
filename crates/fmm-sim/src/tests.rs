//! Agreement of both engines for sliding laws, where it is hard to reach.

use fmm_friction::{AccelerationCoulomb, CoulombStatic};
use fmm_model::{Damping, Dual, Oscillator, Scalar};

use crate::error::SimulationError;
use crate::exact::Exact;
use crate::runge_kutta::RungeKutta;
use crate::scenario::{Direction, EventKind, Excitation, Mode, Sampling, Scenario};
use crate::trajectory::{Engine, Trajectory};

/// Both motions of a machine of 1 kg on 1 N/m let go at `start` (m), damped by `damping` (N s/m), under 1 N on a
/// contact of these two levels and a `force`.
fn both(
    damping: f64,
    levels: [f64; 2],
    start: f64,
    force: Excitation,
    sampling: &Sampling,
) -> Result<[Trajectory; 2], SimulationError> {
    let machine = Oscillator::new(1.0, 1.0)?.with_damping(Damping::linear(damping)?);
    let law = AccelerationCoulomb::new(levels[0], levels[1]).unwrap();
    let scenario = Scenario::new(machine, law, 1.0)?.starting_at(start, 0.0)?.driven_by(force);
    Ok([Exact.run(&scenario, sampling)?, RungeKutta::default().run(&scenario, sampling)?])
}

fn kinds(motion: &Trajectory) -> Vec<(EventKind, Mode)> {
    motion.events().iter().map(|event| (event.kind, event.next)).collect()
}

/// The greatest difference of two positions (m).
fn difference(one: &Trajectory, other: &Trajectory) -> f64 {
    let pairs = one.position().values().iter().zip(other.position().values());
    pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

/// The acceleration is zero twice within one step.
#[test]
fn no_change_of_branch_is_stepped_over() {
    let sampling = Sampling::uniform(0.01, 501).unwrap();
    let wave = Excitation::harmonic(0.3, 10.0, 0.0).unwrap();
    let [exact, stepped] = both(0.0, [0.1, 0.2], 0.5, wave, &sampling).unwrap();
    assert_eq!(kinds(&exact), kinds(&stepped));
    assert!(difference(&exact, &stepped) < 1e-12, "{:e} m", difference(&exact, &stepped));
}

/// The greatest speed (m/s) against the direction in which a contact slides, or of one that holds.
fn against_its_mode(motion: &Trajectory, sampling: &Sampling) -> f64 {
    let mut worst = 0.0f64;
    for (index, velocity) in motion.velocity().values().iter().enumerate() {
        let mode = motion.events().iter().rev().find(|event| event.time <= sampling.time(index)).unwrap().next;
        worst = worst.max(mode.direction().map_or(velocity.abs(), |direction| -velocity * direction.sign()));
    }
    worst
}

/// Slow ramps lead a contact of two levels to ever shorter swings, until rounding decides whether it holds; and once it
/// does, it does until the load has crossed the whole zone.
#[test]
fn a_contact_moves_as_its_mode_says() {
    let sampling = Sampling::uniform(0.05, 801).unwrap();
    let mut checked = 0;
    for damping in [0.0, 0.1, 0.5, 1.0, 2.0, 3.0] {
        for gaining in [0.02, 0.05, 0.1, 0.2] {
            for ratio in [0.5, 0.8, 1.5, 2.0, 2.5, 4.0] {
                for start in [0.3, 0.5, 1.0, 2.0, -1.0, -2.0] {
                    for rate in [-0.3, -0.1, -0.02, 0.005, 0.01, 0.05, 0.2] {
                        let levels = [gaining, gaining * ratio];
                        let case = format!("{damping} N s/m, {levels:?}, from {start} m, {rate} N/s");
                        let ramp = Excitation::ramp(rate).unwrap();
                        let motions = both(damping, levels, start, ramp, &sampling);
                        let motions = motions.unwrap_or_else(|error| panic!("{error}: {case}"));
                        for motion in &motions {
                            let speed = against_its_mode(motion, &sampling);
                            assert!(speed < 1e-9, "{}: {speed} m/s against its mode: {case}", motion.engine());
                        }
                        let off = difference(&motions[0], &motions[1]);
                        // Critically damped, an acceleration far below rounding decides after twenty seconds.
                        assert!(off < 1e-9 || damping == 2.0, "{off} m apart: {case}");
                        checked += 1;
                    }
                }
            }
        }
    }
    assert_eq!(checked, 6048);
}

/// A force that jumps over the static level sets the contact going when it jumps, whatever the level is.
#[test]
fn no_level_moves_a_jump() {
    type Numbers = Dual<3>;
    let variable = |value, direction| Numbers::variable(value, direction);
    let law = CoulombStatic::new(variable(0.1, 0), variable(0.2, 1)).unwrap();
    let machine = Oscillator::new(Numbers::from(1.0), variable(100.0, 2)).unwrap();
    let forces = [5.0, 6.0, 7.0].map(Numbers::from).to_vec();
    let force = Excitation::sampled_force(0.5, forces).unwrap().delayed(Numbers::from(1.0)).unwrap();
    let scenario = Scenario::new(machine, law, Numbers::from(10.0)).unwrap().driven_by(force);
    let sampling = Sampling::uniform(0.01, 301).unwrap();
    for motion in [Exact.run(&scenario, &sampling), RungeKutta::default().run(&scenario, &sampling)] {
        let motion = motion.unwrap();
        let breakaways: Vec<_> = motion.events().iter().filter(|event| event.kind == EventKind::Breakaway).collect();
        assert_eq!(breakaways.len(), 2, "{}: on and off", motion.engine());
        for (event, time) in breakaways.iter().zip([1.0, 2.0]) {
            assert_eq!((event.time, event.grazing), (Numbers::from(time), false), "{}", motion.engine());
        }
        // The static level has no part in the motion at all.
        assert!(motion.position().partial(1).unwrap().iter().all(|partial| *partial == 0.0), "{}", motion.engine());
    }
}

/// A counterface accelerates from rest and takes the machine along until inertia, damping and spring exceed the level:
/// seen from the counterface, m a + c a t + k a t²/2 = F_s.
#[test]
fn an_accelerating_counterface_loses_the_machine_at_a_known_time() {
    let [mass, damping, stiffness, acceleration, level] = [2.0, 1.5, 50.0, 0.7, 9.0];
    let interval = 1e-4;
    let machine = Oscillator::new(mass, stiffness).unwrap().with_damping(Damping::linear(damping).unwrap());
    let force = |t: f64| -acceleration * (mass + damping * t + 0.5 * stiffness * t * t);
    let scenario = Scenario::new(machine, CoulombStatic::new(0.6, 0.9).unwrap(), level / 0.9).unwrap();
    let scenario = scenario.driven_by(Excitation::function(interval, 2.0, force).unwrap());
    let sampling = Sampling::uniform(1e-3, 1000).unwrap();
    let rest = level / acceleration - mass;
    let time = ((damping * damping + 2.0 * stiffness * rest).sqrt() - damping) / stiffness;
    for motion in [Exact.run(&scenario, &sampling).unwrap(), RungeKutta::default().run(&scenario, &sampling).unwrap()] {
        let [start, breakaway, ..] = motion.events() else { panic!("it never slides: {:?}", motion.events()) };
        assert_eq!(start.next, Mode::Stick);
        assert_eq!((breakaway.kind, breakaway.next), (EventKind::Breakaway, Mode::Slip(Direction::Negative)));
        // Straight lines are off by interval²/8 times the curvature k a, over the slope of the load.
        let off = interval * interval / 8.0 * stiffness / (damping + stiffness * time);
        assert!((breakaway.time - time).abs() <= 1.01 * off, "{} s, not {time} s", breakaway.time);
    }
}
