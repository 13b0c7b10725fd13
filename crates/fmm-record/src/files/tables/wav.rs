//! Sound files: one column a channel, and the rate.

use std::io::Cursor;

use hound::{SampleFormat, WavReader};

use super::Text;
use crate::error::RecordError;

/// The samples as text. Whole numbers stay as they are stored and are called counts: their size in the unit that was
/// measured is known to the recorder only.
pub(in crate::files) fn text(bytes: &[u8]) -> Result<Vec<u8>, RecordError> {
    if let Some((rate, channels, data)) = doubles(bytes) {
        let samples: Vec<String> =
            data.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes).to_string()).collect();
        return Ok(table(rate, channels, "", &samples));
    }
    let damaged = |error| RecordError::undecoded("the WAV file cannot be read", error);
    let mut reader = WavReader::new(Cursor::new(bytes)).map_err(damaged)?;
    let spec = reader.spec();
    let unit = if spec.sample_format == SampleFormat::Int { " [counts]" } else { "" };
    let written = |sample: Result<f64, hound::Error>| sample.map(|sample| sample.to_string());
    let samples: Result<Vec<String>, _> = match spec.sample_format {
        SampleFormat::Int => reader.samples::<i32>().map(|sample| written(sample.map(f64::from))).collect(),
        SampleFormat::Float => reader.samples::<f32>().map(|sample| written(sample.map(f64::from))).collect(),
    };
    Ok(table(spec.sample_rate, spec.channels, unit, &samples.map_err(damaged)?))
}

/// The samples of all channels, one frame behind the other.
fn table(rate: u32, channels: u16, unit: &str, samples: &[String]) -> Vec<u8> {
    let mut text = Text::new();
    text.line(["sample rate".to_owned(), rate.to_string()]);
    text.line((1..=channels).map(|channel| format!("channel {channel}{unit}")));
    for frame in samples.chunks_exact(usize::from(channels.max(1))) {
        text.line(frame.iter().cloned());
    }
    text.0
}

/// Rate (Hz), channels and data of a sound of real numbers of 64 bits, which hound does not read.
fn doubles(bytes: &[u8]) -> Option<(u32, u16, &[u8])> {
    let (mut rest, mut format) = (bytes.get(12..)?, None);
    loop {
        let (head, behind) = rest.split_first_chunk::<8>()?;
        let length = u32::from_le_bytes(*head.last_chunk()?) as usize;
        let chunk = behind.get(..length.min(behind.len()))?;
        match &head[..4] {
            b"fmt " => {
                let word = |at: usize| Some(u16::from_le_bytes(*chunk.get(at..)?.first_chunk()?));
                // The kind of an extensible format stands at its end.
                let kind = word(0).and_then(|kind| if kind == 0xFFFE { word(24) } else { Some(kind) });
                let rate = u32::from_le_bytes(*chunk.get(4..)?.first_chunk()?);
                format = Some((rate, word(2)?)).filter(|_| kind == Some(3) && word(14) == Some(64));
            }
            b"data" => return format.map(|(rate, channels)| (rate, channels, chunk)),
            _ => {}
        }
        rest = behind.get(length + length % 2..)?;
    }
}

#[cfg(test)]
mod tests {
    use hound::{SampleFormat, WavSpec, WavWriter};

    use crate::files::{Format, Reader};

    #[test]
    fn samples_are_what_is_stored() {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let spec = WavSpec { channels: 2, sample_rate: 500, bits_per_sample: 16, sample_format: SampleFormat::Int };
        let mut writer = WavWriter::new(&mut bytes, spec).unwrap();
        for sample in [7_i16, 1, -488, 2, 32_767, 3] {
            writer.write_sample(sample).unwrap();
        }
        writer.finalize().unwrap();
        let file = Reader::default().parse(bytes.into_inner()).unwrap();
        let reading = file.channel("channel 1").unwrap();
        assert_eq!((file.format(), reading.record.rate()), (Format::Wav, 500.0));
        assert_eq!(reading.record.values(), [7.0, -488.0, 32_767.0]);
        assert_eq!(file.channel(1).unwrap().channel, "channel 2 [counts]");
        assert!(Reader::default().parse(*b"RIFF\0\0\0\0WAVEfmt ").is_err());
    }

    #[test]
    fn real_numbers_of_64_bits_are_read() {
        let mut bytes =
            b"RIFF\0\0\0\0WAVEfmt \x10\0\0\0\x03\0\x01\0\xf4\x01\0\0\xa0\x0f\0\0\x08\0\x40\0data\x18\0\0\0".to_vec();
        bytes.extend([1.5, 2.5, -1.0].iter().flat_map(|value: &f64| value.to_le_bytes()));
        let reading = Reader::default().parse(bytes).unwrap().channel("channel 1").unwrap();
        assert_eq!((reading.record.values(), reading.record.rate()), (&[1.5, 2.5, -1.0][..], 500.0));
    }
}
