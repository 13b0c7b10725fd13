//! Friction of known truth back from synthetic impacts of a hammer: the impact test of the thesis' chapter 8.

use std::f64::consts::PI;
use std::sync::OnceLock;

use fmm_frf::{
    AverageOptions, Baseline, CoulombLine, Estimator, ForceWindow, FrictionSpectrum, ResponseForm,
    SingleDegreeOfFreedom, TrialAverage,
};
use fmm_friction::{Berger, Coulomb, CoulombViscous};
use fmm_identify::{
    Candidate, Experiment, Identification, IdentifyError, ImpactTrial, Inquiry, Known, Machine, Terms, Warning,
    identify,
};
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Channels, Engine, Exact, Excitation, RungeKutta, Sampling, Scenario};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

const MASS: f64 = 10.391;
const STIFFNESS: f64 = 1982.0;
const DAMPING: f64 = 0.275;
const LOAD: f64 = 6.67;
const MU: f64 = 0.113;

/// 10 kHz, with the impact 10 ms after the begin.
const INTERVAL: f64 = 1e-4;
const BEFORE: usize = 100;
/// 33 s.
const SAMPLES: usize = 330_000;

/// Impulse (N s) and duration (intervals) of the impacts of 450 N, 1000 N and 1450 N.
const LEVELS: [(f64, usize); 3] = [(0.98, 34), (1.42, 22), (1.64, 18)];

const TRIALS_OF_A_LEVEL: usize = 3;

/// Noise of force (N) and velocity (m/s).
const FORCE_NOISE: f64 = 0.5;
const NOISE: f64 = 2e-4;

/// A half sine from sample [`BEFORE`] on, whose samples joined by straight lines have this `impulse`.
fn half_sine(impulse: f64, intervals: usize, interval: f64) -> Vec<f64> {
    let angle = |i: usize| PI * i as f64 / intervals as f64;
    let peak = impulse / interval * (0.5 * angle(1)).tan();
    (0..=BEFORE + intervals).map(|i| if i < BEFORE { 0.0 } else { peak * angle(i - BEFORE).sin() }).collect()
}

fn oscillator(damping: f64) -> Oscillator {
    Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(Damping::linear(damping).unwrap())
}

/// Force and velocity of an impact on a machine with dry friction, without noise.
fn impact(impulse: f64, intervals: usize, damping: f64) -> (Vec<f64>, Vec<f64>) {
    let mut force = half_sine(impulse, intervals, INTERVAL);
    let scenario = Scenario::new(oscillator(damping), Coulomb::new(MU).unwrap(), LOAD).unwrap();
    let scenario = scenario.driven_by(Excitation::sampled_force(INTERVAL, force.clone()).unwrap());
    let sampling = Sampling::uniform(INTERVAL, SAMPLES).unwrap().keeping(Channels::Velocity);
    let velocity = Exact.run(&scenario, &sampling).unwrap().velocity().values().to_vec();
    force.resize(SAMPLES, 0.0);
    (force, velocity)
}

fn records(force: Vec<f64>, velocity: Vec<f64>, interval: f64) -> (Record, Record) {
    (
        Record::new(0.0, interval, force, Quantity::Force, "N").unwrap(),
        Record::new(0.0, interval, velocity, Quantity::Velocity, "m/s").unwrap(),
    )
}

/// Force and velocity as two channels measure them: with white noise, and offsets of up to 0.5 N and 5 mm/s.
fn measured(force: &[f64], velocity: &[f64], interval: f64, seed: u64) -> (Record, Record) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let offsets = [random.random_range(-0.5..0.5), random.random_range(-5e-3..5e-3)];
    let mut noisy = |values: &[f64], offset: f64, deviation: f64| {
        let white = Normal::new(offset, deviation).unwrap();
        values.iter().map(|value| value + white.sample(&mut random)).collect()
    };
    let (force, velocity) = (noisy(force, offsets[0], FORCE_NOISE), noisy(velocity, offsets[1], NOISE));
    records(force, velocity, interval)
}

fn prepared((force, velocity): &(Record, Record)) -> ImpactTrial {
    ImpactTrial::prepare(force, velocity).unwrap()
}

