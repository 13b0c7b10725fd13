//! Sound files: one column a channel, and the rate.

use std::io::Cursor;

use hound::{SampleFormat, WavReader};

use super::Text;
use crate::error::RecordError;

/// The samples as text. Whole numbers stay as they are stored and are called counts: their size in the unit that was
/// measured is known to the recorder only.
pub(in crate::files) fn text(bytes: &[u8]) -> Result<Vec<u8>, RecordError> {
    let damaged = |error| RecordError::undecoded("the WAV file cannot be read", error);
    let mut reader = WavReader::new(Cursor::new(bytes)).map_err(damaged)?;
    let spec = reader.spec();
    let unit = if spec.sample_format == SampleFormat::Int { " [counts]" } else { "" };
    let mut text = Text::new();
    text.line(["sample rate".to_owned(), spec.sample_rate.to_string()]);
    text.line((1..=spec.channels).map(|channel| format!("channel {channel}{unit}")));
    let written = |sample: Result<f64, hound::Error>| sample.map(|sample| sample.to_string());
    let samples: Result<Vec<String>, _> = match spec.sample_format {
        SampleFormat::Int => reader.samples::<i32>().map(|sample| written(sample.map(f64::from))).collect(),
        SampleFormat::Float => reader.samples::<f32>().map(|sample| written(sample.map(f64::from))).collect(),
    };
    let samples = samples.map_err(damaged)?;
    for frame in samples.chunks_exact(usize::from(spec.channels.max(1))) {
        text.line(frame.iter().cloned());
    }
    Ok(text.0)
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
}
