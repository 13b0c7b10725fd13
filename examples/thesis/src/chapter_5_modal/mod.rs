//! Chapter 5 without 5.3: modal parameters from free vibrations, the logarithmic decrement, and damping against
//! velocity.

mod decrement;
mod drag;
mod figures;
mod identifiability;
mod program_a2;
mod regressions;
mod simulated;
mod velocities;
mod windows;

use crate::{Chapter, Found, Settings};

/// Figs 8, 9, 10 and 12, Tables 1 and 2, Eq. 5.5.
///
/// # Errors
/// If a simulation or a fit cannot be done.
pub fn chapter(settings: &Settings<'_>) -> Found<Chapter> {
    let mut chapter = Chapter::new("5 Modal parameters");
    regressions::of_printed_numbers(&mut chapter)?;
    identifiability::of_free_vibrations(&mut chapter, settings)?;
    settings.done(0.3);
    let columns = windows::of_few_cycles(&mut chapter, settings)?;
    velocities::of_table_1(&mut chapter)?;
    drag::of_the_leaf_springs(&mut chapter)?;
    decrement::of_cycles(&mut chapter, settings)?;
    settings.done(0.9);
    figures::complete_test(&mut chapter, settings)?;
    figures::figure_12(&mut chapter, &columns)?;
    settings.done(1.0);
    Ok(chapter)
}
