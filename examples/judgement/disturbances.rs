//! Cells in which Coulomb and viscous friction are right and the measurement is not as it should be.

use std::f64::consts::TAU;

use fmm_record::Quantity;

use super::cell::Group;
use super::filter::{delayed, low_passed};
use super::thesis::{self, DISPLACEMENT_NOISE, INTERVAL, NOISE, largest};
use super::{Case, Cell, Found, Random, Setup, noise};

/// The cells.
pub(crate) fn cells() -> Vec<Cell> {
    vec![
        velocity("rounded", "noise of 1 mm/s, rounded to 10 mm/s", |values, random| {
            noise::white(values, NOISE, random);
            noise::rounded(values, 10.0 * NOISE, random);
        }),
        displacement(
            "encoder",
            "no noise but steps of 1/2000 to 1/100 of the amplitude, with rest",
            |values, random| {
                let step = largest(values) / random.log_uniform(100.0, 2000.0);
                noise::rounded(values, step, random);
            },
        ),
        velocity("remembering", "noise of 1 mm/s that remembers 0.9 of itself", |values, random| {
            noise::remembering(values, 0.9, NOISE, random);
        }),
        velocity("growing-speed", "noise of 0.3 mm/s and 1 to 5 % of the speed", |values, random| {
            let (sizes, share) = (values.to_vec(), random.uniform(0.01, 0.05));
            noise::growing(values, &sizes, 3e-4, share, random);
        }),
        cell("growing-envelope", "noise of 0.3 mm/s and 1 to 5 % of the envelope", growing_with_envelope),
        displacement("drift", "slow drift of 50 μm, noise of 5 μm", |values, random| {
            noise::drift(values, 50e-6, random);
            noise::white(values, DISPLACEMENT_NOISE, random);
        }),
        displacement("walk", "random walk of 50 μm, noise of 5 μm", |values, random| {
            noise::walk(values, 50e-6, random);
            noise::white(values, DISPLACEMENT_NOISE, random);
        }),
        cell("low-pass", "Butterworth filter at 20 f₀, 5 ms late", filtered),
        velocity("hum", "50 Hz of 0.5 to 10 % of the peak", |values, random| {
            let amplitude = largest(values) * random.log_uniform(0.005, 0.1);
            noise::sine(values, INTERVAL, (50.0, amplitude, f64::INFINITY), random);
            noise::white(values, NOISE, random);
        }),
        cell("two-releases", "12 mm, back by hand, 20 mm", two_releases),
        velocity("second-mode", "9.7 Hz of 5 %, gone after 0.3 to 1 s", |values, random| {
            let (amplitude, lasting) = (0.05 * largest(values), random.uniform(0.3, 1.0));
            noise::sine(values, INTERVAL, (9.7, amplitude, lasting), random);
            noise::white(values, NOISE, random);
        }),
        cell("10-khz", "sampled at 10 kHz", |setup, random| thesis::velocity(setup, 0.1 * INTERVAL, random)),
    ]
}

fn cell(name: &str, about: &str, draw: impl Fn(&Setup, &mut Random) -> Found<Case> + Send + Sync + 'static) -> Cell {
    let draw = move |random: &mut Random| draw(&thesis::coulomb_viscous(), random);
    Cell::new(Group::Disturbance, format!("disturbed/{name}"), about, draw)
}

fn velocity(name: &str, about: &str, disturb: fn(&mut [f64], &mut Random)) -> Cell {
    cell(name, about, move |setup, random| thesis::record(setup, Quantity::Velocity, INTERVAL, random, disturb))
}

fn displacement(name: &str, about: &str, disturb: fn(&mut [f64], &mut Random)) -> Cell {
    cell(name, about, move |setup, random| thesis::record(setup, Quantity::Displacement, INTERVAL, random, disturb))
}

/// Noise with the amplitude that the swing has, not with the speed of the moment.
fn growing_with_envelope(setup: &Setup, random: &mut Random) -> Found<Case> {
    let motion = setup.motion(INTERVAL, (thesis::SECONDS / INTERVAL).round() as usize)?;
    let samples = motion.position().values().iter().zip(motion.velocity().values());
    let envelope: Vec<f64> = samples.map(|(x, v)| v.hypot(setup.angular_frequency() * x)).collect();
    // At rest nothing swings, whatever the spring is deflected by.
    let rest = motion.rest().map_or(f64::INFINITY, |rest| rest.time);
    let sizes: Vec<f64> =
        envelope.iter().enumerate().map(|(i, size)| if INTERVAL * i as f64 > rest { 0.0 } else { *size }).collect();
    thesis::record(setup, Quantity::Velocity, INTERVAL, random, |values, random| {
        let share = random.uniform(0.01, 0.05);
        noise::growing(values, &sizes, 3e-4, share, random);
    })
}

/// An instrument with a corner at 20 times the natural frequency, and a clock that is 5 ms late; then noise.
fn filtered(setup: &Setup, random: &mut Random) -> Found<Case> {
    const FINER: usize = 20;
    const DELAY: f64 = 5e-3;
    let fine = INTERVAL / FINER as f64;
    let motion = setup.motion(fine, (thesis::SECONDS / fine).round() as usize)?;
    let velocity = motion.velocity().values();
    let corner = 20.0 * setup.angular_frequency() / TAU;
    let seen = delayed(&low_passed(velocity, fine.recip(), corner), (DELAY / fine).round() as usize);
    let mut values: Vec<f64> = seen.into_iter().step_by(FINER).collect();
    noise::white(&mut values, NOISE, random);
    Case::new(setup, values, INTERVAL, Quantity::Velocity, largest(velocity))
}

/// A release of 12 mm, a rest, a hand that takes the machine to 20 mm within a second and holds it a little, and
/// another release.
fn two_releases(setup: &Setup, random: &mut Random) -> Found<Case> {
    const BY_HAND: usize = 1000;
    const HELD: usize = 200;
    let first = Setup { release: 0.012, ..setup.clone() }.motion(INTERVAL, 1500)?;
    let second = Setup { release: 0.02, ..setup.clone() }.motion(INTERVAL, 2500)?;
    let rest = first.position().values().last().copied().unwrap_or(0.0);
    let by_hand = (0..BY_HAND).map(|i| {
        let share = i as f64 / BY_HAND as f64;
        (0.02 - rest) * (1.0 - (TAU * share).cos()) / (INTERVAL * BY_HAND as f64)
    });
    let mut values = first.velocity().values().to_vec();
    values.extend(by_hand.chain(std::iter::repeat_n(0.0, HELD)));
    values.extend(second.velocity().values());
    let peak_speed = largest(&values);
    noise::white(&mut values, NOISE, random);
    Case::new(setup, values, INTERVAL, Quantity::Velocity, peak_speed)
}
