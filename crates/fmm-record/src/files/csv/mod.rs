//! Records from comma, semicolon or tab separated text.
//!
//! The reader finds out by itself what text files of measuring software differ in: the separator, where the table
//! begins below a preamble, the names of the columns and a row of units below them, decimal points or commas, which
//! column is time. Lines that begin with `#` or `%` and blank lines are skipped wherever they stand, but for names in a
//! comment right above the first row. What it chose is in the [`Reading`](crate::Reading). Files of LabVIEW (`.lvm`),
//! SignalExpress, Tektronix, Rigol, PicoScope and catman and the `sep=` of Excel need nothing more; for others,
//! [`Reader::skip`](crate::Reader::skip) passes over lines.
//!
//! Memory goes to the two columns in use only, so that a file may be larger than the memory. A quote is closed on its
//! own line or is a sign like others.

mod fields;
mod header;
mod layout;
mod lines;
mod stamp;
mod statement;
mod table;
#[cfg(test)]
mod tests;

use std::io::Read;

use crate::error::RecordError;
use crate::files::Reader;
use crate::files::clock::{Clock, counter};
use crate::files::csv::table::{Rows, Table};
use crate::files::rate::stated;
use crate::files::reading::{Reading, quoted};
use crate::sampling::{Sampling, uniform_grid};

impl Reader {
    /// Reads one channel of the text in `input`, which is buffered here.
    pub(crate) fn read_text(&self, input: impl Read) -> Result<Reading, RecordError> {
        let table = Table::open(input, self.separator, self.skip)?;
        let mut found = Found { columns: table.header.names.clone(), ..Found::default() };
        let columns = &found.columns;
        let channel = self.channel.as_ref().map(|column| table.find(column)).transpose()?;
        let time = match &self.time {
            Some(column) => Some(table.find(column)?),
            None => time_by_name(columns, channel),
        };
        if let (Some(time), true) = (time, time == channel) {
            let column = &columns[time];
            return Err(RecordError::options(format!("column \"{column}\" cannot be both the time and the channel")));
        }
        let rate = match self.rate {
            Some(rate) => Some((rate, Sampling::Given { rate })),
            None if time.is_some() => None,
            None => stated(table.header.stated.iter().map(|(name, value)| (&name[..], *value)))?,
        };
        let first = time.unwrap_or(table.first());
        let is_other =
            |index: &usize| *index != first && !table.is_blank(*index) && !Clock::of(&columns[*index]).is_no_motion();
        let other = channel.or_else(|| (0..columns.len()).find(is_other));
        let may_be_time = self.clock(&columns[first]).may_be_time();
        let is_settled = channel.is_some() && self.rate.is_some();
        match (time, other, rate) {
            (Some(time), None, _) => {
                let time = &columns[time];
                let what = format!("the file has only the time column \"{time}\", and no other to read");
                Err(RecordError::channel(what))
            }
            (Some(_), Some(channel), Some(rate)) => {
                let [values] = self.rows(table, [channel], &mut found)?;
                self.reading(found, time, channel, values, Scale::Rate(rate))
            }
            (Some(stamps), Some(channel), None) => {
                let [times, values] = self.rows(table, [stamps, channel], &mut found)?;
                let is_by_nature = false;
                self.reading(found, time, channel, values, Scale::Times { times, is_by_nature })
            }
            (None, Some(second), rate) if may_be_time && !is_settled && second != first => {
                let [times, values] = self.rows(table, [first, second], &mut found)?;
                let clock = self.clock(&found.columns[first]);
                let is_uniform = uniform_grid(&times).is_ok();
                let may_count = is_uniform || clock.is_nameless;
                let counts = found.clock.is_none() && (clock.is_counter || (may_count && clock.counts(&times)));
                // The first column is time if it increases uniformly and does not count.
                let time = (is_uniform && !counts).then_some(first);
                match rate {
                    Some(rate) if time.is_none() || self.rate.is_some() => {
                        let is_second = time.is_some() || counts || clock.is_nameless || channel.is_some();
                        let (channel, values) = if is_second { (second, values) } else { (first, times) };
                        self.reading(found, time, channel, values, Scale::Rate(rate))
                    }
                    _ if time.is_some() => {
                        self.reading(found, time, second, values, Scale::Times { times, is_by_nature: true })
                    }
                    _ if counts => Err(counter(&found.columns[first], &times)),
                    _ => Err(no_rate(&found.columns)),
                }
            }
            (None, _, Some(rate)) => {
                let channel = channel.unwrap_or(first);
                let [values] = self.rows(table, [channel], &mut found)?;
                self.reading(found, None, channel, values, Scale::Rate(rate))
            }
            (None, Some(channel), None) if Clock::of(&columns[channel]).is_time => {
                let column = &columns[channel];
                Err(RecordError::channel(format!(
                    "column \"{column}\" is the time, and no other column tells it; choose another channel"
                )))
            }
            (None, _, None) => Err(no_rate(&found.columns)),
        }
    }

    /// The clock of a column of times, in the unit that was given.
    fn clock(&self, name: &str) -> Clock {
        Clock::of(name).in_unit(self.time_unit.as_deref())
    }

