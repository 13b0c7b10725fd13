//! Mode of a posterior over coordinates, and the whitening about it.

use crate::algebra::definite;
use crate::diagnostics::autocorrelation;
use crate::error::FitError;
use crate::posterior::coordinates::Whitening;
use crate::posterior::target::Target;
use crate::problem::residuals::Residuals;
use crate::result::fit::Fit;

/// Newton steps at most. A centre that is not quite the mode costs a sampler some steps and nothing else.
const STEPS: usize = 40;
/// A step that promises less of ln p is the last.
const ENOUGH: f64 = 1e-4;
/// The longest step of a coordinate: a factor of e² in the distance from a bound.
const LONGEST: f64 = 2.0;
/// Distance from a bound at which the search begins, over the deviation that the residuals alone would give (1).
const FROM_BOUND: f64 = 0.5;

/// The whitening about the mode that lies downhill of `fit`.
///
/// # Errors
/// [`FitError::NoModel`] and [`FitError::Undetermined`].
pub(super) fn whiten<P: Residuals + ?Sized>(target: &mut Target<'_, P>, fit: &Fit) -> Result<Whitening, FitError> {
    let mut psi = start(target, fit)?;
    let order = psi.len();
    let (mut gradient, mut trial) = (vec![0.0; order], vec![0.0; order]);
    let mut density = evaluate(target, &psi, &mut gradient)?;
    for _ in 0..STEPS {
        let [_, mut factored] = target.curvatures(&psi);
        let diagonal: Vec<f64> = (0..order).map(|j| factored[j * order + j]).collect();
        if !definite::factor(&mut factored, order, |j| 1e-13 * diagonal[j]) {
            break;
        }
        let mut step = gradient.clone();
        definite::solve(&factored, &mut step);
        let promised: f64 = step.iter().zip(&gradient).map(|(step, slope)| step * slope).sum();
        let longest = (0..order).filter(|&j| target.is_bounded(j)).map(|j| step[j].abs()).fold(0.0, f64::max);
        if promised.is_nan() || promised < ENOUGH {
            break;
        }
        let mut share = if longest > LONGEST { LONGEST / longest } else { 1.0 };
        let found = loop {
            for j in 0..order {
                trial[j] = psi[j] + share * step[j];
            }
            match target.log_density(&trial) {
                Some(better) if better > density => break true,
                _ if share < 1e-6 => break false,
                _ => share *= 0.25,
            }
        };
        if !found {
            break;
        }
        std::mem::swap(&mut psi, &mut trial);
        density = evaluate(target, &psi, &mut gradient)?;
    }
    // The last look may have been a trial.
    evaluate(target, &psi, &mut gradient)?;
    let [straight, bent] = target.curvatures(&psi);
    Whitening::new(psi, &target.transforms(), &straight, &bent).ok_or_else(|| undetermined(target, fit))
}

/// The coordinates of the fitted values, those at a bound moved off it.
fn start<P: Residuals + ?Sized>(target: &mut Target<'_, P>, fit: &Fit) -> Result<Vec<f64>, FitError> {
    let free = target.free().to_vec();
    let deviation = fit.residual_standard_deviation().filter(|s| *s > 0.0).unwrap_or(1.0);
    let rho = autocorrelation(fit.residuals(), 1).unwrap_or(0.0).clamp(-0.99, 0.99);
    let mut psi = Vec::with_capacity(target.dimension());
    for pass in 0..2 {
        // The first pass is for the derivatives, from which the second takes the distance from the bounds.
        let distances: Vec<f64> = (0..free.len())
            .map(|place| {
                let norm = if pass == 0 { 0.0 } else { target.column_norm(place) };
                if norm > 0.0 {
                    FROM_BOUND * deviation / norm
                } else {
                    1e-6 * fit.values()[free[place]].abs().max(1e-6)
                }
            })
            .collect();
        psi.clear();
        psi.extend(free.iter().zip(distances).enumerate().map(|(place, (&j, distance))| {
            let transform = target.transform(place);
            transform.coordinate(transform.inside(fit.values()[j], distance))
        }));
        psi.resize(target.dimension(), target.transform(free.len()).coordinate(rho));
        evaluate(target, &psi, &mut vec![0.0; target.dimension()])?;
    }
    Ok(psi)
}

fn evaluate<P: Residuals + ?Sized>(
    target: &mut Target<'_, P>,
    psi: &[f64],
    gradient: &mut [f64],
) -> Result<f64, FitError> {
    target.log_density_and_gradient(psi, gradient).ok_or_else(|| no_start(target))
}

pub(super) fn no_start<P: Residuals + ?Sized>(target: &Target<'_, P>) -> FitError {
    let last = target.non_finite().map_or_else(String::new, |reason| format!("; at the last of them {reason}"));
    FitError::no_model(format!("no point about the fit has finite residuals and derivatives{last}"))
}

fn undetermined<P: Residuals + ?Sized>(target: &Target<'_, P>, fit: &Fit) -> FitError {
    let directions = fit.null_directions();
    let names: Vec<String> = match directions {
        [] => target.free().iter().map(|&j| fit.estimates()[j].name().to_owned()).collect(),
        _ => directions.iter().map(ToString::to_string).collect(),
    };
    let parameters = names.join("; ");
    FitError::undetermined(format!(
        "residuals and priors together do not determine {parameters}; fix one of them or give it a prior that has a \
         width"
    ))
}
