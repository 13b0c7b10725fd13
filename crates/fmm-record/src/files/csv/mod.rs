//! Records from comma, semicolon or tab separated text.
//!
//! The reader finds out by itself what text files of measuring software differ in: the separator, where the table
//! begins below a preamble, the names of the columns and a row of units below them, decimal points or commas, which
//! column is time. Lines that begin with `#` or `%` and blank lines are skipped wherever they stand, but for names in a
//! comment right above the first row. What it chose is in the [`Reading`](crate::Reading). Files of LabVIEW (`.lvm`),
//! Tektronix, Rigol, PicoScope and catman and the `sep=` of Excel need nothing more; for others,
//! [`Reader::skip`](crate::Reader::skip) passes over lines.
//!
//! Memory goes to the two columns in use only, so that a file may be larger than the memory. A quote is closed on its
//! own line or is a sign like others.

mod fields;
mod header;
mod layout;
mod lines;
mod table;
#[cfg(test)]
mod tests;

use std::io::Read;

use crate::error::RecordError;
use crate::files::Reader;
use crate::files::clock::{Clock, counter, stated};
use crate::files::csv::table::Table;
use crate::files::reading::{Reading, quoted};
use crate::sampling::{Sampling, uniform_grid};

impl Reader {
    /// Reads one channel of the text in `input`, which is buffered here.
    pub(crate) fn read_text(&self, input: impl Read) -> Result<Reading, RecordError> {
        let table = Table::open(input, self.separator, self.skip)?;
        let columns = table.header.names.clone();
        let channel = self.channel.as_ref().map(|column| table.find(column)).transpose()?;
        let time = match &self.time {
            Some(column) => Some(table.find(column)?),
            None => time_by_name(&columns, channel),
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
            |index: &usize| *index != first && !table.is_blank(*index) && !Clock::of(&columns[*index]).is_counter;
        let other = channel.or_else(|| (0..columns.len()).find(is_other));
        let may_be_time = Clock::of(&columns[first]).may_be_time();
        let is_settled = channel.is_some() && self.rate.is_some();
        match (time, other, rate) {
            (Some(time), None, _) => {
                let time = &columns[time];
                let what = format!("the file has only the time column \"{time}\", and no other to read");
                Err(RecordError::channel(what))
            }
            (Some(_), Some(channel), Some(rate)) => {
                let [values] = table.read_columns([channel])?;
                self.reading(columns, time, channel, values, Scale::Rate(rate))
            }
            (Some(stamps), Some(channel), None) => {
                let [times, values] = table.read_columns([stamps, channel])?;
                let is_by_nature = false;
                self.reading(columns, time, channel, values, Scale::Times { times, is_by_nature })
            }
            (None, Some(second), rate) if may_be_time && !is_settled && second != first => {
                let [times, values] = table.read_columns([first, second])?;
                let clock = Clock::of(&columns[first]);
                let is_uniform = uniform_grid(&times).is_ok();
                let counts = clock.is_counter || (is_uniform && clock.counts(&times));
                // The first column is time if it increases uniformly and does not count.
                let time = (is_uniform && !counts).then_some(first);
                match rate {
                    Some(rate) if time.is_none() || self.rate.is_some() => {
                        let is_second = time.is_some() || counts || channel.is_some();
                        let (channel, values) = if is_second { (second, values) } else { (first, times) };
                        self.reading(columns, time, channel, values, Scale::Rate(rate))
                    }
                    _ if time.is_some() => {
                        self.reading(columns, time, second, values, Scale::Times { times, is_by_nature: true })
                    }
                    _ if counts => Err(counter(&columns[first])),
                    _ => Err(no_rate(&columns)),
                }
            }
            (None, _, Some(rate)) => {
                let channel = channel.unwrap_or(first);
                let [values] = table.read_columns([channel])?;
                self.reading(columns, None, channel, values, Scale::Rate(rate))
            }
            (None, _, None) => Err(no_rate(&columns)),
        }
    }

    /// The columns of text that can be the channel, by position counted from 0 and name: all but the time. Beyond the
    /// header, only what is needed to find the time is read.
    pub(crate) fn text_channels(&self, input: impl Read) -> Result<Vec<(usize, String)>, RecordError> {
        let table = Table::open(input, self.separator, self.skip)?;
        let columns = table.header.names.clone();
        let first = table.first();
        let blank: Vec<bool> = (0..columns.len()).map(|column| table.is_blank(column)).collect();
        let named = match &self.time {
            Some(column) => Some(table.find(column)?),
            None => time_by_name(&columns, None),
        };
        let time = match named {
            Some(time) => Some(time),
            None if columns.len() > 1 && Clock::of(&columns[first]).may_be_time() => {
                // Text or gaps are no time either.
                table.read_columns([first]).ok().filter(|[times]| uniform_grid(times).is_ok()).map(|_| first)
            }
            _ => None,
        };
        let is_channel =
            |(index, name): &(usize, String)| Some(*index) != time && !blank[*index] && !Clock::of(name).is_counter;
        Ok(columns.into_iter().enumerate().filter(is_channel).collect())
    }

    /// The reading of the `values` of column `channel` beside column `time`.
    fn reading(
        &self,
        columns: Vec<String>,
        time: Option<usize>,
        channel: usize,
        values: Vec<f64>,
        scale: Scale,
    ) -> Result<Reading, RecordError> {
        let (time, channel) = (time.map(|index| columns[index].clone()), columns[channel].clone());
        let (record, sampling) = match scale {
            Scale::Rate((rate, sampling)) => (self.span.sampled(rate, values)?, sampling),
            Scale::Times { mut times, is_by_nature } => {
                let name = time.clone().unwrap_or_default();
                Clock::of(&name).to_seconds(&name, is_by_nature, &mut times)?;
                (self.span.timed(&times, values)?, Sampling::Times { name })
            }
        };
        Ok(Reading { record, channel, time, columns, sampling })
    }
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
