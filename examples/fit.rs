//! Nonlinear regression for anyone: `cargo run --release --example fit`.
//!
//! Four problems, each with what makes it hard: a reference data set of NIST from both of its starts, the far one by
//! [`fmm_fit::solve_observed`] and the near one by argmin's executor; a bound that the data push against; outliers; and
//! several records with a parameter in common. `--problem` picks one of them.

use std::error::Error;
use std::fmt::Write as _;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use argmin::core::observers::{Observe, ObserverMode};
use argmin::core::{Executor, KV, State};
use clap::{Parser, ValueEnum};
use fmm_cli::figure::{self, Panel, Role};
use fmm_fit::{
    Automatic, BoundedLevenbergMarquardt, EvaluationError, Fit, Joint, Loss, Model, Options, Residuals, solve_observed,
    solve_robust,
};
use fmm_model::{Bounds, Parameter, Rounded, Scalar};
use indicatif::{ProgressBar, ProgressStyle};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use serde_json::{Value, json};

/// Fits curves to data that are hard to fit.
#[derive(Debug, Parser)]
#[command(name = "fit")]
struct Arguments {
    /// Which problem
    #[arg(long, value_enum, default_value = "all")]
    problem: Problem,
    /// Print one JSON document instead of the reports
    #[arg(long)]
    json: bool,
    /// Write an SVG figure of each problem into this folder
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Problem {
    /// MGH17, five parameters, from both starts of NIST
    Strd,
    /// An offset that cannot be negative
    Bounded,
    /// A decay with outliers
    Robust,
    /// Three decays of one rate
    Joint,
    /// All of them
    All,
}

/// A curve, generic in its number type so that it can carry exact derivatives.
#[derive(Debug, Clone, Copy)]
enum Formula {
    /// y = a exp(−b x) + c
    Decay,
    /// y = b₁ + b₂ exp(−b₄ x) + b₃ exp(−b₅ x)
    TwoDecays,
}

impl Formula {
    fn at<S: Scalar>(self, x: f64, p: &[S]) -> S {
        match self {
            Self::Decay => p[0] * (-p[1] * x).exp() + p[2],
            Self::TwoDecays => p[0] + p[1] * (-p[3] * x).exp() + p[2] * (-p[4] * x).exp(),
        }
    }
}

/// A curve and the points that it is to meet.
#[derive(Debug, Clone)]
struct Regression {
    formula: Formula,
    parameters: Vec<Parameter>,
    points: Vec<(f64, f64)>,
}

impl Model for Regression {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.points.len()
    }
    fn residuals<S: Scalar>(&self, p: &[S], residuals: &mut [S]) -> Result<(), EvaluationError> {
        for (r, &(x, y)) in residuals.iter_mut().zip(&self.points) {
            *r = self.formula.at(x, p) - y;
        }
        Ok(())
    }
}

impl Regression {
    /// A decay, simulated at 0, 0.1, 0.2, … s with normal noise.
    fn decay(truth: [f64; 3], noise: f64, seed: u64) -> Result<Self, Box<dyn Error>> {
        let (mut generator, noise) = (ChaCha8Rng::seed_from_u64(seed), Normal::new(0.0, noise)?);
        let point = |i: i32| (0.1 * f64::from(i), Formula::Decay.at(0.1 * f64::from(i), &truth));
        let points = (0..60).map(point).map(|(x, y)| (x, y + noise.sample(&mut generator))).collect();
        let parameters = vec![
            Parameter::new("amplitude", "a", "V"),
            Parameter::new("rate", "b", "1/s").bounded(Bounds::NOT_NEGATIVE),
            Parameter::new("offset", "c", "V"),
        ];
        Ok(Self { formula: Formula::Decay, parameters, points })
    }

    /// The curve at `p`, finely.
    fn curve(&self, p: &[f64]) -> Vec<(f64, f64)> {
        let end = self.points.last().map_or(0.0, |point| point.0);
        (0..=300).map(|i| f64::from(i) / 300.0 * end).map(|x| (x, self.formula.at(x, p))).collect()
    }

