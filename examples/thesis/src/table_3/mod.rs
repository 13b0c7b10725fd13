//! Table 3: what a coefficient of friction inherits from the mass, stiffness and damping that a fit holds.
//!
//! A ring-down of known truth is fitted again and again, each time on another machine: mass, stiffness and damping
//! drawn from what is known of them, one at a time and all together. The thesis' raw data are not published, so the
//! record is simulated, with the machine, load and initial velocity of the thesis' program A3.
//!
//! ```
//! use fmm_fit::{Options, solve};
//! use fmm_sim::Exact;
//! use fmm_thesis::table_3::{Sensitivities, problem};
//!
//! let problem = problem(&Exact)?;
//! let fit = solve(&problem, problem.values(), &Options::default())?;
//! let sensitivities = Sensitivities::of(&problem, &fit)?;
//! assert!((sensitivities.budget()?.standard_uncertainty() / 2.4712e-4 - 1.0).abs() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error + Send + Sync>>(())
//! ```

mod problem;
mod rows;
mod sensitivities;

pub use problem::{Problem, TRUTH, problem};
pub use rows::{Row, euler_rows, exact_rows};
pub use sensitivities::Sensitivities;

use fmm_uq::{Input, Inputs};

use crate::{Found, printed};

/// Names and units of what is varied; values and standard uncertainties are those of Table 2.
pub const VARIED: [(&str, &str); 3] = [("mass", "kg"), ("stiffness", "N/m"), ("damping", "N s/m")];

/// The rows of the table: one quantity varied, or all.
pub const ROWS: [&str; 4] = ["mass", "stiffness", "damping", "all"];

/// The inputs of one of the [`ROWS`].
///
/// # Errors
/// None that the printed values could raise.
pub fn inputs(row: &str) -> Found<Inputs> {
    Ok(Inputs::new(quantities(|name| row == name || row == "all")?)?)
}

/// Mass, stiffness and damping, each uncertain if it is `varied` and otherwise exact.
fn quantities(varied: impl Fn(&str) -> bool) -> Found<Vec<Input>> {
    let known = printed::MACHINE.into_iter().zip(printed::MACHINE_DEVIATIONS);
    let input = |((name, unit), (value, u)): ((&str, &str), (f64, f64))| {
        Ok(Input::new(name, value, if varied(name) { u } else { 0.0 }, unit)?)
    };
    VARIED.into_iter().zip(known).map(input).collect()
}
