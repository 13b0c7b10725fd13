//! The example with noise: the energy method under five smoothings, with turning points and weak form beside.

use fmm_record::{EndRule, Record, Smoothing};
use fmm_uq::Observations;

use super::energy_rates::{EnergyMethod, EnergyRate, EnergyRates};
use super::turning_points::friction_of_half_cycles;
use super::weak_form::WeakForm;
use super::{Example, SLOWEST, friction};
use crate::ring_down::{INTERVAL, over_time, velocity_record, with_noise};
use crate::{Chapter, Criterion, Found, Settings, Target};
use fmm_cli::figure::{Panel, Role};

/// White noise of the velocity (m/s).
const NOISE: [f64; 4] = [0.0, 1e-5, 1e-4, 1e-3];

/// A smoothing with the standard deviation of one sample of the force (N) that it is known to leave at each noise.
struct Smoothed {
    name: &'static str,
    smoothing: Smoothing,
    expected: [f64; 4],
}

const SMOOTHED: [Smoothed; 5] = [
    Smoothed { name: "not smoothed", smoothing: Smoothing::None, expected: [0.0003, 0.073, 0.745, 7.40] },
    Smoothed {
        name: "mean of 5",
        smoothing: Smoothing::MovingAverage { span: 5, ends: EndRule::Shrinking },
        expected: [0.002, 0.021, 0.209, 2.07],
    },
    Smoothed {
        name: "mean of 15",
        smoothing: Smoothing::MovingAverage { span: 15, ends: EndRule::Truncated },
        expected: [0.016, 0.017, 0.072, 0.70],
    },
    Smoothed {
        name: "Savitzky-Golay 21/3",
        smoothing: Smoothing::SavitzkyGolay { span: 21, degree: 3 },
        expected: [0.0003, 0.009, 0.096, 0.95],
    },
    Smoothed {
        name: "Savitzky-Golay 41/3",
        smoothing: Smoothing::SavitzkyGolay { span: 41, degree: 3 },
        expected: [0.021, 0.021, 0.041, 0.35],
    },
];

/// The same for the force of one half cycle from its turning points, and for that of a record by the weak form.
const TURNING_POINTS: [f64; 4] = [0.0003, 0.0005, 0.004, 0.040];
const WEAK_FORM: [f64; 4] = [0.0, 0.0001, 0.0007, 0.006];

/// Records that are enough for the scatter of samples.
const FEW: usize = 200;

/// Share by which a standard deviation may differ from the reference.
const SHARE: f64 = 0.2;

pub(super) fn add(chapter: &mut Chapter, example: &Example, settings: &Settings<'_>) -> Found<()> {
    // A sample of the force is one of a thousand in its record; a half cycle and a record are fewer.
    let repetitions = settings.repetitions(1000, 300);
    // Every estimator sees the same records.
    let records = NOISE.map(|noise| -> Found<Vec<Record>> {
        let count = if noise == 0.0 { 1 } else { repetitions as u64 };
        let seeds = settings.seed().wrapping_mul(1_000_003)..;
        let velocity = example.contact.velocity().values();
        let noisy = seeds.take(count as usize).map(|seed| velocity_record(with_noise(velocity, noise, seed)?));
        noisy.collect()
    });
    let [clean, low, middle, high] = records;
    let records = [clean?, low?, middle?, high?];
    let mut rows = Vec::new();
    for (done, smoothed) in SMOOTHED.iter().enumerate() {
        rows.push(pointwise(chapter, example, smoothed, &records)?);
        settings.done(0.1 + 0.12 * (done + 1) as f64);
    }
    rows.push(turning_points(chapter, example, &records)?);
    settings.done(0.8);
    rows.push(weak_form(chapter, example, &records)?);
    chapter.table(
        format!(
            "Chapter 6 with noise: standard deviation of the force / N, and of the mean force of a record at 1 mm/s; {} N is \
             the truth, {repetitions} simulated records per noise, {FEW} of them for samples",
            friction()
        ),
        &["estimator", "clean", "0.01 mm/s", "0.1 mm/s", "1 mm/s", "record mean at 1 mm/s", "bias of it"],
        rows,
    );
    offset(chapter, example)?;
    law_of_noise(chapter, example, &records[3])?;
    figure(chapter, example, &records)
}

fn method(example: &Example, smoothing: Smoothing) -> EnergyMethod {
    let position = example.scenario.initial().position;
    EnergyMethod::new(*example.scenario.oscillator(), position, SLOWEST).smoothed_by(smoothing)
}

fn level(noise: f64) -> String {
    if noise == 0.0 { "clean".to_owned() } else { format!("{} mm/s", 1e3 * noise) }
}

