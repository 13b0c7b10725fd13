//! The thesis' numbers beside ours: every target of a chapter and why its tolerance is what it is, and the errata.

mod chapter_4;
mod chapter_5;
mod chapter_6;
mod chapter_7;
mod errata;

use fmm_thesis::{Chapter, Target};

/// Our value of the target with this `id` and `quantity`, or of the one whose quantity begins so.
fn ours(chapter: &Chapter, id: &str, quantity: &str) -> f64 {
    let targets: Vec<_> = chapter.targets.iter().map(Target::document).filter(|target| target["id"] == id).collect();
    let named = |whole: bool| {
        targets.iter().find(|target| {
            target["quantity"].as_str().is_some_and(|text| text == quantity || !whole && text.starts_with(quantity))
        })
    };
    let found = named(true).or_else(|| named(false)).and_then(|target| target["ours"].as_f64());
    found.unwrap_or_else(|| panic!("no target {id}: {quantity}"))
}