/// The machine of the thesis, of which the damping is known or to be found.
fn machine(is_damping_known: bool) -> Machine {
    let known = |value| Known::exact(value).unwrap();
    let machine = Machine::of_mass_and_stiffness(known(MASS), known(STIFFNESS)).unwrap();
    let machine = machine.with_normal_load(known(LOAD)).unwrap();
    if is_damping_known { machine.with_damping(known(DAMPING)).unwrap() } else { machine }
}

/// Mobilities in the band of the thesis.
fn mobilities(trials: &[ImpactTrial]) -> Vec<Experiment> {
    trials.iter().map(|trial| Experiment::mobility(trial, Some((1.0, 4.0))).unwrap()).collect()
}

fn impacts(trials: &[ImpactTrial]) -> Vec<Experiment> {
    trials.iter().map(|trial| Experiment::impact(trial).unwrap()).collect()
}

/// Noisy trials at each of the three levels.
fn trials() -> &'static [ImpactTrial] {
    static TRIALS: OnceLock<Vec<ImpactTrial>> = OnceLock::new();
    TRIALS.get_or_init(|| {
        let level = |(index, (impulse, intervals)): (u64, &(f64, usize))| {
            let (force, velocity) = impact(*impulse, *intervals, DAMPING);
            (0..TRIALS_OF_A_LEVEL as u64)
                .map(move |seed| prepared(&measured(&force, &velocity, INTERVAL, 100 * index + seed)))
        };
        (0..).zip(&LEVELS).flat_map(level).collect()
    })
}

/// Value and standard uncertainty of μ, by μ.
fn relative(found: &Identification) -> (f64, f64) {
    let mu = found.finding("mu").unwrap();
    (mu.value() / MU - 1.0, mu.uncertainty().unwrap() / MU)
}

#[test]
fn mobility_of_each_level_and_of_all() {
    for (level, trials) in trials().chunks(TRIALS_OF_A_LEVEL).enumerate().chain([(3, trials())]) {
        let found = identify::<Coulomb>(&machine(true), &mobilities(trials)).unwrap();
        let (error, u) = relative(&found);
        assert!(error.abs() < 1e-3 && error.abs() < 3.0 * u, "level {level}: μ is off by {error} ± {u}\n{found}");
        assert!(u < 5e-4, "level {level}: u(μ)/μ = {u}");
        assert!(found.warnings().is_empty(), "level {level}\n{found}");
    }
}

/// A trial at each level, as more of 330 000 samples take longer.
fn few_trials() -> Vec<ImpactTrial> {
    trials().iter().step_by(TRIALS_OF_A_LEVEL).cloned().collect()
}

#[test]
fn time_records() {
    let trials = few_trials();
    for (level, trials) in trials.chunks(1).enumerate().chain([(3, trials.as_slice())]) {
        let found = identify::<Coulomb>(&machine(true), &impacts(trials)).unwrap();
        let (error, u) = relative(&found);
        assert!(error.abs() < 1e-3 && error.abs() < 3.0 * u, "level {level}: {error} ± {u}\n{found}");
        assert!(u < 5e-4, "level {level}: u(μ)/μ = {u}");
    }
}

/// The damping too, with a hammer that is trusted or hardly.
#[test]
fn damping_is_found_with_a_hammer_that_is_trusted_or_hardly() {
    let damped = Terms::default().with_linear_damping();
    for calibration in [0.0, 0.5] {
        let trials = few_trials().into_iter().map(|trial| trial.with_calibration_uncertainty(calibration).unwrap());
        let mobilities = mobilities(&trials.collect::<Vec<_>>());
        let found = Inquiry::of(&machine(false), &mobilities)
            .candidate(&Candidate::of::<Coulomb>().with(damped.clone()))
            .unwrap();
        let (error, u) = relative(&found);
        assert!(error.abs() < 3.0 * u && u < 3e-3, "μ is off by {error} ± {u}\n{found}");
        let damping = found.finding("damping_per_mass").unwrap();
        let (error, u) = (MASS * damping.value() - DAMPING, MASS * damping.uncertainty().unwrap());
        assert!(error.abs() < 3.0 * u && u < 0.05, "c is off by {error} ± {u} N s/m\n{found}");
    }
}

