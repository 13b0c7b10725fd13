//! Points as text.

use super::Warning;
use super::lines::{Lines, is_delimiter};
use super::number::Numbers;
use super::points::Points;
use super::records::{Form, shown};
use crate::RecordError;

/// Reads points up to the delimiter or the end of the file; `begin` is the line at which the data set begins.
pub(super) fn read(
    lines: &mut Lines,
    form: &Form,
    begin: u64,
    warnings: &mut Vec<Warning>,
) -> Result<Points, RecordError> {
    let mut points = Points::new(form);
    let needed = form.count.saturating_mul(form.numbers() as u64);
    let mut taken = 0;
    let (mut closed, mut more) = (false, false);
    while let Some(line) = lines.peek() {
        if is_delimiter(line.text) {
            closed = true;
            break;
        }
        lines.pass(&line);
        let mut numbers = Numbers::new(line.text);
        while let Some(number) = numbers.next() {
            if taken == needed {
                more = true;
                break;
            }
            let cut_off = !line.ended && numbers.at_end();
            match number {
                _ if cut_off => break,
                Ok(number) => points.push(number),
                Err(text) => {
                    let (line, text) = (line.number, shown(text));
                    return Err(RecordError::on_line(line, format!("line {line}: \"{text}\" is not a number")));
                }
            }
            taken += 1;
        }
    }
    if more {
        warnings.push(Warning::MorePoints { line: begin, promised: form.count });
    }
    if !closed {
        warnings.push(Warning::NotClosed { line: begin });
    }
    Ok(points)
}
