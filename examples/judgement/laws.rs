//! Cells of every law of the catalogue on the thesis' machine at the stated noise.

use super::cell::Group;
use super::thesis::{self, INTERVAL};
use super::{Cell, Setup};

/// Each law with values like those of the thesis.
const LAWS: &[(&str, &[f64])] = &[
    ("viscous", &[0.2]),
    ("coulomb", &[0.25]),
    // The damping of the thesis' machine, as a viscous part under 14 N.
    ("coulomb_viscous", &[0.25, 0.275 / 14.0]),
    ("acceleration_coulomb", &[0.26, 0.24]),
    ("stribeck", &[0.2, 0.35, 0.05, 1.2, 0.02]),
    ("stribeck_lorentzian", &[0.2, 0.35, 0.05, 0.02]),
    ("hyperbolic", &[0.35, 3.0]),
    ("berger", &[0.228, 0.261, 2.852]),
    ("power_law", &[0.311, 0.2116, 0.031_48]),
    ("exponential_pair", &[0.2, 0.3, 10.0, 50.0]),
    ("makkar_dixon", &[0.25, 100.0, 10.0, 0.1, 40.0, 0.02]),
    ("regularised_stribeck", &[0.3, 0.2, 0.01, 0.02]),
    ("karnopp", &[0.25, 0.3, 1e-3]),
    ("dahl", &[0.25, 1000.0, 1.0]),
    ("lugre", &[0.2, 0.3, 0.05, 2.0, 1000.0, 1.0, 0.02]),
    ("bouc_wen", &[250.0, 1.0, 600.0, 400.0, 1.0]),
];

/// Those that are also sampled at 10 kHz.
const FAST: [&str; 2] = ["coulomb_viscous", "stribeck"];

/// The cells.
pub(crate) fn cells() -> Vec<Cell> {
    let all = LAWS.iter().map(|(law, values)| cell(law, thesis::setup(law, values), INTERVAL));
    let drag = Setup { quadratic: 3.1, right: vec!["coulomb + quadratic"], ..thesis::setup("coulomb", &[0.2]) };
    let fast = LAWS.iter().filter(|(law, _)| FAST.contains(law));
    let fast = fast.map(|(law, values)| cell(&format!("{law}-10-khz"), thesis::setup(law, values), 0.1 * INTERVAL));
    all.chain(std::iter::once(cell("coulomb+quadratic", drag, INTERVAL))).chain(fast).collect()
}

fn cell(name: &str, mut setup: Setup, interval: f64) -> Cell {
    if setup.law == "coulomb_viscous" {
        setup.right.push("coulomb + linear");
    }
    let about = format!("{} {:?} on the thesis' machine", setup.law, setup.values);
    Cell::new(Group::Law, format!("law/{name}"), about, move |random| thesis::velocity(&setup, interval, random))
}
