//! Load, blows and impulses, and what friction takes of a blow: Figs 30 and 31.

use fmm_identify::ImpactTrial;
use fmm_sim::EventKind;
use fmm_uq::Observations;

use super::blows::{Blow, DURATION, FORCE_NOISE, INTERVAL, LEVELS, NOISE, RATE, SPREAD, Test};
use super::{COEFFICIENT, LOAD, friction_force};
use crate::{Chapter, Criterion, Found, Target, printed};
use fmm_cli::figure::{Panel, Role};

/// Mass on the shaft (kg), and gravity (m/s²).
const HUNG: f64 = 0.680;
const GRAVITY: f64 = 9.81;

pub(super) fn add(chapter: &mut Chapter, blows: &[Blow], tests: &[Test]) -> Found<()> {
    chapter.target(
        Target::new("A17", "normal load, 0.680 kg", "N", HUNG * GRAVITY, Criterion::near(6.671, 5e-4))
            .printed("6.67")
            .note("last digit"),
    );
    for (level, reference) in LEVELS.into_iter().zip([3.421, 2.231, 1.777]) {
        let quantity = format!("half sine of {:.0} N and {} N s, duration", level.peak, level.impulse);
        chapter.target(
            Target::new("A18", quantity, "ms", 1e3 * level.duration(), Criterion::near(reference, 5e-4))
                .inferred()
                .note("π J/(2 F₀); the shape is not printed"),
        );
    }
    load(chapter);
    held(chapter, blows)?;
    impulses(chapter, tests)?;
    figure_30(chapter, &tests[1]);
    Ok(())
}

fn load(chapter: &mut Chapter) {
    let [table_4, scripts, ..] = printed::LOADS;
    let at = |load: f64| friction_force() / load;
    chapter.finding(
        "The coefficient 0.113 rests on a load that may not be whole.",
        format!(
            "0.680 kg are {:.2} N without shaft and sample holder, which section 3.1 counts to the load. Only the force μ N = {:.3} N shows \
             in the motion: under the {scripts:.3} N of scripts A4 to A6 it would be μ = {:.4}, under the {table_4} N of chapter 7 {:.4}.",
            HUNG * GRAVITY,
            friction_force(),
            at(scripts),
            at(table_4)
        ),
        &["E34"],
    );
}

/// The contact holds until the blow exceeds friction, and holds again at the end.
fn held(chapter: &mut Chapter, blows: &[Blow]) -> Found<()> {
    let (mut rows, mut shares, mut springs) = (Vec::new(), Vec::new(), Vec::new());
    for blow in blows {
        let motion = &blow.motion;
        let loose = motion.events().iter().find(|event| event.kind == EventKind::Breakaway);
        let loose = loose.ok_or("the blow does not move the contact")?;
        let turn = motion.events().iter().find(|event| event.kind == EventKind::Reversal).ok_or("it never turns")?;
        let rest = motion.rest().ok_or("the contact does not stop the motion")?;
        let end = ((Blow::begin() + blow.level.duration()) / INTERVAL).ceil() as usize;
        let momentum = printed::MACHINE[0] * blow.velocity()[end];
        let taken = 1.0 - momentum / blow.level.impulse;
        let fastest = blow.velocity().iter().copied().fold(0.0, f64::max);
        shares.push(100.0 * taken);
        springs.push((printed::MACHINE[1] * rest.position).abs());
        rows.push(vec![
            format!("{:.0}", blow.level.peak),
            format!("{}", blow.level.impulse),
            format!("{:.3}", 1e3 * blow.level.duration()),
            format!("{:.2}", 1e6 * (loose.time - Blow::begin())),
            format!("{:.2}", 100.0 * taken),
            format!("{:.1}", 1e3 * fastest),
            format!("{:.3}", 1e3 * turn.position),
            format!("{:.3}", rest.time - Blow::begin()),
            format!("{}", motion.half_cycles()),
            format!("{:.3}", 1e3 * rest.position),
        ]);
    }
    chapter.table(
        "The three blows, simulated as half sines with μ = 0.113 at 6.67 N",
        &[
            "level / N",
            "J / (N s)",
            "lasts / ms",
            "held for / µs",
            "taken in the blow / %",
            "v_max / (mm/s)",
            "x_max / mm",
            "rest after / s",
            "half swings",
            "rests at / mm",
        ],
        rows,
    );
    let text = |values: &[f64], digits: usize| {
        values.iter().map(|value| format!("{value:.digits$}")).collect::<Vec<_>>().join(", ")
    };
    chapter.finding(
        "At zero velocity friction is not zero: it holds the machine until |f − k x| > μ N.",
        format!(
            "Eqs. 5.2 and 8.1 have no branch that holds. The contact lets go where the hammer exceeds {:.3} N; friction and spring take {} % of \
             the impulse until the end of the blow. At the end it holds spring forces of {} N at the three levels, which without friction would \
             set {} kg in motion again.",
            friction_force(),
            text(&shares, 2),
            text(&springs, 3),
            printed::MACHINE[0]
        ),
        &["E32"],
    );
    Ok(())
}

