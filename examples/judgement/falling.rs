//! Cells in which friction falls with the speed, on machines at random.

use fmm_record::Quantity;

use super::cell::Group;
use super::draw::{Drawn, End, LIKE_THESIS};
use super::law::Law;
use super::{Case, Cell, Found, Random};

/// The cells.
pub(crate) fn cells() -> Vec<Cell> {
    vec![
        cell(
            "stribeck",
            "static level 1.2 to 2.5 times the sliding one, gone at 2 to 30 % of the peak speed",
            |fall, random| {
                let exponent = if random.coin() { 1.0 } else { 2.0 };
                let values = vec![fall.sliding, fall.breakaway, fall.speed, exponent, 0.0];
                // With an exponent of one it is Berger's law with a viscous part.
                let right: &[&'static str] =
                    if exponent == 1.0 { &["stribeck", "berger", "berger + linear"] } else { &["stribeck"] };
                ("stribeck", values, right)
            },
        ),
        cell("berger", "the same with Berger's law", |fall, _| {
            let values = vec![fall.sliding, fall.breakaway - fall.sliding, fall.speed.recip()];
            ("berger", values, &["berger", "berger + linear", "stribeck"])
        }),
        cell("hyperbolic", "hyperbolic, from the static level to the sliding one at the peak speed", |fall, _| {
            let decay = (fall.breakaway / fall.sliding - 1.0) / fall.peak_speed;
            ("hyperbolic", vec![fall.breakaway, decay], &["hyperbolic", "hyperbolic + linear"])
        }),
        cell("exponential_pair", "falling while the speed grows, rising while it falls", |fall, random| {
            let rise = random.log_uniform(10.0, 50.0) / fall.peak_speed;
            let values = vec![fall.sliding, fall.breakaway, fall.speed.recip(), rise];
            ("exponential_pair", values, &["exponential_pair", "exponential_pair + linear"])
        }),
    ]
}

/// How friction falls.
struct Fall {
    /// Levels at large speed and at rest (1).
    sliding: f64,
    breakaway: f64,
    /// Speed over which it falls (m/s).
    speed: f64,
    /// About the largest speed (m/s).
    peak_speed: f64,
}

type Chosen = (&'static str, Vec<f64>, &'static [&'static str]);

fn cell(name: &str, about: &str, choose: fn(&Fall, &mut Random) -> Chosen) -> Cell {
    Cell::new(Group::Falling, format!("falling/{name}"), about, move |random| {
        let machine = LIKE_THESIS.draw(1.0, random);
        let sliding = random.uniform(0.05, 0.6);
        let fall = Fall {
            sliding,
            breakaway: sliding * random.uniform(1.2, 2.5),
            speed: machine.speed() * random.log_uniform(0.02, 0.3),
            peak_speed: machine.speed(),
        };
        let (law, values, right) = choose(&fall, random);
        drawn(&machine, law, values, right, random)
    })
}

fn drawn(
    machine: &Drawn,
    law: &'static str,
    values: Vec<f64>,
    right: &[&'static str],
    random: &mut Random,
) -> Found<Case> {
    /// Share of the peak speed whose friction stops the machine about as soon as all of the curve does.
    const TYPICAL: f64 = 0.4;
    let levels = Law::named(law).and_then(|law| law.levels(&values, TYPICAL * machine.speed()));
    let load = machine.friction / levels.ok_or("the law has no level")?.peak;
    let setup = machine.with(law, values, load, right);
    machine.record(&setup, Quantity::Velocity, End::Any, random)
}
