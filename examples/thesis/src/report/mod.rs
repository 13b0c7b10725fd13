//! The whole thesis as one page and one document.

mod errata;
mod html;
mod page;
mod program;
mod versions;

pub use errata::{Erratum, errata};
pub use program::program;

use serde_json::{Value, json};

use crate::{Chapter, Target};

/// All chapters, computed.
#[derive(Debug)]
pub struct Report {
    /// In the order of the thesis.
    pub outcomes: Vec<Outcome>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// True if fewer repetitions were made.
    pub quick: bool,
}

/// Result of a chapter.
#[derive(Debug)]
pub struct Outcome {
    /// Name of its example, such as `chapter_4_flexure`.
    pub name: &'static str,
    /// How long it took (s).
    pub seconds: f64,
    /// The chapter, or why it could not be computed.
    pub result: Result<Chapter, String>,
}

impl Outcome {
    /// Its targets; none if it failed.
    pub fn targets(&self) -> &[Target] {
        self.result.as_ref().map_or(&[], |chapter| &chapter.targets)
    }

    /// True if it was computed and all its targets pass.
    pub fn passes(&self) -> bool {
        self.result.as_ref().is_ok_and(Chapter::passes)
    }
}

impl Report {
    /// All targets of all chapters.
    pub fn targets(&self) -> impl Iterator<Item = &Target> {
        self.outcomes.iter().flat_map(Outcome::targets)
    }

    /// True if every chapter was computed and every target passes.
    pub fn passes(&self) -> bool {
        self.outcomes.iter().all(Outcome::passes)
    }

    /// How long all chapters took (s).
    pub fn seconds(&self) -> f64 {
        self.outcomes.iter().map(|outcome| outcome.seconds).sum()
    }

    /// One self-contained HTML page with tables, figures, findings and errata.
    pub fn html(&self) -> String {
        page::page(self, &errata())
    }

    /// One object for each target, as [`Target::document`] makes it, with its `chapter`. A chapter that failed is one
    /// object that does not pass, with the reason as its note.
    pub fn json(&self) -> Value {
        let mut documents = Vec::new();
        for outcome in &self.outcomes {
            for target in outcome.targets() {
                let mut document = target.document();
                document["chapter"] = outcome.name.into();
                documents.push(document);
            }
            if let Err(reason) = &outcome.result {
                documents.push(json!({
                    "id": "", "quantity": "the whole chapter", "unit": "", "thesis": null, "ours": null, "criterion": "computed",
                    "reference": null, "tolerance": null, "pass": false, "kind": "", "note": reason, "chapter": outcome.name,
                }));
            }
        }
        documents.into()
    }
}

#[cfg(test)]
mod tests;
