//! Times at which guards of a motion fall to zero, with their derivatives.

use fmm_model::Scalar;

use crate::error::SimulationError;
use crate::mechanics::curve::{Curve, first_zero};

/// The first of some `guards` that falls to zero between `start` and `limit`, with its time and whether it is only
/// grazed. Each has its curve, counted from `start`, and plain numbers of that; of two at one time the first counts.
pub(crate) fn first_crossing<'a, G, D: Scalar>(
    guards: impl IntoIterator<Item = (G, Curve<'a, D>, Curve<'a, f64>)>,
    start: D,
    limit: f64,
    budget: &mut usize,
) -> Result<Option<(G, D, bool)>, SimulationError> {
    let begin = start.value();
    let mut found: Option<(f64, G, Curve<D>)> = None;
    for (guard, curve, plain) in guards {
        let span = found.as_ref().map_or(limit - begin, |(elapsed, ..)| *elapsed);
        if let Some(elapsed) = first_zero(&plain, span, budget)?
            && found.as_ref().is_none_or(|(earlier, ..)| elapsed < *earlier)
        {
            found = Some((elapsed, guard, curve));
        }
    }
    Ok(found.map(|(elapsed, guard, curve)| {
        let (time, grazing) = crossing(&curve, start, begin + elapsed);
        (guard, time, grazing)
    }))
}

/// The time at which `guard`, counted from `start`, crosses zero near `time`, with its derivatives; and whether it only
/// grazes zero there, without derivatives.
pub(crate) fn crossing<D: Scalar>(guard: &Curve<D>, start: D, time: f64) -> (D, bool) {
    if D::DIRECTIONS == 0 {
        return (D::from(time), false);
    }
    let elapsed = -start + time;
    let value = guard.at(elapsed);
    let jet = guard.plain_jet(elapsed.value());
    // Where the slope is that small, rounding moves the zero further than it is from the turning point.
    let grazing = jet.slope * jet.slope <= 4.0 * f64::EPSILON * jet.size * jet.most_curvature.max(f64::MIN_POSITIVE);
    if grazing { (D::from(time), true) } else { (-(value - value.value()) / jet.slope + time, false) }
}