/// Peak receptance against impulse, and the friction force in it.
#[test]
fn peaks_lie_on_a_line() {
    let window = ForceWindow::new(0.009, 0.015).unwrap();
    let options = AverageOptions::default().force_window(window).force_baseline(Baseline::MeanOf(0..90));
    let options = options.response_baseline(Baseline::MeanOf(0..90)).within(0.5, 30.0).unwrap();
    for damping in [0.0, DAMPING] {
        let mut peaks = Vec::new();
        for (level, (impulse, intervals)) in LEVELS.into_iter().enumerate() {
            let (force, velocity) = impact(impulse, intervals, damping);
            let mut average = TrialAverage::new(ResponseForm::Mobility, 1.0 / INTERVAL, SAMPLES, &options).unwrap();
            for seed in 0..3 {
                let (force, velocity) = measured(&force, &velocity, INTERVAL, 1000 + seed);
                average.add_records(&force, &velocity).unwrap();
            }
            let mobility = average.estimate(Estimator::H1).unwrap();
            peaks.push(mobility.converted(ResponseForm::Receptance).unwrap().peak().unwrap().1);

            // Harmonics of a square wave, without noise, which at 20 Hz is as large as they are.
            average.clear();
            average.add(&force, &velocity).unwrap();
            let mobility = average.estimate(Estimator::H1).unwrap();
            let linear = SingleDegreeOfFreedom::new(MASS, damping, STIFFNESS).unwrap();
            let fundamental = linear.natural_angular_frequency() / (2.0 * PI);
            let linear = linear.frequency_response(ResponseForm::Mobility, mobility.frequencies()).unwrap();
            let harmonics = FrictionSpectrum::of(&mobility, &linear).unwrap().harmonics(fundamental, 9).unwrap();
            let levels = [(3, -9.5), (5, -14.0), (7, -16.9), (9, -19.0)];
            for (order, expected) in levels.into_iter().filter(|_| damping > 0.0) {
                let found = harmonics[order - 1].level;
                assert!((found - expected).abs() < 0.2, "level {level}, {order}th harmonic: {found} dB");
            }
        }
        let impulses = LEVELS.map(|(impulse, _)| impulse);
        let line = CoulombLine::fit(&impulses, &peaks, MASS, (STIFFNESS / MASS).sqrt()).unwrap();
        assert!(line.r_squared > 0.9999, "c = {damping} N s/m: {line}");
        let error = line.friction_force.value / (MU * LOAD) - 1.0;
        // Damping bends the line, which the slope takes for friction.
        assert!(error.abs() < if damping == 0.0 { 0.01 } else { 0.06 }, "c = {damping} N s/m: off by {error}, {line}");
    }
}

/// A light machine at 1 kHz, so that an impact is short to simulate: 0.5 kg, 79 N/m, μ N = 0.06 N, at rest after 1.5 s
/// of 2 s.
mod small {
    use super::*;

    pub(super) const INTERVAL: f64 = 1e-3;
    pub(super) const SAMPLES: usize = 2000;
    pub(super) const COEFFICIENT: f64 = 0.06;

    pub(super) fn oscillator() -> Oscillator {
        Oscillator::new(0.5, 79.0).unwrap().with_damping(Damping::linear(0.02).unwrap())
    }

    pub(super) fn machine() -> Machine {
        let known = |value| Known::exact(value).unwrap();
        let machine = Machine::of_mass_and_stiffness(known(0.5), known(79.0)).unwrap();
        machine.with_damping(known(0.02)).unwrap().with_normal_load(known(1.0)).unwrap()
    }

    /// Force and velocity of an impact of 0.06 N s over 12 ms.
    pub(super) fn impact() -> (Vec<f64>, Vec<f64>) {
        let force = half_sine(0.06, 12, INTERVAL);
        let scenario = Scenario::new(oscillator(), Coulomb::new(COEFFICIENT).unwrap(), 1.0).unwrap();
        let scenario = scenario.driven_by(Excitation::sampled_force(INTERVAL, force.clone()).unwrap());
        let motion = Exact.run(&scenario, &Sampling::uniform(INTERVAL, SAMPLES).unwrap()).unwrap();
        assert!(motion.rest().is_some_and(|rest| rest.time < 1.9), "{:?}", motion.rest());
        let mut force = force;
        force.resize(SAMPLES, 0.0);
        (force, motion.velocity().values().to_vec())
    }