    fn panel(&self, x_label: &str, y_label: &str, name: &str, p: &[f64]) -> Panel {
        Panel::new(x_label, y_label, 330.0).with(Role::Points, "data", self.points.clone()).with(
            Role::Fitted,
            name,
            self.curve(p),
        )
    }
}

/// Result of a problem.
struct Shown {
    name: &'static str,
    text: String,
    document: Value,
    panels: Vec<Panel>,
}

/// From the line that shows progress to what is found.
type Solve = fn(&Line) -> Result<Shown, Box<dyn Error>>;

/// The line on standard error that shows how far a fit is.
#[derive(Debug, Clone)]
struct Line(ProgressBar);

impl Line {
    fn new() -> Result<Self, Box<dyn Error>> {
        let bar = ProgressBar::new_spinner().with_style(ProgressStyle::with_template("{spinner} {msg}")?);
        bar.enable_steady_tick(Duration::from_millis(100));
        Ok(Self(bar))
    }

    /// Fits `problem` while the line shows each step.
    fn follow<P: Residuals>(&self, name: &str, problem: &P, start: &[f64]) -> Result<Fit, fmm_fit::FitError> {
        solve_observed(problem, start, &Options::default(), |progress| {
            let (steps, square) = (progress.iterations(), progress.sum_of_squares());
            self.0.set_message(format!("{name}: step {steps}, sum of squares {square:.6e}"));
            // `Break` would end the fit with the best values so far.
            ControlFlow::Continue(())
        })
    }
}

/// An argmin observer needs no more than this.
impl<I: State> Observe<I> for Line {
    fn observe_iter(&mut self, state: &I, _: &KV) -> Result<(), argmin::core::Error> {
        self.0.set_message(format!("argmin: step {}, sum of squares {}", state.get_iter(), state.get_cost()));
        Ok(())
    }
}

/// The data of MGH17 (x = 0, 10, 20, …).
const MGH17: [f64; 33] = [
    0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751, 0.718, 0.685, 0.658, 0.628, 0.603,
    0.580, 0.558, 0.538, 0.522, 0.506, 0.490, 0.478, 0.467, 0.457, 0.448, 0.438, 0.431, 0.424, 0.420, 0.414, 0.411,
    0.406,
];
/// The two starts that NIST gives.
const STARTS: [[f64; 5]; 2] = [[50.0, 150.0, -100.0, 1.0, 2.0], [0.5, 1.5, -1.0, 0.01, 0.02]];
/// The certified values and their standard deviations.
const CERTIFIED: [(f64, f64); 5] = [
    (3.754_100_521_1e-1, 2.072_315_355_1e-3),
    (1.935_846_912_7, 2.203_166_922_2e-1),
    (-1.464_687_136_6, 2.217_570_773_9e-1),
    (1.286_753_464_0e-2, 4.486_135_811_4e-4),
    (2.212_269_966_2e-2, 8.947_199_657_5e-4),
];

/// Log relative error: how many digits agree. The certified values have 11.
fn digits(value: f64, certified: f64) -> f64 {
    (-((value - certified) / certified).abs().log10()).min(11.0)
}

