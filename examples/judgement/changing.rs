//! Cells in which dry friction, or its load, changes during the record, on machines at random.

use std::f64::consts::PI;

use fmm_friction::Coulomb;
use fmm_record::{Quantity, Record};
use fmm_sim::{Sampling, Scenario, Trajectory, simulate};

use super::cell::Group;
use super::draw::{Drawn, LIKE_THESIS};
use super::law::Levels;
use super::thesis::largest;
use super::{Case, Cell, Found, Random, Truth, noise};

/// Friction over that at the beginning (1), by the half cycles that have passed and their number.
type Factor = Box<dyn Fn(f64, f64) -> f64>;

/// The cells.
pub(crate) fn cells() -> Vec<Cell> {
    vec![
        cell("wear", "Coulomb friction that falls by 0.5 to 2 % with each half cycle", |random| {
            let share = random.uniform(0.005, 0.02);
            Box::new(move |passed, _| (1.0 - share).powf(passed))
        }),
        cell("slight-wear", "the same by 0.1 to 0.5 %", |random| {
            let share = random.uniform(0.001, 0.005);
            Box::new(move |passed, _| (1.0 - share).powf(passed))
        }),
        cell(
            "warming",
            "Coulomb friction that falls to 70 to 95 %, half of it within 10 to 40 % of the time",
            |random| {
                let (end, half) = (random.uniform(0.7, 0.95), random.uniform(0.1, 0.4));
                Box::new(move |passed, all| end + (1.0 - end) * 0.5f64.powf(passed / (half * all)))
            },
        ),
        cell("load-over-time", "a load that rises on a line by 5 to 30 %", |random| {
            let rise = random.uniform(0.05, 0.3);
            Box::new(move |passed, all| 1.0 + rise * passed / all)
        }),
        Cell::new(
            Group::Changing,
            "changing/load-over-position".to_owned(),
            "a load that rises from the middle to the largest deflection by 5 to 30 %",
            |random| {
                let machine = LIKE_THESIS.draw(1.0, random);
                let (coefficient, rise) = (random.uniform(0.05, 0.6), random.uniform(0.05, 0.3));
                over_position(&machine, coefficient, rise, random)
            },
        ),
    ]
}

fn cell(name: &str, about: &str, choose: fn(&mut Random) -> Factor) -> Cell {
    Cell::new(Group::Changing, format!("changing/{name}"), about, move |random| {
        let machine = LIKE_THESIS.draw(1.0, random);
        let coefficient = random.uniform(0.05, 0.6);
        let factor = choose(random);
        drawn(&machine, coefficient, &factor, random)
    })
}

/// The terms beside Coulomb friction of both a machine with damping and one without.
const CHANGE: [&str; 2] = ["coulomb + change", "coulomb_viscous + change"];
const POSITION: [&str; 2] = ["coulomb + position", "coulomb_viscous + position"];

fn drawn(machine: &Drawn, coefficient: f64, factor: &Factor, random: &mut Random) -> Found<Case> {
    let load = machine.friction / coefficient;
    let setup = machine.with("coulomb", vec![coefficient], load, &CHANGE);
    let half_period = PI / setup.angular_frequency();
    let half_cycles = machine.half_cycles();
    let at = |index: u32| load * factor(f64::from(index), half_cycles);
    // Past the planned end the load stays.
    let loads: Vec<f64> = (0..=half_cycles as u32).map(at).collect();
    let scenario = Scenario::new(setup.oscillator()?, Coulomb::new(coefficient)?, load)?;
    let scenario = scenario.under_sampled_load(half_period, loads.clone())?.starting_at(setup.release, 0.0)?;
    let Released { record, motion, peak_speed } = released(machine, &scenario, half_period, random)?;
    let mean = mean_over_path(&motion, |time, _| {
        let (place, last) = (time / half_period, loads.len() - 1);
        let below = (place as usize).min(last);
        let above = (below + 1).min(last);
        (loads[below] + (loads[above] - loads[below]) * (place - below as f64)) / load
    });
    let change = (loads[loads.len() - 1] / loads[0] - 1.0) / (loads.len() - 1) as f64 / mean;
    let truth = Truth { levels: Levels::constant(coefficient * mean), change, ..setup.truth(peak_speed)? };
    Ok(Case { record, machine: setup.known()?, truth })
}

/// A load that rises by the share `rise` from the middle to the release.
fn over_position(machine: &Drawn, coefficient: f64, rise: f64, random: &mut Random) -> Found<Case> {
    let load = machine.friction / coefficient;
    let setup = machine.with("coulomb", vec![coefficient], load, &POSITION);
    let scenario = Scenario::new(setup.oscillator()?, Coulomb::new(coefficient)?, load)?;
    let curvature = rise / setup.release.powi(2);
    let scenario = scenario.under_curved_load(curvature)?.starting_at(setup.release, 0.0)?;
    let half_period = PI / setup.angular_frequency();
    let Released { record, motion, peak_speed } = released(machine, &scenario, half_period, random)?;
    let mean = mean_over_path(&motion, |_, position| 1.0 + curvature * position * position);
    let levels = Levels::constant(coefficient * mean);
    let truth = Truth { levels, rise: rise / mean, ..setup.truth(peak_speed)? };
    Ok(Case { record, machine: setup.known()?, truth })
}

/// The velocity of a simulated motion, with noise.
struct Released {
    record: Record,
    motion: Trajectory,
    peak_speed: f64,
}

fn released(
    machine: &Drawn,
    scenario: &Scenario<f64, Coulomb<f64>>,
    half_period: f64,
    random: &mut Random,
) -> Found<Released> {
    let interval = 2.0 * half_period / machine.samples();
    let count = (machine.half_cycles() * half_period / interval).ceil() as usize;
    let motion = simulate(scenario, &Sampling::uniform(interval, count)?)?;
    let mut values = motion.velocity().values().to_vec();
    let peak_speed = largest(&values);
    noise::white(&mut values, peak_speed / machine.signal_to_noise(), random);
    let record = Record::new(0.0, interval, values, Quantity::Velocity, "m/s")?;
    Ok(Released { record, motion, peak_speed })
}

/// Mean over the path slid of a `factor` by time (s) and position (m).
fn mean_over_path(motion: &Trajectory, factor: impl Fn(f64, f64) -> f64) -> f64 {
    let places = motion.times().zip(motion.position().values()).zip(motion.velocity().values());
    let (mut sum, mut path) = (0.0, 0.0);
    for ((time, position), velocity) in places {
        sum += factor(time, *position) * velocity.abs();
        path += velocity.abs();
    }
    sum / path
}
