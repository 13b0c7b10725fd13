//! Pages: one file of HTML that needs no network, for a screen of any width, light or dark, and for paper.

use fmm_model::Rounded;

const STYLE: &str = include_str!("style.css");

/// The page with this `title` (text) and `body` (HTML).
///
/// ```
/// use fmm_cli::page::{page, table, text_cell};
///
/// let rows = [vec![text_cell("friction"), text_cell("0.0299 ± 0.0018")]];
/// let html = page("Fork & wheel", &table("findings", &["quantity", "value"], rows));
/// assert!(html.contains("<title>Fork &amp; wheel</title>") && !html.contains("http"));
/// ```
pub fn page(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n",
        escaped(title)
    )
}

/// Rows of cells that are HTML already, under headings that are text.
pub fn table(class: &str, headings: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let head = headings.iter().map(|heading| format!("<th scope=\"col\">{}</th>", escaped(heading)));
    let body = rows.into_iter().map(|cells| format!("<tr>{}</tr>\n", cells.concat()));
    let [head, body] = [head.collect::<Vec<_>>(), body.collect()].map(|parts| parts.concat());
    // The table may be wider than a small screen, the page not.
    format!(
        "<div class=\"wide\"><table \
         class=\"{class}\">\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table></div>\n"
    )
}

/// A cell of HTML.
pub fn cell(html: &str) -> String {
    format!("<td>{html}</td>")
}

/// A cell with text, kept on one line if it is a number.
pub fn text_cell(text: &str) -> String {
    let class = if is_number(text) { " class=\"number\"" } else { "" };
    format!("<td{class}>{}</td>", escaped(text))
}

/// A cell with text, or a dash without any.
pub(crate) fn optional_cell(text: Option<String>) -> String {
    text_cell(&text.unwrap_or_else(|| "–".to_owned()))
}

/// The cell with the name of a row.
pub(crate) fn row_heading(name: &str) -> String {
    format!("<th scope=\"row\">{}</th>", escaped(name))
}

/// Texts as a list of bullets, and nothing without any.
pub(crate) fn bullets(texts: impl IntoIterator<Item = String>) -> String {
    let items = texts.into_iter().map(|text| format!("<li>{}</li>\n", marked(&text))).collect::<Vec<_>>().concat();
    if items.is_empty() { items } else { format!("<ul>\n{items}</ul>\n") }
}

/// Texts as paragraphs.
pub(crate) fn paragraphs(texts: impl IntoIterator<Item = String>) -> String {
    texts.into_iter().map(|text| format!("<p>{}</p>\n", marked(&text))).collect::<Vec<_>>().concat()
}

/// A part of a page under a heading.
pub(crate) fn section(title: &str, html: &str) -> String {
    format!("<section><h2>{}</h2>\n{html}</section>\n", escaped(title))
}

/// True if the text is a number, perhaps with a sign, a tolerance or a per cent sign, or stands for none.
fn is_number(text: &str) -> bool {
    let first = text.trim_start_matches("< ").split([' ', '±', '%']).next().unwrap_or_default();
    matches!(text, "–" | "") || first.replace('−', "-").parse::<f64>().is_ok()
}

/// A picture (SVG) with its caption (text); `id` must be unique within the page.
pub fn figure(svg: &str, caption: &str, id: &str) -> String {
    let label = format!("{id}-caption");
    format!(
        "<figure id=\"{id}\">{}\n<figcaption id=\"{label}\">{}</figcaption></figure>\n",
        inline(svg, id, &label),
        escaped(caption)
    )
}

