//! Blows of known truth, whose force is seen at its samples only: whether intervals cover the truth, and whether the residuals
//! pass for noise.

use std::f64::consts::PI;

use fmm_friction::{Coulomb, CoulombViscous};
use fmm_identify::{
    ImpactDomain, ImpactIdentification, ImpactMachine, ImpactOptions, ImpactTrial, Known, Warning, identify_impact,
};
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Channels, Engine, Exact, Excitation, Sampling, Scenario};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rand_distr::{Distribution, Normal};

const MASS: f64 = 10.391;
const STIFFNESS: f64 = 1982.0;
const LOAD: f64 = 14.0;
const FORCE_NOISE: f64 = 0.5;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// With a kink at either end.
    HalfSine,
    /// Without.
    SquaredSine,
}

/// A kind of blow on the machine of the thesis.
#[derive(Debug, Clone, Copy)]
struct Kind {
    shape: Shape,
    /// Sampling intervals in the pulse.
    intervals: f64,
    mu: f64,
    /// Viscous damping (N s/m).
    damping: f64,
    /// Noise of the velocity (m/s).
    noise: f64,
}

/// A number between 0 and 1.
fn uniform(random: &mut impl Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

impl Kind {
    /// A blow of 450 N to 1450 N and 3 ms to 8 ms, begun anywhere between two samples.
    fn trial(&self, seed: u64) -> ImpactTrial {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let peak = 450.0 + 1000.0 * uniform(&mut random);
        let duration = (3.0 + 5.0 * uniform(&mut random)) * 1e-3;
        let interval = duration / self.intervals;
        let begin = 100.0 + uniform(&mut random);
        let force_at = |time: f64| {
            let share = (time - begin * interval) / duration;
            match self.shape {
                _ if !(0.0..=1.0).contains(&share) => 0.0,
                Shape::HalfSine => peak * (PI * share).sin(),
                Shape::SquaredSine => peak * (PI * share).sin().powi(2),
            }
        };
        let excitation = match self.shape {
            Shape::HalfSine => Excitation::half_sine(peak, duration),
            // Straight lines this short miss a millionth of the impulse.
            Shape::SquaredSine => Excitation::sampled_force(
                duration / 1000.0,
                (0..=1000).map(|i| peak * (PI * f64::from(i) * 1e-3).sin().powi(2)).collect::<Vec<f64>>(),
            ),
        };
        let excitation = excitation.unwrap().delayed(begin * interval).unwrap();
        let impulse = peak * duration * if self.shape == Shape::HalfSine { 2.0 / PI } else { 0.5 };
        // With a fifth more than dry friction takes.
        let lasting = 1.2 * 0.5 * PI * impulse / (self.mu * LOAD) + 0.2;
        let samples = (lasting / interval) as usize + 200;
        let oscillator = Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(Damping::linear(self.damping).unwrap());
        let scenario = Scenario::new(oscillator, Coulomb::new(self.mu).unwrap(), LOAD).unwrap().driven_by(excitation);
        let sampling = Sampling::uniform(interval, samples).unwrap().keeping(Channels::Velocity);
        let motion = Exact.run(&scenario, &sampling).unwrap();
        let mut noisy = |value: f64, deviation: f64| value + Normal::new(0.0, deviation).unwrap().sample(&mut random);
        let force = (0..samples).map(|i| noisy(0.3 + force_at(i as f64 * interval), FORCE_NOISE)).collect();
        let velocity = motion.velocity().values().iter().map(|v| noisy(v - 1e-3, self.noise)).collect();
        let force = Record::new(0.0, interval, force, Quantity::Force, "N").unwrap();
        let velocity = Record::new(0.0, interval, velocity, Quantity::Velocity, "m/s").unwrap();
        ImpactTrial::prepare(&force, &velocity).unwrap()
    }
}

fn machine(damping: f64) -> ImpactMachine {
    let known = |value| Known::exact(value).unwrap();
    let machine = ImpactMachine::new(known(MASS), known(STIFFNESS)).unwrap().with_damping(known(damping)).unwrap();
    machine.with_normal_load(known(LOAD)).unwrap()
}

/// What many seeds gave: how many intervals cover the truth of each finding, and how often something was said to be left out.
#[derive(Debug, Default)]
struct Count {
    runs: usize,
    covering: Vec<usize>,
    alarms: usize,
    /// Mean relative uncertainty of each.
    widths: Vec<f64>,
    /// Sum of χ.
    chi: f64,
    largest: f64,
}

impl Count {
    fn add(&mut self, found: &ImpactIdentification, truths: &[(&str, f64)]) {
        self.covering.resize(truths.len(), 0);
        self.widths.resize(truths.len(), 0.0);
        self.runs += 1;
        self.chi += found.chi();
        self.largest = self.largest.max(found.chi());
        let is_alarm = |warning: &Warning| matches!(warning, Warning::StructuredResiduals { .. });
        self.alarms += usize::from(found.warnings().iter().any(is_alarm));
        for ((covering, width), (name, truth)) in self.covering.iter_mut().zip(&mut self.widths).zip(truths) {
            let (low, high) = found.interval(name, 0.95).unwrap_or_else(|| panic!("{name}: {found}"));
            *covering += usize::from((low..=high).contains(truth));
            *width += 0.5 * (high - low) / truth;
        }
    }
}

#[test]
#[ignore = "a study of minutes"]
fn study() {
    let seeds: u64 = std::env::var("SEEDS").map_or(200, |seeds| seeds.parse().unwrap());
    let noises = [2e-5, 2e-4, 2e-3];
    for shape in [Shape::HalfSine, Shape::SquaredSine] {
        for intervals in [10.0, 18.0, 26.5, 34.0, 60.0] {
            for noise in noises {
                let kind = Kind { shape, intervals, mu: 0.113, damping: 0.275, noise };
                for domain in [ImpactDomain::Mobility, ImpactDomain::Time, ImpactDomain::Both] {
                    let options = ImpactOptions::default().fitting(domain);
                    let mut count = Count::default();
                    for seed in 0..seeds {
                        let trials = [kind.trial(seed)];
                        let found = identify_impact::<Coulomb>(&machine(kind.damping), &trials, &options).unwrap();
                        count.add(&found, &[("coefficient", kind.mu)]);
                    }
                    report("coulomb", &kind, domain, &count);
                }
            }
        }
    }
}

fn report(what: &str, kind: &Kind, domain: ImpactDomain, count: &Count) {
    let share = |n: usize| 100.0 * n as f64 / count.runs as f64;
    let covering: Vec<String> = count.covering.iter().map(|n| format!("{:5.1}", share(*n))).collect();
    let widths: Vec<String> = count.widths.iter().map(|w| format!("{:.1e}", w / count.runs as f64)).collect();
    println!(
        "{what:<10} {:?} n {:<4} noise {:.0e} {domain:?}: covers {} %, half width {}, alarms {:.1} %, χ {:.2} to {:.2}",
        kind.shape,
        kind.intervals,
        kind.noise,
        covering.join(" "),
        widths.join(" "),
        share(count.alarms),
        count.chi / count.runs as f64,
        count.largest,
    );
}

#[test]
#[ignore = "a study of minutes"]
fn study_of_two_parameters() {
    let seeds: u64 = std::env::var("SEEDS").map_or(200, |seeds| seeds.parse().unwrap());
    for (shape, intervals) in [(Shape::HalfSine, 12.0), (Shape::HalfSine, 18.0), (Shape::SquaredSine, 34.0)] {
        let kind = Kind { shape, intervals, mu: 0.2, damping: 1.0, noise: 2e-4 };
        for domain in [ImpactDomain::Mobility, ImpactDomain::Time, ImpactDomain::Both] {
            let options = ImpactOptions::default().fitting(domain);
            let (mut free, mut viscous, mut wrong) = (Count::default(), Count::default(), Count::default());
            for seed in 0..seeds {
                let trials: Vec<ImpactTrial> = (0..2).map(|trial| kind.trial(2 * seed + trial)).collect();
                let found =
                    identify_impact::<Coulomb>(&machine(0.1), &trials, &options.clone().free("damping")).unwrap();
                free.add(&found, &[("coefficient", kind.mu), ("damping", kind.damping)]);
                let found = identify_impact::<CoulombViscous>(&machine(0.0), &trials, &options).unwrap();
                viscous.add(&found, &[("coefficient", kind.mu)]);
                let found = identify_impact::<Coulomb>(&machine(0.0), &trials, &options).unwrap();
                wrong.add(&found, &[("coefficient", kind.mu)]);
            }
            report("c free", &kind, domain, &free);
            report("viscous", &kind, domain, &viscous);
            report("wrong law", &kind, domain, &wrong);
        }
    }
}
