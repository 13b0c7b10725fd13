//! Section 7.5: the continuously differentiable law, raw and shifted, Figs 25 to 28.

use fmm_fit::{Options, solve};
use fmm_friction::{LawFamily, MakkarDixon, ShiftedMakkarDixon, SlidingLaw};
use fmm_record::Record;
use fmm_sim::{Engine, Sampling, Thesis};

use super::{Known, LOAD_5, Release, fit_panels, rms, seed, value};
use crate::ring_down::{INTERVAL, Viscous, machine, motion, over_time, scenario};
use crate::{Chapter, Criterion, Found, Settings, Target};
use fmm_cli::figure::{Panel, Role};

/// Where A6 starts: γ₁ to γ₅, and γ₆ = 0.
const A6: [f64; 6] = [0.25, 100.0, 10.0, 0.1, 100.0, 0.0];
/// γ's with a static level of 0.63 and a dynamic one of 0.24, as printed in section 7.5; three of many.
const ILLUSTRATIONS: [[f64; 6]; 3] = [
    [0.418_71, 500.0, 5.0, 0.24, 500.0, 0.0],
    [0.405_91, 1000.0, 5.0, 0.24, 1000.0, 0.0],
    [0.608_74, 100.0, 10.0, 0.24, 100.0, 0.0],
];
/// γ's of the comparison of raw and shifted law.
const COMPARED: [f64; 6] = [0.39, 500.0, 5.0, 0.24, 500.0, 0.0];

pub(super) fn add(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    levels(chapter)?;
    start_of_a6(chapter)?;
    unshifted(chapter)?;
    shapes(chapter)?;
    fitted(chapter, settings)
}

fn law([difference, rise, fall, level, level_rise, viscous]: [f64; 6]) -> Found<MakkarDixon> {
    Ok(MakkarDixon::six(difference, rise, fall, level, level_rise, viscous)?)
}

fn shifted(values: [f64; 6]) -> Found<ShiftedMakkarDixon> {
    Ok(ShiftedMakkarDixon::new(law(values)?))
}

/// Static and dynamic level of the illustration.
fn levels(chapter: &mut Chapter) -> Found<()> {
    let mut cells = Vec::new();
    for (i, values) in ILLUSTRATIONS.into_iter().enumerate() {
        let law = shifted(values)?;
        let (speed, peak) = law.law().peak().ok_or("the law has no peak")?;
        // At 10 m/s all hyperbolic tangents are 1 to rounding.
        let [level, dynamic] = [law.breakaway(), law.coefficient(10.0)];
        cells.push(vec![
            format!("{}, {}, {}, {}, {}", values[0], values[1], values[2], values[3], values[4]),
            format!("{:.4} at {:.1} mm/s", peak, 1e3 * speed),
            format!("{:.2}", 1e3 * law.inflection()),
            format!("{level:.4}"),
            format!("{:.4}", law.coefficient(0.3)),
            format!("{dynamic:.4}"),
        ]);
        if i == 0 {
            let note =
                "γ found so that the printed levels come out: an illustration, no fit of the thesis can be repeated";
            for (quantity, ours, reference, text) in
                [("static level after the shift", level, 0.63, "0.63"), ("dynamic level", dynamic, 0.24, "0.24")]
            {
                chapter.target(
                    Target::new("C11", quantity, "1", ours, Criterion::near(reference, 1e-4)).printed(text).note(note),
                );
            }
            let row = |quantity: &str, unit, ours, criterion| {
                Target::new("C11", format!("illustration, {quantity}"), unit, ours, criterion)
                    .note("reference to its last digit")
            };
            chapter.target(row("height of the peak", "1", peak, Criterion::near(0.6431, 1e-4)));
            chapter.target(row("inflection", "mm/s", 1e3 * law.inflection(), Criterion::near(13.73, 5e-3)));
        }
    }
    chapter.table(
        "Section 7.5: three sets of γ₁ to γ₅ with the printed levels, of many; γ₂ and γ₃ are free",
        &["γ₁ to γ₅", "peak of the raw law", "inflection / (mm/s)", "static, shifted", "shifted at 0.3 m/s", "dynamic"],
        cells,
    );
    Ok(())
}

