//! Cost of `fmm identify` as its problem grows, as a table and a picture:
//!
//! ```text
//! cargo build --release -p fmm-cli
//! cargo run --example growth -- target/release/fmm --figure docs/growth.svg
//! ```
//!
//! Each time is that of the whole program: its start, the reading of a table of times and velocities, preparation, fit and
//! document. The records are simulated.

use std::error::Error;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use clap::Parser;
use fmm_cli::figure::{Panel, Role, drawn};
use fmm_friction::Coulomb;
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Engine as _, Exact, Sampling, Scenario};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

/// Times of a program `fmm` as records and laws grow.
#[derive(Debug, Parser)]
#[command(name = "growth")]
struct Arguments {
    /// The program
    program: PathBuf,
    /// Draw the picture into this file
    #[arg(long)]
    figure: Option<PathBuf>,
}

/// Mass (kg), stiffness (N/m), linear damping (N s/m) and normal load (N) of the thesis' machine.
const MACHINE: [f64; 4] = [10.391, 1982.0, 0.1, 7.2];
/// Where the decays are released (m), and the standard deviation of the noise (m/s).
const RELEASE: f64 = 0.02;
const NOISE: f64 = 3e-4;
/// How long a call is repeated (s).
const WHILE: f64 = 2.0;
/// Half swings and samples where something else grows.
const HALF_SWINGS: f64 = 10.0;
const SAMPLES: f64 = 1500.0;

/// Fits of 3 to 9 parameters: initial position, natural frequency and friction, then initial velocity and offset, then
/// damping and the spring.
const LAWS: [&[&str]; 7] = [
    &["coulomb", "--hold=offset=0", "--hold=initial_velocity=0"],
    &["coulomb", "--hold=offset=0"],
    &["coulomb"],
    &["coulomb_viscous"],
    &["coulomb_viscous+quadratic"],
    &["coulomb_viscous+quadratic+cubic"],
    &["coulomb_viscous+quadratic+cubic+cubic_spring"],
];

/// A decay of so many half swings and samples, as a table of times (s) and velocities (m/s).
fn decay(half_swings: f64, samples: f64, seed: u64) -> Result<String, Box<dyn Error>> {
    let [mass, stiffness, damping, load] = MACHINE;
    let machine = Oscillator::new(mass, stiffness)?.with_damping(Damping::linear(damping)?);
    // Each half swing takes twice the friction over the stiffness from the amplitude.
    let friction = 0.9 * RELEASE * stiffness / (2.0 * half_swings);
    // Records of one machine are not the same motion.
    let release = RELEASE * (1.0 - 0.01 * seed as f64);
    let scenario = Scenario::new(machine, Coulomb::new(friction / load)?, load)?.starting_at(release, 0.0)?;
    let interval = half_swings * std::f64::consts::PI * (mass / stiffness).sqrt() / samples;
    let motion = Exact.run(&scenario, &Sampling::uniform(interval, samples as usize)?)?;
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let row = |(index, velocity): (usize, &f64)| {
        let noise: f64 = StandardNormal.sample(&mut generator);
        format!("{:.9},{:.7}\n", index as f64 * interval, velocity + NOISE * noise)
    };
    Ok(std::iter::once("t,v\n".to_owned()).chain(motion.velocity().values().iter().enumerate().map(row)).collect())
}

/// Files of decays, and who reads them.
struct Bench {
    folder: PathBuf,
    program: PathBuf,
}

impl Bench {
    /// Paths of so many decays.
    fn records(&self, count: usize, half_swings: f64, samples: f64) -> Result<Vec<PathBuf>, Box<dyn Error>> {
        let paths = (0..count).map(|index| self.folder.join(format!("{index}.csv"))).collect::<Vec<_>>();
        for (seed, path) in paths.iter().enumerate() {
            std::fs::write(path, decay(half_swings, samples, seed as u64)?)?;
        }
        Ok(paths)
    }

    /// Least time (s) of an identification with these `options` on so many threads, over many calls: other programs only
    /// ever add.
    fn time(&self, threads: usize, options: &[String], records: &[PathBuf]) -> Result<f64, Box<dyn Error>> {
        let (mut least, mut spent, mut calls) = (f64::INFINITY, 0.0, 0);
        while spent < WHILE || calls < 2 {
            let mut command = Command::new(&self.program);
            command.arg("identify").args(["--unit", "m/s", "--json"]).args(options).arg("--").args(records);
            let begin = Instant::now();
            let output = command.env("RAYON_NUM_THREADS", threads.to_string()).stdin(Stdio::null()).output()?;
            let taken = begin.elapsed().as_secs_f64();
            (least, spent, calls) = (least.min(taken), spent + taken, calls + 1);
            if !output.status.success() {
                return Err(format!("{command:?} failed: {}", String::from_utf8_lossy(&output.stdout)).into());
            }
        }
        Ok(least)
    }

