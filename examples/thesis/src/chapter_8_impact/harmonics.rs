//! Lines at the odd multiples of the natural frequency: Fig. 42.

use std::f64::consts::TAU;

use fmm_frf::{FrequencyResponse, FrictionSpectrum, ResponseForm};
use fmm_friction::Coulomb;
use fmm_identify::identify;

use super::blows::{Blow, Spectra, Test};
use super::friction::{fitted_velocity, known_machine, mobilities};
use super::{COEFFICIENT, LOAD, decibels, linear, over_frequency};
use crate::{Chapter, Criterion, Found, Target};
use fmm_cli::figure::{Panel, Role};

/// The highest order that is looked at.
const HIGHEST: u32 = 9;
/// Odd orders, the level (dB) of the friction force there, and that of the response by the linear one (dB).
const EXPECTED: [(u32, f64, f64); 4] = [(3, -9.5, 2.4), (5, -14.0, -1.8), (7, -16.9, 1.1), (9, -19.0, -0.9)];

pub(super) fn add(chapter: &mut Chapter, blows: &[Blow], tests: &[Test], spectra: &mut Spectra) -> Found<()> {
    let linear = linear()?.frequency_response(ResponseForm::Mobility, spectra.frequencies())?;
    let fundamental = self::linear()?.natural_angular_frequency() / TAU;
    let mut found = Vec::new();
    for blow in blows {
        let mobility = spectra.mobility(&blow.force, blow.velocity())?;
        let harmonics = FrictionSpectrum::of(&mobility, &linear)?.harmonics(fundamental, HIGHEST)?;
        // |H| of each order by that of the first.
        let size = |order: usize| {
            let at = harmonics[order - 1].frequency;
            let line = mobility.frequencies().iter().position(|frequency| *frequency >= at).unwrap_or(0);
            mobility.values()[line].norm()
        };
        let relative: Vec<f64> = (1..=HIGHEST as usize).map(|order| decibels(size(order) / size(1))).collect();
        found.push((harmonics, relative));
    }
    for (order, level, deviation) in EXPECTED {
        let index = order as usize - 1;
        for (blow, (harmonics, _)) in blows.iter().zip(&found) {
            let quantity = format!("friction force at {order} f₀ by that at f₀, {:.0} N", blow.level.peak);
            chapter.target(
                Target::new("C14", quantity, "dB", harmonics[index].level, Criterion::near(level, 0.2))
                    .note(format!("a square wave has {:.1} dB; motion of finite length", -decibels(f64::from(order)))),
            );
        }
        let quantity = format!("|H/H_lin| at {order} f₀, 1000 N");
        chapter.target(
            Target::new("C14", quantity, "dB", found[1].0[index].deviation, Criterion::near(deviation, 0.1))
                .note("reference to its last digit, 0.05 dB, and as much for the shape of the pulse"),
        );
    }
    let even = |of: fn(&fmm_frf::Harmonic) -> f64| {
        let even = found.iter().flat_map(|(harmonics, _)| harmonics.iter().filter(|one| one.order % 2 == 0));
        even.map(of).fold(f64::NEG_INFINITY, f64::max)
    };
    let loudest = even(|harmonic| harmonic.level);
    chapter.target(
        Target::new(
            "C14",
            "friction force at 2, 4, 6, 8 f₀ by that at f₀, largest",
            "dB",
            loudest,
            Criterion::AtMost(-22.0),
        )
        .note("none but for the finite length"),
    );
    table(chapter, blows, &found);
    let odd = |index: usize| {
        let levels = EXPECTED.map(|(order, ..)| format!("{:+.1}", found[index].0[order as usize - 1].deviation));
        levels.join(", ")
    };
    chapter.finding(
        "The odd harmonics are ripples on the slope 1/(m ω) of the mobility, not peaks.",
        format!(
            "Friction is nearly a square wave, so that its spectrum has −9.5, −14.0, −16.9 and −19.0 dB at 3, 5, 7 and 9 f₀ at every level. \
             Against the mobility without contact the response has {} dB there (1000 N), and at even multiples at most {:.2} dB: they show when \
             |H| is divided by |H_lin|, and tell that friction is symmetric.",
            odd(1),
            even(|harmonic| harmonic.deviation.abs())
        ),
        &[],
    );
    figure_42(chapter, blows, &tests[1], spectra, &linear)
}