/// A row: standard deviations, then scatter and bias of the record means at the highest noise.
fn row(name: &str, deviations: &[f64; 4], means: &Observations) -> Vec<String> {
    let mut row = vec![name.to_owned()];
    row.extend(deviations.iter().map(|deviation| format!("{deviation:.2e}")));
    row.push(format!("{:.1e}", means.standard_deviation()));
    row.push(format!("{:+.2} %", 100.0 * (means.mean() / friction() - 1.0)));
    row
}

fn pointwise(
    chapter: &mut Chapter,
    example: &Example,
    smoothed: &Smoothed,
    records: &[Vec<Record>; 4],
) -> Found<Vec<String>> {
    let method = method(example, smoothed.smoothing);
    let mut deviations = [0.0; 4];
    let mut means = Vec::new();
    for (level_index, records) in records.iter().enumerate() {
        let few = records.iter().take(FEW);
        let all: Vec<EnergyRates> = few.map(|record| method.rates(record)).collect::<Result<_, _>>()?;
        deviations[level_index] = all.iter().map(EnergyRates::scatter).sum::<f64>() / all.len() as f64;
        means = all.iter().map(EnergyRates::mean_friction).collect();
        let expected = smoothed.expected[level_index];
        let quantity = format!("std of F of a sample, {}, {}", smoothed.name, level(NOISE[level_index]));
        let target = Target::new("C12", quantity, "N", deviations[level_index], Criterion::within(expected, SHARE));
        chapter.target(target.note("reference from 20 records, to two digits"));
    }
    Ok(row(smoothed.name, &deviations, &Observations::new(&means)?))
}

fn turning_points(chapter: &mut Chapter, example: &Example, records: &[Vec<Record>; 4]) -> Found<Vec<String>> {
    let name = "turning points, mean of six half cycles";
    let (oscillator, position) = (example.scenario.oscillator(), example.scenario.initial().position);
    let mut deviations = [0.0; 4];
    let mut means = Vec::new();
    for (level_index, records) in records.iter().enumerate() {
        let all: Vec<Vec<f64>> = records
            .iter()
            .map(|record| friction_of_half_cycles(record, oscillator, position, &example.reversals))
            .collect::<Found<_>>()?;
        means = all.iter().map(|forces| forces.iter().sum::<f64>() / forces.len() as f64).collect();
        // About the truth, so that the one clean record has a deviation too: that of the trapezoidal rule.
        let count = all[0].len();
        let deviation = |j: usize| {
            let squares = all.iter().map(|forces| (forces[j] - friction()).powi(2));
            (squares.sum::<f64>() / all.len() as f64).sqrt()
        };
        deviations[level_index] = (0..count).map(deviation).sum::<f64>() / count as f64;
        let (noise, expected) = (NOISE[level_index], TURNING_POINTS[level_index]);
        let quantity = format!("std of F, {name}, {}", level(noise));
        let (criterion, note) = if noise == 0.0 {
            (Criterion::AtMost((1.0 + SHARE) * expected), "error of the trapezoidal rule over the kinks")
        } else {
            (Criterion::within(expected, SHARE), "reference from 20 records, to one digit")
        };
        chapter.target(Target::new("C12", quantity, "N", deviations[level_index], criterion).note(note));
    }
    Ok(row(name, &deviations, &Observations::new(&means)?))
}

fn weak_form(chapter: &mut Chapter, example: &Example, records: &[Vec<Record>; 4]) -> Found<Vec<String>> {
    let name = "weak form, of a record, position unknown";
    let weak = WeakForm::new(example.scenario.oscillator());
    let mut deviations = [0.0; 4];
    let mut means = Vec::new();
    for (level_index, records) in records.iter().enumerate() {
        means = records.iter().map(|record| weak.friction(record, &example.reversals)).collect::<Found<Vec<f64>>>()?;
        let squares = means.iter().map(|force| (force - friction()).powi(2));
        deviations[level_index] = (squares.sum::<f64>() / means.len() as f64).sqrt();
        let (noise, expected) = (NOISE[level_index], WEAK_FORM[level_index]);
        let quantity = format!("std of F, {name}, {}", level(noise));
        let (criterion, note) = if noise == 0.0 {
            // (ω h)²/24 of the force, 1.4e-5 N.
            (Criterion::AtMost(2e-5), "error of straight lines between samples")
        } else {
            (Criterion::AtMost((1.0 + SHARE) * expected), "less than the reference, as equations are weighted")
        };
        chapter.target(Target::new("C12", quantity, "N", deviations[level_index], criterion).note(note));
    }
    let row = row(name, &deviations, &Observations::new(&means)?);
    chapter.finding(
        "Only the pointwise F(v) of Fig. 17 is hopeless without smoothing: the weak form needs neither derivative nor \
         smoothing nor initial position.",
        format!(
            "At 1 mm/s of noise the force of a record comes out with a standard deviation of {:.1} mN by the weak form, \
             where a single sample of the energy method scatters by several newtons.",
            1e3 * deviations[3]
        ),
        &[],
    );
    Ok(row)
}

