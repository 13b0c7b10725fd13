//! Mirror images and powers of two, bit for bit, under every law and force.

use fmm_sim::{RungeKutta, Trajectory};

use super::contact::Family;
use super::setup::{Cause, Setup, Solver, setups};

/// The motion of `image` is that of `setup` with positions times `position` and forces times `force`, to the last bit.
fn corresponds(setup: &Setup, image: &Setup, solver: Solver, position: f64, force: f64) {
    let sampling = setup.sampling(24).with_work();
    let (motion, other) = (setup.motion(solver, &sampling), image.motion(solver, &sampling));
    assert_eq!(other.events().len(), motion.events().len(), "number of events: {setup}");
    for (event, other) in motion.events().iter().zip(other.events()) {
        assert_eq!((other.kind, other.time), (event.kind, event.time), "event: {setup}");
        assert_eq!(other.position, event.position * position, "position at {} s: {setup}", event.time);
        assert_eq!(other.velocity, event.velocity * position, "velocity at {} s: {setup}", event.time);
        assert_eq!(other.load, event.load * force.abs(), "load at {} s: {setup}", event.time);
    }
    let samples = |motion: &Trajectory| [motion.position().values().to_vec(), motion.velocity().values().to_vec()];
    let scaled = samples(&motion).map(|values| values.into_iter().map(|value| value * position).collect::<Vec<_>>());
    assert_eq!(samples(&other), scaled, "samples: {setup}");
    for index in 0..sampling.count() {
        let (work, other) = (motion.work(index).unwrap(), other.work(index).unwrap());
        let scaled = [work.friction, work.viscous, work.external].map(|work| work * position * force);
        assert_eq!([other.friction, other.viscous, other.external], scaled, "work up to sample {index}: {setup}");
    }
}

/// All forces from outside and all motion of base and belt times a factor.
fn scaled(causes: &[Cause], force: f64, motion: f64) -> Vec<Cause> {
    let mut causes = causes.to_vec();
    for cause in &mut causes {
        match cause {
            Cause::Sampled { values, .. } => values.iter_mut().for_each(|value| *value *= force),
            Cause::HalfSine { peak: size, .. }
            | Cause::Ramp { rate: size, .. }
            | Cause::Harmonic { amplitude: size, .. } => *size *= force,
            Cause::Base { amplitude: size, .. } | Cause::Belt { velocity: size } => *size *= motion,
        }
    }
    causes
}

fn check(image: impl Fn(&Setup) -> (Setup, f64, f64)) {
    let stepped = Solver::RungeKutta(RungeKutta::default());
    let all =
        Family::EXACT.iter().map(|family| (*family, true)).chain(Family::SLIDING.iter().map(|family| (*family, false)));
    for (family, linear) in all {
        for setup in setups(8, family, linear, 100) {
            let (image, position, force) = image(&setup);
            corresponds(&setup, &image, if linear { Solver::Exact } else { stepped }, position, force);
        }
    }
}

#[test]
fn mirror_image_under_forces() {
    check(|setup| {
        let (position, velocity) = (-setup.position, -setup.velocity);
        let causes = scaled(&setup.causes, -1.0, -1.0);
        (Setup { position, velocity, causes, ..setup.clone() }, -1.0, -1.0)
    });
}

/// Twice the machine under twice the load and force moves as before.
#[test]
fn scale_of_the_machine_under_forces() {
    let factor = 2f64.powi(17);
    check(|setup| {
        let scaled = Setup {
            mass: setup.mass * factor,
            stiffness: setup.stiffness * factor,
            damping: setup.damping.map(|damping| damping * factor),
            normal_load: setup.normal_load * factor,
            causes: scaled(&setup.causes, factor, 1.0),
            ..setup.clone()
        };
        (scaled, 1.0, factor)
    });
}

/// Twice the start, the load and all forces give twice the motion of a linear machine whose law has levels only.
#[test]
fn scale_of_the_motion_under_forces() {
    let factor = 2f64.powi(-9);
    for (family, solver) in [
        (Family::Coulomb, Solver::Exact),
        (Family::CoulombStatic, Solver::Exact),
        (Family::AccelerationCoulomb, Solver::Exact),
        (Family::CoulombStatic, Solver::RungeKutta(RungeKutta::default())),
    ] {
        for setup in setups(9, family, true, 200) {
            let image = Setup {
                position: setup.position * factor,
                velocity: setup.velocity * factor,
                normal_load: setup.normal_load * factor,
                causes: scaled(&setup.causes, factor, factor),
                ..setup.clone()
            };
            corresponds(&setup, &image, solver, factor, factor);
        }
    }
}
