//! Points of a data set, as text and as bytes.

use super::ByteOrder;
use super::lines::{Line, Lines, delimiter_at, find_delimiter, is_delimiter};
use super::records::{Form, Numbers, shown, wrong_header};
use crate::error::RecordError;

/// Numbers of the points up to the delimiter or the end of the file; `begin` is the line at which the data set begins.
pub(super) fn text(
    lines: &mut Lines,
    form: &Form,
    begin: u64,
    warnings: &mut Vec<String>,
) -> Result<Vec<f64>, RecordError> {
    let mut found = Vec::new();
    let needed = form.count.saturating_mul(form.numbers() as u64);
    let (mut closed, mut more) = (false, false);
    while let Some(line) = lines.peek() {
        if is_delimiter(line.text) {
            closed = true;
            break;
        }
        lines.pass(&line);
        let mut numbers = Numbers::new(line.text);
        while let Some(number) = numbers.next() {
            if found.len() as u64 == needed {
                more = true;
                break;
            }
            let cut_off = !line.ended && numbers.at_end();
            match number {
                _ if cut_off => break,
                Ok(number) => found.push(number),
                Err(text) => {
                    let (line, text) = (line.number, shown(text));
                    return Err(RecordError::on_line(line, format!("line {line}: \"{text}\" is not a number")));
                }
            }
        }
    }
    if more {
        warnings.push(more_points(begin, form.count));
    }
    if !closed {
        warnings.push(not_closed(begin));
    }
    Ok(found)
}

/// The order of bytes and their number, 0 if it is not stated, by the first line of a binary data set: `58b`, order of
/// bytes, format of numbers, number of lines in the header, number of bytes.
pub(super) fn encoding(line: &Line) -> Result<(ByteOrder, u64), RecordError> {
    let text = shown(line.text);
    let mut words = text.split_whitespace().skip(1).map(str::parse::<u64>);
    let mut next = || words.next().and_then(Result::ok);
    let order = match next() {
        Some(1) => ByteOrder::Little,
        Some(2) => ByteOrder::Big,
        _ => {
            let what = "the order of bytes must be 1 (little end first) or 2 (big end first)";
            return Err(wrong_header(line.number, what, &text));
        }
    };
    let format = next().unwrap_or_default();
    if !matches!(format, 0 | 2) {
        let line = line.number;
        return Err(RecordError::unsupported(format!(
            "line {line}: binary numbers of format {format} (1: VMS, 3: IBM) are not supported, only IEEE 754 (2)"
        )));
    }
    let stated = words.nth(1).and_then(Result::ok).unwrap_or_default();
    Ok((order, stated))
}

/// Number of bytes of the numbers of a point.
#[derive(Clone, Copy)]
struct Layout {
    abscissa: usize,
    ordinate: usize,
    parts: usize,
}

impl Layout {
    /// The layouts in use. By the format an uneven abscissa is single; some programs write it as double beside double
    /// ordinates.
    fn all(form: &Form) -> Vec<Self> {
        let parts = 1 + usize::from(form.complex);
        let layout = |abscissa, ordinate| Self { abscissa, ordinate, parts };
        match (form.even.is_some(), form.is_double) {
            (true, false) => vec![layout(0, 4)],
            (true, true) => vec![layout(0, 8)],
            (false, false) => vec![layout(4, 4)],
            (false, true) => vec![layout(4, 8), layout(8, 8)],
        }
    }

    fn point(self) -> usize {
        self.abscissa + self.ordinate * self.parts
    }

    /// Number of bytes of `count` points; `None` if no memory has as many.
    fn bytes(self, count: u64) -> Option<usize> {
        usize::try_from(count).ok()?.checked_mul(self.point())
    }

    /// The numbers of all points that are complete in `bytes`.
    fn numbers(self, bytes: &[u8], order: ByteOrder) -> impl Iterator<Item = f64> {
        bytes.chunks_exact(self.point()).flat_map(move |point| {
            let (abscissa, ordinate) = point.split_at(self.abscissa);
            let abscissa = (!abscissa.is_empty()).then(|| number(abscissa, order));
            abscissa.into_iter().chain(ordinate.chunks_exact(self.ordinate).map(move |part| number(part, order)))
        })
    }

    /// True if the abscissae in `bytes` increase.
    fn increases(self, bytes: &[u8], order: ByteOrder) -> bool {
        let mut abscissae = bytes.chunks_exact(self.point()).map(|point| number(&point[..self.abscissa], order));
        abscissae.try_fold(f64::NEG_INFINITY, |last, next| (next > last).then_some(next)).is_some()
    }
}

/// The number in four or eight bytes.
fn number(bytes: &[u8], order: ByteOrder) -> f64 {
    let word = order.unsigned(bytes);
    if bytes.len() == 4 { f64::from(f32::from_bits(word as u32)) } else { f64::from_bits(word) }
}

/// Numbers of the points up to the delimiter or the end of the file; `begin` is the line at which the data set begins.
///
/// A delimiter within the points cannot be told from one behind them, so that the number of points and their type
/// say where they end. Only where no delimiter follows there is one looked for.
pub(super) fn binary(
    lines: &mut Lines,
    form: &Form,
    (order, stated): (ByteOrder, u64),
    begin: u64,
    warnings: &mut Vec<String>,
) -> Result<Vec<f64>, RecordError> {
    let bytes = lines.rest();
    let layouts = Layout::all(form);
    let closed = layouts.iter().find_map(|layout| {
        let end = layout.bytes(form.count)?;
        Some((*layout, end, end + delimiter_at(bytes.get(end..)?)?))
    });
    let (layout, end, next) = if let Some(found) = closed {
        found
    } else {
        let delimiter = find_delimiter(bytes);
        let block = &bytes[..delimiter.unwrap_or(bytes.len())];
        let kept = |layout: &Layout| layout.bytes(form.count).map_or(block.len(), |end| end.min(block.len()));
        let plausible = |layout: &&Layout| layouts.len() == 1 || layout.increases(&block[..kept(layout)], order);
        let layout = layouts.iter().find(plausible).ok_or_else(|| {
            let what = format!(
                "the binary data set at line {begin} ends neither as if its abscissae were single nor as if they were \
                 double numbers, and they increase neither way"
            );
            RecordError::on_line(begin, what)
        })?;
        if delimiter.is_none() {
            warnings.push(not_closed(begin));
        } else if kept(layout) < block.len() {
            warnings.push(more_points(begin, form.count));
        }
        (*layout, kept(layout), block.len())
    };
    let points = end / layout.point();
    let actual = (points * layout.point()) as u64;
    if points as u64 == form.count && stated != 0 && stated != actual {
        warnings.push(format!("the data set at line {begin} states {stated} bytes, but its points have {actual}"));
    }
    lines.skip(next);
    Ok(layout.numbers(&bytes[..end], order).collect())
}

/// Points follow those that the header promises. They were not read.
fn more_points(line: u64, promised: u64) -> String {
    format!("the data set at line {line} promises {promised} points, but more are there")
}

/// The file ends without the line that closes the data set. A number at the very end was not read, as it may be cut
/// off.
fn not_closed(line: u64) -> String {
    format!("the file ends before the data set at line {line} does")
}
