//! Files of other programs, and their arrays.

use super::*;
use crate::error::says;
use crate::sampling::Sampling;
use crate::units::Quantity;

/// Half a unit of the last of `digits` digits, relative.
fn rounding(digits: i32) -> f64 {
    0.5 * 10f64.powi(1 - digits)
}

fn assert_near(found: f64, expected: f64, relative: f64) {
    // One more unit of rounding for the conversion to and from decimals.
    let limit = (relative + f64::EPSILON) * expected.abs();
    assert!((found - expected).abs() <= limit, "{found} is not within {limit} of {expected}");
}

#[test]
fn time_records_as_text_and_bytes() {
    let (text, bytes) = (sets(&file("impact_time_ascii.uff")), sets(&file("impact_time_binary.uff")));
    // The second trial of the measurement that was written.
    for (index, name, quantity, unit, first, last) in [
        (0, "force trial 2", Quantity::Force, "N", -0.0573, 0.8069),
        (1, "velocity trial 2", Quantity::Velocity, "m/s", -0.000_169_26, 0.170_215_5),
    ] {
        let record = bytes[index].record().unwrap();
        assert_eq!((record.len(), record.rate(), record.start()), (1024, 512.0, 0.0));
        assert_eq!((record.values()[0], record.values()[1023]), (first, last));
        assert_eq!((&bytes[index].name()[..], record.quantity(), record.unit()), (name, quantity, unit));
        for (text, bytes) in real(&text[index]).iter().zip(record.values()) {
            assert_near(*text, *bytes, rounding(12));
        }
        assert_eq!(text[index].header, bytes[index].header);
    }
    let file = UffFile::parse(&file("impact_time_binary.uff")).unwrap();
    let reading = channel(&file, "Velocity trial 2").unwrap();
    assert_eq!((reading.record, &reading.channel[..]), (bytes[1].record().unwrap(), "velocity trial 2"));
    assert_eq!(reading.sampling, Sampling::Header { interval: 1.953_12e-3, rate: 512.0 });
    assert_eq!(channel(&file, 0).unwrap().channel, "force trial 2");
    assert_eq!(
        super::reading(&file).unwrap_err().to_string(),
        "name the data set; the file has 2 records over time among: \"force trial 2\", \"velocity trial 2\""
    );
    assert!(says(&channel(&file, 2), "there is no data set"));
}

#[test]
fn frequency_responses_as_text_and_bytes() {
    let whole = UffFile::parse(&file("impact_frf_binary.uff")).unwrap();
    // The program that wrote the file counts half the bytes of complex numbers.
    assert_eq!(whole.warnings(), ["the data set at line 2 states 2560 bytes, but its points have 5120"]);
    let [set] = whole.sets() else { panic!("{} sets", whole.sets().len()) };
    assert_eq!(set.header.function, FunctionType::FREQUENCY_RESPONSE);
    assert_eq!((set.header.denominator.data_type, &set.header.denominator.unit[..]), (DataType::EXCITATION_FORCE, "N"));
    assert_eq!(set.abscissae().collect::<Vec<_>>(), (1..=320).map(|i| f64::from(i) / 16.0).collect::<Vec<_>>());
    // As numpy 2.4.6 had them before they were written.
    let values = complex(set);
    assert_eq!(values[0], [7.468_381_857_619_109e-7, 0.000_196_850_723_565_416_34]);
    assert_eq!(values[319], [3.037_610_210_349_742e-6, -0.000_772_447_695_902_109_9]);
    for (name, digits) in [("impact_frf_ascii.uff", 12), ("impact_frf_ascii_single.uff", 6)] {
        let [text] = &sets(&file(name))[..] else { panic!("{name}") };
        assert_eq!((text.abscissa(), text.ordinate().len()), (set.abscissa(), 320));
        for (text, bytes) in complex(text).iter().flatten().zip(values.iter().flatten()) {
            assert_near(*text, *bytes, rounding(digits));
        }
    }
    // Every line from the second on, then fewer.
    let [uneven] = &sets(&file("impact_frf_ascii_uneven.uff"))[..] else { panic!() };
    assert_eq!(uneven.ordinate().len(), 111);
    for (frequency, value) in uneven.abscissae().zip(complex(uneven)) {
        // Six digits of a frequency of up to 20 Hz leave 5e-5 Hz, well below the distance of 1/16 Hz.
        let even = values[(frequency * 16.0).round() as usize - 1];
        for (text, bytes) in value.iter().zip(even) {
            assert_near(*text, bytes, rounding(12));
        }
    }
    let error = set.record().unwrap_err().to_string();
    assert_eq!(error, "\"mobility H1\" is no record over time, but a frequency response");
}

#[test]
fn a_measured_sound_as_text_and_bytes() {
    let (text, bytes) = (sets(&file("microphone_ascii.uff")), sets(&file("microphone_binary.uff")));
    assert_eq!(text[0].header, bytes[0].header);
    assert_eq!(text[0].header.response, Freedom { entity: "Mic 01".into(), node: 0, direction: 1 });
    assert_eq!(text[0].header.lines[2], "18-Apr-16 13:49:58");
    let record = bytes[0].record().unwrap();
    assert_eq!((record.len(), record.rate(), record.unit()), (600, 65_536.0, "Pa"));
    assert_eq!(real(&text[0])[..2], [-1.475_53e-2, -1.729_57e-2]);
    for (text, bytes) in real(&text[0]).iter().zip(record.values()) {
        assert_near(*text, *bytes, rounding(6));
    }
}
