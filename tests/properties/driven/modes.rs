//! Modes of the contact: a trajectory states those that its motion shows, under all forces and belts.

use fmm_sim::{Event, EventKind, Mode, RungeKutta, Sampling, Trajectory};

use super::contact::Family;
use super::setup::{Cause, Setup, Solver, draws, setups};

/// Samples of a motion.
const SAMPLES: usize = 97;

/// Velocity of the counterface (m/s).
pub(crate) fn belt(setup: &Setup) -> f64 {
    let belt = |cause: &Cause| if let Cause::Belt { velocity } = cause { *velocity } else { 0.0 };
    setup.causes.iter().map(belt).sum()
}

/// The greatest speed relative to the counterface (m/s), or what the start would make of it.
pub(crate) fn fastest(setup: &Setup, motion: &Trajectory) -> f64 {
    let scale = setup.length * setup.angular();
    motion.velocity().values().iter().fold(scale, |most, v| most.max((v - belt(setup)).abs()))
}

/// Fails where a sample lies against the mode that the last event before it has left the contact in.
pub(crate) fn samples_follow_the_modes(setup: &Setup, sampling: &Sampling, motion: &Trajectory, slack: f64) {
    let (belt, slack) = (belt(setup), slack * fastest(setup, motion));
    let events = motion.events();
    let mut before: Option<(usize, f64)> = None;
    for (index, velocity) in motion.velocity().values().iter().enumerate() {
        let (time, relative) = (sampling.time(index), velocity - belt);
        let current = events.iter().rposition(|event| event.time <= time).expect("the start is an event");
        let mode = events[current].next;
        let along = relative * mode.direction().map_or(0.0, fmm_sim::Direction::sign);
        let holds = match mode {
            Mode::Stick => relative.abs() <= slack,
            _ => along >= -slack,
        };
        assert!(holds, "{}: {relative} m/s relative in {mode:?} at {time} s: {setup}", motion.engine());
        if let Some((_, earlier)) = before.filter(|(event, _)| *event == current) {
            let keeps = match mode {
                Mode::Gaining(_) => along >= earlier - slack,
                Mode::Steady(_) => (along - earlier).abs() <= slack,
                Mode::Losing(_) => along <= earlier + slack,
                _ => true,
            };
            assert!(keeps, "{}: from {earlier} to {along} m/s in {mode:?} at {time} s: {setup}", motion.engine());
        }
        before = Some((current, along));
    }
}

/// Fails where the kind of an event contradicts the modes on both sides of it, the velocity at it or its load.
fn kinds_fit_the_motion(setup: &Setup, motion: &Trajectory) {
    let belt = belt(setup);
    // Rounding of the terms of a load, which are as large as the forces from outside.
    let rounding = 1e-9 * setup.stiffness * setup.length;
    for pair in motion.events().windows(2) {
        let [before, event]: &[Event; 2] = pair.try_into().expect("windows of two");
        let at_rest = event.velocity == belt;
        let holds = event.next == Mode::Stick;
        let fits = match event.kind {
            EventKind::Start => false,
            EventKind::Stop => {
                before.next != Mode::Stick && holds && at_rest && event.load <= event.static_level + rounding
            }
            EventKind::Reversal => {
                before.next != Mode::Stick && !holds && at_rest && event.load >= event.static_level - rounding
            }
            EventKind::Breakaway => {
                before.next == Mode::Stick && !holds && at_rest && event.load >= event.static_level - rounding
            }
            EventKind::BranchChange => before.next != event.next && before.next.direction() == event.next.direction(),
            _ => true,
        };
        let list = motion.events().iter().map(|event| (event.kind, event.next, event.time)).collect::<Vec<_>>();
        assert!(fits && event.time >= before.time, "{}: {before:?}, {event:?}, {list:?}: {setup}", motion.engine());
    }
    assert!(motion.events().first().is_some_and(|event| event.kind == EventKind::Start && event.time == 0.0));
}

fn check(families: &[Family], linear: bool, solver: Solver) {
    for &family in families {
        for setup in setups(12, family, linear, draws(300)) {
            let sampling = setup.sampling(SAMPLES);
            let motion = setup.motion(solver, &sampling);
            samples_follow_the_modes(&setup, &sampling, &motion, 1e-9);
            if family != Family::MaxwellSlip {
                kinds_fit_the_motion(&setup, &motion);
            }
        }
    }
}

#[test]
fn exact_motions_are_as_their_events_say() {
    check(Family::EXACT, true, Solver::Exact);
}

#[test]
fn stepped_motions_are_as_their_events_say() {
    // A contact that is caught at the speed of its dead zone stops from there, at once.
    let families: Vec<_> = Family::SLIDING.iter().copied().filter(|family| *family != Family::Karnopp).collect();
    check(&families, false, Solver::RungeKutta(RungeKutta::default()));
}