fn strd(line: &Line) -> Result<Shown, Box<dyn Error>> {
    let names = [("b1", "b₁"), ("b2", "b₂"), ("b3", "b₃"), ("b4", "b₄"), ("b5", "b₅")];
    let regression = Regression {
        formula: Formula::TwoDecays,
        parameters: names.map(|(name, symbol)| Parameter::new(name, symbol, "1")).to_vec(),
        points: MGH17.iter().enumerate().map(|(i, y)| (10.0 * i as f64, *y)).collect(),
    };
    let problem = Automatic::<_, 5>::new(regression);
    let far = line.follow("MGH17", &problem, &STARTS[0])?;
    // The same solver under argmin's executor, with whatever observers, timeouts and checkpoints that has.
    let solver = BoundedLevenbergMarquardt::new(Options::default());
    let run = Executor::new(&problem, solver)
        .configure(|state| state.param(STARTS[1].to_vec()).max_iters(1000))
        .add_observer(line.clone(), ObserverMode::Always)
        .run()?;
    let near = run.solver.fit()?;

    let mut text = String::from("MGH17 (NIST StRD): y = b1 + b2 exp(−b4 x) + b3 exp(−b5 x)\n");
    let mut documents = Vec::new();
    for (number, (fit, way)) in [(&far, "solve_observed"), (&near, "argmin's Executor")].into_iter().enumerate() {
        let (start, steps) = (number + 1, fit.iterations());
        writeln!(text, "  start {start}, by {way}: {}, {steps} steps", fit.outcome())?;
        writeln!(
            text,
            "    {:>18} {:>18} {:>5}   {:>16} {:>16} {:>5}",
            "value", "certified", "LRE", "u", "certified", "LRE"
        )?;
        for (estimate, (value, deviation)) in fit.estimates().iter().zip(CERTIFIED) {
            let (ours, u) = (estimate.value(), estimate.standard_uncertainty().unwrap_or(f64::NAN));
            let (of_value, of_u) = (digits(ours, value), digits(u, deviation));
            write!(text, "    {ours:>18.10e} {value:>18.10e} {of_value:>5.1}   ")?;
            writeln!(text, "{u:>16.8e} {deviation:>16.8e} {of_u:>5.1}")?;
        }
        documents.push(document(fit));
    }
    let regression = problem.model();
    let residuals = regression.points.iter().zip(far.residuals()).map(|((x, _), r)| (*x, -r));
    let remainder = Panel::new("x", "residual", 210.0).with(Role::Residual, "data − fit", residuals);
    let panels = vec![regression.panel("", "y", "fit", far.values()), remainder];
    Ok(Shown { name: "strd", text, document: json!({ "starts": documents, "certified": CERTIFIED }), panels })
}

fn bounded(line: &Line) -> Result<Shown, Box<dyn Error>> {
    // A light that has gone out cannot be darker than dark, but the zero of this instrument is off.
    let free = Regression::decay([2.0, 0.8, -0.04], 0.05, 2)?;
    let mut held = free.clone();
    held.parameters[2] = held.parameters[2].clone().bounded(Bounds::NOT_NEGATIVE);
    let start = [1.0, 0.1, 0.5];
    let without = line.follow("free", &Automatic::<_, 3>::new(free), &start)?;
    let within = line.follow("bounded", &Automatic::<_, 3>::new(held.clone()), &start)?;
    let text = format!("With an offset that is not negative\n{within}Without that bound\n{without}");
    let document = json!({ "bounded": document(&within), "free": document(&without) });
    Ok(Shown {
        name: "bounded",
        text,
        document,
        panels: vec![held.panel("time / s", "y / V", "fit in bounds", within.values())],
    })
}

fn robust(line: &Line) -> Result<Shown, Box<dyn Error>> {
    let truth = [2.0, 0.8, 0.3];
    let mut decay = Regression::decay(truth, 0.03, 3)?;
    let wrong = [4, 17, 23, 38, 51];
    for i in wrong {
        decay.points[i].1 += 1.2;
    }
    let (problem, start) = (Automatic::<_, 3>::new(decay), [1.0, 0.1, 0.0]);
    let squares = line.follow("least squares", &problem, &start)?;
    let robust = solve_robust(&problem, &start, Loss::Tukey, None, &Options::default())?;
    let mut text = String::from("A decay with five outliers\n");
    writeln!(text, "  {:<10} {:>6} {:>20} {:>20}", "", "truth", "least squares", "Tukey's biweight")?;
    for (j, estimate) in squares.estimates().iter().enumerate() {
        let of_squares = Rounded::new(estimate.value(), estimate.standard_uncertainty()).to_string();
        let of_tukey = Rounded::new(robust.values()[j], robust.standard_uncertainty(j)).to_string();
        writeln!(text, "  {:<10} {:>6} {of_squares:>20} {of_tukey:>20}", estimate.name(), truth[j])?;
    }
    writeln!(text, "  called outliers: {:?}; put in: {wrong:?}", robust.outliers())?;
    let uncertainties: Vec<_> = (0..3).map(|j| robust.standard_uncertainty(j)).collect();
    let of_tukey = json!({
        "values": robust.values(),
        "standard_uncertainties": uncertainties,
        "outliers": robust.outliers(),
    });
    let decay = problem.model();
    let panel = decay.panel("time / s", "y / V", "Tukey's biweight", robust.values());
    let panel = panel.with(Role::Residual, "least squares", decay.curve(squares.values()));
    let document = json!({ "truth": truth, "least_squares": document(&squares), "tukey": of_tukey });
    Ok(Shown { name: "robust", text, document, panels: vec![panel] })
}

