//! The thesis' machine.

use fmm_record::Quantity;

use super::{Case, Found, Random, Setup, noise};

/// Time between samples (s), and the length of a record (s).
pub(crate) const INTERVAL: f64 = 1e-3;
pub(crate) const SECONDS: f64 = 3.0;
/// White noise of a velocity (m/s), and of a displacement (m).
pub(crate) const NOISE: f64 = 1e-3;
pub(crate) const DISPLACEMENT_NOISE: f64 = 5e-6;

/// The thesis' machine under 14 N, let go at 22 mm, with a contact of `law` and no damping of its own.
pub(crate) fn setup(law: &'static str, values: &[f64]) -> Setup {
    Setup {
        mass: 10.391,
        stiffness: 1982.0,
        damping: 0.0,
        quadratic: 0.0,
        load: 14.0,
        release: 0.022,
        law,
        values: values.to_vec(),
        right: vec![law],
    }
}

/// The same with its damping and a coefficient of 0.25.
pub(crate) fn coulomb_viscous() -> Setup {
    Setup { damping: 0.275, right: vec!["coulomb_viscous", "coulomb + linear"], ..setup("coulomb", &[0.25]) }
}

/// A record of `quantity` of `setup` over [`SECONDS`], to which `disturb` adds what a measurement adds.
pub(crate) fn record(
    setup: &Setup,
    quantity: Quantity,
    interval: f64,
    random: &mut Random,
    disturb: impl FnOnce(&mut [f64], &mut Random),
) -> Found<Case> {
    lasting(setup, quantity, interval, SECONDS, random, disturb)
}

/// As [`record`], of another length (s).
pub(crate) fn lasting(
    setup: &Setup,
    quantity: Quantity,
    interval: f64,
    seconds: f64,
    random: &mut Random,
    disturb: impl FnOnce(&mut [f64], &mut Random),
) -> Found<Case> {
    let motion = setup.motion(interval, (seconds / interval).round() as usize)?;
    let velocity = motion.velocity().values();
    let peak_speed = largest(velocity);
    let mut values = if quantity == Quantity::Displacement { motion.position().values() } else { velocity }.to_vec();
    disturb(&mut values, random);
    Case::new(setup, values, interval, quantity, peak_speed)
}

/// A velocity record with white noise, as the thesis has them.
pub(crate) fn velocity(setup: &Setup, interval: f64, random: &mut Random) -> Found<Case> {
    record(setup, Quantity::Velocity, interval, random, |values, random| noise::white(values, NOISE, random))
}

/// The largest absolute value.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}
