//! The lines of a file that is text, but for the points of some of its data sets.

/// Goes through the lines of a file, and can leave them for bytes.
pub(super) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    passed: u64,
    end: u8,
}

/// A line without its end.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    pub(super) text: &'a [u8],
    /// Its number, counted from 1.
    pub(super) number: u64,
    /// True if it has an end; the last line of a file that is cut off has none.
    pub(super) ended: bool,
    next: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        /// Latest end of the first line, if lines end as on most systems (bytes).
        const HEAD: usize = 4096;
        let head = &bytes[..bytes.len().min(HEAD)];
        let end = if head.contains(&b'\r') && !head.contains(&b'\n') { b'\r' } else { b'\n' };
        Self { bytes, at: 0, passed: 0, end }
    }

    /// The next line, which stays the next.
    pub(super) fn peek(&self) -> Option<Line<'a>> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|byte| *byte == self.end);
        let text = &rest[..length.unwrap_or(rest.len())];
        let text = text.strip_suffix(b"\r").unwrap_or(text);
        let next = self.at + length.map_or(rest.len(), |length| length + 1);
        Some(Line { text, number: self.passed + 1, ended: length.is_some(), next })
    }

    /// Goes past a line that was peeked at.
    pub(super) fn pass(&mut self, line: &Line) {
        self.at = line.next;
        self.passed = line.number;
    }

    pub(super) fn next(&mut self) -> Option<Line<'a>> {
        let line = self.peek()?;
        self.pass(&line);
        Some(line)
    }

    /// Everything behind the last line that was passed.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Passes the next `count` bytes.
    pub(super) fn skip(&mut self, count: usize) {
        self.passed += self.rest()[..count].split(|byte| *byte == self.end).skip(1).count() as u64;
        self.at += count;
    }
}

/// True for a line that begins or ends a data set: −1 in its first six columns.
pub(super) fn is_delimiter(line: &[u8]) -> bool {
    let text = line.trim_ascii_end();
    text.len() <= 6 && text.trim_ascii_start() == b"-1"
}

/// The delimiter in its six columns.
const DELIMITER: &[u8] = b"    -1";

/// Place of the delimiter that follows a block of bytes, if one does: at its start, or behind a line end or two,
/// which some programs put there. Bytes are no lines, so that its blanks must be there.
pub(super) fn delimiter_at(bytes: &[u8]) -> Option<usize> {
    const STRAY: usize = 4;
    /// A record of the format and a line end.
    const LINE: usize = 82;
    let stray = bytes.iter().take(STRAY).take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
    let rest = &bytes[stray..];
    let head = &rest[..rest.len().min(LINE)];
    let line = match head.iter().position(|byte| matches!(byte, b'\r' | b'\n')) {
        Some(length) => &head[..length],
        None if head.len() == rest.len() => head,
        None => return None,
    };
    (line.starts_with(DELIMITER) && is_delimiter(line)).then_some(stray)
}

/// Place in a block of bytes of the next delimiter that is followed by another one or by the end of the file.
pub(super) fn find_delimiter(bytes: &[u8]) -> Option<usize> {
    let mut at = 0;
    loop {
        at += bytes[at..].windows(DELIMITER.len()).position(|window| window == DELIMITER)?;
        let behind = &bytes[at + DELIMITER.len()..];
        let blank = behind.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let next = &behind[blank..];
        if next.is_empty() || (next.starts_with(b"-1") && behind[..blank].contains(&b'\n')) {
            return Some(at);
        }
        at += DELIMITER.len() + blank;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_all_systems_have_their_numbers() {
        for (text, lines) in [
            (&b"a\nb\n\nc"[..], &["a", "b", "", "c"][..]),
            (b"a\r\nb\r\n\r\nc\r\n", &["a", "b", "", "c"]),
            (b"a\rb\r\rc", &["a", "b", "", "c"]),
            (b"", &[]),
            (b"\n", &[""]),
        ] {
            let mut file = Lines::new(text);
            for (index, expected) in lines.iter().enumerate() {
                let line = file.next().unwrap();
                assert_eq!((line.text, line.number), (expected.as_bytes(), index as u64 + 1), "{text:?}");
            }
            assert!(file.next().is_none(), "{text:?}");
        }
        let mut file = Lines::new(b"a\n\n\x00b\nc");
        file.skip(4);
        let line = file.next().unwrap();
        assert_eq!((line.text, line.number), (&b"b"[..], 3));
        assert!(line.ended && !file.next().unwrap().ended);
    }

    #[test]
    fn delimiters_are_told_from_numbers() {
        for line in [&b"    -1"[..], b"-1", b"    -1   ", b" -1"] {
            assert!(is_delimiter(line), "{line:?}");
        }
        for line in [&b"        -1"[..], b"-1 58", b" -1.0", b"", b"    58", b"    1"] {
            assert!(!is_delimiter(line), "{line:?}");
        }
    }

    #[test]
    fn delimiters_are_found_behind_bytes() {
        let padded = [&b"    -1"[..], &[b' '; 74], b"\nx"].concat();
        for (bytes, at) in [
            (&b"    -1"[..], Some(0)),
            (b"\r\n    -1\r\n    -1", Some(2)),
            (b"\n    -1\n", Some(1)),
            (b"x    -1\n", None),
            (b"    -1x\n", None),
            (b"-1\n", None),
            (b"", None),
            (&padded, Some(0)),
        ] {
            assert_eq!(delimiter_at(bytes), at, "{bytes:?}");
        }
        assert_eq!(find_delimiter(b"x    -1 y    -1\n    -1\n"), Some(9));
        assert_eq!(find_delimiter(b"x    -1\n  \n"), Some(1));
        assert_eq!(find_delimiter(b"x    -1    -1\ny"), None);
        assert_eq!(find_delimiter(b"    -"), None);
    }
}