/// Meaning of the start values of A6, and Eq. 7.5 as printed.
fn start_of_a6(chapter: &mut Chapter) -> Found<()> {
    let law = shifted(A6)?;
    let (speed, peak) = law.law().peak().ok_or("the law has no peak")?;
    let sum = A6[0] + A6[3];
    let row = |quantity: &str, unit, ours, reference, tolerance| {
        Target::new("C11", format!("A6's start, {quantity}"), unit, ours, Criterion::near(reference, tolerance))
            .note("reference to its last digit")
    };
    chapter.target(row("height of the peak", "1", peak, 0.2881, 5e-5));
    chapter.target(row("speed of the peak", "mm/s", 1e3 * speed, 20.2, 0.06));
    chapter.target(row("inflection", "mm/s", 1e3 * law.inflection(), 37.45, 5e-3));
    chapter.target(row("static level after the shift", "1", law.breakaway(), 0.2601, 5e-5));
    chapter.finding(
        "The static level is not γ₁ + γ₄ but the coefficient at the inflection that the curve is shifted by.",
        format!(
            "For A6's start γ₁ + γ₄ = {sum:.2}, the peak is {peak:.4} at {:.1} mm/s, and the shifted curve begins at {:.4}, {:.0} % below \
             the sum.",
            1e3 * speed,
            law.breakaway(),
            100.0 * (1.0 - law.breakaway() / sum)
        ),
        &["E21"],
    );
    // Eq. 7.5 with its printed sign: the Stribeck part less the level.
    let stribeck = self::law([A6[0], A6[1], A6[2], 0.0, A6[4], 0.0])?;
    let level = self::law([0.0, A6[1], A6[2], A6[3], A6[4], 0.0])?;
    let printed = |v: f64| stribeck.coefficient(v) - level.coefficient(v);
    let highest = (1..1000).map(|i| printed(1e-4 * f64::from(i))).fold(f64::NEG_INFINITY, f64::max);
    for (speed, reference) in [(0.1, -0.040), (1.0, -0.100)] {
        let quantity = format!("Eq. 7.5 as printed, A6's start, at {speed} m/s");
        chapter.target(
            Target::new("C11", quantity, "1", printed(speed), Criterion::near(reference, 5e-4))
                .note("negative: it would push; reference to its last digit"),
        );
    }
    chapter.finding(
        "Eq. 7.5 prints −γ₄ where A6 and Makkar et al. have +γ₄.",
        format!(
            "With the minus and A6's start the coefficient rises to {highest:.3} only, and is {:.3} at 0.1 m/s and {:.3} at 1 m/s: a friction \
             that drives the motion.",
            printed(0.1),
            printed(1.0)
        ),
        &["E20"],
    );
    Ok(())
}

/// A6 makes a table of the shifted law and integrates the unshifted one.
fn unshifted(chapter: &mut Chapter) -> Found<()> {
    const START: f64 = 0.28;
    let machine = machine(Viscous::Mean)?;
    let sampling = Sampling::uniform(INTERVAL, 5000)?;
    let raw = scenario::<MakkarDixon>(machine, &COMPARED, LOAD_5, (0.0, START))?;
    let raw = motion::<MakkarDixon>(&raw, &sampling)?;
    let moved = scenario::<ShiftedMakkarDixon>(machine, &COMPARED, LOAD_5, (0.0, START))?;
    let coded = Thesis::A6.run(&scenario::<MakkarDixon>(machine, &COMPARED, LOAD_5, (0.0, START))?, &sampling)?;
    let moved = motion::<ShiftedMakkarDixon>(&moved, &sampling)?;
    let rest = moved.rest().ok_or("the shifted law does not stop the motion")?;
    // A6 compares 1840 samples.
    let end = 1840;
    let [one, other, code] = [&raw, &moved, &coded].map(|motion| motion.velocity().values());
    let difference: Vec<f64> = one[..end].iter().zip(other).map(|(a, b)| 1e3 * (a - b)).collect();
    let slow = one.iter().rposition(|v| v.abs() >= 1e-4).unwrap_or(0) as f64 * INTERVAL;
    let row = |quantity: &str, unit, ours, reference, tolerance| {
        Target::new("C11", quantity, unit, ours, Criterion::near(reference, tolerance))
            .note("reference to its last digit")
    };
    chapter.target(row("raw law, speed at 1.84 s", "mm/s", 1e3 * one[end].abs(), 0.48, 5e-3));
    chapter.target(row("raw law, position at 1.84 s", "mm", 1e3 * raw.position().values()[end].abs(), 0.64, 5e-3));
    chapter.target(row("raw law, faster than 0.1 mm/s until", "s", slow, 3.9, 0.05));
    let stepped = "reference not met to its last digit; two samples of 1 ms allowed";
    chapter.target(row("shifted law, rest", "s", rest.time, 1.245, 2e-3).note(stepped));
    chapter.target(row("shifted law, position at rest", "mm", 1e3 * rest.position, -0.19, 0.01).note(stepped));
    chapter.target(row("raw less shifted, rms until 1.84 s", "mm/s", rms(&difference), 4.5, 0.06));
    chapter.finding(
        "A6 integrates the unshifted law: its motion creeps and cannot stop, and its coefficients do not belong to the shifted curve of \
         Figs 26 and 28.",
        format!(
            "With γ = (0.39, 500, 5, 0.24, 500) at 8.604 N from 0.28 m/s the shifted law rests at {:.3} s; the raw one still creeps with \
             {:.2} mm/s at 1.84 s (A6's own Euler motion with {:.2} mm/s) and is faster than 0.1 mm/s until {slow:.1} s. The two differ by \
             {:.1} mm/s rms and {:.0} mm/s at most: two models, not one.",
            rest.time,
            1e3 * one[end].abs(),
            1e3 * code[end].abs(),
            rms(&difference),
            super::largest(difference.iter().copied())
        ),
        &["E22"],
    );
    chapter.figure(
        "raw_and_shifted",
        "Section 7.5. Velocity with the raw law, which A6 integrates, and with the shifted law, which the text describes; simulated with γ = \
         (0.39, 500, 5, 0.24, 500) at 8.604 N from 0.28 m/s. Bottom: the end of the motion.",
        &[
            Panel::new("time / s", "velocity / (mm/s)", 260.0)
                .with(Role::Reference, "raw law (A6)", over_time(&one[..2400], 1e3))
                .with(Role::Fitted, "shifted law (text)", over_time(&other[..2400], 1e3)),
            Panel::new("time / s", "velocity / (mm/s)", 220.0)
                .with(Role::Reference, "raw law (A6)", late(one))
                .with(Role::Fitted, "shifted law (text)", late(other)),
        ],
    );
    Ok(())
}

