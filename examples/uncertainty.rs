//! Measurement uncertainty for anyone: `cargo run --release --example uncertainty`.
//!
//! Two calibrations from JCGM 101:2008 in which the GUM falls short for different reasons: a weight, whose model is
//! curved (9.3), and a gauge block, whose inputs are known from few observations and between limits that are themselves
//! inexact (9.5; example H.1 of the GUM). Each is evaluated to first order, to second order and by a Monte Carlo that
//! stops when it is stable, beside the published figures, and the Monte Carlo says which of the others may be used.

use std::error::Error;
use std::fmt::Write as _;
use std::io::Write as _;
use std::process::ExitCode;

use fmm_uq::{
    Adaptive, Budget, Distribution, Input, Inputs, IntervalKind, MonteCarlo, OutputSample, Scalar, UncertaintyError,
    Validation, propagate, validate,
};

/// Conventional mass of a weight less 100 g (mg), weighed in air against a reference:
///
/// ```text
/// δm = (m_Rc + δm_Rc) (1 + (ρ_a − 1.2 kg/m³)(1/ρ_W − 1/ρ_R)) − 100 g
/// ```
fn mass<D: Scalar>(x: &[D]) -> D {
    let [reference, difference, air, weight, reference_density] = x else { return D::from(f64::NAN) };
    let one = D::from(1.0);
    let buoyancy = (*air - 1.2) * (one / *weight - one / *reference_density);
    (*reference + *difference) * (buoyancy + 1.0) - 100_000.0
}

fn mass_inputs() -> Result<Inputs, UncertaintyError> {
    Inputs::new([
        Input::new("m_Rc", 100_000.0, 0.05, "mg")?,
        Input::new("δm_Rc", 1.234, 0.02, "mg")?,
        Input::of("ρ_a", Distribution::rectangular(1.1, 1.3)?, "kg/m³")?,
        Input::of("ρ_W", Distribution::rectangular(7000.0, 9000.0)?, "kg/m³")?,
        Input::of("ρ_R", Distribution::rectangular(7950.0, 8050.0)?, "kg/m³")?,
    ])
}

/// Length of a gauge block less 50 mm (nm), compared with a standard near 20 °C:
///
/// ```text
/// δl = l_S + D + d₁ + d₂ − l_S (δα (θ₀ + Δ) + α_S δθ) − 50 mm
/// ```
fn length<D: Scalar>(x: &[D]) -> D {
    let [standard, difference, random, systematic, expansion, mean, cycle, expansions, temperatures] = x else {
        return D::from(f64::NAN);
    };
    let warm = *expansions * (*mean + *cycle) + *expansion * *temperatures;
    *standard + *difference + *random + *systematic - *standard * warm - 50_000_000.0
}

/// The GUM takes limits as exact and counts in degrees of freedom how well they are known; a Monte Carlo draws the
/// limits.
fn length_inputs(inexact_limits: bool) -> Result<Inputs, UncertaintyError> {
    let observed = |name, value, u, nu| Input::new(name, value, u, "nm")?.with_degrees_of_freedom(nu);
    let limited = |name, half: f64, inexactness, unit, nu| {
        let distribution = if inexact_limits {
            Distribution::curvilinear_trapezoid(-half, half, inexactness)?
        } else {
            Distribution::rectangular(-half, half)?
        };
        Input::of(name, distribution, unit)?.with_degrees_of_freedom(nu)
    };
    Inputs::new([
        observed("l_S", 50_000_623.0, 25.0, 18.0)?,
        observed("D", 215.0, 6.0, 24.0)?,
        observed("d₁", 0.0, 4.0, 5.0)?,
        observed("d₂", 0.0, 7.0, 8.0)?,
        Input::of("α_S", Distribution::rectangular(9.5e-6, 13.5e-6)?, "1/K")?,
        Input::of("θ₀", Distribution::normal(-0.1, 0.2)?, "K")?,
        Input::of("Δ", Distribution::arc_sine(-0.5, 0.5)?, "K")?,
        limited("δα", 1e-6, 1e-7, "1/K", 50.0)?,
        limited("δθ", 0.05, 0.025, "K", 2.0)?,
    ])
}

