//! The errata: complete, and each shown by something that exists.

use std::collections::BTreeSet;
use std::path::Path;

use fmm_thesis::report::{Erratum, errata};
use fmm_thesis::{CHAPTERS, Target};

use super::chapter;

/// All targets there are: A1 to A19, B1 to B5, C1 to C16, and F1 to F3 of the future work.
fn all_targets() -> BTreeSet<String> {
    let letters = [('A', 19), ('B', 5), ('C', 16), ('F', 4)];
    letters.into_iter().flat_map(|(letter, count)| (1..=count).map(move |i| format!("{letter}{i}"))).collect()
}

#[test]
fn all_are_there_and_whole() {
    let errata = errata();
    let ids: Vec<&str> = errata.iter().map(|erratum| erratum.id.as_str()).collect();
    let expected: Vec<String> = (1..=34).map(|i| format!("E{i}")).collect();
    assert_eq!(ids, expected);
    for Erratum { id, title, printed, right, evidence, targets, tests } in &errata {
        assert!([title, printed, right, evidence].iter().all(|text| !text.is_empty()), "{id} lacks a part");
        assert!(!(targets.is_empty() && tests.is_empty()), "nothing shows {id}");
    }
}

#[test]
fn tests_that_show_them_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for erratum in errata() {
        for test in &erratum.tests {
            let (path, function) = test.split_once("::").unwrap_or_else(|| panic!("{}: {test}", erratum.id));
            let text = std::fs::read_to_string(root.join(path)).unwrap_or_else(|error| panic!("{path}: {error}"));
            assert!(text.contains(&format!("fn {function}() {{")), "{test} is not there");
        }
    }
}

/// All targets are there, and the errata that chapters speak of exist.
#[test]
fn targets_and_errata_know_each_other() {
    let chapters: Vec<_> = CHAPTERS.iter().map(|(name, _)| chapter(name)).collect();
    let present: BTreeSet<String> =
        chapters.iter().flat_map(|chapter| chapter.targets.iter().map(Target::id)).map(str::to_owned).collect();
    let all = all_targets();
    assert_eq!(present, all);
    let errata = errata();
    for erratum in &errata {
        for id in &erratum.targets {
            assert!(all.contains(id), "{}: there is no target {id}", erratum.id);
        }
    }
    for finding in chapters.iter().flat_map(|chapter| &chapter.findings) {
        for id in &finding.errata {
            assert!(errata.iter().any(|erratum| erratum.id == *id), "{}: there is no {id}", finding.statement);
        }
    }
}
