//! Backbones of simulated decays against closed forms, and the modes of a decay.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use fmm_frf::{Backbone, BackboneOptions, BackbonePoint, DampingTermKind, FrfError, IsolatedMode, decay_modes};
use fmm_friction::{CoulombViscous, LawFamily};
use fmm_identify::{Experiment, Machine, Preparation, identify};
use fmm_model::{Damping, Estimated, Oscillator, Restoring};
use fmm_record::{Quantity, Record, open};
use fmm_sim::{Sampling, Scenario, simulate};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const RATE: f64 = 2000.0;

/// 20 Hz, a level (m/s²) and a viscous part (1/s), released at `amplitude`.
fn decay(machine: Oscillator, levels: [f64; 2], amplitude: f64, quantity: Quantity, samples: usize) -> Vec<f64> {
    let law = CoulombViscous::at(&levels).unwrap();
    let scenario = Scenario::new(machine, law, 1.0).unwrap().starting_at(amplitude, 0.0).unwrap();
    let motion = simulate(&scenario, &Sampling::uniform(1.0 / RATE, samples).unwrap()).unwrap();
    match quantity {
        Quantity::Velocity => motion.velocity().values().to_vec(),
        _ => motion.position().values().to_vec(),
    }
}

fn machine() -> Oscillator {
    Oscillator::per_unit_mass(20.0).unwrap()
}

fn record(values: Vec<f64>, quantity: Quantity) -> Record {
    let unit = if quantity == Quantity::Velocity { "m/s" } else { "m" };
    Record::sampled(RATE, values, quantity, unit).unwrap()
}

