//! Chapter 5.3: Table 3 and Fig. 11.

mod computed;
mod printed_columns;
mod uncertainty;

use computed::Computed;

use crate::{Chapter, Found, Settings};

/// Table 3 by derivatives, by refits of the exact motion and by refits of the thesis' own, and Fig. 11.
///
/// # Errors
/// If a fit fails.
pub fn chapter(settings: &Settings<'_>) -> Found<Chapter> {
    let mut chapter = Chapter::new("5.3 Monte Carlo");
    let computed = Computed::new(settings)?;
    printed_columns::of_table_3(&mut chapter, &computed);
    uncertainty::by_derivatives(&mut chapter, &computed)?;
    uncertainty::by_refits(&mut chapter, &computed, settings)?;
    uncertainty::budgets(&mut chapter, &computed)?;
    uncertainty::figure_11(&mut chapter, &computed)?;
    settings.done(1.0);
    Ok(chapter)
}
