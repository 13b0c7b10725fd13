//! Receptance against impulse: Figs 32 to 35.

use fmm_frf::{CoulombLine, FrequencyResponse, ResponseForm, SingleDegreeOfFreedom};
use fmm_uq::Observations;

use super::blows::{Blow, DURATION, LEVELS, RATE, SAMPLES, Spectra, Test, peak_receptance};
use super::{COEFFICIENT, LOAD, decibels, friction_force, linear, over_frequency, parts};
use crate::{Chapter, Criterion, Found, Target, printed};
use fmm_cli::figure::{Panel, Role};

/// Expected largest receptances (mm/N) of the three levels.
const EXPECTED: [f64; 3] = [3.510, 5.034, 5.787];

pub(super) fn add(chapter: &mut Chapter, blows: &[Blow], tests: &[Test], spectra: &mut Spectra) -> Found<()> {
    let [first, second, ..] = spectra.frequencies() else { return Err("the band has no lines".into()) };
    let spacing = second - first;
    chapter.target(
        Target::new("A19", "spacing of the lines of 33 s", "Hz", spacing, Criterion::near(1.0 / 33.0, 1e-12))
            .note("1/T, exact"),
    );
    chapter.target(
        Target::new("A19", "samples of 33 s at 10 kHz", "1", SAMPLES as f64, Criterion::near(330_000.0, 0.0))
            .note("exact"),
    );
    let mut peaks = Vec::new();
    let mut rows = Vec::new();
    let machine = linear()?;
    let omega = machine.natural_angular_frequency();
    let (mut closed, mut viscous) = (Vec::new(), Vec::new());
    for (blow, expected) in blows.iter().zip(EXPECTED) {
        let mobility = spectra.mobility(&blow.force, blow.velocity())?;
        let (frequency, peak) = peak_receptance(&mobility)?;
        let highest = mobility.peak().ok_or("the spectrum has no lines")?.1;
        let level = blow.level;
        chapter.target(
            Target::new(
                "C13",
                format!("largest receptance, {:.0} N, {} N s", level.peak, level.impulse),
                "mm/N",
                1e3 * peak,
                Criterion::within(expected, 0.01),
            )
            .note("half sine, μ = 0.113; 0.6 % by the shape of the pulse"),
        );
        let dry = undamped(&machine)?.peak_after_impact(level.impulse, friction_force())?;
        let damped = machine.peak_after_impact(level.impulse, friction_force())?;
        rows.push(vec![
            format!("{:.0}", level.peak),
            format!("{}", level.impulse),
            format!("{frequency:.3}"),
            format!("{:.3}", 1e3 * peak),
            format!("{:.3} ({:+.1} %)", 1e3 * dry, 100.0 * (dry / peak - 1.0)),
            format!("{:.3} ({:+.1} %)", 1e3 * damped, 100.0 * (damped / peak - 1.0)),
            format!("{:.1}", peak * machine.stiffness()),
            format!("{highest:.4}"),
        ]);
        peaks.push(peak);
        closed.push(dry);
        viscous.push(damped);
    }
    chapter.table(
        "Largest receptance of the three blows, simulated without noise, and closed forms",
        &[
            "level / N",
            "J / (N s)",
            "line / Hz",
            "|R| / (mm/N)",
            "π J/(8 F m ω)",
            "with viscous damping",
            "|R| k",
            "mobility / (m/(N s))",
        ],
        rows,
    );
    let impulses = LEVELS.map(|level| level.impulse);
    let line = CoulombLine::fit(&impulses, &peaks, machine.mass(), omega)?;
    line_targets(chapter, &line);
    not_a_property(chapter, &peaks, &line, spectra)?;
    structural(chapter, &closed, &viscous);
    figure_32_and_33(chapter, &tests[1])?;
    figure_34(chapter, tests)?;
    figure_35(chapter, tests)
}

/// The machine without its viscous damping.
fn undamped(machine: &SingleDegreeOfFreedom) -> Found<SingleDegreeOfFreedom> {
    Ok(SingleDegreeOfFreedom::new(machine.mass(), 0.0, machine.stiffness())?)
}

