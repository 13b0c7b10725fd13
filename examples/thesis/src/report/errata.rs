//! The errata, read from `docs/errata.md`, which people read too.

const TEXT: &str = include_str!("../../../../docs/errata.md");

/// Something printed that is not right.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Erratum {
    /// Such as E25.
    pub id: String,
    /// Subject.
    pub title: String,
    /// Statement that the thesis prints.
    pub printed: String,
    /// Statement that is right.
    pub right: String,
    /// How one knows.
    pub evidence: String,
    /// Identifiers of the targets that show it, such as A13.
    pub targets: Vec<String>,
    /// Tests that show it, as `path::function`.
    pub tests: Vec<String>,
}

/// All errata in their order.
pub fn errata() -> Vec<Erratum> {
    parsed(TEXT)
}

/// One erratum for each heading `### E1. Title`, with the list items below it; lines that continue an item are
/// indented.
fn parsed(text: &str) -> Vec<Erratum> {
    let mut errata: Vec<Erratum> = Vec::new();
    for section in text.split("\n### ").skip(1) {
        // The heading of the next chapter ends the last erratum of this one.
        let section = section.split("\n## ").next().unwrap_or_default();
        let (heading, items) = section.split_once('\n').unwrap_or((section, ""));
        let (id, title) = heading.split_once(". ").unwrap_or((heading, ""));
        let mut erratum = Erratum { id: id.to_owned(), title: title.trim().to_owned(), ..Erratum::default() };
        for item in format!("\n{items}").split("\n- ").skip(1) {
            let item = item.split_whitespace().collect::<Vec<_>>().join(" ");
            match item.split_once(": ") {
                Some(("Printed", value)) => value.clone_into(&mut erratum.printed),
                Some(("Right", value)) => value.clone_into(&mut erratum.right),
                Some(("Evidence", value)) => value.clone_into(&mut erratum.evidence),
                Some(("Shown by", value)) => erratum.shown_by(value),
                _ => {}
            }
        }
        errata.push(erratum);
    }
    errata
}

impl Erratum {
    /// Sorts what shows it, comma-separated, into targets and tests, the latter between backquotes.
    fn shown_by(&mut self, list: &str) {
        for entry in list.split(", ") {
            match entry.strip_prefix('`').and_then(|entry| entry.strip_suffix('`')) {
                Some(test) => self.tests.push(test.to_owned()),
                None => self.targets.push(entry.to_owned()),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_are_read_with_their_continued_lines() {
        let text = "# Title\nintroduction\n## One\n\n### E1. First thing\n- Printed: a: b\n- Right: c\n  d\n- Evidence: e\n\
                    - Shown by: A1, `tests/x.rs::y`\n\n## Two\nwords\n### E2. Second\n- Printed: f\n";
        let errata = parsed(text);
        assert_eq!(errata.len(), 2);
        assert_eq!((errata[0].id.as_str(), errata[0].title.as_str()), ("E1", "First thing"));
        assert_eq!((errata[0].printed.as_str(), errata[0].right.as_str()), ("a: b", "c d"));
        assert_eq!(
            (errata[0].targets.as_slice(), errata[0].tests.as_slice()),
            (&["A1".to_owned()][..], &["tests/x.rs::y".to_owned()][..])
        );
        assert_eq!((errata[1].printed.as_str(), errata[1].right.as_str()), ("f", ""));
    }
}
