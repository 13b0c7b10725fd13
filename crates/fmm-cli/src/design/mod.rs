//! Choice of the next tests: `fmm design FILE.toml`.
//!
//! Reads a machine, a guess of its friction and the tests that may be made, and says what each would tell, which set of
//! them tells most, and what each of that set tells that the others do not.

mod campaign;
mod candidates;
mod figures;
mod file;
mod result;

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use fmm_identify::design::{Aim, DesignPrediction, Plan};
use fmm_identify::{Finding, FrictionCurve, FrictionLevel};
use serde::{Deserialize, Serialize};

use crate::answer::{Answer, Detail, Document};
use crate::host::Host;
use crate::output::Output;
use campaign::Campaign;
use file::{Robust, Wanted};

/// Says which tests to make.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The plan, as TOML or, by its ending, as JSON
    #[arg(required_unless_present = "from")]
    file: Option<PathBuf>,
    /// Make the plan from a document: of one record, by `fmm identify --json`, or of a campaign, campaign.json of `fmm
    /// batch --out`. It takes its machine, friction and noise, with tests at its loads and releases, and is printed, to
    /// be changed and given as a file
    #[arg(long, value_name = "result.json|campaign.json", conflicts_with = "file")]
    from: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) output: Output,
}

pub(crate) const HELP: &str = include_str!("help.txt");

/// One test.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Row {
    name: String,
    settings: BTreeMap<&'static str, f64>,
    cost: f64,
    /// Standard uncertainty of the aim by this test alone; none if it does not determine the aim.
    u: Option<f64>,
    /// Friction at the speed that is aimed at, as a curve of this test alone would have it.
    #[serde(skip_serializing_if = "Option::is_none")]
    friction: Option<FrictionLevel>,
    told: String,
}

/// A set of tests and what it would find.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Set {
    /// Places of tests with how often each is made.
    chosen: Vec<(usize, usize)>,
    u: Option<f64>,
    cost: f64,
    is_exhaustive: bool,
    findings: BTreeMap<String, Finding>,
    /// Friction at the speed that is aimed at, as the curve has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    friction: Option<FrictionLevel>,
    /// Friction over the speed that the set would show without a law, if the aim is of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    friction_curve: Option<FrictionCurve>,
    stays_free: Vec<String>,
    hardly_told_apart: Vec<(String, String, f64)>,
    /// Information of each test that the others do not have.
    told: Vec<(usize, String)>,
    #[serde(skip)]
    text: String,
}

#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Choice {
    aim: String,
    tests: Vec<Row>,
    /// The test that tells most by itself, and the one that tells most for its cost.
    single: Option<usize>,
    for_its_cost: Option<usize>,
    best: Set,
    /// u of the same number of repeats of the single best test.
    repeats: Option<f64>,
    /// The plan that a campaign led to, and what more of its records would tell.
    #[serde(skip)]
    told: Option<[String; 2]>,
}

pub(crate) fn design(arguments: &Arguments, host: &Host<'_>) -> Result<Choice, Box<dyn Error>> {
    host.while_busy("comparing tests", || {
        if let Some(path) = &arguments.file {
            return host.document(path, |file| answer(Wanted::of(file)?));
        }
        let path = arguments
            .from
            .as_deref()
            .ok_or("give the file of a plan, or --from with the document of a record or a campaign")?;
        host.document(path, |from: From| {
            let (plan, more) = from.plan()?;
            let answer = answer(Wanted::of(toml::from_str(&plan)?)?)?;
            Ok(Choice { told: Some([plan, more]), ..answer })
        })
    })?
}

/// Document of which a plan is made.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum From {
    Campaign(Campaign),
    Record(result::Found),
}

impl From {
    fn plan(&self) -> Result<(String, String), String> {
        match self {
            Self::Campaign(campaign) => campaign.plan(),
            Self::Record(found) => found.plan(),
        }
    }
}

