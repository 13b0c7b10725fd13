use std::collections::BTreeSet;

use super::*;
use crate::{Criterion, Target};

const EVIL: &str = "<script>alert(\"1\")</script> & 'x'";

/// A chapter whose every text tries to get out of the page.
fn chapter(ours: f64) -> Chapter {
    let mut chapter = Chapter::new(EVIL);
    chapter.target(Target::new("A5", EVIL, "<b>", ours, Criterion::near(1.0, 0.1)).printed(EVIL).note(EVIL));
    chapter.target(Target::new("A5", "again", "m", 2.0, Criterion::Shown));
    chapter.table(EVIL, &[EVIL], vec![vec![EVIL.to_owned()]]);
    chapter.finding(EVIL, EVIL, &["E1"]);
    chapter.finding(EVIL, EVIL, &["E1"]);
    let svg = r#"<svg xmlns="http://www.w3.org/2000/svg"><clipPath id="clip0"/><g clip-path="url(#clip0)"/></svg>"#;
    for name in ["figure_1", "figure_1"] {
        chapter.drawings.push(crate::Drawing { name, caption: EVIL.to_owned(), svg: svg.to_owned() });
    }
    chapter
}

/// A chapter with its pictures as they are drawn.
fn real() -> Result<Chapter, String> {
    crate::chapter_4_flexure::chapter(&crate::Settings::new()).map_err(|error| error.to_string())
}

fn report(results: Vec<Result<Chapter, String>>) -> Report {
    let names = ["chapter_1", "chapter_2", "chapter_3"];
    let outcomes =
        results.into_iter().zip(names).map(|(result, name)| Outcome { name, seconds: 1.25, result }).collect();
    Report { outcomes, seed: 7, quick: true }
}

/// The values of an attribute, in order.
fn values<'a>(html: &'a str, attribute: &str) -> Vec<&'a str> {
    let start = format!(" {attribute}=\"");
    html.split(start.as_str()).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

#[test]
fn the_page_is_sealed_and_its_ids_are_unique() {
    let html = report(vec![Ok(chapter(1.0)), real(), Err(EVIL.to_owned())]).html();
    assert!(!html.contains("<script") && !html.contains("<b>,") && html.contains("&lt;script&gt;"));
    // Nothing is fetched: the namespace of SVG is the only address.
    assert!(!html.replace("http://www.w3.org/2000/svg", "").contains("http"));
    let ids = values(&html, "id");
    let unique: BTreeSet<_> = ids.iter().collect();
    assert_eq!(unique.len(), ids.len(), "{ids:?}");
    for label in values(&html, "aria-labelledby") {
        assert!(unique.contains(&label), "{label} is nowhere");
    }
    for link in values(&html, "href") {
        let target = link.strip_prefix('#').unwrap_or_else(|| panic!("{link} leads out of the page"));
        assert!(unique.contains(&target), "{link} leads nowhere");
    }
    for clip in values(&html, "clip-path") {
        let target = clip.trim_start_matches("url(#").trim_end_matches(')');
        assert!(unique.contains(&target), "{clip} leads nowhere");
    }
}

/// Every element that is opened is closed, in order.
#[test]
fn the_elements_nest() {
    let html = report(vec![Ok(chapter(1.0)), real(), Err(EVIL.to_owned())]).html();
    let mut open = Vec::new();
    for tag in html.split('<').skip(1).filter_map(|rest| rest.split('>').next()) {
        let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap_or_default();
        if tag.starts_with('!') || tag.ends_with('/') || name == "meta" {
            continue;
        }
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "in <{tag}>");
        } else {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

#[test]
fn verdicts_are_counted_and_failures_named() {
    let good = report(vec![Ok(chapter(1.0))]);
    assert!(good.passes() && good.html().contains("1 of 1 numbers meet their criterion."));
    let missed = report(vec![Ok(chapter(3.0)), Ok(chapter(1.0))]);
    assert!(!missed.passes());
    assert!(missed.html().contains("1 of 2 numbers meet their criterion. Missed: <a href=\"#A5\">A5</a>."));
    let failed = report(vec![Ok(chapter(1.0)), Err("no spring".to_owned())]);
    assert!(!failed.passes() && failed.html().contains("Not computed: no spring"));

    let json = failed.json();
    let documents = json.as_array().unwrap();
    assert_eq!(documents.len(), 3);
    assert_eq!((documents[0]["id"].as_str(), documents[0]["pass"].as_bool()), (Some("A5"), Some(true)));
    assert_eq!((documents[2]["note"].as_str(), documents[2]["pass"].as_bool()), (Some("no spring"), Some(false)));
    let keys = |value: &Value| value.as_object().unwrap().keys().cloned().collect::<BTreeSet<_>>();
    assert_eq!(keys(&documents[0]), keys(&documents[2]));
}

#[test]
fn errata_stand_beside_what_they_concern() {
    let html = report(vec![Ok(chapter(1.0))]).html();
    // E1 by the finding, E3 by the target A5, and both once more in the list.
    let (beside, listed) = html.split_once("<section id=\"errata\">").unwrap();
    assert_eq!(beside.matches("<a href=\"#E1\">E1</a> <b>Printed:</b>").count(), 1);
    assert!(beside.contains("<p class=\"erratum\"><a href=\"#E1\">E1</a></p>"));
    assert!(beside.contains("<a href=\"#E3\">E3</a> <b>Printed:</b>") && !beside.contains("E25"));
    assert_eq!(values(listed, "id").iter().filter(|id| id.starts_with('E')).count(), errata().len());
}
