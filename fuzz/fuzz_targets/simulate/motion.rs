//! Conditions that every motion must meet.

use fmm_model::Scalar;
use fmm_sim::{Engine, EventKind, Samples, Trajectory};

use crate::case::Case;

/// Runs `law` on `engine` and looks at what comes out; an error with a reason is as good as a motion.
pub(crate) fn check<D: Scalar, L>(case: &Case, engine: &impl Engine<D, L>, law: L, needs_uniform: bool) {
    let (Ok(scenario), Ok(sampling)) = (case.scenario::<D, L>(law), case.sampling(needs_uniform)) else { return };
    let Ok(motion) = engine.run(&scenario, &sampling) else { return };

    let expected = |kept: bool| if kept { sampling.count() } else { 0 };
    assert_eq!(motion.position().values().len(), expected(sampling.channels().position()), "positions");
    assert_eq!(motion.velocity().values().len(), expected(sampling.channels().velocity()), "velocities");
    let accelerations = motion.acceleration().values();
    assert_eq!(accelerations.len(), expected(sampling.channels().acceleration()), "accelerations");
    assert!(accelerations.iter().all(|acceleration| acceleration.is_finite()), "{motion:?}");
    assert!([motion.position(), motion.velocity()].into_iter().chain(motion.states()).all(is_finite), "{motion:?}");

    let events = motion.events();
    assert_eq!(events[0].kind, EventKind::Start);
    assert_eq!(events[0].time.value(), 0.0, "time of the start (s)");
    for pair in events.windows(2) {
        let (before, after) = (pair[0].time.value(), pair[1].time.value());
        assert!(before <= after, "an event at {before} s before one at {after} s");
    }
    let (last, end) = (events[events.len() - 1].time.value(), sampling.end());
    assert!(last <= end, "an event at {last} s after the last sample at {end} s");
    for event in events {
        let numbers = [event.time, event.position, event.velocity];
        assert!(numbers.into_iter().all(has_finite_parts), "{event:?}");
        assert!(event.load.is_finite() && event.static_level.is_finite() && !event.margin().is_nan(), "{event:?}");
    }
    if sampling.wants_work() && has_work(&motion) {
        for index in 0..sampling.count() {
            let work = motion.work(index).expect("work was asked for");
            assert!([work.friction, work.viscous, work.external].into_iter().all(f64::is_finite), "{work:?}");
        }
    }
}

/// Engines of fixed step keep no account of work.
fn has_work<D: Scalar>(motion: &Trajectory<D>) -> bool {
    !matches!(motion.engine(), "moreau" | "thesis")
}

fn is_finite<D: Scalar>(samples: &Samples<D>) -> bool {
    let partials = (0..D::DIRECTIONS).filter_map(|direction| samples.partial(direction));
    std::iter::once(samples.values()).chain(partials).flatten().all(|value| value.is_finite())
}

fn has_finite_parts<D: Scalar>(number: D) -> bool {
    number.value().is_finite() && (0..D::DIRECTIONS).all(|direction| number.partial(direction).is_finite())
}