/// The end of a velocity (m/s), in mm/s over s.
fn late(values: &[f64]) -> Vec<(f64, f64)> {
    over_time(values, 1e3).into_iter().filter(|(time, _)| (1.05..4.0).contains(time)).collect()
}

/// Figs 25 and 26.
fn shapes(chapter: &mut Chapter) -> Found<()> {
    let law = shifted(A6)?;
    let speeds = || (0..=400).map(|i| 5e-4 * f64::from(i));
    let odd = |of: &dyn Fn(f64) -> f64, sign: f64| -> Vec<(f64, f64)> {
        speeds().map(|v| (1e3 * sign * v, sign * of(v))).collect()
    };
    let raw = |v: f64| law.law().coefficient(v);
    let moved = |v: f64| law.coefficient(v);
    let points = [-1.0, 1.0].map(|sign| (1e3 * sign * law.inflection(), sign * law.breakaway()));
    let axes = || Panel::new("velocity / (mm/s)", "coefficient of friction", 300.0);
    chapter.figure(
        "figure_25",
        "Fig. 25. Steps from Eq. 7.5, with +γ₄, to the shifted law, for the start values of A6: the raw curve, its two inflections, and what \
         lies beyond them.",
        &[axes()
            .with(Role::Measured, "raw law", odd(&raw, -1.0))
            .with(Role::Measured, "raw law", odd(&raw, 1.0))
            .with(Role::Fitted, "shifted to the axis", odd(&moved, -1.0))
            .with(Role::Fitted, "shifted to the axis", odd(&moved, 1.0))
            .with(Role::ResidualPoints, "inflections", points.to_vec())],
    );
    let mut whole = odd(&moved, -1.0);
    whole.reverse();
    whole.extend(odd(&moved, 1.0));
    chapter.figure(
        "figure_26",
        format!(
            "Fig. 26. The shifted law for the start values of A6. At zero velocity it takes any value between ±{:.4}: the contact sticks.",
            law.breakaway()
        ),
        &[axes().with(Role::Fitted, "shifted law", whole)],
    );
    Ok(())
}

