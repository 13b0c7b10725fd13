//! Text that is safe inside HTML.

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

/// The name of a quantity as words, without the unit at its end, which stands beside it.
pub(crate) fn words(name: &str) -> String {
    name.strip_suffix("_hz").unwrap_or(name).replace('_', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

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