    /// The chosen columns of the table that is meant, the times first if there are two.
    ///
    /// Tables whose times go on are one record unless one of them was chosen; otherwise the first counts.
    fn rows<const N: usize>(
        &self,
        table: Table<impl Read>,
        chosen: [usize; N],
        found: &mut Found,
    ) -> Result<[Vec<f64>; N], RecordError> {
        let mut rows: Rows<N> = table.read_columns(chosen, self.repairs, self.span.is_any_spacing)?;
        let length = rows.columns[0].len();
        let bounds: Vec<usize> = [0].into_iter().chain(rows.begins.clone()).chain([length]).collect();
        let count = bounds.len() - 1;
        let goes_on = N == 2 && uniform_grid(&rows.columns[0]).is_ok();
        match self.table {
            None if count == 1 => {}
            None if goes_on => rows.remarks.push(format!(
                "the file has {count} tables whose times go on, and was read as one record; `table` chooses one of them"
            )),
            None => {
                rows.cut(0, bounds[1]);
                rows.remarks.push(format!(
                    "the file has {count} tables; the first was read, which has {} of {length} samples; `table` \
                     chooses another",
                    bounds[1]
                ));
            }
            Some(table) if (1..=count).contains(&table) => rows.cut(bounds[table - 1], bounds[table]),
            Some(table) => {
                return Err(RecordError::options(format!("there is no table {table}; the file has {count}")));
            }
        }
        found.remarks.append(&mut rows.remarks);
        found.clock.clone_from(&rows.clocks[0]);
        if let Some(text) = rows.clocks.iter().skip(1).flatten().next() {
            let name = &found.columns[chosen[N - 1]];
            let what = format!("column \"{name}\" holds times of day, such as {text}, and no motion; choose another");
            return Err(RecordError::channel(what));
        }
        Ok(rows.columns)
    }

    /// The columns of text that can be the channel, by position counted from 0 and name: all but the time. Beyond the
    /// header, only what is needed to find the time is read.
    pub(crate) fn text_channels(&self, input: impl Read) -> Result<Vec<(usize, String)>, RecordError> {
        let table = Table::open(input, self.separator, self.skip)?;
        let columns = table.header.names.clone();
        let first = table.first();
        let blank: Vec<bool> = (0..columns.len()).map(|column| table.is_blank(column)).collect();
        let numbers = (0..columns.len()).filter(|column| table.is_number(*column)).count();
        let named = match &self.time {
            Some(column) => Some(table.find(column)?),
            None => time_by_name(&columns, None),
        };
        let time = match named {
            Some(time) => Some(time),
            None if columns.len() > 1 && self.clock(&columns[first]).may_be_time() => {
                // Text or gaps are no time either.
                let rows = table.read_columns([first], self.repairs, false);
                // Of two columns of numbers, the damaged one may be the time.
                if let (Err(error @ RecordError::Damaged { .. }), 2) = (&rows, numbers) {
                    return Err(error.clone());
                }
                rows.ok().filter(|rows| uniform_grid(&rows.columns[0]).is_ok()).map(|_| first)
            }
            _ => None,
        };
        let is_channel =
            |(index, name): &(usize, String)| Some(*index) != time && !blank[*index] && !Clock::of(name).is_no_motion();
        Ok(columns.into_iter().enumerate().filter(is_channel).collect())
    }

    /// The reading of the `values` of column `channel` beside column `time`.
    fn reading(
        &self,
        found: Found,
        time: Option<usize>,
        channel: usize,
        values: Vec<f64>,
        scale: Scale,
    ) -> Result<Reading, RecordError> {
        let Found { columns, mut remarks, clock } = found;
        remarks.extend(self.span.lacking(&values));
        let (time, channel) = (time.map(|index| columns[index].clone()), columns[channel].clone());
        let (record, sampling) = match scale {
            Scale::Rate((rate, sampling)) => (self.span.sampled(rate, values)?, sampling),
            Scale::Times { mut times, is_by_nature } => {
                let name = time.clone().unwrap_or_default();
                let sampling = match clock {
                    Some(first) => Sampling::TimesOfDay { name, first },
                    None => self.clock(&name).to_seconds(&name, is_by_nature, &mut times)?,
                };
                (self.span.timed(&times, values)?, sampling)
            }
        };
        Ok(Reading { record, channel, time, columns, sampling, remarks })
    }
}

/// Findings in a text beside the numbers.
#[derive(Default)]
struct Found {
    columns: Vec<String>,
    remarks: Vec<String>,
    /// The first time of day in the column that was read as times.
    clock: Option<String>,
}

/// Scale of the time of a channel.
enum Scale {
    /// The rate (Hz), and its source.
    Rate((f64, Sampling)),
    /// Time stamps; by nature only if nothing calls them so.
    Times { times: Vec<f64>, is_by_nature: bool },
}

/// Neither a time column nor a rate.
fn no_rate(columns: &[String]) -> RecordError {
    let what =
        format!("the sampling rate is not known: give a time column or a rate; the file has: {}", quoted(columns));
    RecordError::time(None, what)
}

/// The first column that is called time, other than the channel; one in a known unit before others.
fn time_by_name(columns: &[String], channel: Option<usize>) -> Option<usize> {
    let first = |is_time: fn(&Clock) -> bool| {
        let mut others = columns.iter().enumerate().filter(|(index, _)| Some(*index) != channel);
        others.find(|(_, name)| is_time(&Clock::of(name))).map(|(index, _)| index)
    };
    first(Clock::is_known_time).or_else(|| first(|clock| clock.is_time))
}
