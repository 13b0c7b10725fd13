//! Crates: who uses whom, by the guide and by cargo.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use serde_json::Value;

/// Third-party crates that each crate takes when nobody asks for a feature, and for what.
const THIRD_PARTY: &[(&str, &[(&str, &str)])] = &[
    ("fmm-model", &[]),
    ("fmm-record", &[("flate2", "inflates MATLAB files up to a limit"), REALFFT, THISERROR]),
    ("fmm-friction", &[]),
    (
        "fmm-fit",
        &[
            ("argmin", "the solver is one of argmin's, with its observers and checkpoints"),
            PULP,
            ("rand", "draws the starts of a search"),
            RAND_CHACHA,
            STATRS,
            THISERROR,
        ],
    ),
    (
        "fmm-uq",
        &[
            ("nalgebra", "eigenvalues of a matrix of correlations, Cholesky factors of covariances"),
            ("rand", "random numbers of the trials"),
            RAND_CHACHA,
            ("rand_distr", "normal, exponential, gamma and t variates"),
            STATRS,
            THISERROR,
        ],
    ),
    ("fmm-sim", &[THISERROR]),
    ("fmm-frf", &[PULP, THISERROR]),
    (
        "fmm-identify",
        &[
            ("nalgebra", "Cholesky factors and eigenvalues of the covariances of a friction curve"),
            RAND_CHACHA,
            ("rand_distr", "normal variates behind the band of a friction curve"),
            ("rayon", "takes derivatives, starts and laws of a fit on all threads"),
            ("strsim", "distance of two words, for the name that is meant"),
            THISERROR,
        ],
    ),
    (
        "fmm-cli",
        &[
            ("clap", "reads the arguments and explains them"),
            ("clap_complete", "writes the completions of shells"),
            ("clap_mangen", "writes the manual pages"),
            ("csv", "reads the list of a campaign and writes its table"),
            ("indicatif", "shows how far a search is"),
            ("kuva", "draws the figures"),
            RAND_CHACHA,
            ("rand_distr", "normal variates of the noise of a simulated record"),
            ("rayon", "identifies several records at a time"),
            ("serde", "writes motions and campaigns as documents"),
            ("sha2", "names the input of a report"),
            ("serde_json", "reads scenarios and writes documents"),
            THISERROR,
            ("toml", "reads measurements and campaigns"),
        ],
    ),
];

const PULP: (&str, &str) = ("pulp", "vectors as wide as the processor has, without unsafe code here");
const RAND_CHACHA: (&str, &str) = ("rand_chacha", "streams of the same bits on every machine");
const REALFFT: (&str, &str) = ("realfft", "Fourier transforms of any length");
const STATRS: (&str, &str) = ("statrs", "quantiles of normal, t, F and chi-square distributions");
const THISERROR: (&str, &str) = ("thiserror", "writes Display and Error of the error types");

/// A package of the workspace as `cargo metadata` describes it.
struct Package(Value);

impl Package {
    fn name(&self) -> &str {
        text(&self.0["name"])
    }

    /// An empty list of registries says that a package stays at home.
    fn is_published(&self) -> bool {
        self.0["publish"].is_null()
    }

    fn dependencies(&self) -> impl Iterator<Item = &Value> {
        list(&self.0["dependencies"]).iter()
    }

    /// Names of what it is built with, development left out.
    fn uses(&self) -> impl Iterator<Item = &Value> {
        self.dependencies().filter(|dependency| dependency["kind"] != "dev")
    }

    /// Optional dependencies that the feature `default` turns on, through however many other features.
    fn on_by_default(&self) -> BTreeSet<&str> {
        let (mut waiting, mut on) = (vec!["default"], BTreeSet::new());
        while let Some(feature) = waiting.pop() {
            for part in self.0["features"].get(feature).map_or(&[][..], list).iter().map(text) {
                match part.strip_prefix("dep:").or(part.split_once('/').map(|(dependency, _)| dependency)) {
                    Some(dependency) => drop(on.insert(dependency)),
                    None => waiting.push(part),
                }
            }
        }
        on
    }
}

/// One row of the guide's table of crates.
#[derive(Debug, PartialEq)]
struct Row {
    name: String,
    uses: BTreeSet<String>,
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("{value} is no text"))
}

fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("{value} is no list"))
}

fn packages() -> Vec<Package> {
    let arguments = ["metadata", "--no-deps", "--format-version", "1", "--offline"];
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    let run = Command::new(env!("CARGO")).args(arguments).args(["--manifest-path", manifest]).output().unwrap();
    assert!(run.status.success(), "cargo metadata: {}", String::from_utf8_lossy(&run.stderr));
    let metadata: Value = serde_json::from_slice(&run.stdout).unwrap();
    list(&metadata["packages"]).iter().cloned().map(Package).collect()
}

/// The guide's section on the crates.
fn section() -> &'static str {
    let (_, section) =
        include_str!("../../docs/guide.md").split_once("\n## Crates\n").expect("the guide has a section on the crates");
    section.split("\n## ").next().unwrap_or(section)
}

/// Everything between backquotes.
fn quoted(cell: &str) -> impl Iterator<Item = String> + '_ {
    cell.split('`').skip(1).step_by(2).map(str::to_owned)
}

