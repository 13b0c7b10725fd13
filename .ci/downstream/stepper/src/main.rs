//! How far off is a slide that follows a ramp, with its friction compensated and without?

use std::error::Error;

use fmm_friction::{FeedForward, LuGre, SlidingLaw, Stribeck};
use fmm_model::{Dual, Oscillator, Scalar};
use fmm_sim::{Force, State, Stepper};

/// Period of the controller (s), and the wanted velocity (m/s).
const PERIOD: f64 = 1e-3;
const VELOCITY: f64 = 0.03;

fn main() -> Result<(), Box<dyn Error>> {
    let law = Stribeck::new(3.0, 4.0, 0.02, 1.0, 1.5)?;
    let plain = lag(|_| 0.0)?;
    let by_speed = lag(|velocity| law.coefficient(velocity))?;
    // A model with bristles knows the level as well, a little later.
    let mut bristles = FeedForward::new(LuGre::new(3.0, 4.0, 0.02, 1.0, 1e6, 100.0, 1.5)?, [0.0])?;
    let by_bristles = lag(|velocity| bristles.step(velocity, PERIOD).unwrap_or(0.0))?;
    println!("behind by {:.1} µm, {:.1} µm and {:.1} µm", 1e6 * plain, 1e6 * by_speed, 1e6 * by_bristles);

    // 5000 N/m against the friction at 30 mm/s.
    let friction = law.coefficient(VELOCITY);
    assert!((plain - friction / 5000.0).abs() < 1e-6, "{plain} m");
    assert!(by_speed.abs() < 1e-6 && by_bristles.abs() < 1e-6, "{by_speed} m, {by_bristles} m");

    // What one newton does to the velocity of a slide without a spring: h/m less what the slope of the friction takes.
    let number = Dual::<1>::from;
    let law = Stribeck::new(number(3.0), number(4.0), number(0.02), number(1.0), number(1.5))?;
    let mut joint = Stepper::new(Oscillator::new(number(2.0), number(0.0))?, law, number(1.0))?;
    let sliding = State { position: number(0.0), velocity: number(VELOCITY) };
    let gain = joint.step(sliding, Force::held(Dual::variable(friction, 0)), PERIOD)?.state.velocity.partial(0);
    assert!((gain / (PERIOD / 2.0) - 1.0).abs() < 0.01, "{gain} m/s per N");
    Ok(())
}

/// How far (m) the slide is behind after 2 s of a ramp.
fn lag(mut feed_forward: impl FnMut(f64) -> f64) -> Result<f64, Box<dyn Error>> {
    let mut joint = Stepper::new(Oscillator::new(2.0, 0.0)?, Stribeck::new(3.0, 4.0, 0.02, 1.0, 1.5)?, 1.0)?;
    let mut now = State { position: 0.0, velocity: VELOCITY };
    for period in 0..2000 {
        let wanted = f64::from(period) * PERIOD * VELOCITY;
        let force = 5000.0 * (wanted - now.position) + 200.0 * (VELOCITY - now.velocity) + feed_forward(VELOCITY);
        now = joint.step(now, Force::held(force), PERIOD)?.state;
    }
    Ok(2000.0 * PERIOD * VELOCITY - now.position)
}
