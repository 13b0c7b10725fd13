//! The profiles of a report: quantities about which value ± k u misleads.

use std::error::Error;

use fmm_fit::ProfileEnd;
use fmm_identify::{Profile, Profiles};
use fmm_model::Rounded;

use super::{Found, LEVEL};
use crate::figure::{Panel, Role, drawn, label};
use crate::page::{bullets, figure, interval, row_heading, table, text_cell, words};

/// Points of a parabola.
const POINTS: usize = 200;
/// A parabola is drawn as far as this many times the threshold (1).
const TOP: f64 = 1.6;

/// The intervals by the sum of squares beside those by the standard uncertainty, with a curve of each that bends.
pub(super) fn profiles(found: &Found) -> Result<String, Box<dyn Error>> {
    let profiles = found.comparison.preferred().profiles(&found.decays, LEVEL)?;
    let (bent, straight): (Vec<&Profile>, Vec<_>) = profiles.profiles().iter().partition(|profile| profile.is_bent());
    let left_out = profiles.left_out().iter();
    let left_out = bullets(left_out.map(|(parameter, error)| format!("{}: none, as {error}", words(parameter.name()))));
    let within = straight.iter().map(|profile| profile.bend()).fold(0.0, f64::max);
    let within = (100.0 * within).ceil().max(1.0);
    let said = match (bent.is_empty(), straight.is_empty()) {
        (true, true) => {
            "There is nothing to draw: no fitted quantity has an interval by the sum of squares.".to_owned()
        }
        (true, false) => {
            format!(
                "All intervals are symmetric within {within:.0} % of k u, as value ± k u takes them: no profile is \
                 drawn."
            )
        }
        (false, true) => "For none of the fitted quantities does value ± k u hold.".to_owned(),
        (false, false) => format!("All other intervals are symmetric within {within:.0} % of k u."),
    };
    let rows = bent.iter().map(|profile| {
        let ((low, high), by_squares) = (profile.straight(), profile.interval());
        let ends = (by_squares.lower().value(), by_squares.upper().value());
        // The ends are rounded to half the width of the interval by value ± k u.
        let reach = Some(0.25 * (high - low)).filter(|reach| *reach > 0.0);
        let rounded = Rounded::new(profile.value(), reach);
        let value = rounded.to_string();
        vec![
            row_heading(&words(profile.parameter().name())),
            text_cell(&value.split(" ± ").next().unwrap_or_default().replace('(', "")),
            text_cell(profile.parameter().unit()),
            text_cell(&rounded.interval(low, high)),
            text_cell(&interval(&rounded, ends, "no end on either side")),
            text_cell(&misleads(profile)),
        ]
    });
    let headings = ["quantity", "value", "unit", "value ± k u", "by the sum of squares", "what that says"];
    let table = if bent.is_empty() { String::new() } else { table("profiles", &headings, rows) };
    let figures = bent.iter().enumerate().map(|(number, profile)| picture(number, profile));
    Ok(format!(
        "<p>Each fitted quantity is moved away from its value and all others are fitted again, until the sum of \
         squares has risen by as much as 95 % allow: that interval follows the bends of the model, value ± k u does \
         not. Both speak of the residuals alone, with the noise that they show; gains, inputs and other laws come on \
         top of it. A quantity counts as bent from a difference of {:.0} % of k u on. The search took {} evaluations \
         of the motion, and ends after {}.</p>\n<p>{said}</p>\n{left_out}{table}{}",
        100.0 * Profiles::BENT,
        profiles.residual_evaluations(),
        Profiles::MOST_EVALUATIONS,
        figures.collect::<Vec<_>>().concat()
    ))
}

/// Result of a profile in words.
fn misleads(profile: &Profile) -> String {
    let side = |end: ProfileEnd, side: &str| match end {
        ProfileEnd::At(_) => None,
        ProfileEnd::Bound(bound) => {
            Some(format!("{side} it the record rules nothing out as far as the bound {}", Rounded::new(bound, None)))
        }
        ProfileEnd::Edge(_) => Some(format!("{side} it the record rules nothing out as far as the law has a motion")),
        _ => Some(format!("{side} it the record rules nothing out")),
    };
    let sides: Vec<String> = [side(profile.interval().lower(), "below"), side(profile.interval().upper(), "above")]
        .into_iter()
        .flatten()
        .collect();
    if sides.is_empty() {
        format!("one side differs by {:.0} % of k u", 100.0 * profile.bend())
    } else {
        sides.join("; ")
    }
}

/// The curve of a profile, the parabola of value ± k u, and the threshold.
fn picture(number: usize, profile: &Profile) -> String {
    let curve = profile.curve();
    let threshold = profile.interval().threshold();
    let (low, high) = profile.straight();
    let first = curve.first().map_or(low, |point| point.0.min(low));
    let last = curve.last().map_or(high, |point| point.0.max(high));
    let parabola = (0..=POINTS)
        .map(|step| first + (last - first) * step as f64 / POINTS as f64)
        .map(|value| (value, profile.parabola(value)))
        .filter(|(_, rise)| *rise <= TOP * threshold);
    let axis = label(words(profile.parameter().name()), profile.parameter().unit());
    let panel = Panel::new(axis, "rise of the sum of squares over the variance", 300.0)
        .with(Role::Fitted, "profile", curve.iter().copied())
        .with(Role::Measured, "value ± k u", parabola)
        .with(Role::Reference, "95 %", [(first, threshold), (last, threshold)]);
    let caption = format!(
        "{}: the sum of squares with all others fitted again, beside the parabola of value ± k u; below the line lies \
         the 95 % interval.",
        words(profile.parameter().name())
    );
    figure(&drawn(&[panel]), &caption, &format!("profile-{number}"))
}