    /// Two trials, with noise of 1 % of the force and of the velocity.
    pub(super) fn trials(seed: u64) -> Vec<ImpactTrial> {
        let (force, velocity) = impact();
        let trial = |seed| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut noisy = |values: &[f64], deviation: f64| {
                let white = Normal::new(0.1 * deviation, deviation).unwrap();
                values.iter().map(|value| value + white.sample(&mut random)).collect()
            };
            let (force, velocity) = (noisy(&force, 0.08), noisy(&velocity, 1e-3));
            prepared(&records(force, velocity, INTERVAL))
        };
        vec![trial(2 * seed), trial(2 * seed + 1)]
    }
}

/// Share of seeds whose 95 % interval contains the truth: 95 ± 1.5 % is expected of 200 seeds.
#[test]
fn intervals_cover_the_truth() {
    const SEEDS: u64 = 200;
    let mobilities = |trials: &[ImpactTrial]| -> Vec<Experiment> {
        trials.iter().map(|trial| Experiment::mobility(trial, None).unwrap()).collect()
    };
    for name in ["mobility", "time"] {
        let experiments = |trials: &[ImpactTrial]| if name == "time" { impacts(trials) } else { mobilities(trials) };
        let mut covering = 0;
        let (mut squares, mut variances) = (0.0, 0.0);
        for seed in 0..SEEDS {
            let found = identify::<Coulomb>(&small::machine(), &experiments(&small::trials(seed))).unwrap();
            let (low, high) = found.interval("mu", 0.95).unwrap_or_else(|| panic!("{name}, {seed}: {found}"));
            covering += usize::from((low..=high).contains(&small::COEFFICIENT));
            let mu = found.finding("mu").unwrap();
            squares += (mu.value() - small::COEFFICIENT).powi(2);
            variances += mu.uncertainty().unwrap().powi(2);
        }
        let share = covering as f64 / SEEDS as f64;
        let ratio = (squares / variances).sqrt();
        assert!((0.90..=0.99).contains(&share), "{name}: {share} of the intervals cover μ; error by u {ratio}");
    }
}

/// A law that depends on velocity, and one with a viscous part; both without noise, so that the truth comes back.
#[test]
fn other_laws() {
    let force = half_sine(0.06, 12, small::INTERVAL);
    let drive = || Excitation::sampled_force(small::INTERVAL, force.clone()).unwrap();
    let sampling = Sampling::uniform(small::INTERVAL, small::SAMPLES).unwrap();
    let trial = |velocity: &[f64]| {
        let mut force = force.clone();
        force.resize(small::SAMPLES, 0.0);
        prepared(&records(force, velocity.to_vec(), small::INTERVAL))
    };

    let berger = Scenario::new(small::oscillator(), Berger::new(0.04, 0.05, 20.0).unwrap(), 1.0).unwrap();
    let motion = RungeKutta::default().run(&berger.driven_by(drive()), &sampling).unwrap();
    let trials = [trial(motion.velocity().values())];
    for experiment in [Experiment::mobility(&trials[0], Some((0.5, 20.0))), Experiment::impact(&trials[0])] {
        let experiments = [experiment.unwrap()];
        let found = identify::<Berger>(&small::machine(), &experiments).unwrap();
        for (name, truth) in [("friction_force", 0.04), ("excess_friction_force", 0.05), ("decay", 20.0)] {
            let value = found.finding(name).unwrap().value();
            assert!((value / truth - 1.0).abs() < 1e-4, "{name} = {value}, not {truth}\n{found}");
        }
        let model = found.model(&experiments, 0).unwrap();
        let measured = &trials[0].velocity()[trials[0].motion()];
        let worst = model.iter().zip(measured).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-6, "{worst} m/s off");
        // Dry friction misses something, and says so.
        let found = identify::<Coulomb>(&small::machine(), &experiments).unwrap();
        let is_structured = |warning: &Warning| matches!(warning, Warning::StructuredResiduals { .. });
        assert!(found.warnings().iter().any(is_structured), "{found}");
    }

    let both = Scenario::new(small::oscillator(), CoulombViscous::new(0.04, 0.03).unwrap(), 1.0).unwrap();
    let motion = Exact.run(&both.driven_by(drive()), &sampling).unwrap();
    let experiments = [Experiment::mobility(&trial(motion.velocity().values()), None).unwrap()];
    let found = identify::<CoulombViscous>(&small::machine(), &experiments).unwrap();
    let value = found.finding("mu").unwrap().value();
    assert!((value / 0.04 - 1.0).abs() < 1e-6, "{found}");
    let damped = Terms::default().with_linear_damping();
    let two =
        Inquiry::of(&small::machine(), &experiments).candidate(&Candidate::of::<CoulombViscous>().with(damped.clone()));
    assert!(matches!(two, Err(IdentifyError::Contradiction { .. })));
}

