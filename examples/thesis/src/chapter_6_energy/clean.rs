//! The example without noise: Figs 13 to 16, and what a late sample does.

use fmm_friction::Coulomb;
use fmm_record::Smoothing;
use fmm_sim::{Engine, Scenario, Thesis};
use fmm_uq::Observations;

use super::energy_rates::{EnergyMethod, EnergyRate, EnergyRates};
use super::{Example, SLOWEST, friction};
use crate::ring_down::{INTERVAL, over_time, velocity_record};
use crate::target::number;
use crate::{Chapter, Criterion, Found, Target};
use fmm_cli::figure::{Panel, Role};

pub(super) fn add(chapter: &mut Chapter, example: &Example) -> Found<()> {
    let difference = exact_difference(example)?;
    forces(chapter, example, &difference)?;
    motions(chapter, example);
    late_samples(chapter, example)?;
    figures(chapter, example, &difference);
    chapter.finding(
        "The Monte Carlo that chapter 6 refers to as section 5.1 is section 5.3, and Eq. 6.3 is cited and not printed.",
        "Taken as dE/dt = m x′ x″ + k x x′ = −c x′² − F |x′|, it gives back the force of the example in both \
         directions; so it is the equation meant.",
        &["E14", "E17"],
    );
    Ok(())
}

/// Part that is missing in the rate of energy with the contact, and the force that it stands for.
struct Difference {
    contact: Vec<EnergyRate>,
    free: Vec<EnergyRate>,
    /// Velocity (m/s), missing rate (W).
    missing: Vec<(f64, f64)>,
}

impl Difference {
    /// The thesis' two tables, both sorted by velocity; that without contact is read between its lines.
    fn of(contact: &EnergyRates, free: &EnergyRates) -> Self {
        let (contact, free) = (contact.points().to_vec(), free.points().to_vec());
        let missing = contact
            .iter()
            .filter_map(|point| Some((point.velocity, between(&free, point.velocity)? - point.rate)))
            .collect();
        Self { contact, free, missing }
    }

    /// Missing rate over velocity (N) for velocities of this sign.
    fn forces(&self, sign: f64) -> Found<Observations> {
        let forces = self.missing.iter().filter(|point| point.0 * sign > 0.0).map(|(v, rate)| rate / v);
        Ok(Observations::new(&forces.collect::<Vec<_>>())?)
    }

    /// Mean and standard deviation of the force against the motion (N).
    fn opposing(&self) -> Found<Observations> {
        let forces: Vec<f64> = self.missing.iter().map(|(v, rate)| rate / v.abs()).collect();
        Ok(Observations::new(&forces)?)
    }
}

/// The rate at `velocity` by a straight line between the neighbours in a table sorted by velocity.
fn between(table: &[EnergyRate], velocity: f64) -> Option<f64> {
    let above = table.partition_point(|point| point.velocity < velocity);
    let (low, high) = (table.get(above.checked_sub(1)?)?, table.get(above)?);
    let share = (velocity - low.velocity) / (high.velocity - low.velocity);
    Some(low.rate + share * (high.rate - low.rate))
}

/// The exact motions, with the acceleration that their velocity shows.
fn exact_difference(example: &Example) -> Found<Difference> {
    let position = example.scenario.initial().position;
    let method = EnergyMethod::new(*example.scenario.oscillator(), position, SLOWEST);
    let rates = |motion: &fmm_sim::Trajectory| -> Found<EnergyRates> {
        method.rates(&velocity_record(motion.velocity().values().to_vec())?)
    };
    Ok(Difference::of(&rates(&example.contact)?, &rates(&example.without)?))
}

/// Plus and minus μ N, from the thesis' own motion and from velocity alone.
fn forces(chapter: &mut Chapter, example: &Example, from_velocity: &Difference) -> Found<()> {
    let euler = CONSISTENT.difference(example)?;
    for (sign, text) in [(1.0, "1.75"), (-1.0, "-1.75")] {
        let forces = euler.forces(sign)?;
        let direction = if sign > 0.0 { "positive" } else { "negative" };
        let quantity = format!("rate difference over velocity, {direction} velocity");
        // The free rate between two velocities of the table is off by c Δv²/8, a straight line for a parabola.
        let criterion = Criterion::near(sign * friction(), 1e-4);
        let note = format!("Euler's motion as in the thesis; std of a sample {:.1e} N", forces.standard_deviation());
        chapter.target(Target::new("A11", quantity, "N", forces.mean(), criterion).printed(text).note(note));
    }
    let alone = from_velocity.opposing()?;
    let quantity = "rate difference over speed, from clean velocity alone";
    // Central differences at 1 kHz are off by (ω h)²/6 of m a, 6e-4 N at most and odd about the middle of a swing.
    let criterion = Criterion::near(friction(), 1e-4);
    let note = format!("differentiated and integrated; std of a sample {:.1e} N", alone.standard_deviation());
    chapter.target(Target::new("A11", quantity, "N", alone.mean(), criterion).printed("1.75").note(note));
    Ok(())
}

