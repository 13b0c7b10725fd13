//! Golden documents: results of the program and the library, all digits, as they were when they were written.
//!
//! `cargo test -p fmm-thesis --test golden` compares them with `tests/data/golden`: names, structure and integers
//! exactly, other numbers within 1e-6, of sentences the numbers. `FMM_GOLDEN=exact` compares all digits and words, as
//! on the machine that wrote them, and `FMM_GOLDEN=write` writes them anew.
//!
//! Times, versions and paths are left out; series are digested. Cut down for time: searches see the first 12 s of 30 s
//! of the fork and the first 8 s of 55 s of the pendulum, the fit of which by three laws sees 15 s; the budget takes
//! 100 000 trials, table 3 takes 1000 refits a row, and the thesis is without the chapter of its Monte Carlo.

mod document;
mod program;
mod simulated;

use document::golden;
use program::fmm;

const FORK: &str = "identify";
const WHEEL: &str = "identify examples/data/bicycle_wheel_radial_gyro.csv --unit rad/s";
const PENDULUM: &str = "identify examples/data/single_pendulum_55s_1khz.csv --channel theta_rad --pendulum";
const RUN: &str = "identify examples/data/flexure/run_";
const MACHINE: &str = "--mass 10.391 --mass-u 0.005 --normal-load 14 --normal-load-u 0.07";

#[test]
fn commands() {
    let lines = [
        "backbone",
        "backbone examples/data/bicycle_wheel_radial_gyro.csv --unit rad/s",
        "budget examples/budgets/stiffness.toml --trials 100000",
        "frf examples/data/hammer_1.mat examples/data/hammer_2.mat examples/data/hammer_3.mat",
        "laws",
        "formats",
    ];
    golden("commands", lines.map(fmm));
}

#[test]
fn designs() {
    golden("designs", ["design examples/designs/berger.toml", "design examples/designs/one_ring_down.toml"].map(fmm));
}

#[test]
fn forces() {
    const RECORD: &str = "force examples/data/damper_1Hz_36lb_1amplitude.csv";
    const OTHER: &str = "examples/data/damper_1Hz_30lb_1amplitude.csv";
    let models = "coulomb+linear+asymmetry,dahl+linear+asymmetry,coulomb+linear+zero+inertia+channels";
    let lines = [
        format!("{RECORD} --channels band_1,band_2 --average 0.02 --model {models} --validate {OTHER}"),
        format!("{RECORD} --average 0.05 --model coulomb,stribeck"),
        format!("{RECORD} --average 0.05 --model dahl --hold dahl.exponent=1"),
    ];
    golden("forces", lines.iter().map(|line| fmm(line)));
}

#[test]
fn records_by_law() {
    let mut lines = vec![
        format!("{FORK} --law coulomb_viscous"),
        "compare".to_owned(),
        format!("{WHEEL} --law coulomb_viscous"),
        format!("{WHEEL} --law coulomb,stribeck"),
        format!("{PENDULUM} --law coulomb+linear,coulomb+quadratic,berger+quadratic --to 15"),
    ];
    lines.extend((1..=6).map(|run| format!("{RUN}{run}.csv --law coulomb_viscous {MACHINE}")));
    golden("records_by_law", lines.iter().map(|line| fmm(line)));
}

#[test]
fn records_by_search() {
    let mut lines = vec![format!("{FORK} --to 12"), WHEEL.to_owned(), format!("{PENDULUM} --to 8")];
    lines.extend((1..=6).map(|run| format!("{RUN}{run}.csv {MACHINE}")));
    golden("records_by_search", lines.iter().map(|line| fmm(line)));
}

#[test]
fn simulations() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/scenarios");
    let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    golden("simulations", names.iter().map(|name| fmm(&format!("simulate examples/scenarios/{name}"))));
}

#[test]
fn campaign() {
    golden("campaign", [fmm(&format!("batch examples/data/flexure --joint -- --law coulomb_viscous {MACHINE}"))]);
}

#[test]
fn experiments() {
    golden("experiments", simulated::experiments());
}

#[test]
fn impacts() {
    golden("impacts", simulated::impacts());
}

#[test]
fn table_3() {
    golden("table_3", simulated::table_3());
}

/// Every target of the thesis with few repetitions, but for the chapter of the Monte Carlo, whose table is above.
#[test]
fn thesis() {
    let settings = fmm_thesis::Settings::new().quick(true);
    let chapters = fmm_thesis::CHAPTERS.iter().filter(|(name, _)| *name != "chapter_5_monte_carlo");
    let targets =
        |chapter: &fmm_thesis::Chapter| chapter.targets.iter().map(fmm_thesis::Target::document).collect::<Vec<_>>();
    let chapters = chapters.map(|(name, chapter)| {
        let chapter = chapter(&settings).unwrap();
        // One key a target, as a long list would be digested.
        let targets = targets(&chapter).into_iter().enumerate();
        ((*name).to_owned(), targets.map(|(i, target)| (format!("{i:02}"), target)).collect())
    });
    golden("thesis", chapters);
}
