//! Names that a crate gives out: each is used by somebody else.

use std::collections::BTreeSet;

use super::source::{crates, files, first_names, root, text, words};

/// Names that nobody else names; the list only shrinks.
const UNUSED: &[&str] = &[
    "fmm_identify::ImpactSummary",
    "fmm_identify::PredictiveCheck",
    "fmm_identify::RecordSummary",
    "fmm_uq::Evaluation",
    "fmm_uq::Failure",
    "fmm_uq::FailureKind",
    "fmm_uq::Failures",
    "fmm_uq::Region",
    "fmm_uq::SecondOrder",
];

/// Folders of those who use the crates beside other crates.
const USERS: [&str; 5] = ["examples", "benches", "tests", ".ci/downstream", "fuzz"];

/// The names that a file gives out.
fn given_out(path: &str) -> BTreeSet<String> {
    let text = text(path.as_ref());
    let text: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    let mut names = BTreeSet::new();
    for statement in text.split("pub use ").skip(1) {
        let statement = statement.split(';').next().unwrap();
        let list = statement.rsplit_once('{').map_or(statement, |(_, list)| list).trim_end_matches('}');
        for item in list.split(',') {
            // The name after `as`, or the last one of the path.
            names.extend(words(item).last().filter(|name| *name != "self").map(str::to_owned));
        }
    }
    names.extend(first_names(&text, "pub mod ").into_iter().map(str::to_owned));
    names
}

/// The names that a crate gives out: those of `lib.rs`, and those of the folders that are public modules.
fn exported(name: &str) -> BTreeSet<String> {
    let source = format!("crates/{name}/src");
    let mut names = given_out(&format!("{source}/lib.rs"));
    for module in names.clone() {
        let file = format!("{source}/{module}/mod.rs");
        if root().join(&file).exists() {
            names.extend(given_out(&file));
        }
    }
    names
}

/// The code blocks of the documentation of a crate.
fn doc_examples(name: &str) -> String {
    let mut blocks = String::new();
    let mut add = |text: &str, prefixes: &[&str]| {
        let mut is_inside = false;
        for line in text.lines() {
            let line = line.trim_start();
            let Some(line) = prefixes.iter().find_map(|prefix| line.strip_prefix(prefix)) else { continue };
            if line.trim_start().starts_with("```") {
                is_inside = !is_inside;
            } else if is_inside {
                blocks.push_str(line);
                blocks.push('\n');
            }
        }
    };
    for path in files(&format!("crates/{name}/src"), &["rs"]) {
        add(&text(&path), &["///", "//!"]);
    }
    add(&text(format!("crates/{name}/README.md").as_ref()), &[""]);
    blocks
}

#[test]
fn every_exported_name_is_used() {
    let crates = crates();
    let mut texts: Vec<(String, String)> = Vec::new();
    for folder in USERS.iter().map(ToString::to_string).chain(crates.iter().map(|name| format!("crates/{name}"))) {
        let files = files(&folder, &["rs"]).into_iter();
        let files = files.filter(|path| !path.starts_with("tests/layers"));
        texts.extend(files.map(|path| (path.to_str().unwrap().to_owned(), text(&path))));
    }
    texts.push(("README.md".to_owned(), text("README.md".as_ref())));
    let texts: Vec<(&str, BTreeSet<&str>)> =
        texts.iter().map(|(path, text)| (path.as_str(), words(text).collect())).collect();
    let mut unused = BTreeSet::new();
    for name in &crates {
        let (examples, own, ident) = (doc_examples(name), format!("crates/{name}/"), name.replace('-', "_"));
        let examples: BTreeSet<&str> = words(&examples).collect();
        let users = || texts.iter().filter(|(path, words)| !path.starts_with(&own) && words.contains(ident.as_str()));
        for exported in exported(name) {
            let is_used =
                examples.contains(exported.as_str()) || users().any(|user| user.1.contains(exported.as_str()));
            if !is_used {
                unused.insert(format!("{ident}::{exported}"));
            }
        }
    }
    let unused: BTreeSet<&str> = unused.iter().map(String::as_str).collect();
    let known: BTreeSet<&str> = UNUSED.iter().copied().collect();
    let new: Vec<_> = unused.difference(&known).collect();
    assert!(new.is_empty(), "nobody names {new:?}: make them private, or show them in an example");
    let gone: Vec<_> = known.difference(&unused).collect();
    assert!(gone.is_empty(), "{gone:?} are used or gone: take them out of UNUSED");
    assert!(UNUSED.is_sorted(), "UNUSED is not in order");
}