/// How a measurement is reported.
struct Report {
    title: &'static str,
    unit: &'static str,
    /// Decimals that are printed.
    decimals: usize,
    /// Coverage probability (1).
    level: f64,
    /// Digits that u is meant to, which decide how far intervals may differ.
    digits: u32,
    /// Figures that are printed in the guides of the first order, the second and the Monte Carlo.
    published: [&'static str; 3],
}

impl Report {
    /// The budget, and below it all three methods with the figures they were published with.
    fn write(&self, budget: &Budget, trials: &OutputSample) -> Result<String, Box<dyn Error>> {
        let Self { title, unit, decimals, level, digits, published } = self;
        let (first, second) = (budget.expanded(*level)?, budget.expanded_to_second_order(*level)?);
        let shortest = trials.shortest_interval(0, *level)?;
        let u = trials.standard_uncertainty(0)?;
        let curved = second.uncertainty / second.coverage_factor;
        let counted = format!("Monte Carlo, {} trials", trials.trials());
        let rows = [
            ("GUM, first order", budget.estimate(), budget.standard_uncertainty(), first.interval()),
            ("GUM, second order", budget.estimate(), curved, second.interval()),
            (&counted, trials.estimate(0)?, u, shortest),
        ];
        let mut text = format!("{title}\n\n{budget}\n");
        let (y_header, u_header, header) =
            (format!("y/{unit}"), format!("u/{unit}"), format!("{} % interval", level * 100.0));
        writeln!(text, "{:<28} {y_header:>8} {u_header:>7}  {header:<17}  published", "")?;
        for ((method, y, u, interval), published) in rows.iter().zip(published) {
            let interval = format!("[{:.decimals$}, {:.decimals$}]", interval.low, interval.high);
            writeln!(text, "{method:<28} {y:>8.decimals$} {u:>7.decimals$}  {interval:<17}  {published}")?;
        }
        for (method, _, _, interval) in &rows[..2] {
            let found = validate(*interval, shortest, u, *digits)?;
            let verdict = if found.is_valid() { "may be used" } else { "must not be used" };
            let Validation { low, high, tolerance, .. } = found;
            let ends = format!("ends differ by {low:.decimals$} and {high:.decimals$} {unit}");
            writeln!(text, "{method}: {ends}, δ = {tolerance} {unit}: {verdict} (clause 8)")?;
        }
        Ok(text)
    }
}

fn weight() -> Result<String, Box<dyn Error>> {
    let inputs = mass_inputs()?;
    let budget = propagate(&inputs, mass)?.named("mass less 100 g", "mg");
    let report = Report {
        title: "Weight (JCGM 101:2008, 9.3)",
        unit: "mg",
        decimals: 4,
        level: 0.95,
        digits: 1,
        published: [
            "1.2340 0.0539 [1.1285, 1.3395]",
            "1.2340 0.0750 [1.0870, 1.3810]",
            "1.2341 0.0754 [1.0834, 1.3825]",
        ],
    };
    // A fifth of the tolerance, as a validation needs it.
    let rule = Adaptive::to_digits(report.digits)?.with_interval(IntervalKind::Shortest, report.level)?;
    let trials = MonteCarlo::adaptive(&inputs, rule.for_validation()).run(mass)?;
    report.write(&budget, &trials)
}

fn gauge_block() -> Result<String, Box<dyn Error>> {
    let budget = propagate(&length_inputs(false)?, length)?.named("length less 50 mm", "nm");
    let report = Report {
        title: "Gauge block (JCGM 101:2008, 9.5)",
        unit: "nm",
        decimals: 1,
        level: 0.99,
        digits: 2,
        published: ["838 32 [745, 931]", "u = 34 (GUM, H.1.7)", "838 36 [745, 932]"],
    };
    // The tolerance itself, as in the guide; a fifth of it takes a hundred times as many trials.
    let rule = Adaptive::to_digits(report.digits)?.with_interval(IntervalKind::Shortest, report.level)?;
    let trials = MonteCarlo::adaptive(&length_inputs(true)?, rule).run(length)?;
    report.write(&budget, &trials)
}

fn run() -> Result<(), Box<dyn Error>> {
    let report = format!("{}\n{}", weight()?, gauge_block()?);
    match write!(std::io::stdout(), "{report}") {
        // Whoever reads may stop reading.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        written => Ok(written?),
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