impl Answer for Choice {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        let told = self.told.as_ref().map_or_else(String::new, |[plan, more]| {
            format!("the plan, to be changed and given as a file:\n\n{plan}\n{more}\n\n")
        });
        Ok(format!("{told}{}", text(self).trim_end()))
    }

    fn document(&self, _: Detail) -> Result<String, Box<dyn Error>> {
        Document::new("design-1", self).pretty()
    }

    fn pictures(&self) -> Result<Vec<(String, String)>, Box<dyn Error>> {
        Ok(figures::picture(self).into_iter().collect())
    }
}

/// The plan that follows from the document of a record or a campaign, after it was carried out, and what more records would tell.
#[cfg(test)]
pub(crate) fn of_document(document: &str) -> Result<(String, String), Box<dyn Error>> {
    let told = serde_json::from_str::<From>(document)?.plan()?;
    answer(Wanted::of_toml(&told.0)?)?;
    Ok(told)
}

fn answer(wanted: Wanted) -> Result<Choice, Box<dyn Error>> {
    let Wanted { guess, tests, settings, choose } = wanted;
    let aim = choose.aim.aim();
    let samples = choose.robust.map(|_| guess.draws(choose.draws, choose.seed));
    let plan = Plan::new(guess, tests)?;
    let search = match (&samples, choose.robust) {
        (Some(samples), Some(Robust::Worst)) => plan.robust_search(&aim, samples)?.for_worst_case(),
        (Some(samples), _) => plan.robust_search(&aim, samples)?,
        (None, _) => plan.search(&aim)?,
    };
    let search = search.with_seed(choose.seed);
    let speed = match aim {
        Aim::FrictionAt(speed) => Some((speed, plan.curve()?)),
        _ => None,
    };
    let costs: Vec<f64> = plan.tests().iter().map(fmm_identify::design::PlannedTest::cost).collect();
    let best = match (choose.tests, choose.budget) {
        (Some(tests), _) => search.best(tests)?,
        (None, budget) => search.best_within(&costs, budget.unwrap_or_default())?,
    };
    let uncertainty = |set: &[usize], prediction: &DesignPrediction| -> Result<Option<f64>, Box<dyn Error>> {
        Ok(match &aim {
            Aim::Finding(name) => prediction.relative_uncertainty(name),
            Aim::FrictionAt(_) => Some(search.score(set)?.exp()),
            _ if prediction.null_directions().is_empty() => Some(search.score(set)?.exp()),
            _ => None,
        })
    };
    let mut rows = Vec::with_capacity(settings.len());
    for (place, (test, settings)) in plan.tests().iter().zip(settings).enumerate() {
        let u = uncertainty(&[place], &plan.predict(&[place])?)?;
        rows.push(Row {
            name: test.name().to_owned(),
            settings,
            cost: test.cost(),
            u,
            friction: match &speed {
                Some((speed, curve)) => curve.predict(&[place])?.at(*speed),
                None => None,
            },
            told: plan.sentence_alone(place)?,
        });
    }
    let least = |of: &dyn Fn(&Row) -> f64| {
        let known = (0..rows.len()).filter(|place| rows[*place].u.is_some());
        known.min_by(|a, b| of(&rows[*a]).total_cmp(&of(&rows[*b])))
    };
    let single = least(&|row| row.u.unwrap_or(f64::INFINITY));
    // Repeats lessen u as the root of their number: what counts is u² times the cost.
    let for_its_cost = least(&|row| row.u.unwrap_or(f64::INFINITY).powi(2) * row.cost);
    let repeats = match single.filter(|_| choose.tests.is_some()) {
        Some(place) => {
            let set = vec![place; best.measurements().len()];
            uncertainty(&set, &plan.predict(&set)?)?
        }
        None => None,
    };
    let prediction = plan.predict(best.measurements())?;
    let close = prediction.close_pairs().into_iter();
    let friction_curve = speed.as_ref().map(|(_, curve)| curve.predict(best.measurements())).transpose()?;
    let friction = friction_curve.as_ref().zip(speed).and_then(|(curve, (speed, _))| curve.at(speed));
    let mut told = plan.sentences_of_each(best.measurements())?;
    if friction.is_some() {
        for (place, told) in &mut told {
            let others: Vec<usize> = best.measurements().iter().copied().filter(|other| other != place).collect();
            let ratio = (search.score(&others)? - search.score(best.measurements())?).exp();
            *told = format!("without it, u of {} would be {ratio:.2} times as large; by the law, {told}", choose.aim);
        }
    }
    let by_curve = friction.as_ref().map_or_else(String::new, |level| format!("  {} = {level}\n", choose.aim));
    let best = Set {
        chosen: best.counts(),
        u: uncertainty(best.measurements(), &prediction)?,
        cost: best.measurements().iter().map(|place| costs[*place]).sum(),
        is_exhaustive: best.is_exhaustive(),
        findings: prediction.findings().iter().map(|one| (one.parameter().name().to_owned(), one.clone())).collect(),
        stays_free: prediction.null_directions().iter().map(ToString::to_string).collect(),
        hardly_told_apart: close.map(|(a, b, r)| (a.to_owned(), b.to_owned(), r)).collect(),
        friction,
        friction_curve,
        told,
        text: format!("{by_curve}{prediction}"),
    };
    Ok(Choice { aim: choose.aim.to_string(), tests: rows, single, for_its_cost, best, repeats, told: None })
}