/// Requirements on an impact, and what is said if they are not met.
#[test]
fn doubtful_impacts() {
    let (force, velocity) = small::impact();
    let identify = |force: Vec<f64>, velocity: Vec<f64>| {
        let trial = prepared(&records(force, velocity, small::INTERVAL));
        identify::<Coulomb>(&small::machine(), &impacts(&[trial])).unwrap()
    };
    let coefficient = |found: &Identification| found.finding("mu").unwrap().value();

    // A bounce is simulated as well.
    let mut bounced = force.clone();
    (0..=12).for_each(|i| bounced[200 + i] += 2.0 * (PI * i as f64 / 12.0).sin());
    let scenario = Scenario::new(small::oscillator(), Coulomb::new(small::COEFFICIENT).unwrap(), 1.0).unwrap();
    let scenario = scenario.driven_by(Excitation::sampled_force(small::INTERVAL, bounced.clone()).unwrap());
    let motion = Exact.run(&scenario, &Sampling::uniform(small::INTERVAL, small::SAMPLES).unwrap()).unwrap();
    let found = identify(bounced, motion.velocity().values().to_vec());
    let is_hit = |warning: &Warning| matches!(warning, Warning::FurtherHit { trial: 1, time, .. } if (time - 0.206).abs() < 1e-9);
    assert!(found.warnings().iter().any(is_hit), "{found}");
    assert!((coefficient(&found) / small::COEFFICIENT - 1.0).abs() < 1e-6, "{found}");

    // A record that ends too early tells, and what it holds is used.
    let found = identify(force[..900].to_vec(), velocity[..900].to_vec());
    let is_early = |warning: &Warning| matches!(warning, Warning::NotAtRest { trial: 1, .. });
    assert!(found.warnings().iter().any(is_early), "{found}");
    assert!((coefficient(&found) / small::COEFFICIENT - 1.0).abs() < 1e-5, "{found}");

    // A hammer that is cut off.
    let cut: Vec<f64> = force.iter().map(|force| force.min(5.5)).collect();
    let found = identify(cut, velocity.clone());
    let is_cut = |warning: &Warning| matches!(warning, Warning::Overload { trial: 1, .. });
    assert!(found.warnings().iter().any(is_cut), "{found}");

    let trial = prepared(&records(force, velocity, small::INTERVAL));
    let narrow = Experiment::mobility(&trial, Some((2.01, 2.02)));
    assert!(matches!(narrow, Err(IdentifyError::NotSeen { .. })));
    assert!(trial.with_calibration_uncertainty(-1.0).is_err());
}

/// Knowledge of the machine and the hammer goes into the uncertainty, and the more of it the less is uncertain.
#[test]
fn known_values_pass_on_their_uncertainty() {
    let trials = small::trials(1);
    let known = |value, u| Known::new(value, u).unwrap();
    let of = |stiffness: Known, damping: Known, calibration: f64| {
        let machine = Machine::of_mass_and_stiffness(known(0.5, 0.0), stiffness).unwrap();
        let machine = machine.with_damping(damping).unwrap().with_normal_load(known(1.0, 0.0)).unwrap();
        let trials = trials.iter().map(|trial| trial.clone().with_calibration_uncertainty(calibration).unwrap());
        let found = identify::<Coulomb>(&machine, &impacts(&trials.collect::<Vec<_>>())).unwrap();
        found.finding("mu").unwrap().uncertainty().unwrap()
    };
    let (stiffness, damping) = (known(79.0, 0.0), known(0.02, 0.0));
    let exact = of(stiffness, damping, 0.0);
    let [little, much] = [0.002, 0.02].map(|u| of(stiffness, known(0.02, u), 0.0));
    assert!(exact < little && little < much, "{exact}, {little}, {much}");
    let [poor, nothing] = [0.1, 100.0].map(|calibration| of(stiffness, damping, calibration));
    // The motion tells the impulse better than a poor hammer, which a better one helps a little.
    assert!(exact < poor && poor < nothing && nothing < 1.2 * poor, "{exact}, {poor}, {nothing}");
}
