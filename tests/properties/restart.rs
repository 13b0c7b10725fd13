//! A motion has no memory but its state: any sample is as good a start as the first.

use fmm_sim::Mode;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::case::{Case, cases, sense};

#[test]
fn any_sample_starts_the_rest_of_the_motion() {
    let mut random = ChaCha8Rng::seed_from_u64(71);
    let (mut checked, mut stuck) = (0, 0);
    for case in cases(71, 1600) {
        let (whole, sampling) = (case.run(), case.sampling());
        for first in [random.random_range(0..case.count), random.random_range(0..case.count)] {
            let state = (whole.position().values()[first], whole.velocity().values()[first]);
            let again = Case { position: state.0, velocity: state.1, count: case.count - first, ..case };
            // What is known of the sample, and the rounding of the two runs.
            let tolerance = 4.0 * case.rounding(sampling.end());
            let before = whole.events().iter().rfind(|event| event.time <= sampling.time(first)).unwrap();
            let later: Vec<_> = whole.events().iter().filter(|event| event.time > sampling.time(first)).collect();
            // Rounding may decide the direction of a contact that has just turned, and a stop at the very edge.
            let turning = before.next != Mode::Stick && state.1.abs() <= case.angular() * tolerance;
            let narrow =
                |event: &&fmm_sim::Event| (event.load - event.static_level).abs() <= case.stiffness * tolerance;
            if turning || later.iter().any(narrow) {
                continue;
            }
            let rest = again.run();

            // Events: a turning point is as late as the velocity there is off, over the acceleration.
            assert_eq!(rest.events().len(), later.len() + 1, "events after sample {first}: {case}");
            let (mut mode, mut late) = (before.next, 0.0f64);
            for (event, expected) in rest.events()[1..].iter().zip(later) {
                let distance = expected.position + sense(mode) * case.friction() / case.stiffness;
                late = late.max((1.0 + case.damping_ratio()) * tolerance / (case.angular() * distance.abs()));
                let time = sampling.time(first) + event.time - expected.time;
                assert!(
                    time.abs() <= late,
                    "restart at sample {first}: event {time:e} s late, {late:e} s allowed: {case}"
                );
                let position = event.position - expected.position;
                assert!(position.abs() <= tolerance, "restart at sample {first}: turns {position:e} m off: {case}");
                assert_eq!((event.kind, event.next), (expected.kind, expected.next), "restart at {first}: {case}");
                mode = expected.next;
            }
            for index in first..case.count {
                let position = rest.position().values()[index - first] - whole.position().values()[index];
                let velocity =
                    (rest.velocity().values()[index - first] - whole.velocity().values()[index]) / case.angular();
                let error = position.abs().max(velocity.abs());
                assert!(
                    error <= tolerance,
                    "restart at {first}: sample {index} {error:e} m off, {tolerance:e} m allowed: {case}"
                );
            }
            if before.next == Mode::Stick {
                assert_eq!(rest.rest().map(|rest| rest.time), Some(0.0), "restart at {first}, in stick: {case}");
                stuck += 1;
            }
            checked += 1;
        }
    }
    assert!(checked >= 2000 && stuck >= 200, "{checked} restarts, {stuck} of them in stick");
}