/// The drawing for use inside HTML: without a prolog, scaling with the page, labelled by the element with the id
/// `label`, and with its ids and the references to them prefixed by `prefix`, so that several pictures can share a
/// page.
///
/// Ids occur as `id="…"`, and are referred to as `url(#…)` or `href="#…"`.
fn inline(svg: &str, prefix: &str, label: &str) -> String {
    let start = svg.find("<svg").unwrap_or(0);
    let body = svg[start..]
        .replace(" id=\"", &format!(" id=\"{prefix}-"))
        .replace("url(#", &format!("url(#{prefix}-"))
        .replace("href=\"#", &format!("href=\"#{prefix}-"))
        // HTML knows the name of the language by itself.
        .replace(" xmlns=\"http://www.w3.org/2000/svg\"", "");
    let opening = body.split('>').next().unwrap_or_default();
    // Without a view box a picture that is made narrower is cut off instead.
    let view_box = match (attribute(opening, "width"), attribute(opening, "height")) {
        (Some(width), Some(height)) if attribute(opening, "viewBox").is_none() => {
            format!(" viewBox=\"0 0 {width} {height}\"")
        }
        _ => String::new(),
    };
    body.replacen("<svg", &format!("<svg role=\"img\" aria-labelledby=\"{label}\"{view_box}"), 1)
}

/// The value of an attribute in an opening tag.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    tag.split(&format!(" {name}=\"")).nth(1)?.split('"').next()
}

/// `text` with the characters that mean something to HTML written as entities.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            character => escaped.push(character),
        }
    }
    escaped
}

/// The same, with what stands between backquotes as code.
pub fn marked(text: &str) -> String {
    let parts = text.split('`').enumerate();
    // An odd number of backquotes leaves the last one as it is.
    let pairs = text.matches('`').count() / 2 * 2;
    parts.fold(String::new(), |mut html, (i, part)| {
        if i > 0 {
            html.push_str(if i > pairs {
                "`"
            } else if i % 2 == 1 {
                "<code>"
            } else {
                "</code>"
            });
        }
        html + &escaped(part)
    })
}

/// An interval to the digits of `rounded`; a side without an end is open, and an interval without either is `open`.
pub(crate) fn interval(rounded: &Rounded, ends: (Option<f64>, Option<f64>), open: &str) -> String {
    match ends {
        (Some(low), Some(high)) => rounded.interval(low, high),
        (Some(low), None) => format!("above {}", Rounded::new(low, None)),
        (None, Some(high)) => format!("below {}", Rounded::new(high, None)),
        (None, None) => open.to_owned(),
    }
}

/// The name of a quantity as words, without the unit at its end, which stands beside it.
pub(crate) fn words(name: &str) -> String {
    name.strip_suffix("_hz").unwrap_or(name).replace('_', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_told_from_words() {
        for number in ["1.5", "−0.00023763", "552 ± 1.2", "+5.2 %", "6.75123e−5", "–"] {
            assert!(is_number(number), "{number}");
        }
        for words in ["six", "inferred: steel", "≤ 5.0", "length / mm", "3, 5, 7"] {
            assert!(!is_number(words), "{words}");
        }
    }

    #[test]
    fn ids_of_two_pictures_differ() {
        let svg = concat!(
            r##"<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" width="90" height="50"><clipPath id="c0"/>"##,
            r##"<g clip-path="url(#c0)"/><use href="#c0"/></svg>"##
        );
        let expected = concat!(
            r##"<svg role="img" aria-labelledby="one" viewBox="0 0 90 50" width="90" height="50"><clipPath id="f-1-c0"/>"##,
            r##"<g clip-path="url(#f-1-c0)"/><use href="#f-1-c0"/></svg>"##
        );
        assert_eq!(inline(svg, "f-1", "one"), expected);
        // A view box that is there stays.
        assert_eq!(inline(expected, "g", "two").matches("viewBox").count(), 1);
    }

    #[test]
    fn names_are_words() {
        assert_eq!(words("natural_frequency_hz"), "natural frequency");
        assert_eq!(words("friction_per_mass"), "friction per mass");
    }

    #[test]
    fn nothing_gets_through() {
        assert_eq!(escaped("<script>\"a\" & 'b'"), "&lt;script&gt;&quot;a&quot; &amp; &#39;b&#39;");
        assert_eq!(marked("set `a<b` and `c`, then `"), "set <code>a&lt;b</code> and <code>c</code>, then `");
    }
}
