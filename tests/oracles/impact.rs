//! Blows on a machine with dry friction, against an independent event-driven solution.

use std::f64::consts::PI;
use std::path::Path;

use fmm_frf::{AverageOptions, Complex64, Estimator, ResponseForm, TrialAverage};
use fmm_friction::Coulomb;
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Engine, EventKind, Exact, Excitation, Sampling, Scenario, Trajectory};

const INTERVAL: f64 = 1e-4;
/// 33 s.
const SAMPLES: usize = 330_000;
/// Sample with which the blow begins.
const BEGIN: usize = 100;

struct Oracle {
    /// Impulse (N s) and intervals of the half sine.
    pulse: (f64, usize),
    damping: f64,
    reversals: usize,
    /// When it stops (s) and where (m).
    stop: (f64, f64),
    /// Largest velocity (m/s) of any sample.
    largest: f64,
    /// First reversals: time (s) and position (m).
    first: [(f64, f64); 2],
}

/// Mass (kg), stiffness (N/m) and friction force (N).
const MACHINE: (f64, f64, f64) = (10.391, 1982.0, 0.113 * 6.67);

/// The motions behind `coulomb_impact_mobility.csv` and `coulomb_impact_motion.csv`, and one without damping.
const ORACLES: [Oracle; 4] = [
    Oracle {
        pulse: (0.98, 34),
        damping: 0.275,
        reversals: 9,
        stop: (1.941_105_970_159_174_4, 0.000_275_308_319_699_283_85),
        largest: 0.094_030_776_167_841_17,
        first: [(0.121_334_272_231, 0.006_440_312_117_587_847), (0.348_805_734_472, -0.005_661_543_601_247_453_5)],
    },
    Oracle {
        pulse: (1.42, 22),
        damping: 0.275,
        reversals: 13,
        stop: (2.851_641_294_185_562_4, 0.000_200_824_951_790_405_7),
        largest: 0.136_474_459_080_886_85,
        first: [(0.121_983_747_293, 0.009_501_710_698_554_867), (0.349_455_209_534, -0.008_713_741_104_659_611)],
    },
    Oracle {
        pulse: (1.64, 18),
        damping: 0.275,
        reversals: 15,
        stop: (3.306_757_521_690_176_6, 0.000_150_723_243_303_844_2),
        largest: 0.157_680_094_614_306_65,
        first: [(0.122_157_050_316, 0.011_032_525_086_818_934), (0.349_628_512_557, -0.010_239_954_608_218_221)],
    },
    Oracle {
        pulse: (1.64, 18),
        damping: 0.0,
        reversals: 16,
        stop: (3.534_296_661_165_667, 0.000_359_349_463_582_591_5),
        largest: 0.157_683_850_426_110_44,
        first: [(0.122_226_293_698, 0.011_048_975_460_735_267), (0.349_697_651_529, -0.010_288_420_465_780_797)],
    },
];

impl Oracle {
    /// The force (N) of the half sine, whose samples joined by straight lines have the impulse exactly.
    fn force(&self) -> Vec<f64> {
        let (impulse, intervals) = self.pulse;
        let angle = |i: usize| PI * i as f64 / intervals as f64;
        let peak = impulse / INTERVAL * (0.5 * angle(1)).tan();
        (0..=BEGIN + intervals).map(|i| if i < BEGIN { 0.0 } else { peak * angle(i - BEGIN).sin() }).collect()
    }

    fn motion(&self) -> Trajectory {
        let (mass, stiffness, friction) = MACHINE;
        let machine = Oscillator::new(mass, stiffness).unwrap().with_damping(Damping::linear(self.damping).unwrap());
        let scenario = Scenario::new(machine, Coulomb::new(friction).unwrap(), 1.0).unwrap();
        let scenario = scenario.driven_by(Excitation::sampled_force(INTERVAL, self.force()).unwrap());
        Exact.run(&scenario, &Sampling::uniform(INTERVAL, SAMPLES).unwrap()).unwrap()
    }
}

/// The rows of a table of numbers.
fn table(path: &str) -> Vec<Vec<f64>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.lines().skip(1).map(|line| line.split(',').map(|number| number.parse().expect("a number")).collect()).collect()
}

/// The cross-check of the oracle agrees with it to 5e-7 s and 8e-11 m.
#[test]
fn stops_and_reversals() {
    for oracle in &ORACLES {
        let (motion, pulse) = (oracle.motion(), oracle.pulse);
        let rest = motion.rest().expect("friction stops it");
        assert!((rest.time - oracle.stop.0).abs() < 1e-6, "{pulse:?}: stops at {} s", rest.time);
        assert!((rest.position - oracle.stop.1).abs() < 1e-9, "{pulse:?}: rests at {} m", rest.position);
        assert_eq!(motion.half_cycles(), oracle.reversals, "{pulse:?}");
        let reversals = motion.events().iter().filter(|event| event.kind == EventKind::Reversal);
        for (found, (time, position)) in reversals.zip(oracle.first) {
            assert!((found.time - time).abs() < 1e-6, "{pulse:?}: turns at {} s, not {time} s", found.time);
            assert!(
                (found.position - position).abs() < 1e-9,
                "{pulse:?}: turns at {} m, not {position} m",
                found.position
            );
        }
        let largest = motion.velocity().values().iter().copied().fold(0.0, f64::max);
        assert!((largest - oracle.largest).abs() < 1e-9, "{pulse:?}: {largest} m/s at most");
    }
}

#[test]
fn positions_and_velocities() {
    let table = table("tests/data/frf/coulomb_impact_motion.csv");
    assert_eq!(table.len(), 73);
    for (level, oracle) in ORACLES[..3].iter().enumerate() {
        let motion = oracle.motion();
        for row in &table {
            let sample = (row[0] / INTERVAL).round() as usize;
            let (x, v) = (motion.position().values()[sample], motion.velocity().values()[sample]);
            // The deceleration in which an error of 1e-6 s would show is below 2.3 m/s².
            assert!((x - row[1 + 2 * level]).abs() < 1e-9, "{} s: {x} m, not {} m", row[0], row[1 + 2 * level]);
            assert!((v - row[2 + 2 * level]).abs() < 1e-9, "{} s: {v} m/s, not {} m/s", row[0], row[2 + 2 * level]);
        }
    }
}

#[test]
fn mobilities() {
    let table = table("crates/fmm-frf/tests/data/coulomb_impact_mobility.csv");
    for (level, oracle) in ORACLES[..3].iter().enumerate() {
        let options = AverageOptions::default().within(0.5, 25.0).unwrap();
        let mut average = TrialAverage::new(ResponseForm::Mobility, 1.0 / INTERVAL, SAMPLES, &options).unwrap();
        let mut force = oracle.force();
        force.resize(SAMPLES, 0.0);
        average.add(&force, oracle.motion().velocity().values()).unwrap();
        let mobility = average.estimate(Estimator::H1).unwrap();
        let (_, most) = mobility.peak().unwrap();
        for row in &table {
            let line = mobility.frequencies().iter().position(|frequency| (frequency - row[0]).abs() < 1e-9);
            let found = mobility.values()[line.unwrap_or_else(|| panic!("no line at {} Hz", row[0]))];
            let expected = Complex64::new(row[1 + 2 * level], row[2 + 2 * level]);
            assert!((found - expected).norm() < 1e-6 * most, "{} Hz: {found}, not {expected}", row[0]);
        }
    }
}