fn largest_error(backbone: &Backbone, value: impl Fn(usize) -> f64, truth: impl Fn(usize) -> f64) -> f64 {
    (0..backbone.points().len()).map(|i| (value(i) / truth(i) - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn points_lie_on_the_closed_forms() {
    let velocity = |backbone: &Backbone, i: usize| {
        let point = backbone.points()[i];
        TAU * point.frequency.value * point.amplitude.value
    };
    for quantity in [Quantity::Displacement, Quantity::Velocity] {
        for (name, machine, levels, amplitude) in [
            ("coulomb", machine(), [0.1, 0.0], 1e-2),
            ("quadratic", machine().with_damping(Damping::new(0.0, 0.5).unwrap()), [0.0, 0.0], 1e-2),
            ("duffing", machine().with_restoring(Restoring::polynomial(2e3, 0.0).unwrap()), [0.0, 0.4], 1e-2),
            ("pendulum", machine().with_restoring(Restoring::sine(1.0).unwrap()), [0.0, 0.4], 0.6),
        ] {
            let values = decay(machine, levels, amplitude, quantity, 16_000);
            let backbone = Backbone::of(&record(values, quantity), &BackboneOptions::default()).unwrap();
            let points = backbone.points();
            assert!(points.len() > 20, "{name}: {}", points.len());
            let frequency = |i: usize| {
                let square = points[i].amplitude.value.powi(2);
                let of = |stiffening: f64| 20.0 * stiffening.sqrt();
                match name {
                    "duffing" => of(1.0 + 0.75 * 2e3 * square),
                    "pendulum" => 20.0 / (1.0 + square / 16.0 + 11.0 * square * square / 3072.0),
                    _ => 20.0,
                }
            };
            let damping = |i: usize| match name {
                "coulomb" => 4.0 * 0.1 / (PI * velocity(&backbone, i)),
                "quadratic" => 8.0 * 0.5 * velocity(&backbone, i) / (3.0 * PI),
                _ => 0.4,
            };
            // Below a tenth of the release Coulomb friction shifts the middle of each half swing by more than a percent
            // of it.
            let off_frequency = largest_error(&backbone, |i| points[i].frequency.value, frequency);
            let large = |i: usize| name != "coulomb" || points[i].amplitude.value > 2e-3;
            let off =
                largest_error(&backbone, |i| if large(i) { points[i].damping.value } else { damping(i) }, damping);
            assert!(off_frequency < 1e-3 && off < 1e-3, "{name}, {quantity:?}: f {off_frequency:.2e}, c {off:.2e}");
        }
    }
}

/// Five cycles, told by half cycles: frequency and damping are those of the closed forms, and the terms are not
/// excluded.
#[test]
fn half_cycles_tell_short_records() {
    for quantity in [Quantity::Displacement, Quantity::Velocity] {
        for (levels, model) in [([0.0, 2.0], "viscous"), ([1.0, 0.0], "coulomb"), ([0.6, 1.5], "coulomb_viscous")] {
            let mut random = ChaCha8Rng::seed_from_u64(3);
            let noise = if quantity == Quantity::Velocity { 1e-4 } else { 1e-6 };
            let noisy = |value: &f64| {
                let draw: f64 = StandardNormal.sample(&mut random);
                value + noise * draw
            };
            let values = decay(machine(), levels, 1e-2, quantity, 500).iter().map(noisy).collect();
            let backbone = Backbone::of(&record(values, quantity), &BackboneOptions::default()).unwrap();
            assert!(backbone.points().len() >= 6, "{backbone:?}");
            for point in backbone.points() {
                let velocity = TAU * point.frequency.value * point.amplitude.value;
                let truth = 4.0 * levels[0] / (PI * velocity) + levels[1];
                assert!(
                    (point.damping.value / truth - 1.0).abs() < 0.02,
                    "{levels:?}, {quantity:?}: {point:?}, {truth}"
                );
                assert!((point.frequency.value / 20.0 - 1.0).abs() < 1e-3, "{point:?}");
            }
            let suggestion = backbone.suggestion();
            let is_left = suggestion.model() == model || suggestion.others.iter().any(|other| other == model);
            assert!(is_left, "{levels:?}, {quantity:?}: {suggestion}");
            // Five cycles do not tell a sum of two terms from another one of the same curve.
            assert!(
                model == "coulomb_viscous" || suggestion.model() == model,
                "{levels:?}, {quantity:?}: {suggestion}"
            );
        }
    }
}

/// Hum is listed as steady and is not taken for the machine, however strong.
#[test]
fn steady_lines_are_told_from_modes() {
    let at = |t: f64| (-0.6 * t).exp() * (TAU * 20.0 * t).cos() + 2.0 * (TAU * 50.0 * t + 1.0).sin();
    let record = record((0..8000).map(|i| at(f64::from(i) / RATE)).collect(), Quantity::Displacement);
    let modes = decay_modes(&record);
    assert!(modes[0].is_steady(&record) && (modes[0].frequency - 50.0).abs() < 0.01, "{modes:?}");
    assert!(!modes[1].is_steady(&record) && (modes[1].damping.unwrap() - 1.2).abs() < 0.01, "{modes:?}");
    let backbone = Backbone::of(&record, &BackboneOptions::default()).unwrap();
    assert!(backbone.points().iter().all(|point| (point.frequency.value - 20.0).abs() < 1e-3));
}

/// The damping that is listed is that of the mode: not of the noise that is left of it, nor of a mode too near to be
/// told from it.
#[test]
fn listed_damping_is_that_of_the_mode() {
    let mut random = ChaCha8Rng::seed_from_u64(8);
    let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
    // In the second half of 2 s the amplitude falls from 0.14 to 0.02, into the noise of some frequencies.
    let at = |t: f64| (-2.0 * t).exp() * (TAU * 20.0 * t).cos();
    let told: Vec<f64> = (0..100)
        .filter_map(|_| {
            let noisy = (0..4000).map(|i| at(f64::from(i) / RATE) + 0.2 * draw()).collect();
            decay_modes(&record(noisy, Quantity::Displacement))[0].damping
        })
        .collect();
    let mean = told.iter().sum::<f64>() / told.len() as f64;
    println!("listed damping {mean} in the mean of {}", told.len());
    assert!(told.len() > 90 && (mean / 4.0 - 1.0).abs() < 0.01, "{mean} of {}", told.len());

    // Modes that a second tells apart, but its half does not.
    let near = |t: f64| at(t) + 0.8 * (-0.2 * t).exp() * (TAU * 26.0 * t + 1.0).cos();
    let both = decay_modes(&record((0..2400).map(|i| near(f64::from(i) / RATE)).collect(), Quantity::Displacement));
    assert_eq!(both.len(), 2, "{both:?}");
    assert!(both.iter().all(|mode| mode.damping.is_none()), "{both:?}");
}

/// Uncertainties of amplitude, frequency and damping over draws of white noise, of a long record, of a short one and of
/// half cycles.
#[test]
fn uncertainties_hold_what_they_say() {
    let clean = decay(machine(), [0.1, 0.2], 1e-2, Quantity::Displacement, 8000);
    let windows = |cycles: f64| BackboneOptions::default().over(cycles).unwrap();
    for (samples, options) in [(8000, windows(8.0)), (1600, windows(4.0)), (500, BackboneOptions::default())] {
        let (clean, noise) = (&clean[..samples], 2e-5);
        let truth = Backbone::of(&record(clean.to_vec(), Quantity::Displacement), &options).unwrap();
        let (mut inside, mut all) = ([0.0; 3], 0.0);
        for seed in 0..1000 {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let noisy = |value: &f64| {
                let draw: f64 = StandardNormal.sample(&mut random);
                value + noise * draw
            };
            let values: Vec<f64> = clean.iter().map(noisy).collect();
            let found = Backbone::of(&record(values, Quantity::Displacement), &options).unwrap();
            for found in found.points() {
                // Noise may hide a turning point at the begin of the record.
                let same = |truth: &&BackbonePoint| (truth.time - found.time).abs() < 1e-3;
                let Some(truth) = truth.points().iter().find(same) else { panic!("{samples} samples: {found:?}") };
                let holds = |found: Estimated, truth: f64| {
                    f64::from(u8::from((found.value - truth).abs() < 1.96 * found.uncertainty))
                };
                inside[0] += holds(found.amplitude, truth.amplitude.value);
                inside[1] += holds(found.frequency, truth.frequency.value);
                inside[2] += holds(found.damping, truth.damping.value);
                all += 1.0;
            }
        }
        for share in inside.map(|count| count / all) {
            assert!((0.92..0.98).contains(&share), "{samples} samples: {inside:?} of {all}");
        }
    }
}

/// A second mode 5 % away, with a tenth of the amplitude: both are listed, and the backbone of each is that of its own
/// decay.
#[test]
fn close_modes_are_told_apart() {
    let (rate, modes): (f64, [(f64, f64, f64); 2]) = (2000.0, [(20.0, 1.0, 0.12), (21.0, 0.1, 0.2)]);
    let at = |t: f64| -> f64 { modes.iter().map(|(f, a, rate)| a * (-rate * t).exp() * (TAU * f * t).cos()).sum() };
    let values: Vec<f64> = (0..20_000).map(|i| at(f64::from(i) / rate)).collect();
    let record = Record::sampled(rate, values, Quantity::Acceleration, "m/s²").unwrap();
    let found = decay_modes(&record);
    assert_eq!(found.len(), 2, "{found:?}");
    for (found, (frequency, ..)) in found.iter().zip(modes) {
        assert!((found.frequency - frequency).abs() < 0.05, "{found:?}");
    }
    for (frequency, _, decay) in modes {
        let backbone = Backbone::of(&record, &BackboneOptions::default().at(frequency).unwrap()).unwrap();
        for point in backbone.points() {
            let off = (point.frequency.value / frequency - 1.0).abs();
            assert!(
                off < 1e-4 && (point.damping.value / (2.0 * decay) - 1.0).abs() < 0.02,
                "{frequency} Hz: {point:?}"
            );
        }
    }
}

/// The terms of a decay are suggested, with the share of the energy that each term has taken.
#[test]
fn suggestions_name_what_is_there() {
    let hardening = Restoring::polynomial(2e3, 0.0).unwrap();
    for (name, damping, levels, spring) in [
        ("coulomb", Damping::none(), [0.1, 0.0], Restoring::Linear),
        ("viscous", Damping::none(), [0.0, 0.4], Restoring::Linear),
        ("coulomb_viscous", Damping::none(), [0.1, 0.3], Restoring::Linear),
        ("coulomb + quadratic", Damping::new(0.0, 0.5).unwrap(), [0.1, 0.0], Restoring::Linear),
        ("coulomb_viscous + cubic spring", Damping::none(), [0.1, 0.3], hardening),
    ] {
        let machine = machine().with_damping(damping).with_restoring(spring);
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let values = decay(machine, levels, 1e-2, Quantity::Displacement, 16_000);
        let noisy = |value: f64| {
            let draw: f64 = StandardNormal.sample(&mut random);
            value + 5e-6 * draw
        };
        let values = values.into_iter().map(noisy).collect();
        let backbone = Backbone::of(&record(values, Quantity::Displacement), &BackboneOptions::default()).unwrap();
        let suggestion = backbone.suggestion();
        assert_eq!(suggestion.model(), name, "{suggestion}");
        let all: f64 = suggestion.damping.iter().map(|term| term.share.value).sum();
        assert!((all - 1.0).abs() < 1e-12, "{suggestion}");
        for term in &suggestion.damping {
            let truth = match term.kind {
                DampingTermKind::Coulomb => levels[0],
                DampingTermKind::Linear => levels[1],
                _ => 0.5,
            };
            let off = (term.coefficient.value - truth).abs();
            assert!(off < 4.0 * term.coefficient.uncertainty && off < 0.05 * truth, "{name}: {term:?}");
        }
    }
}

/// Ends of decays and frequencies that change spread over the spectrum; neither makes a mode. After a stop there is no
/// point.
#[test]
fn one_mode_is_one() {
    let pendulum = machine().with_restoring(Restoring::sine(1.0).unwrap());
    for (machine, levels, amplitude, noise) in [
        (machine(), [1.0, 0.0], 1e-2, 1e-4),
        (machine(), [1.0, 0.0], 1e-2, 1e-7),
        (machine(), [3.0, 0.5], 1e-2, 1e-4),
        (machine(), [3.0, 0.5], 1e-2, 1e-7),
        (pendulum, [0.0, 0.4], 1.2, 1e-4),
        (pendulum, [0.0, 0.4], 1.2, 1e-7),
    ] {
        let values = decay(machine, levels, amplitude, Quantity::Displacement, 16_000);
        let mut random = ChaCha8Rng::seed_from_u64(9);
        let noisy = |value: f64| {
            let draw: f64 = StandardNormal.sample(&mut random);
            value + noise * amplitude * draw
        };
        let record = record(values.iter().copied().map(noisy).collect(), Quantity::Displacement);
        let modes = decay_modes(&record);
        assert!(modes[1..].iter().all(|mode| mode.multiple.is_some()), "{levels:?}: {modes:?}");
        let backbone = Backbone::of(&record, &BackboneOptions::default()).unwrap();
        let last_motion = values.windows(2).rposition(|pair| pair[0] != pair[1]).unwrap() as f64 / RATE;
        let last = backbone.points().last().unwrap();
        assert!(
            last.time + 0.5 * backbone.window() < last_motion + 0.01,
            "{levels:?}: {last:?}, stop at {last_motion} s"
        );
    }
}

/// A mode that is asked for and not there is refused, with the nearest that is; it is not taken for another.
#[test]
fn a_mode_that_is_not_there_is_none() {
    let at = |t: f64| (-0.2 * t).exp() * (TAU * 20.0 * t).cos();
    let record = record((0..8000).map(|i| at(f64::from(i) / RATE)).collect(), Quantity::Displacement);
    for (frequency, is_there) in [(20.0, true), (22.0, true), (60.0, false), (5.0, false)] {
        let options = BackboneOptions::default().at(frequency).unwrap();
        assert_eq!(Backbone::of(&record, &options).is_ok(), is_there, "{frequency} Hz");
        assert_eq!(IsolatedMode::of(&record, &options).is_ok(), is_there, "{frequency} Hz");
    }
    let backbone = Backbone::of(&record, &BackboneOptions::default()).unwrap();
    assert!(backbone.envelope().all(|(time, seen)| (seen / (-0.2 * time).exp() - 1.0).abs() < 1e-4));
}

/// Friction that falls as the speed rises looks like a negative damper, and no term is suggested that feeds the motion.
#[test]
fn no_term_feeds_the_motion() {
    let falling = machine().with_damping(Damping::of_any_sign(-0.15, 0.0).unwrap());
    let values = decay(falling, [0.2, 0.0], 1e-2, Quantity::Displacement, 8000);
    let backbone = Backbone::of(&record(values, Quantity::Displacement), &BackboneOptions::default()).unwrap();
    let suggestion = backbone.suggestion();
    assert!(suggestion.damping.iter().all(|term| term.coefficient.value > 0.0), "{suggestion}");
}

#[test]
fn what_is_no_decay_has_no_backbone() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let noise = (0..4000).map(|_| StandardNormal.sample(&mut random)).collect();
    assert!(decay_modes(&record(noise, Quantity::Displacement)).is_empty());
    for values in [vec![0.0; 1000], vec![1.0; 3], vec![0.0, 1.0, 0.0, -1.0]] {
        let refused = Backbone::of(&record(values, Quantity::Velocity), &BackboneOptions::default());
        assert!(matches!(refused, Err(FrfError::NoFit { .. })), "{refused:?}");
    }
}

/// A mode with friction beside another one of a third of its amplitude: alone it gives its friction, together they do
/// not.
#[test]
fn an_isolated_mode_gives_its_friction() {
    let main = decay(machine(), [0.1, 0.3], 1e-2, Quantity::Displacement, 6000);
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let with_other = |(i, value): (usize, &f64)| {
        let t = i as f64 / RATE;
        let draw: f64 = StandardNormal.sample(&mut random);
        value + 3e-3 * (-0.5 * t).exp() * (TAU * 27.0 * t).cos() + 1e-6 * draw
    };
    let both = record(main.iter().enumerate().map(with_other).collect(), Quantity::Displacement);
    let alone = IsolatedMode::of(&both, &BackboneOptions::default().at(20.0).unwrap()).unwrap();
    let friction = |record: &Record| {
        let decay = Experiment::ring_down(record, &Preparation::default()).unwrap();
        let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &[decay]).unwrap();
        found.finding("friction_per_mass").unwrap().value()
    };
    let off = (friction(&alone.record) / 0.1 - 1.0).abs();
    let off_together = (friction(&both) / 0.1 - 1.0).abs();
    assert!(off < 5e-3 && off_together > 10.0 * off, "{off} alone, {off_together} with the other mode");
}

/// The pendulum's record shows the sine, k₃ = −1/6 and k₅ = 1/120; what it and the fork suggest is what their fits
/// prefer.
#[test]
fn real_records_show_their_springs_and_friction() {
    let pendulum = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data/single_pendulum_55s_1khz.csv");
    let file = open(pendulum).unwrap();
    let rate = file.channel("omega_rad_per_s").unwrap().record.with_quantity(Quantity::Velocity).with_unit("rad/s");
    // Each multiple moves with the frequency, by a sixth, and is listed once.
    // The frequency sweeps over a sixth, and the damping is still that between 0.053 and 0.057 1/s of the backbone's
    // first half. The third multiple goes with the third power of the amplitude, and so loses three times as much.
    let modes = decay_modes(&rate);
    let [damping, of_third] = [0, 1].map(|place| modes[place].damping.unwrap());
    assert!((0.05..0.06).contains(&damping) && modes[1].multiple == Some(3), "{modes:?}");
    assert!((of_third / (3.0 * damping) - 1.0).abs() < 0.05, "{of_third} and {damping}");
    let mut listed: Vec<f64> = decay_modes(&rate).iter().map(|mode| mode.frequency).collect();
    listed.sort_by(f64::total_cmp);
    assert!(listed.windows(2).all(|pair| pair[1] / pair[0] > 1.1), "{listed:?}");
    let angle = file.channel("theta_rad").unwrap().record;
    let angle = angle.with_quantity(Quantity::Displacement).with_unit("rad");
    let backbone = Backbone::of(&angle, &BackboneOptions::default()).unwrap();
    let spring = backbone.spring();
    let off = |place: usize, truth: f64| (spring[place].value - truth).abs() / truth.abs();
    // The series of the sine ends two terms later; the amplitude is 1.6 rad.
    assert!(off(1, -1.0 / 6.0) < 0.02 && off(2, 1.0 / 120.0) < 0.15, "{spring:?}");

    let fork = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data/BrowserForkCompoundFirst1.mat");
    let fork = open(fork).unwrap().channel("data").unwrap().record;
    let fork = fork.with_quantity(Quantity::Velocity).with_unit("V");
    // The line that the end of the record leaves at twice the frequency is none.
    let multiples: Vec<u32> = decay_modes(&fork).iter().filter_map(|mode| mode.multiple).collect();
    assert_eq!(multiples, [15, 3, 5]);
    let suggestion = Backbone::of(&fork, &BackboneOptions::default()).unwrap().suggestion();
    assert!(suggestion.model().starts_with("coulomb_viscous"), "{suggestion}");
    let decay = Experiment::ring_down(&fork, &Preparation::default()).unwrap();
    let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &[decay]).unwrap();
    for (term, name) in suggestion.damping.iter().zip(["friction_per_mass", "damping_per_mass"]) {
        let fitted = found.finding(name).unwrap().value();
        assert!((term.coefficient.value / fitted - 1.0).abs() < 0.1, "{name}: {term:?} and {fitted}");
    }
}