/// Figs 27 and 28: a fit by the shifted law and by the raw one to a record of the shifted one.
fn fitted(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    const NOISE: f64 = 5e-4;
    let truth = ILLUSTRATIONS[0];
    let release = Release { viscous: Viscous::Line, law: &truth, load: LOAD_5, displacement: 22.0 };
    let record = release.record::<ShiftedMakkarDixon>(NOISE, seed(settings, 6, 0, 0))?;
    let start = [0.39, 500.0, 5.5, 0.22, 500.0, 0.0];
    let (shifted_fit, shifted_values) = by::<ShiftedMakkarDixon>(&record, start)?;
    let (raw_fit, raw_values) = by::<MakkarDixon>(&record, start)?;
    let deviation = |fit: &fmm_fit::Fit| 1e3 * rms(fit.residuals());
    let (with_shift, without) = (deviation(&shifted_fit), deviation(&raw_fit));
    let found = shifted(shifted_values)?;
    let quantity = "static level of a fit by the shifted law, 22 mm, 0.5 mm/s of noise";
    chapter.target(
        Target::new("C11", quantity, "1", found.breakaway(), Criterion::within(0.63, 0.02))
            .note("truth 0.6300; γ₁, γ₃, γ₄ found, γ₂ and γ₅ held; a round trip"),
    );
    let raw_level = shifted(raw_values)?.breakaway();
    chapter.finding(
        "Fitted by the raw law, as A6 does, a contact that sticks gives another static level.",
        format!(
            "A simulated record of 22 mm whose truth is the shifted law with 0.63 and 0.24, 0.5 mm/s of noise: the shifted law leaves \
             {with_shift:.2} mm/s and finds {:.3} and {:.3}; the raw law leaves {without:.2} mm/s, and its γ's stand for {raw_level:.3} and {:.3}.",
            found.breakaway(),
            shifted_values[3],
            raw_values[3]
        ),
        &["E22"],
    );
    let mut panels = fit_panels(&record, &shifted_fit).to_vec();
    let left: Vec<f64> = raw_fit.residuals().iter().map(|left| -left).collect();
    panels.push(Panel::new("time / s", "record − raw / (mm/s)", 180.0).with(
        Role::Residual,
        "residual of the raw law",
        over_time(&left, 1e3),
    ));
    chapter.figure(
        "figure_27",
        "Fig. 27. Fit of the shifted law to a test of 22 mm, what it leaves, and what a fit of the raw law leaves. The record is simulated: \
         shifted law with γ = (0.41871, 500, 5, 0.24, 500) at 8.604 N, static 0.63, dynamic 0.24, white noise of 0.5 mm/s.",
        &panels,
    );
    let curve = |values: [f64; 6], is_raw: bool| -> Found<Vec<(f64, f64)>> {
        let law = shifted(values)?;
        let of = |v: f64| if is_raw { law.law().coefficient(v) } else { law.coefficient(v) };
        Ok((0..=600).map(|i| 5e-4 * f64::from(i)).map(|v| (1e3 * v, of(v))).collect())
    };
    let axes = || Panel::new("speed / (mm/s)", "coefficient at 8.604 N", 280.0);
    chapter.figure(
        "figure_28",
        "Fig. 28. Coefficient against speed by the fits of Fig. 27 to a simulated record (top), and three sets of γ that all have the printed \
         levels of 0.63 and 0.24 (bottom): an illustration.",
        &[
            axes()
                .with(Role::Measured, "truth", curve(truth, false)?)
                .with(Role::Fitted, "fit by the shifted law", curve(shifted_values, false)?)
                .with(Role::Reference, "fit by the raw law", curve(raw_values, true)?),
            axes()
                .with(Role::Measured, "γ₂ = 500, γ₃ = 5", curve(ILLUSTRATIONS[0], false)?)
                .with(Role::Fitted, "γ₂ = 1000, γ₃ = 5", curve(ILLUSTRATIONS[1], false)?)
                .with(Role::Reference, "γ₂ = 100, γ₃ = 10", curve(ILLUSTRATIONS[2], false)?),
        ],
    );
    Ok(())
}

/// γ₁, γ₃ and γ₄ fitted, the two steep slopes held: the fit and all γ's.
fn by<F: LawFamily>(record: &Record, start: [f64; 6]) -> Found<(fmm_fit::Fit, [f64; 6])> {
    const NAMES: [&str; 6] = ["difference_coefficient", "rise", "fall", "coefficient", "level_rise", "viscous"];
    let law: Vec<(&str, f64)> = NAMES.into_iter().zip(start).collect();
    let free = [NAMES[0], NAMES[2], NAMES[3], "initial_velocity"];
    let problem = Known { viscous: Viscous::Line, load: LOAD_5 }.problem::<F>(record, &law, &free)?;
    let fit = solve(&problem, problem.values(), &Options::default())?;
    let mut values = start;
    for (value_of, name) in values.iter_mut().zip(NAMES) {
        *value_of = value(&fit, name)?;
    }
    Ok((fit, values))
}