/// Heights, energies and times of Figs 13 and 14.
fn motions(chapter: &mut Chapter, example: &Example) {
    let fastest =
        |motion: &fmm_sim::Trajectory| motion.velocity().values().iter().fold(0.0f64, |top, v| top.max(v.abs()));
    let (kinetic, potential) = example.scenario.stored_energy(example.scenario.initial());
    let row = |quantity: &str, unit, ours, reference, tolerance, note: &str| {
        Target::new("A11", quantity, unit, ours, Criterion::near(reference, tolerance)).note(note)
    };
    let rounding = "reference to its last digit";
    chapter.target(row("Fig. 13, v_max without contact", "m/s", fastest(&example.without), 0.1379, 5e-5, rounding));
    chapter.target(row("Fig. 13, v_max with contact", "m/s", fastest(&example.contact), 0.1257, 5e-5, rounding));
    chapter.target(row("Fig. 13, rest", "s", example.rest(), 1.365, 5e-4, rounding));
    chapter.target(row("Fig. 14, energy at release", "J", kinetic + potential, 0.0991, 5e-5, "k x₀²/2"));
}

/// One way to put together what Euler's loop computes.
struct Tables {
    name: &'static str,
    /// Samples by which acceleration and position run ahead of the velocity.
    ahead: [usize; 2],
}

const CONSISTENT: Tables = Tables { name: "all of one instant", ahead: [1, 0] };
const STORED: Tables = Tables { name: "as the loop stores them: acceleration a sample late", ahead: [0, 0] };
const POSITION_AHEAD: Tables = Tables { name: "position a sample ahead", ahead: [1, 1] };

/// The thesis' own Euler motion, with channels that are a sample apart.
fn late_samples(chapter: &mut Chapter, example: &Example) -> Found<()> {
    let mut rows = Vec::new();
    for tables in [CONSISTENT, STORED, POSITION_AHEAD] {
        let contact = tables.rates(&example.scenario, example)?;
        let found = tables.difference(example)?.opposing()?;
        if tables.name == STORED.name {
            let quantity = "force, acceleration a sample late, Euler motion";
            let note = "the lateness is the same with and without contact and cancels in the difference";
            chapter.target(
                Target::new("A11", quantity, "N", found.mean(), Criterion::near(friction(), 1e-3))
                    .printed("1.75")
                    .note(note),
            );
        }
        let alone = [contact.mean_friction(), contact.scatter()];
        rows.push(row(tables.name, [found.mean(), found.standard_deviation()], Some(alone)));
    }
    let euler = Thesis::A3.run(&example.scenario, &example.sampling)?;
    let wobbling = by_total_energy(example, &euler)?;
    rows.push(row("slope of Euler's total energy", [wobbling.mean(), wobbling.standard_deviation()], None));
    chapter.table(
        format!(
            "Chapter 6: {} N back from Euler's motion, with channels a sample apart (mean ± standard deviation)",
            friction()
        ),
        &["channels", "difference of the two tables / N", "friction table alone / N"],
        rows,
    );
    chapter.finding(
        "A channel that is a sample late cancels in the difference of the two tables, not in the table with contact alone; \
         the total energy of Fig. 14 must not be differentiated.",
        format!(
            "The energy of the semi-implicit scheme wobbles: its slope gives {:.2} ± {:.2} N instead of {} N, sample by sample, where \
             m x′ x″ + k x x′ with all channels of one instant is right to {:.0e} N.",
            wobbling.mean(),
            wobbling.standard_deviation(),
            friction(),
            CONSISTENT.difference(example)?.opposing()?.standard_deviation()
        ),
        &[],
    );
    Ok(())
}

fn row(name: &str, difference: [f64; 2], alone: Option<[f64; 2]>) -> Vec<String> {
    let text = |[mean, deviation]: [f64; 2]| format!("{mean:.5} ± {deviation:.1e}");
    vec![name.to_owned(), text(difference), alone.map_or_else(|| "–".to_owned(), text)]
}

impl Tables {
    fn difference(&self, example: &Example) -> Found<Difference> {
        Ok(Difference::of(&self.rates(&example.scenario, example)?, &self.rates(&example.free, example)?))
    }

    fn rates(&self, scenario: &Scenario<f64, Coulomb>, example: &Example) -> Found<EnergyRates> {
        let motion = Thesis::A3.run(scenario, &example.sampling)?;
        let (x, v) = (motion.position().values(), motion.velocity().values());
        // What the loop computed as acceleration on its way to each sample.
        let loops: Vec<f64> = v.windows(2).map(|pair| (pair[1] - pair[0]) / INTERVAL).collect();
        let samples = 1..v.len() - 2;
        let [acceleration, position] = self.ahead;
        let late = |values: &[f64], by: usize| values[samples.start + by..samples.end + by].to_vec();
        let velocity = velocity_record(v[samples.clone()].to_vec())?;
        let method = EnergyMethod::new(*scenario.oscillator(), x[1], SLOWEST);
        // Element i of the differences leads to sample i + 1.
        let acceleration = loops[samples.start + acceleration - 1..samples.end + acceleration - 1].to_vec();
        method.rates_of_motion(&velocity, &late(x, position), &acceleration)
    }
}