fn percent(u: Option<f64>) -> String {
    match u {
        Some(u) if u < 10.0 => format!("{:.3} %", 100.0 * u),
        Some(_) => "more than 1000 %".to_owned(),
        None => "not determined".to_owned(),
    }
}

fn text(answer: &Choice) -> String {
    let mut text = String::new();
    let Choice { aim, tests, best, .. } = answer;
    let width = tests.iter().map(|test| test.name.chars().count()).max().unwrap_or(0);
    // Writing to a string does not fail.
    let _ = writeln!(text, "u of {aim}, relative, by each test alone:");
    for test in tests {
        let _ = writeln!(text, "  {:width$}  cost {:<6} {:<16} {}", test.name, test.cost, percent(test.u), test.told);
    }
    if let Some(place) = answer.single {
        let _ = writeln!(text, "\nthe single best: {}", tests[place].name);
    }
    if let Some(place) = answer.for_its_cost {
        let _ = writeln!(text, "most for its cost: {}", tests[place].name);
    }
    let count: usize = best.chosen.iter().map(|(_, count)| count).sum();
    let how = if best.is_exhaustive { "of all sets" } else { "by exchanges" };
    let tests_of_it = if count == 1 { "1 test".to_owned() } else { format!("{count} tests") };
    let _ = writeln!(text, "\nthe best set {how}, {tests_of_it} at a cost of {}: u = {}", best.cost, percent(best.u));
    for (place, count) in &best.chosen {
        let _ = writeln!(text, "  {count} × {}", tests[*place].name);
    }
    if let Some(repeats) = answer.repeats {
        let _ = writeln!(text, "the single best as many times: u = {}", percent(Some(repeats)));
    }
    let _ = writeln!(text, "\nwhat the set would find:\n{}", best.text);
    let _ = writeln!(text, "what each test of it tells that the others do not:");
    for (place, told) in &best.told {
        let _ = writeln!(text, "  {}: {told}", tests[*place].name);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXAMPLE: &str = include_str!("../../../../examples/designs/berger.toml");

    #[test]
    fn the_example_is_chosen() {
        let answer = answer(Wanted::of_toml(EXAMPLE).unwrap()).unwrap();
        // Three ring-downs that differ tell three times as much as three at 16 mm and 14 N, and as three of the best.
        let at = |name: &str| answer.tests.iter().find(|test| test.name == name).unwrap().u.unwrap();
        let repeated = at("release 0.016 m, normal load 14 N") / 3f64.sqrt();
        assert!((repeated - 0.0273).abs() < 2e-4 && answer.best.u.unwrap() < 0.0081, "{repeated} {:?}", answer.best.u);
        assert!(answer.repeats.unwrap() > answer.best.u.unwrap() && answer.best.cost == 15.0);
        let text = text(&answer);
        for part in ["the best set of all sets, 3 tests", "what each test of it tells", "without it, u of", "μ₀"] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        let json = serde_json::to_value(&answer).unwrap();
        assert_eq!(json["tests"].as_array().unwrap().len(), 9);
        assert!(json["best"]["findings"]["mu"]["u"].as_f64().unwrap() > 0.0);
        let (_, drawn) = figures::picture(&answer).unwrap();
        assert!(drawn.contains("release") && drawn.contains("normal load"));
    }

    /// A budget, other kinds of tests, and a choice that is good over what is guessed.
    #[test]
    fn kinds_budgets_and_robust_choices_are_read() {
        let file = "[machine]\nmass = { value = 10.391, u = 0.05 }\nfrequency = 2.198\nnormal_load = 14\n\
                    [guess]\nlaw = \"coulomb_static\"\nvalues = { mu = 0.25, static_coefficient = 0.3 }\nwithin = 0.1\n\
                    [sensor]\nquantity = \"velocity\"\nnoise = 1e-4\n\
                    [[candidates]]\nrelease = [0.016, 0.022]\nadded_mass = [0, 2]\nrate = 500\nduration = 2\n\
                    [[candidates]]\nforce = [6, 12]\nfrequency = 0.5\nrate = 500\nduration = 4\ncost = 4\n\
                    [[candidates]]\nblow = 400\npulse = 0.02\nrate = 500\nduration = 2\ncost = 2\n\
                    [[candidates]]\nbase = 0.6\nfrequency = 0.5\nrate = 500\nduration = 4\n\
                    sensor = { quantity = \"displacement\", noise = 1e-5 }\n\
                    [choose]\naim = \"static_mu\"\nbudget = 6\nrobust = \"worst\"\ndraws = 3\n";
        let answer = answer(Wanted::of_toml(file).unwrap()).unwrap();
        assert_eq!(answer.tests.len(), 8);
        assert!(answer.best.cost <= 6.0 && answer.best.u.is_some(), "{:?}", answer.best.chosen);
        assert!(answer.tests[0].u.is_none() && text(&answer).contains("not determined"));
        assert!(answer.tests[0].told.contains("static_excess_friction_per_mass has no influence"));
    }

    /// Friction at a speed without a law: the set tells more than any of its tests.
    #[test]
    fn friction_at_a_speed_is_an_aim() {
        let plan = |speed: &str| {
            let file = EXAMPLE.replace("normal_load = [3.5, 7, 14]", "");
            Wanted::of_toml(&file.replace("aim = \"mu\"", &format!("aim = {{ friction_at = {speed} }}"))).unwrap()
        };
        let slow = answer(plan("0.002")).unwrap();
        let curve = slow.best.friction_curve.as_ref().unwrap();
        assert_eq!((curve.unit(), slow.tests.len()), ("1", 3));
        let friction = slow.best.friction.as_ref().unwrap();
        // μ₀ + μ₁ exp(−α v) of the guess.
        let guessed = 0.228 + 0.261 * f64::exp(-2.852 * 0.002);
        assert!((friction.value() - guessed).abs() < friction.uncertainty(), "{friction} {guessed}");
        let relative = friction.uncertainty() / friction.value();
        assert!((relative / slow.best.u.unwrap() - 1.0).abs() < 0.02, "{relative} {:?}", slow.best.u);
        assert!(slow.tests.iter().all(|test| test.friction.as_ref().unwrap().uncertainty() > friction.uncertainty()));
        let text = text(&slow);
        for part in
            ["u of friction at 0.002 m/s, relative", "  friction at 0.002 m/s = 0.487", "without it, u of friction"]
        {
            assert!(text.contains(part), "{part}\n{text}");
        }
        assert_eq!(answer(plan("0")).unwrap().aim, "friction at rest");
        let fast = answer(plan("0.4")).err().unwrap().to_string();
        assert!(fast.contains("highest speed of all tests") && fast.contains("larger release"), "{fast}");
    }

    #[test]
    fn what_is_wrong_in_a_file_is_named() {
        for (wrong, right, part) in [
            ("mass = { value = 10.391, u = 0.005 }", "", "needs two of mass, stiffness and frequency"),
            ("stiffness = 1982", "stiffness = { value = 1982, u = 1 }", "leave out its u"),
            ("u = 0.005", "u = -0.005", "standard uncertainty"),
            ("alpha = 2.852", "", "lack decay"),
            ("alpha = 2.852", "alpha = 2.852, damping = 1", "no term with a value called \"damping\""),
            ("\"berger\"", "\"burger\"", "no law called \"burger\""),
            ("\"velocity\"", "\"force\"", "no sensor of \"force\""),
            ("noise = 1e-4", "noise = 0", "noise of a planned sensor"),
            ("release = [0.008, 0.016, 0.022]", "", "needs one of release, blow, force and base"),
            ("release =", "blow =", "with a blow needs pulse"),
            ("release =", "force =", "with a force needs frequency"),
            ("[3.5, 7, 14]", "[]", "a list without a number"),
            ("[3.5, 7, 14]", "[-3]", "normal load of a test"),
            ("duration = 2 ", "duration = 1e-3 ", "samples of a test"),
            ("cost = 5", "cost = 0", "cost of a test"),
            ("cost = 5", "price = 5", "price"),
            ("aim = \"mu\"", "aim = \"my\"", "\"my\""),
            (
                "aim = \"mu\"",
                "aim = { friction_at = 0.002 }",
                "release 0.008 m, normal load 3.5 N: friction over speed",
            ),
            ("aim = \"mu\"", "aim = { friction = 0.002 }", "{ friction_at = … } with a speed in m/s"),
            ("tests = 3", "", "tests, their number, or budget"),
            (
                "law = \"berger\"\nvalues = { ",
                "law = \"berger + quadratic\"\nvalues = { quadratic_damping = 1, quadratic_damping_per_mass = 1, ",
                "quadratic_damping_per_mass is given twice",
            ),
            ("tests = 3", "tests = 0", "1 to 1000 measurements, not 0"),
            ("tests = 3", "tests = 1000000000", "1 to 1000 measurements, not 1000000000"),
            (
                "tests = 3",
                "budget = nan",
                "the budget must be 5 to 5000, which pays for 1 to 1000 of the cheapest measurement, not NaN",
            ),
            ("mu0 = 0.228", "mu0 = -1", "the guess of coefficient must be at least 0, not -1"),
            ("mu0 = 0.228", "mu0 = 0.228, coefficient = 0.9", "its parameter coefficient twice, once as \"mu0\""),
            ("[sensor]", "within = 0\n[sensor]", "must be positive and finite, not 0"),
            ("noise = 1e-4", "noise = 1e-300", "must be 1e-100 or more, not 1e-300"),
            ("release =", "pulse = 0.01\nrelease =", "with a release takes no pulse, which belongs to blow"),
            ("release =", "frequency = 1\nrelease =", "takes no frequency, which belongs to force and base"),
            ("release =", "frequency = 1\npulse = 0.01\nforce =", "with a force takes no pulse"),
            ("release =", "contact = false\nrelease =", "takes no normal_load"),
            ("release =", "frequency = 500\nforce =", "a force of 500 Hz cannot be seen at the rate of 1000 Hz"),
            ("release =", "frequency = 0\nbase =", "frequency of a sine must be positive"),
            ("tests = 3", "tests = 3\nrobust = \"mean\"", "needs within"),
            ("tests = 3", "tests = 3\ndraws = 0", "draws must be 1 to 1000"),
        ] {
            let file = EXAMPLE.replacen(wrong, right, 1);
            assert_ne!(file, EXAMPLE, "{wrong}");
            let error = Wanted::of_toml(&file).and_then(answer).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(part), "{right}: {error}");
        }
    }
}
