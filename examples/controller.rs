//! A position loop with and without feed-forward of friction: `cargo run --release --example controller`.
//!
//! Friction is found in a record of force along a motion; what the controller knows of it is that law, and what the
//! joint does is moved by the true one, step by step.

use std::error::Error;
use std::f64::consts::TAU;

use fmm_friction::{SlidingLaw, Stribeck};
use fmm_identify::{Candidate, Finding, ForceRecord, Identification, Machine, compare};
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Force, State, Stepped, Stepper};

/// Mass (kg) and viscous damping (N s/m) of the slide.
const MASS: f64 = 2.0;
const DAMPING: f64 = 1.5;
/// Period of the controller (s).
const PERIOD: f64 = 1e-3;

/// A force (N) of the wanted velocity (m/s) and acceleration (m/s²).
type FeedForward<'a> = &'a dyn Fn(f64, f64) -> f64;

/// Friction of the slide: 3 N, and 4 N at rest.
fn friction() -> Result<Stribeck, Box<dyn Error>> {
    Ok(Stribeck::new(3.0, 4.0, 0.02, 1.0, 0.0)?)
}

/// The wanted position (m) with its velocity and acceleration: to and fro by 50 mm at 0.5 Hz.
fn wanted(time: f64) -> (State, f64) {
    let (angular, (sin, cos)) = (0.5 * TAU, (0.5 * TAU * time).sin_cos());
    let amplitude = 0.05;
    let state = State { position: -amplitude * cos, velocity: amplitude * angular * sin };
    (state, amplitude * angular * angular * cos)
}

fn main() -> Result<(), Box<dyn Error>> {
    let identification = identified()?;
    println!("{identification}\n");
    let value = |name: &str| identification.finding(name).map(Finding::value).ok_or("not found");
    let [sliding, breakaway, speed, exponent, damping, inertia] =
        ["sliding_friction_force", "static_friction_force", "stribeck_speed", "exponent", "damping", "inertia"]
            .map(value);
    let law = Stribeck::new(sliding?, breakaway?, speed?, exponent?, damping?)?;
    let inertia = inertia?;
    let mean = sliding?;

    println!("Position error of the loop, in µm:\n");
    println!("{:<42} {:>8} {:>8}", "force beside the controller's", "rms", "greatest");
    let rows: [(&str, FeedForward); 4] = [
        ("none", &|_, _| 0.0),
        ("inertia", &|_, acceleration| inertia * acceleration),
        ("inertia and a constant level", &|v, acceleration| inertia * acceleration + mean * sign(v)),
        ("inertia and the law that was found", &|v, acceleration| {
            inertia * acceleration + law.coefficient(v.abs()) * sign(v)
        }),
    ];
    for (what, feed_forward) in rows {
        let errors = follow(feed_forward)?;
        let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        let greatest = errors.iter().fold(0.0f64, |most, error| most.max(error.abs()));
        println!("{what:<42} {:>8.1} {:>8.1}", 1e6 * rms, 1e6 * greatest);
    }
    Ok(())
}

/// The sign of a wanted velocity; none at rest.
fn sign(velocity: f64) -> f64 {
    if velocity == 0.0 { 0.0 } else { velocity.signum() }
}

/// Position errors (m) of two cycles after the first, with a force (N) of the wanted velocity and acceleration beside
/// that of the controller, which holds its force over each period.
fn follow(feed_forward: FeedForward) -> Result<Vec<f64>, Box<dyn Error>> {
    let machine = Oscillator::new(MASS, 0.0)?.with_damping(Damping::linear(DAMPING)?);
    let mut joint = Stepper::new(machine, friction()?, 1.0)?;
    // Critically damped at 5 Hz.
    let bandwidth = 5.0 * TAU;
    let (proportional, derivative) = (MASS * bandwidth * bandwidth, 2.0 * MASS * bandwidth);
    let mut now = wanted(0.0).0;
    let mut errors = Vec::new();
    for period in 0..6000 {
        let time = f64::from(period) * PERIOD;
        let (aim, _) = wanted(time);
        // The force acts over the period to come; its middle is the best that one number can do.
        let (ahead, acceleration) = wanted(time + 0.5 * PERIOD);
        let corrects = proportional * (aim.position - now.position) + derivative * (aim.velocity - now.velocity);
        let force = Force::held(corrects + feed_forward(ahead.velocity, acceleration));
        let Stepped { state, .. } = joint.step(now, force, PERIOD)?;
        now = state;
        if time >= 2.0 {
            errors.push(wanted(time + PERIOD).0.position - now.position);
        }
    }
    Ok(errors)
}

/// The fit to a force that moves the slide along a sine, with noise of 50 mN.
fn identified() -> Result<Identification, Box<dyn Error>> {
    let law = friction()?;
    let times: Vec<f64> = (0..8000).map(|i| f64::from(i) * PERIOD).collect();
    let states: Vec<_> = times.iter().map(|time| wanted(*time)).collect();
    let noise = |i: usize| 0.05 * ((i * i % 1009) as f64 / 504.5 - 1.0);
    let force = |(i, (state, acceleration)): (usize, &(State, f64))| {
        let speed = state.velocity.abs();
        MASS * acceleration + DAMPING * state.velocity + law.coefficient(speed) * state.velocity.signum() + noise(i)
    };
    let forces: Vec<f64> = states.iter().enumerate().map(force).collect();
    let positions: Vec<f64> = states.iter().map(|(state, _)| state.position).collect();
    let record = ForceRecord::of_positions(&times, &positions, &forces)?.in_units("m", "N");
    let candidate = Candidate::named("stribeck + inertia")?;
    Ok(compare(&Machine::per_unit_mass(), &[record], &[candidate])?.preferred().clone())
}
