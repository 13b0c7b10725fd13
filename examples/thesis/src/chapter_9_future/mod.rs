//! Section 9.2: what the thesis leaves to the future, on simulated records of known truth and on real ones.
//!
//! Laws with a state, of Dahl, `LuGre` and Maxwell, that the thesis would use if there were tests at low constant
//! velocity: what a ring-down says of them. And a monolithic machine beside an assembled one: what a ring-down says of
//! the clamps. And which tests would have told more than those of Table 5.

mod clamps;
mod measured;
mod next_tests;
mod presliding;

use fmm_friction::{Coulomb, Dahl, LuGre, MaxwellSlipOf};
use fmm_identify::{Candidate, Terms};

use crate::{Chapter, Found, Settings};

/// The questions of section 9.2.
///
/// # Errors
/// If a simulation or a fit cannot be done.
pub fn chapter(settings: &Settings<'_>) -> Found<Chapter> {
    let mut chapter = Chapter::new("9.2 Future work");
    presliding::add(&mut chapter, settings)?;
    settings.done(0.6);
    measured::add(&mut chapter, settings)?;
    settings.done(0.9);
    clamps::add(&mut chapter, settings)?;
    settings.done(0.95);
    next_tests::add(&mut chapter)?;
    settings.done(1.0);
    Ok(chapter)
}

/// Results of `of` for 0 up to `count`, each on a thread of its own, in this order.
fn side_by_side<T: Send>(count: usize, of: &(impl Fn(usize) -> Found<T> + Sync)) -> Vec<Found<T>> {
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..count).map(|index| scope.spawn(move || of(index))).collect();
        threads
            .into_iter()
            .map(|thread| thread.join().unwrap_or_else(|_| Err("a comparison panicked".into())))
            .collect()
    })
}

/// Dry friction, and the three laws that have it as their limit: Dahl's with exponent 1, `LuGre`'s with a simple
/// exponential, and two Maxwell elements; beside those without a viscous part of their own with `terms`.
fn candidates(terms: &Terms) -> Found<[Candidate; 4]> {
    Ok([
        Candidate::of::<Coulomb>().with(terms.clone()),
        Candidate::of::<Dahl>().with(terms.clone()).holding("exponent", 1.0)?,
        Candidate::of::<LuGre>().holding("exponent", 1.0)?,
        Candidate::of::<MaxwellSlipOf<2>>().with(terms.clone()),
    ])
}
