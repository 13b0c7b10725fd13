//! Pictures of a motion: motion.svg and friction.svg.

use std::error::Error;

use fmm_sim::SimulationError;

use crate::figure::{Panel, Role, drawn, label};
use crate::scenario::{Motion, Plan, Simulation};

/// Points of a curve besides those at events.
const POINTS: usize = 2000;

/// Events marked in a curve; more of them would hide it.
const MOST_MARKS: usize = 500;

/// The motion and its friction. The curves are sampled again, whatever the output of the scenario.
///
/// # Errors
/// If the motion cannot be simulated again.
pub(crate) fn pictures(scenario: &Simulation, motion: &Motion) -> Result<Vec<(String, String)>, Box<dyn Error>> {
    let end = motion.samples.t.last().copied().unwrap_or(0.0);
    let end = motion.events.last().map_or(end, |event| event.t.max(end));
    let mut times: Vec<f64> = (0..=POINTS).map(|index| end * index as f64 / POINTS as f64).collect();
    times.extend(motion.events.iter().map(|event| event.t));
    times.sort_by(f64::total_cmp);
    let dense = match scenario.run_at(&Plan::at(times, end)?) {
        Ok(dense) => dense,
        // A method of fixed step has no times but its own.
        Err(error) if matches!(error.downcast_ref(), Some(SimulationError::NotSupported { .. })) => motion.clone(),
        Err(error) => return Err(error),
    };
    Ok(vec![
        ("motion.svg".to_owned(), drawn(&motion_panels(scenario, &dense))),
        ("friction.svg".to_owned(), drawn(&friction_panels(scenario, &dense))),
    ])
}

fn curve(times: &[f64], values: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    times.iter().copied().zip(values.iter().copied())
}

fn motion_panels(scenario: &Simulation, motion: &Motion) -> Vec<Panel> {
    let [position, velocity, _] = scenario.units();
    let (times, samples) = (&motion.samples.t, &motion.samples);
    let events = motion.events.iter().skip(1).take(MOST_MARKS);
    let panel = |name: &str, unit: &str, values: &[f64], events: Vec<(f64, f64)>| {
        Panel::new("time / s", label(name, unit), 340.0).with(Role::Fitted, name, curve(times, values)).with(
            Role::Points,
            "events",
            events,
        )
    };
    let mut panels = vec![
        panel("position", position, &samples.x, events.clone().map(|event| (event.t, event.x)).collect()),
        panel("velocity", velocity, &samples.v, events.map(|event| (event.t, event.v)).collect()),
    ];
    if let [state] = &samples.z[..] {
        let panel = Panel::new("time / s", label("deflection", position), 240.0);
        panels.push(panel.with(Role::Residual, "deflection of the bristles", curve(times, state)));
    }
    panels
}

fn friction_panels(scenario: &Simulation, motion: &Motion) -> Vec<Panel> {
    let [_, velocity, force] = scenario.units();
    let velocity = label("velocity relative to the counterface", velocity);
    let force = Panel::new(velocity, label("friction", force), 340.0).with(
        Role::Fitted,
        "friction along the motion",
        friction(scenario, motion),
    );
    let (times, energy) = (&motion.samples.t, &motion.energy);
    let mut balance = Panel::new("time / s", label("energy", "J"), 440.0);
    if let Some(work) = &energy.work {
        let sum =
            |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(one, other)| one + other).collect::<Vec<_>>();
        let rubbed = sum(&energy.total, &work.friction);
        balance = balance.with(Role::Measured, "+ lost to damping", curve(times, &sum(&rubbed, &work.viscous))).with(
            Role::Fitted,
            "+ lost to friction",
            curve(times, &rubbed),
        );
    }
    vec![force, balance.with(Role::Residual, "kinetic + potential", curve(times, &energy.total))]
}

/// Friction force (N) against the relative velocity (m/s), in the order in which the motion passes through it. A
/// contact that holds is left out, but for the level at which it lets go.
fn friction(scenario: &Simulation, motion: &Motion) -> Vec<(f64, f64)> {
    let samples = &motion.samples;
    let sign = |next: &str| if next == "slip-" { -1.0 } else { 1.0 };
    let mut points = Vec::with_capacity(samples.t.len());
    let mut events = motion.events.iter().peekable();
    let mut current = motion.events.first();
    for (index, (t, v)) in samples.t.iter().zip(&samples.v).enumerate() {
        let velocity = v - scenario.belt;
        while let Some(event) = events.next_if(|event| event.t <= *t) {
            // A law of the speed jumps at zero velocity, from one limit to the other or to the static level.
            let limit = |sign: f64, losing| (0.0, scenario.friction(f64::MIN_POSITIVE * sign, &[], losing));
            let jumps = samples.z.is_empty();
            if jumps && event.kind.starts_with("breakaway") {
                points.extend([(0.0, sign(event.next) * event.static_level), limit(sign(event.next), false)]);
            }
            if jumps
                && event.kind == "zero_velocity"
                && let Some(before) = current
            {
                points.push(limit(sign(before.next), true));
                points.extend((event.next != "stick").then(|| limit(sign(event.next), false)));
            }
            current = Some(event);
        }
        let Some(event) = current.filter(|event| event.next != "stick") else { continue };
        // At constant speed friction is between its two levels; the straight line from one to the other stands for it.
        if event.phase == Some("const") || (velocity == 0.0 && samples.z.is_empty()) {
            continue;
        }
        let states: Vec<f64> = samples.z.iter().map(|state| state[index]).collect();
        points.push((velocity, scenario.friction(velocity, &states, event.phase == Some("dec"))));
    }
    points
}
