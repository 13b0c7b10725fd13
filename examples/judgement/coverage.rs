//! Cells in which a standard law is right and the noise is white.

use fmm_record::Quantity;

use super::cell::Group;
use super::draw::{ANY, End};
use super::thesis::{self, DISPLACEMENT_NOISE, INTERVAL, SECONDS};
use super::{Case, Cell, Found, Random, Setup, noise};

/// The cells.
pub(crate) fn cells() -> Vec<Cell> {
    let mut cells = vec![
        velocity("viscous", || thesis::setup("viscous", &[0.2])),
        velocity("coulomb", || thesis::setup("coulomb", &[0.25])),
        velocity("coulomb_viscous", thesis::coulomb_viscous),
        displacement("cut", "that ends before the stop", 1.1),
        displacement("rest", "with the rest", SECONDS),
    ];
    for law in ["viscous", "coulomb", "coulomb_viscous"] {
        cells.push(any_machine(law, Quantity::Velocity, End::Any, "velocity"));
    }
    cells.push(any_machine("viscous", Quantity::Displacement, End::Any, "displacement"));
    for law in ["coulomb", "coulomb_viscous"] {
        cells.push(any_machine(law, Quantity::Displacement, End::BeforeStop, "displacement-cut"));
        cells.push(any_machine(law, Quantity::Displacement, End::AfterStop, "displacement-rest"));
    }
    cells
}

fn velocity(law: &str, setup: fn() -> Setup) -> Cell {
    let (name, about) = (format!("right/thesis-velocity-{law}"), format!("{law}, thesis' machine, velocity, 1 mm/s"));
    Cell::new(Group::Coverage, name, about, move |random| thesis::velocity(&setup(), INTERVAL, random))
}

fn displacement(end: &str, which: &str, seconds: f64) -> Cell {
    let name = format!("right/thesis-displacement-{end}");
    let about = format!("coulomb_viscous, thesis' machine, displacement {which}, 5 μm");
    Cell::new(Group::Coverage, name, about, move |random| {
        let setup = thesis::coulomb_viscous();
        thesis::lasting(&setup, Quantity::Displacement, INTERVAL, seconds, random, |values, random| {
            noise::white(values, DISPLACEMENT_NOISE, random);
        })
    })
}

fn any_machine(law: &'static str, quantity: Quantity, end: End, channel: &str) -> Cell {
    let (name, about) = (format!("right/any-{channel}-{law}"), format!("{law}, machines at random, {channel}"));
    Cell::new(Group::Coverage, name, about, move |random| drawn(law, quantity, end, random))
}

fn drawn(law: &str, quantity: Quantity, end: End, random: &mut Random) -> Found<Case> {
    let mut ranges = ANY;
    if law == "viscous" {
        // Some damping, or nothing decays.
        ranges.damping_ratio.0 = 0.002;
    } else if law == "coulomb" {
        ranges.damping_ratio = (0.0, 0.0);
    }
    let stops = end != End::Any || random.coin();
    let share = if stops { 1.0 } else { random.uniform(0.3, 1.0) };
    let machine = ranges.draw(share, random);
    let coefficient = random.uniform(0.05, 0.8);
    let load = machine.friction / coefficient;
    let setup = match law {
        "viscous" => machine.with("coulomb", vec![0.0], load, &["viscous"]),
        "coulomb" => machine.with("coulomb", vec![coefficient], load, &["coulomb"]),
        _ => machine.with("coulomb", vec![coefficient], load, &["coulomb_viscous", "coulomb + linear"]),
    };
    machine.record(&setup, quantity, end, random)
}
