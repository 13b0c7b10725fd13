//! Pages: one file of HTML that needs no network, for a screen of any width, light or dark, and for paper.

mod svg;
mod text;

pub(crate) use text::words;
pub use text::{escaped, marked};

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
        "<div class=\"wide\"><table class=\"{class}\">\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table></div>\n"
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

/// Whether the text is a number, perhaps with a sign, a tolerance or a per cent sign, or stands for none.
fn is_number(text: &str) -> bool {
    let first = text.split([' ', '±', '%']).next().unwrap_or_default();
    matches!(text, "–" | "") || first.replace('−', "-").parse::<f64>().is_ok()
}

/// A picture (SVG) with its caption (text); `id` must be unique within the page.
pub fn figure(svg: &str, caption: &str, id: &str) -> String {
    let label = format!("{id}-caption");
    format!(
        "<figure id=\"{id}\">{}\n<figcaption id=\"{label}\">{}</figcaption></figure>\n",
        svg::inline(svg, id, &label),
        escaped(caption)
    )
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
}