fn table(chapter: &mut Chapter, blows: &[Blow], found: &[(Vec<fmm_frf::Harmonic>, Vec<f64>)]) {
    let mut headings = vec!["order".to_owned()];
    for blow in blows {
        let level = blow.level.peak;
        headings.extend(["|R|, ", "|H/H_lin|, ", "|H|, "].map(|what| format!("{what}{level:.0} N")));
    }
    let rows = (0..HIGHEST as usize).map(|index| {
        let cells = found.iter().flat_map(|(harmonics, relative)| {
            let harmonic = &harmonics[index];
            [harmonic.level, harmonic.deviation, relative[index]].map(|value| format!("{value:.2}"))
        });
        std::iter::once(format!("{}", index + 1)).chain(cells).collect()
    });
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    chapter.table(
        "Multiples of f₀ / dB: friction force R by that at f₀, mobility by the linear one, mobility by that at f₀; simulated without noise",
        &headings,
        rows.collect(),
    );
}

fn figure_42(
    chapter: &mut Chapter,
    blows: &[Blow],
    test: &Test,
    spectra: &mut Spectra,
    linear: &FrequencyResponse,
) -> Found<()> {
    let trial = &test.trials[..1];
    let fit = identify::<Coulomb>(&known_machine()?, &mobilities(trial)?)?;
    let model = fitted_velocity(&fit, trial)?;
    let record = &test.mobilities[0];
    let model = spectra.mobility_of_pulse(&trial[0], &model)?;
    let size = |response: &FrequencyResponse| over_frequency(response, |value| decibels(value.norm()));
    let mobilities = Panel::new("", "|mobility| / dB re 1 m/(N s)", 340.0)
        .with(Role::Measured, "simulated record", size(record))
        .with(Role::Fitted, "fit", size(&model))
        .with(Role::Reference, "without contact", size(linear));
    let by_linear = |response: &FrequencyResponse| -> Found<Vec<(f64, f64)>> {
        let spectrum = FrictionSpectrum::of(response, linear)?;
        let levels = spectrum.quotients().iter().map(|quotient| decibels(quotient.norm()));
        Ok(spectrum.frequencies().iter().copied().zip(levels).filter(|(frequency, _)| *frequency > 3.0).collect())
    };
    let ratios = Panel::new("", "|H/H_lin| / dB", 260.0)
        .with(Role::Measured, "simulated record", by_linear(record)?)
        .with(Role::Fitted, "fit", by_linear(&model)?);
    let clean = spectra.mobility(&blows[1].force, blows[1].velocity())?;
    let friction = FrictionSpectrum::of(&clean, linear)?;
    let fundamental = self::linear()?.natural_angular_frequency() / TAU;
    let first = friction.values().map(fmm_frf::Complex64::norm).fold(0.0, f64::max);
    let force =
        friction.frequencies().iter().copied().zip(friction.values().map(|value| decibels(value.norm() / first)));
    let square = [1.0, 3.0, 5.0, 7.0, 9.0].map(|order: f64| (order * fundamental, -decibels(order)));
    let forces = Panel::new("frequency / Hz", "friction force / dB re f₀", 280.0)
        .with(Role::Reference, "of the motion without noise", force)
        .with(Role::FittedPoints, "square wave, 1/n", square.to_vec());
    chapter.figure(
        "figure_42",
        format!(
            "Fig. 42. Mobility of a trial of the medium level to 20 Hz, the same by the mobility without contact from 3 Hz on, and the friction \
             force, 1 − H/H_lin. Simulated: μ = {COEFFICIENT} at {LOAD} N. The odd harmonics are ripples of up to 2.4 dB."
        ),
        &[mobilities, ratios, forces],
    );
    Ok(())
}