    /// Times of one question on one and on two threads.
    fn both(&self, options: &[String], records: &[PathBuf]) -> Result<[f64; 2], Box<dyn Error>> {
        Ok([self.time(1, options, records)?, self.time(2, options, records)?])
    }
}

/// Times (s) on one and on two threads as something grows.
struct Growth {
    /// Quantity that grows.
    what: &'static str,
    /// Question that is asked: one law, or a search.
    asked: &'static str,
    points: Vec<(f64, [f64; 2])>,
}

impl Growth {
    /// The exponent of growth on one thread from the middle of the points on, by least squares of the logarithms.
    fn slope(&self) -> f64 {
        let logarithms = self.points.iter().map(|(x, times)| (x.ln(), times[0].ln()));
        let late: Vec<(f64, f64)> = logarithms.skip(self.points.len() / 2).collect();
        let count = late.len() as f64;
        let middle = late.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / count, sum.1 + point.1 / count));
        let products =
            |of: fn(f64, f64) -> f64| late.iter().map(|point| of(point.0 - middle.0, point.1 - middle.1)).sum::<f64>();
        products(|x, y| x * y) / products(|x, _| x * x)
    }

    fn row(&self) -> String {
        let counts = self.points.iter().map(|(x, _)| x.to_string()).collect::<Vec<_>>().join(", ");
        let times = |threads: usize| self.points.iter().map(move |(_, times)| format!("{:.0}", 1e3 * times[threads]));
        let [one, two] = [0, 1].map(|threads| times(threads).collect::<Vec<_>>().join(", "));
        format!("| {}, {}: {counts} | {one} | {two} | {:.2} |", self.what, self.asked, self.slope())
    }
}

fn law(name: &str) -> Vec<String> {
    vec![format!("--law={name}")]
}

fn measured(bench: &Bench) -> Result<Vec<Growth>, Box<dyn Error>> {
    let one_law = law("coulomb_viscous");
    let mut found = Vec::new();
    for (asked, options) in [("one law", &one_law[..]), ("a search", &[])] {
        let mut grow = |what, values: &[f64], records: &dyn Fn(f64) -> Result<Vec<PathBuf>, Box<dyn Error>>| {
            let point = |&value: &f64| Ok((value, bench.both(options, &records(value)?)?));
            let points = values.iter().map(point).collect::<Result<Vec<_>, Box<dyn Error>>>()?;
            found.push(Growth { what, asked, points });
            Ok::<(), Box<dyn Error>>(())
        };
        grow("samples", &[1500.0, 5e3, 15e3, 5e4, 15e4, 1e6], &|samples| bench.records(1, HALF_SWINGS, samples))?;
        grow("half swings", &[5.0, 10.0, 20.0, 50.0, 100.0, 200.0], &|half_swings| {
            bench.records(1, half_swings, 4.0 * SAMPLES)
        })?;
        grow("records", &[1.0, 2.0, 4.0, 8.0, 16.0], &|count| bench.records(count as usize, HALF_SWINGS, SAMPLES))?;
    }
    let record = bench.records(1, HALF_SWINGS, SAMPLES)?;
    let point = |(index, parts): (usize, &&[&str])| {
        let mut options = law(parts[0]);
        options.extend(parts[1..].iter().map(ToString::to_string));
        Ok(((3 + index) as f64, bench.both(&options, &record)?))
    };
    let points = LAWS.iter().enumerate().map(point).collect::<Result<Vec<_>, Box<dyn Error>>>()?;
    found.push(Growth { what: "parameters", asked: "one law", points });
    Ok(found)
}

/// One panel for each thing that grows.
fn picture(found: &[Growth]) -> String {
    let panel = |what: &str| {
        let empty = Panel::new(what, "time / s", 250.0).logarithmic();
        found.iter().filter(|growth| growth.what == what).fold(empty, |panel, growth| {
            let [line, dots] = match growth.asked {
                "one law" => [Role::Fitted, Role::FittedPoints],
                _ => [Role::Reference, Role::ResidualPoints],
            };
            let curve = |threads: usize| growth.points.iter().map(move |(x, times)| (*x, times[threads]));
            let name = format!("{}, one thread: slope {:.2}", growth.asked, growth.slope());
            panel.with(line, name, curve(0)).with(dots, format!("{}, two threads", growth.asked), curve(1))
        })
    };
    drawn(&["samples", "half swings", "parameters", "records"].map(panel))
}

fn main() -> Result<(), Box<dyn Error>> {
    let Arguments { program, figure } = Arguments::parse();
    let folder = std::env::temp_dir().join(format!("fmm-growth-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let bench = Bench { folder, program };
    let found = measured(&bench);
    std::fs::remove_dir_all(&bench.folder)?;
    let found = found?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "| what grows | ms on one thread | ms on two | slope |\n|---|---|---|---|")?;
    for growth in &found {
        writeln!(out, "{}", growth.row())?;
    }
    if let Some(path) = figure {
        std::fs::write(&path, picture(&found))?;
        writeln!(out, "figure: {}", Path::new(&path).display())?;
    }
    Ok(())
}