/// Effect of an offset of the velocity that is integrated into the position.
fn offset(chapter: &mut Chapter, example: &Example) -> Found<()> {
    const OFFSET: f64 = 1e-4;
    let shifted = velocity_record(example.contact.velocity().values().to_vec())?.shifted(-OFFSET)?;
    let oscillator = example.scenario.oscillator();
    let drift = OFFSET * example.rest();
    let force = oscillator.stiffness() * drift;
    let (friction, offset) = WeakForm::new(oscillator).friction_and_offset(&shifted, &example.reversals)?;
    chapter.target(
        Target::new("C12", "drift of k x by rest, offset of 0.1 mm/s", "N", force, Criterion::near(0.27, 5e-3))
            .note("reference to its last digit"),
    );
    chapter.finding(
        "An offset of the velocity must be removed before it is integrated; the weak form finds it.",
        format!(
            "0.1 mm/s drifts x by {:.3} mm until rest, {force:.2} N of spring force. The weak form reads {:.4} mm/s of offset \
             and {:.4} N of friction from the same record.",
            1e3 * drift,
            1e3 * offset,
            friction
        ),
        &[],
    );
    Ok(())
}

/// The uncertainty that the record itself tells, against m σ/(√2 h).
fn law_of_noise(chapter: &mut Chapter, example: &Example, records: &[Record]) -> Found<()> {
    let method = method(example, Smoothing::None);
    let stated: Vec<f64> =
        records.iter().take(FEW).map(|record| Ok(method.rates(record)?.uncertainty())).collect::<Found<Vec<_>>>()?;
    let stated = Observations::new(&stated)?.mean();
    let law = example.scenario.oscillator().mass() * NOISE[3] / (2f64.sqrt() * INTERVAL);
    let quantity = "uncertainty of F that the record tells of itself, not smoothed, 1 mm/s";
    let criterion = Criterion::within(law, 0.05);
    chapter.target(
        Target::new("C12", quantity, "N", stated, criterion)
            .note("law m σ/(√2 h); a record tells its noise to a few percent"),
    );
    Ok(())
}

fn figure(chapter: &mut Chapter, example: &Example, records: &[Vec<Record>; 4]) -> Found<()> {
    let record = &records[3][0];
    let raw = method(example, Smoothing::None).rates(record)?;
    let smooth = method(example, SMOOTHED[4].smoothing).rates(record)?;
    let oscillator = example.scenario.oscillator();
    let force = WeakForm::new(oscillator).friction(record, &example.reversals)?;
    let points = |rates: &EnergyRates, of: &dyn Fn(&EnergyRate) -> f64| -> Vec<(f64, f64)> {
        rates.points().iter().map(|point| (1e3 * point.velocity, of(point))).collect()
    };
    let fastest = raw.points().iter().fold(0.0f64, |top, point| top.max(point.velocity.abs()));
    let speeds = (0..=50).map(|i| SLOWEST + (fastest - SLOWEST) * f64::from(i) / 50.0);
    let speeds: Vec<f64> = speeds.collect();
    let modelled = |panel: Panel, sign: f64, of: &dyn Fn(f64) -> f64| {
        let curve = speeds.iter().map(|speed| (1e3 * sign * speed, of(sign * speed)));
        panel.with(Role::Fitted, format!("weak form, {force:.3} N"), curve)
    };
    let rate = |v: f64| 1e3 * (-v * oscillator.damping_force(v) - force * v.abs());
    let level = |v: f64| force * v.signum();
    let panel = |y: &str, name: &str, points: Vec<(f64, f64)>, of: &dyn Fn(f64) -> f64| {
        let panel = Panel::new("velocity / (mm/s)", y, 260.0);
        let panel = panel.with(Role::Points, format!("simulated record, {name}"), points);
        modelled(modelled(panel, -1.0, of), 1.0, of)
    };
    let watts = |point: &EnergyRate| 1e3 * point.rate;
    let newtons = |point: &EnergyRate| point.friction;
    chapter.figure(
        "figure_17",
        "Fig. 17. Rate of energy and friction force from a velocity record with noise, which is simulated: μ = 0.25 at 7 N, \
         10 mm, white noise of 1 mm/s at 1 kHz. Top: the record and its noise; then the rate of energy without smoothing, the \
         force without smoothing, and the force with a Savitzky-Golay filter of 41 samples. Red: what the weak form finds in the \
         same record.",
        &[
            Panel::new("time / s", "velocity / (mm/s)", 220.0)
                .with(Role::Measured, "simulated record", over_time(record.values(), 1e3)),
            panel("rate of energy / mW", "not smoothed", points(&raw, &watts), &rate),
            panel("friction force / N", "not smoothed", points(&raw, &newtons), &level),
            panel("friction force / N", "Savitzky-Golay 41/3", points(&smooth, &newtons), &level),
        ],
    );
    Ok(())
}
