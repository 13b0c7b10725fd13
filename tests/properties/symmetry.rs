//! Symmetries, bit for bit: mirror images and powers of two leave every rounding as it is.

use fmm_sim::Trajectory;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::case::{Case, cases};

/// Factors by which times, positions and forces of one motion differ from those of another.
struct Factors {
    time: f64,
    position: f64,
    force: f64,
}

/// The motion of `other` is that of `case` times `factors`, to the last bit.
fn corresponds(case: &Case, motion: &Trajectory, other: &Case, factors: &Factors) {
    let Factors { time, position, force } = *factors;
    let velocity = position / time;
    let image = other.run();
    assert_eq!(image.events().len(), motion.events().len(), "number of events: {case}\nagainst {other}");
    for (event, image) in motion.events().iter().zip(image.events()) {
        let expected = (event.time * time, event.position * position, event.velocity * velocity);
        assert_eq!((image.time, image.position, image.velocity), expected, "event: {case}\nagainst {other}");
        let expected = (event.load * force.abs(), event.static_level * force.abs());
        assert_eq!((image.load, image.static_level), expected, "load at {} s: {case}\nagainst {other}", event.time);
        assert_eq!(image.kind, event.kind, "kind at {} s: {case}\nagainst {other}", event.time);
    }
    let agree = |what: &str, values: &[f64], images: &[f64], factor: f64| {
        assert_eq!(values.len(), images.len());
        for (index, (value, image)) in values.iter().zip(images).enumerate() {
            assert_eq!(value * factor, *image, "{what} of sample {index}: {case}\nagainst {other}");
        }
    };
    agree("position (m)", motion.position().values(), image.position().values(), position);
    agree("velocity (m/s)", motion.velocity().values(), image.velocity().values(), velocity);
}

/// Cases with a power of two for each: nothing of them leaves the normal numbers.
fn cases_with_factors(seed: u64) -> impl Iterator<Item = (Case, f64)> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    cases(seed, 1000).map(move |case| (case, 2f64.powi(random.random_range(-40..=40))))
}

#[test]
fn mirror_image() {
    for case in cases(21, 1000) {
        let mirrored = Case { position: -case.position, velocity: -case.velocity, ..case };
        corresponds(&case, &case.run(), &mirrored, &Factors { time: 1.0, position: -1.0, force: -1.0 });
    }
}

/// Twice the machine under twice the load moves as before: a record sees k/m, c/m and F/m only.
#[test]
fn scale_of_the_machine() {
    for (case, factor) in cases_with_factors(31) {
        let scaled = Case {
            mass: case.mass * factor,
            stiffness: case.stiffness * factor,
            damping: case.damping * factor,
            normal_load: case.normal_load * factor,
            ..case
        };
        corresponds(&case, &case.run(), &scaled, &Factors { time: 1.0, position: 1.0, force: factor });
    }
}

/// Twice the start under twice the load gives twice the motion.
#[test]
fn scale_of_the_motion() {
    for (case, factor) in cases_with_factors(32) {
        let scaled = Case {
            position: case.position * factor,
            velocity: case.velocity * factor,
            normal_load: case.normal_load * factor,
            ..case
        };
        corresponds(&case, &case.run(), &scaled, &Factors { time: 1.0, position: factor, force: factor });
    }
}

/// Four times the mass at twice the damping moves alike in twice the time.
#[test]
fn scale_of_time() {
    for (case, factor) in cases_with_factors(33) {
        let scaled = Case {
            mass: case.mass * factor * factor,
            damping: case.damping * factor,
            velocity: case.velocity / factor,
            interval: case.interval * factor,
            ..case
        };
        corresponds(&case, &case.run(), &scaled, &Factors { time: factor, position: 1.0, force: 1.0 });
    }
}

/// Coefficients and normal load enter as their product only.
#[test]
fn coefficient_against_load() {
    for (case, factor) in cases_with_factors(34) {
        let scaled = Case {
            sliding: case.sliding * factor,
            breakaway: case.breakaway * factor,
            normal_load: case.normal_load / factor,
            ..case
        };
        corresponds(&case, &case.run(), &scaled, &Factors { time: 1.0, position: 1.0, force: 1.0 });
    }
}