fn joint(line: &Line) -> Result<Shown, Box<dyn Error>> {
    // One rate; amplitudes and offsets differ from record to record.
    let truths = [[2.0, 0.8, 0.3], [1.2, 0.8, 0.1], [0.7, 0.8, -0.2]];
    let records = truths.iter().zip(10..).map(|(truth, seed)| Regression::decay(*truth, 0.05, seed));
    let problems: Vec<_> = records.map(|record| record.map(Automatic::<_, 3>::new)).collect::<Result<_, _>>()?;
    let start = [1.0, 0.1, 0.0];
    let mut text = String::from("Three decays of one rate, 0.8/s\n");
    for (number, problem) in problems.iter().enumerate() {
        let alone = line.follow("alone", problem, &start)?;
        let rate = &alone.estimates()[1];
        writeln!(
            text,
            "  record {} alone: rate {} 1/s",
            number + 1,
            Rounded::new(rate.value(), rate.standard_uncertainty())
        )?;
    }
    let joint = Joint::new(problems, &["rate"])?;
    let fit = line.follow("together", &joint, &joint.start(&[start; 3])?)?;
    write!(text, "Together\n{fit}")?;
    let mut panels = Vec::new();
    for (number, (problem, values)) in joint.problems().iter().zip(joint.split(&fit)?).enumerate() {
        let x_label = if number == 2 { "time / s" } else { "" };
        panels.push(problem.model().panel(x_label, "y / V", "joint fit", &values));
    }
    Ok(Shown { name: "joint", text, document: document(&fit), panels })
}

/// A fit for other programs.
fn document(fit: &Fit) -> Value {
    let estimates = fit.estimates().iter().map(|estimate| {
        json!({
            "name": estimate.name(),
            "unit": estimate.parameter().unit(),
            "start": estimate.start(),
            "value": estimate.value(),
            "standard_uncertainty": estimate.standard_uncertainty(),
            "is_at_bound": estimate.status().is_at_bound(),
        })
    });
    json!({
        "outcome": fit.outcome().to_string(),
        "is_success": fit.outcome().is_success(),
        "iterations": fit.iterations(),
        "residual_evaluations": fit.residual_evaluations(),
        "jacobian_evaluations": fit.jacobian_evaluations(),
        "sum_of_squares": fit.sum_of_squares(),
        "rank": fit.rank(),
        "estimates": estimates.collect::<Vec<_>>(),
    })
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let line = Line::new()?;
    let ways: [(Problem, Solve); 4] =
        [(Problem::Strd, strd), (Problem::Bounded, bounded), (Problem::Robust, robust), (Problem::Joint, joint)];
    let mut all = Vec::new();
    for (problem, solve) in ways {
        if arguments.problem == problem || arguments.problem == Problem::All {
            all.push(solve(&line)?);
        }
    }
    line.0.finish_and_clear();
    let report = if arguments.json {
        let documents = all.iter().map(|shown| (shown.name.to_owned(), shown.document.clone())).collect();
        serde_json::to_string_pretty(&Value::Object(documents))?
    } else {
        all.iter().map(|shown| shown.text.trim_end()).collect::<Vec<_>>().join("\n\n")
    };
    match writeln!(std::io::stdout(), "{report}") {
        // Whoever reads may stop reading.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => {}
        written => written?,
    }
    if let Some(folder) = &arguments.figures {
        std::fs::create_dir_all(folder).map_err(|error| format!("cannot create {}: {error}", folder.display()))?;
        for shown in &all {
            let path = folder.join(shown.name).with_extension("svg");
            std::fs::write(&path, figure::drawn(&shown.panels))?;
            eprintln!("figure: {}", path.display());
        }
    }
    Ok(())
}