fn line_targets(chapter: &mut Chapter, line: &CoulombLine) {
    chapter.target(
        Target::new("C13", "receptance over impulse, R²", "1", line.r_squared, Criterion::AtLeast(0.999))
            .printed("very close to unity"),
    );
    chapter.target(
        Target::new(
            "C13",
            "receptance over impulse, slope",
            "mm/(N² s)",
            1e3 * line.slope.value,
            Criterion::within(3.451, 0.01),
        )
        .note("as the receptances"),
    );
}

fn not_a_property(chapter: &mut Chapter, peaks: &[f64], line: &CoulombLine, spectra: &mut Spectra) -> Found<()> {
    let machine = linear()?;
    let omega = machine.natural_angular_frequency();
    let without = Blow::of(LEVELS[1], 0.0)?;
    let cut = peak_receptance(&spectra.mobility(&without.force, without.velocity())?)?.1;
    let whole = machine.receptance(omega / std::f64::consts::TAU)?.norm();
    let times = |peak: Option<&f64>| peak.copied().unwrap_or_default() * machine.stiffness();
    chapter.finding(
        "The receptance is not a property of the machine: its peak is π J/(8 F m ω), proportional to the impulse and to 1/(μ N).",
        format!(
            "The three blows give {} mm/N, {:.0} to {:.1} times the static 1/k, where the machine without contact has {:.0} mm/N. Dry friction \
             makes the amplitude fall along a straight line of a length proportional to J, hence R² = {:.6}. The line is |R| = {:.3} J + {:.3}: \
             its slope alone gives F = {:.4} N, {:+.1} % off μ N = {:.4} N, as viscous damping bends it.",
            peaks.iter().map(|peak| format!("{:.3}", 1e3 * peak)).collect::<Vec<_>>().join(", "),
            times(peaks.first()),
            times(peaks.last()),
            1e3 * whole,
            line.r_squared,
            1e3 * line.slope.value,
            1e3 * line.intercept.value,
            line.friction_force.value,
            100.0 * (line.friction_force.value / friction_force() - 1.0),
            friction_force()
        ),
        &[],
    );
    let width = machine.damping() / (std::f64::consts::TAU * machine.mass());
    chapter.finding(
        "33 s are enough only because friction stops the machine.",
        format!(
            "Lines are {:.4} Hz apart; without the contact the half-power width is {width:.4} Hz, and a record cut at {DURATION} s shows a peak of \
             {:.0} mm/N in place of {:.0} mm/N. With it the hardest blow is over after {:.1} s.",
            RATE / SAMPLES as f64,
            1e3 * cut,
            1e3 * whole,
            fmm_frf::coulomb_impact_duration(LEVELS[2].impulse, friction_force())?
        ),
        &[],
    );
    Ok(())
}

fn structural(chapter: &mut Chapter, closed: &[f64], viscous: &[f64]) {
    let lost = closed.iter().zip(viscous).map(|(dry, damped)| format!("{:.1}", 100.0 * (dry / damped - 1.0)));
    chapter.finding(
        "Eq. 8.1 is Eq. 5.2 with the force of the hammer; it has no structural damping.",
        format!(
            "Its damping is c x′. Nor does it matter much: without c = {} N s/m the closed forms of the peaks are {} % higher.",
            printed::MACHINE[2],
            lost.collect::<Vec<_>>().join(", ")
        ),
        &["E29"],
    );
}

/// The band in which responses are drawn (Hz).
pub(super) const SHOWN: (f64, f64) = (1.0, 4.0);

fn figure_32_and_33(chapter: &mut Chapter, test: &Test) -> Found<()> {
    let name = format!("{} simulated trials", test.trials.len());
    let mobilities = shown(&test.mobilities)?;
    let receptances = mobilities.iter().map(|response| response.converted(ResponseForm::Receptance));
    let receptances = receptances.collect::<Result<Vec<_>, _>>()?;
    for (figure, number, what, responses, unit) in [
        ("figure_32", "Fig. 32", "mobility", &mobilities, "mm/(N s)"),
        ("figure_33", "Fig. 33", "receptance", &receptances, "mm/N"),
    ] {
        let curves: Vec<_> = responses.iter().map(|response| (Role::Measured, name.as_str(), response)).collect();
        chapter.figure(
            figure,
            format!(
                "{number}. Real and imaginary part of the {what} of {} trials of the {} level. Simulated: μ = {COEFFICIENT} at {LOAD} N. The \
                 trials differ because their impulses do.",
                test.trials.len(),
                test.level.name
            ),
            &parts(what, unit, 1e3, &curves),
        );
    }
    Ok(())
}