/// The rows of a table whose first cell is a crate and whose last says what it uses.
fn table(section: &str) -> Vec<Row> {
    let cells = |line: &str| line.trim_matches('|').split('|').map(str::to_owned).collect::<Vec<_>>();
    let lines = section.lines().filter(|line| line.starts_with("| [`"));
    let mut rows: Vec<Row> = Vec::new();
    // From the last row up, so that the rows below one are known.
    for cells in lines.map(cells).collect::<Vec<_>>().into_iter().rev() {
        let (name, uses) = (quoted(&cells[0]).next().unwrap(), &cells[cells.len() - 1]);
        let named: BTreeSet<String> = quoted(uses).collect();
        let below = rows.iter().map(|row| row.name.clone());
        let uses = if uses.trim().starts_with("all below") {
            below.filter(|name| !named.contains(name)).collect()
        } else {
            named
        };
        rows.push(Row { name, uses });
    }
    rows.reverse();
    rows
}

#[test]
fn a_table_is_read_as_it_is_meant() {
    let text = "\
| crate | job | uses |
|---|---|---|
| [`a`](x) | `z` | all below but `c` |
| [`b`](x) | y | `c` |
| [`c`](x) | y | - |
";
    let row =
        |name: &str, uses: &[&str]| Row { name: name.into(), uses: uses.iter().map(ToString::to_string).collect() };
    assert_eq!(table(text), [row("a", &["b"]), row("b", &["c"]), row("c", &[])]);
}

#[test]
fn the_guide_says_who_uses_whom() {
    let packages = packages();
    let published: Vec<&Package> = packages.iter().filter(|package| package.is_published()).collect();
    let ours: BTreeSet<&str> = published.iter().map(|package| package.name()).collect();
    let rows = table(section());
    assert_eq!(rows.iter().map(|row| row.name.as_str()).collect::<BTreeSet<_>>(), ours, "crates in the table");
    for package in published {
        let uses: BTreeSet<&str> =
            package.uses().map(|used| text(&used["name"])).filter(|name| ours.contains(name)).collect();
        let row = rows.iter().find(|row| row.name == package.name()).unwrap();
        assert_eq!(row.uses.iter().map(String::as_str).collect::<BTreeSet<_>>(), uses, "{} uses", package.name());
    }
}

/// Down the table, tests and examples of a crate included: so there is no cycle, and the last row can be published
/// first.
#[test]
fn every_crate_uses_crates_below_it_only() {
    let packages = packages();
    let rows = table(section());
    let home: BTreeSet<&str> = packages.iter().map(Package::name).collect();
    let place = |name: &str| rows.iter().position(|row| row.name == name);
    for package in packages.iter().filter(|package| package.is_published()) {
        for used in package.dependencies().map(|used| text(&used["name"])).filter(|name| home.contains(name)) {
            assert!(place(used) > place(package.name()), "{} uses {used}, which is not below it", package.name());
        }
    }
}

/// A floor is as high as the longest way down.
#[test]
fn every_crate_is_on_its_floor() {
    let rows = table(section());
    let mut floors: BTreeMap<&str, usize> = BTreeMap::new();
    for row in rows.iter().rev() {
        let highest = row.uses.iter().map(|used| floors[used.as_str()] + 1).max();
        floors.insert(&row.name, highest.unwrap_or(0));
    }
    let mut drawn = BTreeMap::new();
    for line in section().lines().filter_map(|line| line.strip_prefix("floor ")) {
        let mut words = line.split_whitespace();
        let floor: usize = words.next().and_then(|floor| floor.parse().ok()).expect("a floor has a number");
        drawn.extend(words.map(|name| (name, floor)));
    }
    assert_eq!(drawn, floors);
}

#[test]
fn no_crate_takes_more_from_others_than_is_stated() {
    let packages = packages();
    let stated: BTreeMap<&str, BTreeSet<&str>> =
        THIRD_PARTY.iter().map(|(name, taken)| (*name, taken.iter().map(|(taken, _)| *taken).collect())).collect();
    let mut taken = BTreeMap::new();
    for package in packages.iter().filter(|package| package.is_published()) {
        let on = package.on_by_default();
        let is_on = |used: &&Value| used["optional"] == false || on.contains(text(&used["name"]));
        let others = package.uses().filter(is_on).filter(|used| used["path"].is_null());
        taken.insert(package.name(), others.map(|used| text(&used["name"])).collect::<BTreeSet<_>>());
    }
    assert_eq!(taken, stated);
}

/// Who cites a version, installs the wheel or reads what changed finds the same one.
#[test]
fn versions_are_in_step() {
    let version = env!("CARGO_PKG_VERSION");
    for (file, text, line) in [
        ("CITATION.cff", include_str!("../../CITATION.cff"), format!("version: {version}")),
        ("python/Cargo.toml", include_str!("../../python/Cargo.toml"), format!("version = \"{version}\"")),
        ("CHANGELOG.md", include_str!("../../CHANGELOG.md"), format!("## {version} - ")),
    ] {
        assert!(text.lines().any(|found| found.starts_with(&line)), "{file} has no line {line:?}");
    }
}
