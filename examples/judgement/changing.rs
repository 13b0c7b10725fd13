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

fn drawn(machine: &Drawn, coefficient: f64, factor: &Factor, random: &mut Random) -> Found<Case> {
    let load = machine.friction / coefficient;
    let setup = machine.with("coulomb", vec![coefficient], load, &["coulomb + change", "coulomb_viscous + change"]);
    let half_period = PI / setup.angular_frequency();
    let half_cycles = machine.half_cycles();
    let at = |index: u32| load * factor(f64::from(index), half_cycles);
    // Past the planned end the load stays.
    let loads: Vec<f64> = (0..=half_cycles as u32).map(at).collect();
    let scenario = Scenario::new(setup.oscillator()?, Coulomb::new(coefficient)?, load)?;
    let scenario = scenario.under_sampled_load(half_period, loads.clone())?.starting_at(setup.release, 0.0)?;
    let interval = 2.0 * half_period / machine.samples();
    let count = (half_cycles * half_period / interval).ceil() as usize;
    let motion = simulate(&scenario, &Sampling::uniform(interval, count)?)?;
    let mut values = motion.velocity().values().to_vec();
    let peak_speed = largest(&values);
    noise::white(&mut values, peak_speed / machine.signal_to_noise(), random);
    let mean = mean_over_path(&motion, |time| {
        let (place, last) = (time / half_period, loads.len() - 1);
        let below = (place as usize).min(last);
        let above = (below + 1).min(last);
        (loads[below] + (loads[above] - loads[below]) * (place - below as f64)) / load
    });
    let level = coefficient * mean;
    let change = (loads[loads.len() - 1] / loads[0] - 1.0) / (loads.len() - 1) as f64 / mean;
    let truth =
        Truth { levels: Levels { rest: level, peak: level, beyond: level }, change, ..setup.truth(peak_speed)? };
    let record = Record::new(0.0, interval, values, Quantity::Velocity, "m/s")?;
    Ok(Case { record, machine: setup.known()?, truth })
}

/// Mean of a `factor` over the path slid (1).
fn mean_over_path(motion: &Trajectory, factor: impl Fn(f64) -> f64) -> f64 {
    let times = motion.times();
    let (mut sum, mut path) = (0.0, 0.0);
    for (time, velocity) in times.zip(motion.velocity().values()) {
        sum += factor(time) * velocity.abs();
        path += velocity.abs();
    }
    sum / path
}
