//! Pictures inside a page.

/// The drawing for use inside HTML: without a prolog, scaling with the page, labelled by the element with the id
/// `label`, and with its ids and the references to them prefixed by `prefix`, so that several pictures can share a
/// page.
///
/// Ids occur as `id="…"`, and are referred to as `url(#…)` or `href="#…"`.
pub(super) fn inline(svg: &str, prefix: &str, label: &str) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