/// Force against the motion (N) from the slope of kinetic plus potential energy.
fn by_total_energy(example: &Example, euler: &fmm_sim::Trajectory) -> Found<Observations> {
    let (x, v) = (euler.position().values(), euler.velocity().values());
    let damping = example.scenario.oscillator().damping();
    let energy = |(&position, &velocity): (&f64, &f64)| {
        let (kinetic, potential) = example.scenario.stored_energy(fmm_sim::State { position, velocity });
        kinetic + potential
    };
    let total: Vec<f64> = x.iter().zip(v).map(energy).collect();
    let slopes = Smoothing::None.slope(&total)?;
    let margin = (0.02 / INTERVAL) as usize;
    let samples = margin..total.len() - margin;
    let forces = samples.filter(|&i| v[i].abs() > SLOWEST);
    let forces = forces.map(|i| -(slopes[i] / INTERVAL + v[i] * damping.force(v[i])) / v[i].abs());
    Ok(Observations::new(&forces.collect::<Vec<_>>())?)
}

fn figures(chapter: &mut Chapter, example: &Example, difference: &Difference) {
    let curve = |motion: &fmm_sim::Trajectory| over_time(motion.velocity().values(), 1e3);
    let truth = "μ = 0.25 at 7 N, 10 mm, m, k and c of Table 2";
    let velocities = Panel::new("time / s", "velocity / (mm/s)", 300.0)
        .with(Role::Reference, "without contact", curve(&example.without))
        .with(Role::Measured, "with contact", curve(&example.contact));
    chapter.figure(
        "figure_13",
        format!("Fig. 13. Velocity with and without contact. Both simulated: {truth}."),
        &[velocities],
    );
    let energies = |scenario: &Scenario<f64, Coulomb>, motion: &fmm_sim::Trajectory, title: &str| {
        let states = motion.position().values().iter().zip(motion.velocity().values());
        let all: Vec<(f64, f64)> = states
            .map(|(&position, &velocity)| scenario.stored_energy(fmm_sim::State { position, velocity }))
            .collect();
        let of = |part: &dyn Fn(&(f64, f64)) -> f64| over_time(&all.iter().map(part).collect::<Vec<_>>(), 1e3);
        Panel::new("time / s", format!("energy {title} / mJ"), 280.0)
            .with(Role::Measured, "kinetic", of(&|energy| energy.0))
            .with(Role::Reference, "potential", of(&|energy| energy.1))
            .with(Role::Fitted, "total", of(&|energy| energy.0 + energy.1))
    };
    chapter.figure(
        "figure_14",
        format!("Fig. 14. Energy of the free vibration (top) and with contact (bottom). Both simulated: {truth}."),
        &[
            energies(&example.free, &example.without, "without contact"),
            energies(&example.scenario, &example.contact, "with contact"),
        ],
    );
    let rates =
        |points: &[EnergyRate]| points.iter().map(|point| (1e3 * point.velocity, 1e3 * point.rate)).collect::<Vec<_>>();
    let panel = Panel::new("velocity / (mm/s)", "rate of energy / mW", 300.0)
        .with(Role::Points, "with contact, simulated", rates(&difference.contact))
        .with(Role::Reference, "without contact, simulated", rates(&difference.free));
    chapter.figure(
        "figure_15",
        format!("Fig. 15. Rate of energy against velocity, from velocity alone. Both records simulated without noise: {truth}."),
        &[panel],
    );
    let missing = difference.missing.iter().map(|(v, rate)| (1e3 * v, 1e3 * rate));
    let force = difference.missing.iter().map(|(v, rate)| (1e3 * v, rate / v));
    let level = |sign: f64| [SLOWEST, 0.1257].map(|speed| (1e3 * sign * speed, sign * friction()));
    chapter.figure(
        "figure_16",
        format!(
            "Fig. 16. Difference of the two rates of energy (top), and divided by the velocity, which is the force of {} N \
             (bottom). Simulated without noise: {truth}.",
            number(friction())
        ),
        &[
            Panel::new("velocity / (mm/s)", "rate difference / mW", 280.0)
                .with(Role::Points, "simulated records", missing),
            Panel::new("velocity / (mm/s)", "friction force / N", 280.0)
                .with(Role::Points, "simulated records", force)
                .with(Role::Fitted, "μ N", level(-1.0))
                .with(Role::Fitted, "μ N", level(1.0)),
        ],
    );
}