fn impulses(chapter: &mut Chapter, tests: &[Test]) -> Found<()> {
    let mut forces = Panel::new("time / ms", "force / N", 300.0);
    let mut scatter = Panel::new("peak of the force / N", "impulse / (N s)", 300.0);
    let (mut single, mut means, mut texts) = (Vec::new(), Vec::new(), Vec::new());
    for test in tests {
        forces = forces.with(Role::Measured, "a simulated trial of each level", pulse(&test.trials[0]));
        let impulses = test.impulses();
        let levels: Vec<f64> = test.trials.iter().map(|trial| trial.summary().level).collect();
        let (impulse, level) = (Observations::new(&impulses)?, Observations::new(&levels)?);
        single.extend(levels.iter().copied().zip(impulses));
        means.push((level.mean(), impulse.mean()));
        texts.push(format!("{:.3} ± {:.3}", impulse.mean(), impulse.standard_deviation()));
    }
    scatter =
        scatter.with(Role::Points, "simulated trials", single).with(Role::FittedPoints, "mean of each level", means);
    chapter.figure(
        "figure_31",
        format!(
            "Fig. 31. Forces of the three levels and impulses of {} trials each. Simulated half sines whose peaks are anywhere within {SPREAD} N \
             of the level; impulses by the trapezoid rule, mean ± standard deviation {} N s (printed means 0.98, 1.42, 1.64 N s).",
            tests[0].trials.len(),
            texts.join(", ")
        ),
        &[forces, scatter],
    );
    Ok(())
}

fn figure_30(chapter: &mut Chapter, test: &Test) {
    let mut forces = Panel::new("time / ms", "force / N", 240.0);
    let mut velocities = Panel::new("time / s", "velocity / (mm/s)", 320.0);
    let name = format!("{} simulated trials", test.trials.len());
    for trial in &test.trials {
        forces = forces.with(Role::Measured, &name, pulse(trial));
        velocities = velocities.with(Role::Measured, &name, velocity_curve(trial.velocity()));
    }
    chapter.figure(
        "figure_30",
        format!(
            "Fig. 30. Force and velocity of {} trials of the {} level. Simulated: μ = {COEFFICIENT} at {LOAD} N, {DURATION} s at {} kHz, white \
             noise of {FORCE_NOISE} N and {} mm/s.",
            test.trials.len(),
            test.level.name,
            1e-3 * RATE,
            1e3 * NOISE
        ),
        &[forces, velocities],
    );
}

/// Force (N) of a trial about its pulse, over time (ms).
pub(super) fn pulse(trial: &ImpactTrial) -> Vec<(f64, f64)> {
    let at = |i: usize| 1e3 * INTERVAL * i as f64;
    let end = trial.begin() + trial.force().len();
    let pulse = trial.force().iter().enumerate().map(|(i, force)| (at(trial.begin() + i), *force));
    std::iter::once((at(trial.begin() - 20), 0.0)).chain(pulse).chain(std::iter::once((at(end + 20), 0.0))).collect()
}

/// The first four seconds of a velocity (m/s), in mm/s over time (s).
pub(super) fn velocity_curve(velocity: &[f64]) -> Vec<(f64, f64)> {
    let shown = (4.0 * RATE) as usize;
    velocity.iter().take(shown).enumerate().map(|(i, v)| (i as f64 * INTERVAL, 1e3 * v)).collect()
}