/// The lines from 1 Hz to 4 Hz of each response.
fn shown(responses: &[FrequencyResponse]) -> Found<Vec<FrequencyResponse>> {
    responses.iter().map(|response| Ok(response.within(SHOWN.0, SHOWN.1)?)).collect()
}

fn figure_34(chapter: &mut Chapter, tests: &[Test]) -> Found<()> {
    let mut panel = Panel::new("frequency / Hz", "|receptance| / (mm/N)", 340.0);
    let machine = linear()?;
    let frequency = machine.natural_angular_frequency() / std::f64::consts::TAU;
    let (mut closed, mut highest) = (Vec::new(), 0.0);
    for test in tests {
        let receptance = test.mean.within(SHOWN.0, SHOWN.1)?.converted(ResponseForm::Receptance)?;
        let curve = over_frequency(&receptance, |value| 1e3 * value.norm());
        panel = panel.with(Role::Measured, "means of simulated trials", curve);
        let impulse = mean(&test.impulses())?;
        highest = peak_receptance(&test.mean)?.1;
        closed.push((frequency, 1e3 * machine.peak_after_impact(impulse, friction_force())?));
    }
    panel = panel.with(Role::FittedPoints, "closed form, viscous and dry", closed);
    chapter.figure(
        "figure_34",
        format!(
            "Fig. 34. Magnitude of the mean receptance of {} trials each at three levels, from below 450 N, 1000 N and 1450 N. Simulated: \
             μ = {COEFFICIENT} at {LOAD} N at all levels. Without the contact the peak is {:.0} dB above the highest curve.",
            tests[0].trials.len(),
            decibels(machine.receptance(frequency)?.norm() / highest)
        ),
        &[panel],
    );
    Ok(())
}

fn figure_35(chapter: &mut Chapter, tests: &[Test]) -> Found<()> {
    let machine = linear()?;
    let omega = machine.natural_angular_frequency();
    let (mut single, mut impulses, mut peaks) = (Vec::new(), Vec::new(), Vec::new());
    for test in tests {
        single.extend(test.impulses().into_iter().zip(test.peaks()?.iter().map(|peak| 1e3 * peak)));
        impulses.push(mean(&test.impulses())?);
        peaks.push(peak_receptance(&test.mean)?.1);
    }
    let line = CoulombLine::fit(&impulses, &peaks, machine.mass(), omega)?;
    let ends = [0.9, 1.72];
    let fitted = ends.map(|impulse| (impulse, 1e3 * (line.intercept.value + line.slope.value * impulse)));
    let undamped = undamped(&machine)?;
    let [low, high] = ends.map(|impulse| undamped.peak_after_impact(impulse, friction_force()));
    let dry = vec![(ends[0], 1e3 * low?), (ends[1], 1e3 * high?)];
    let means = impulses.iter().copied().zip(peaks.iter().map(|peak| 1e3 * peak));
    let panel = Panel::new("impulse / (N s)", "largest |receptance| / (mm/N)", 360.0)
        .with(Role::Reference, "π J/(8 F m ω)", dry)
        .with(Role::Fitted, "line through the means", fitted.to_vec())
        .with(Role::Points, "simulated trials", single)
        .with(Role::FittedPoints, "means of the levels", means);
    chapter.figure(
        "figure_35",
        format!(
            "Fig. 35. Largest receptance against impulse. Simulated: μ = {COEFFICIENT} at {LOAD} N. The line through the means of {} trials each has \
             R² = {:.6}; the closed form without viscous damping lies above it.",
            tests[0].trials.len(),
            line.r_squared
        ),
        &[panel],
    );
    chapter.target(
        Target::new(
            "C13",
            "the same through means of noisy trials, R²",
            "1",
            line.r_squared,
            Criterion::AtLeast(0.999),
        )
        .printed("very close to unity")
        .note("30 simulated trials if not quick"),
    );
    Ok(())
}

fn mean(values: &[f64]) -> Found<f64> {
    Ok(Observations::new(values)?.mean())
}
