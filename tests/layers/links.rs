//! Links and paths of the pages: each leads to a file of the workspace, and a link to a heading that it has.

use std::path::{Component, Path, PathBuf};

use super::source::{files, root, text};

/// Folders with pages; those at the root are added.
const FOLDERS: [&str; 5] = ["crates", "docs", "examples", "python", ".ci"];

/// The targets of the links of a page: what stands in round brackets behind square ones, outside of code.
fn targets(page: &str) -> Vec<&str> {
    let mut is_code = false;
    let mut found = Vec::new();
    for line in page.lines() {
        is_code ^= line.trim_start().starts_with("```");
        if !is_code {
            let rests = line.split("](").skip(1);
            found.extend(rests.filter_map(|rest| rest.split_once(')').map(|(target, _)| target)));
        }
    }
    found
}

/// The anchor of a heading, as hosts of repositories make it.
fn anchor(heading: &str) -> String {
    let heading = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = heading.chars().filter(|letter| letter.is_alphanumeric() || matches!(letter, ' ' | '-' | '_'));
    kept.map(|letter| if letter == ' ' { '-' } else { letter }).collect()
}

/// `path` without steps up.
fn resolved(path: &Path) -> PathBuf {
    let mut resolved = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(resolved.pop()),
            Component::CurDir => {}
            part => resolved.push(part),
        }
    }
    resolved
}

/// Why the link to `target` on the page at this `path` leads nowhere.
fn fault(path: &Path, target: &str) -> Option<String> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (file, heading) = target.split_once('#').unwrap_or((target, ""));
    let folder = path.parent().unwrap_or(Path::new(""));
    let linked = if file.is_empty() { path.to_owned() } else { resolved(&folder.join(file)) };
    if !root().join(&linked).exists() {
        return Some(format!("{}: there is no {}", path.display(), linked.display()));
    }
    let is_page = linked.extension().is_some_and(|ending| ending == "md");
    let has_heading = || text(&linked).lines().any(|line| line.starts_with('#') && anchor(line) == heading);
    (is_page && !heading.is_empty() && !has_heading())
        .then(|| format!("{}: {} has no heading #{heading}", path.display(), linked.display()))
}

#[test]
fn every_link_leads_somewhere() {
    let at_root = std::fs::read_dir(root()).unwrap().map(|entry| PathBuf::from(entry.unwrap().file_name()));
    let mut pages: Vec<PathBuf> = at_root.filter(|path| path.extension().is_some_and(|own| own == "md")).collect();
    pages.extend(FOLDERS.iter().flat_map(|folder| files(folder, &["md"])));
    let (mut faults, mut count) = (Vec::new(), 0);
    for path in &pages {
        let page = text(path);
        let targets = targets(&page);
        count += targets.len();
        faults.extend(targets.into_iter().filter_map(|target| fault(path, target)));
    }
    assert!(count > 100, "{count} links on {} pages", pages.len());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The paths of the workspace between backquotes on a page, without those that stand for several.
fn named_paths(page: &str) -> impl Iterator<Item = &str> {
    let places = ["crates/", "docs/", "tests/", "examples/", "benches/", "fuzz/", ".ci/", ".github/"];
    let named = page.split("```").step_by(2).flat_map(|text| text.split('`').skip(1).step_by(2));
    named.filter(move |text| places.iter().any(|place| text.starts_with(place)) && !text.contains(['*', ' ', '{', '[']))
}

#[test]
fn every_path_that_a_page_names_is_there() {
    let mut pages: Vec<PathBuf> = ["ARCHITECTURE.md", "CONTRIBUTING.md", "README.md"].map(PathBuf::from).into();
    pages.extend(files("docs", &["md"]));
    let mut missing = Vec::new();
    for path in &pages {
        let page = text(path);
        let gone = named_paths(&page).filter(|named| !root().join(named.split([':', '#']).next().unwrap()).exists());
        missing.extend(gone.map(|named| format!("{}: there is no {named}", path.display())));
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
    assert_eq!(
        named_paths("`crates/a.rs`\n```\n`docs/b`\n```\n`tests/*.rs` `docs/c`").collect::<Vec<_>>(),
        ["crates/a.rs", "docs/c"]
    );
}

#[test]
fn links_that_lead_nowhere_are_told() {
    assert_eq!(targets("[a](b.md) and ![c](d.svg#e)\n```\n[f](g)\n```"), ["b.md", "d.svg#e"]);
    assert_eq!(anchor("## A record, of `your` own"), "a-record-of-your-own");
    let page = Path::new("docs/guide.md");
    assert_eq!(fault(page, "../README.md#use"), None);
    assert!(fault(page, "../README.md#misuse").is_some() && fault(page, "absent.md").is_some());
}
