//! The thesis' numbers beside ours: every target of a chapter and why its tolerance is what it is, and the errata.

mod chapter_4;
mod chapter_5;
mod chapter_6;
mod chapter_7;
mod chapter_8;
mod chapter_9;
mod errata;
mod guide;

use std::collections::BTreeSet;
use std::sync::OnceLock;

use fmm_thesis::{CHAPTERS, Chapter, Settings, Target};

/// The chapter of the example called `name` with few repetitions, computed once for all tests.
fn chapter(name: &str) -> &'static Chapter {
    static COMPUTED: [OnceLock<Chapter>; CHAPTERS.len()] = [const { OnceLock::new() }; CHAPTERS.len()];
    let index = CHAPTERS.iter().position(|(known, _)| *known == name).unwrap_or_else(|| panic!("no chapter {name}"));
    let compute = || CHAPTERS[index].1(&Settings::new().quick(true)).unwrap_or_else(|error| panic!("{name}: {error}"));
    COMPUTED[index].get_or_init(compute)
}

/// All targets pass; those with `ids` are there, and what is said of `errata`, and the `figures`.
fn assert_complete(chapter: &Chapter, ids: &[&str], errata: &[&str], figures: &[&str]) {
    for target in &chapter.targets {
        assert!(target.passes(), "{target:?}");
    }
    for id in ids {
        assert!(chapter.targets.iter().any(|target| target.id() == *id), "{id} is missing");
    }
    for erratum in errata {
        assert!(chapter.findings.iter().any(|finding| finding.errata.contains(erratum)), "{erratum} is missing");
    }
    let names: BTreeSet<_> = chapter.drawings.iter().map(|drawing| drawing.name).collect();
    assert_eq!(names, figures.iter().copied().collect());
}

/// Our value of the target with this `id` and `quantity`, or of the one whose quantity begins so.
fn found(chapter: &Chapter, id: &str, quantity: &str) -> Option<f64> {
    let targets: Vec<_> = chapter.targets.iter().map(Target::document).filter(|target| target["id"] == id).collect();
    let named = |whole: bool| {
        targets.iter().find(|target| {
            target["quantity"].as_str().is_some_and(|text| text == quantity || !whole && text.starts_with(quantity))
        })
    };
    named(true).or_else(|| named(false)).and_then(|target| target["ours"].as_f64())
}

fn ours(chapter: &Chapter, id: &str, quantity: &str) -> f64 {
    found(chapter, id, quantity).unwrap_or_else(|| panic!("no target {id}: {quantity}"))
}
