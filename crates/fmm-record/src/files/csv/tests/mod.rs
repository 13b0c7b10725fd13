//! Tests of the text reader.

use std::io::{self, Read};

use crate::error::{RecordError, says};
use crate::files::Reader;
use crate::files::reading::Reading;
use crate::sampling::Sampling;
use crate::units::Quantity;

mod programs;
mod times;

fn read_text(text: &str) -> Result<Reading, RecordError> {
    Reader::default().read_from(text.as_bytes())
}

fn values(text: &str) -> Vec<f64> {
    read_text(text).unwrap().record.into_values()
}

fn message(text: &str) -> String {
    read_text(text).unwrap_err().to_string()
}

fn measured(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/data").join(name)
}

#[test]
fn separators_headers_comments_and_line_ends() {
    for text in [
        "t,v\n0,1.5\n1,2.5\n2,-1\n",
        "t,v\n0,1.5\n1,2.5\n2,-1",
        "t;v\r\n0;1,5\r\n1;2,5\r\n2;-1\r\n",
        "t\tv\n0\t1,5\n1\t2,5\n2\t-1\n",
        "\u{feff}t;v\n0;1.5\n1;2.5\n2;-1\n",
        "# a \"comment, with; all\n\n% another\nt , v\n 0 , 1.5\n  # within, \"data\n1,2.5\n\n2,-1\n\n",
        "\"t\",\"v\"\n\"0\",\"1.5\"\n\"1\",\"2.5\"\n\"2\",\"-1\"\n",
        "t,v\r0,1.5\r1,2.5\r2,-1\r",
    ] {
        let reading = read_text(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        assert_eq!(reading.record.values(), [1.5, 2.5, -1.0], "{text:?}");
        assert_eq!(reading.record.rate(), 1.0);
    }
}

#[test]
fn columns_by_name_and_position() {
    let text = "time,v,V,w\n0,1,2,3\n1,1,2,3\n";
    let channel = |column: &str| Reader::default().channel(column).read_from(text.as_bytes());
    for (column, value) in [("v", 1.0), ("V", 2.0), ("W", 3.0), ("2", 2.0), (" w ", 3.0)] {
        assert_eq!(channel(column).unwrap().record.values()[0], value, "{column}");
    }
    let missing = channel("x").unwrap_err().to_string();
    assert_eq!(missing, "there is no column \"x\"; the file has: \"time\", \"v\", \"V\", \"w\"");
    assert!(says(&channel("4"), "there is no column"));
    let twice = Reader::default().channel("A").read_from(&b"t,a,a\n0,1,2\n1,1,2\n"[..]);
    assert!(says(&twice, "columns are called"));
    let same = Reader::default().channel("v").time("v").read_from(text.as_bytes());
    assert!(says(&same, "cannot be both the time and the channel"));
}

#[test]
fn a_name_without_its_unit_is_enough_where_one_column_has_it() {
    let text =
        "t [s],Velocity [m/s],x (left) [mm],x (right) [mm],v,v [mm/s],a / (m/s^2)\n0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n";
    let channel = |column: &str| Reader::default().channel(column).read_from(text.as_bytes());
    for (column, found) in [("Velocity", 1), ("velocity", 1), ("v", 4), ("v [mm/s]", 5), ("a", 6)] {
        assert_eq!(channel(column).unwrap().record.values()[0], f64::from(found), "{column}");
    }
    assert_eq!(channel("velocity").unwrap().channel, "Velocity [m/s]", "the unit is that of the column");
    assert_eq!(
        channel("x").unwrap_err().to_string(),
        "2 columns are called \"x\": \"x (left) [mm]\" at position 2, \"x (right) [mm]\" at position 3; choose one by \
         its whole name or by its position, counted from 0"
    );
    assert!(says(&channel("vel"), "there is no column \"vel\""), "a part of a name is none");
    let timed = Reader::default().time("t").channel("v").read_from(text.as_bytes()).unwrap();
    assert_eq!(timed.time.as_deref(), Some("t [s]"));
}

#[test]
fn channels_are_all_columns_but_the_time() {
    let channels = |text: &str| Reader::default().text_channels(text.as_bytes()).unwrap();
    let positions = |text: &str| channels(text).into_iter().map(|(index, _)| index).collect::<Vec<_>>();
    assert_eq!(channels("t,v\n0,1\n1,2\n"), [(1, "v".to_owned())]);
    assert_eq!(positions("x,time,v,v\n0,1,a,2\n1,2,b,3\n"), [0, 2, 3], "text in other columns does not matter");
    assert_eq!(positions("0.1,5,7\n0.2,6,7\n0.3,7,7\n"), [1, 2], "the first column is time by nature");
    assert_eq!(positions("a,b\n3,5\n1,6\n2,7\n"), [0, 1], "no column is time");
    assert_eq!(positions("date,b\nMonday,5\nMonday,6\n"), [0, 1], "no column is time");
    assert_eq!(positions("4\n5\n6\n"), [0], "a single column is no time");
    let other = Reader::default().time("b").text_channels(&b"t,a,b\n0,1,2\n"[..]).unwrap();
    assert_eq!(other.iter().map(|(index, _)| *index).collect::<Vec<_>>(), [0, 1]);
    assert!(says(&Reader::default().text_channels(&b""[..]), "empty or holds comments only"));
    assert!(says(&Reader::default().open("/no/such/file.csv"), "cannot read"));
}

#[test]
fn damage_is_named_with_its_line() {
    assert_eq!(message("# c\n\nt,v\n0,1\n# c\n1,x2\n"), "line 6, column \"v\": \"x2\" is not a number");
    assert_eq!(message("t,v\n0,1\n1,\n"), "line 3, column \"v\": \"\" is not a number");
    assert_eq!(message("t;v;w\n0;1;2\n1;1\n"), "line 3 has 2 fields, but the first row has 3");
    assert!(message("t,v\n0,001,1,5\n").starts_with("line 2 has 4 fields, but the first row has 2; if the numbers"));
    let mixed = message("t;v\n0;1,5\n1;2.5\n");
    assert!(mixed.starts_with("line 3, column \"v\": \"2.5\" has a decimal point, but earlier numbers"), "{mixed}");
    for (text, expected) in [("", "empty"), ("# only\n\n", "empty"), ("t,v\n", "no rows"), ("\n", "empty")] {
        assert!(message(text).contains(expected), "{text:?}: {}", message(text));
    }
    for number in ["NaN", "inf", "-Infinity", "1e999"] {
        let error = read_text(&format!("t,v\n0,1\n1,{number}\n")).unwrap_err();
        assert!(error.to_string().contains("not finite; the first is sample"), "{number}");
    }
    assert!(says(&Reader::default().read_text(io::repeat(b'1')), "is longer than"));
    assert!(says(&Reader::default().separator(b'.').read_from(&b""[..]), "cannot separate columns"));
    assert!(says(&Reader::default().read("/no/such/file.csv"), "cannot read"));
    // Latin-1 in a header is not UTF-8, and no reason to stop.
    assert!(Reader::default().read_from(&b"t,\xb0C\n0,1\n1,2\n"[..]).is_ok());
}

#[test]
fn text_of_any_bytes_never_panics() {
    let mut random = crate::tests::synthetic::Noise::new(5);
    let alphabet = b"0123456789.,;\t\n\r\"#%-+eE tv\xff\0";
    for _ in 0..20_000 {
        let length = random.next() % 40;
        let text: Vec<u8> = (0..length).map(|_| alphabet[random.next() as usize % alphabet.len()]).collect();
        // Either outcome is right; a panic is not.
        let _ = Reader::default().read_from(&text[..]);
        let _ = Reader::default().rate(10.0).separator(b';').read_from(&text[..]);
    }
}

/// Rows that nobody stores, each far longer than the numbers in use.
struct Endless {
    row: u32,
    rows: u32,
    text: io::Cursor<Vec<u8>>,
}

impl Read for Endless {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if self.text.position() as usize == self.text.get_ref().len() && self.row < self.rows {
            let time = f64::from(self.row) / 1000.0;
            self.text = io::Cursor::new(format!("{time:.3};{};{}\n", self.row % 7, "x".repeat(500)).into_bytes());
            self.row += 1;
        }
        self.text.read(out)
    }
}

#[test]
fn rows_are_read_as_a_stream() {
    let header = &b"t;v;text\n"[..];
    let rows = Endless { row: 0, rows: 100_000, text: io::Cursor::new(Vec::new()) };
    let reading = Reader::default().read_text(header.chain(rows)).unwrap();
    assert_eq!((reading.record.len(), reading.record.rate()), (100_000, 1000.0));
    assert_eq!(reading.record.values()[99_999], f64::from(99_999 % 7));
}

#[test]
fn measured_records_are_read_by_themselves() {
    let wheel = Reader::default().read(measured("bicycle_wheel_radial_gyro.csv")).unwrap();
    assert_eq!((wheel.record.len(), wheel.record.rate(), &wheel.channel[..]), (1001, 500.0, "angular_velocity"));
    assert_eq!(wheel.record.values()[0], 3.236_790_061_330_015);
    let pendulum = Reader::default()
        .channel("omega_rad_per_s")
        .quantity(Quantity::Velocity)
        .unit("rad/s")
        .read(measured("single_pendulum_55s_1khz.csv"))
        .unwrap();
    assert_eq!((pendulum.record.len(), pendulum.record.rate(), pendulum.record.end()), (55_001, 1000.0, 55.0));
    assert_eq!((pendulum.record.quantity(), pendulum.record.unit()), (Quantity::Velocity, "rad/s"));
    assert_eq!(values("t,v\n0,1\n1,2\n"), [1.0, 2.0]);
}

#[test]
fn decimal_commas_without_another_separator() {
    let read = |text: &str| Reader::default().rate(10.0).read_from(text.as_bytes());
    for (text, expected) in [
        ("1,5\n1,05\n0,75\n", &[1.5, 1.05, 0.75][..]),
        ("v\n1,5\n1,25\n0,75\n", &[1.5, 1.25, 0.75]),
        ("angular velocity\n1,5\n1,25\n", &[1.5, 1.25]),
        ("1,5\n2\n-0,5\n", &[1.5, 2.0, -0.5]),
        ("0,1\n1,3\n2,5\n", &[1.0, 3.0, 5.0]),
    ] {
        assert_eq!(read(text).unwrap().record.values(), expected, "{text:?}");
    }
    let error = read("4,1\n2,2\n9,5\n").unwrap_err();
    assert!(error.to_string().starts_with("\"4,1\" may be two whole numbers"), "{error}");
    let separated = |separator| Reader::default().rate(10.0).separator(separator).read_from(&b"4,1\n2,2\n"[..]);
    assert_eq!(separated(b',').unwrap().record.values(), [4.0, 2.0]);
    assert_eq!(separated(b';').unwrap().record.values(), [4.1, 2.2]);
}

#[test]
fn a_file_cut_off_within_its_last_number_is_refused() {
    let rows = |format: fn(f64) -> String| -> String {
        let value = |i: u32| (f64::from(i) * 0.7).sin();
        let row = |i: u32| format!("{:.3};{}\n", f64::from(i) / 1e3, format(value(i)));
        (0..40).map(row).collect()
    };
    let formats: [fn(f64) -> String; 4] = [
        |value| format!("{value:.4}"),
        |value| format!("{value:.5e}"),
        |value| format!("{value:.3}").replace('.', ","),
        |value| format!("{:+06}", (value * 1e4) as i32),
    ];
    for format in formats {
        let text = format!("t;v\n{}", rows(format).replace('.', if format(0.1).contains(',') { "," } else { "." }));
        assert_eq!(values(&text).len(), 40);
        assert_eq!(values(text.trim_end()).len(), 40, "the last line need not end");
        let last = text.trim_end().rfind(';').unwrap() + 1;
        for length in last..text.len() - 1 {
            let error = read_text(&text[..length]).unwrap_err();
            let shown = error.to_string();
            assert!(matches!(error, RecordError::Damaged { line: Some(41), .. }), "{error}");
            assert!(shown.contains("is cut off") || shown.contains("is not a number"), "{error}");
        }
    }
}

#[test]
fn a_stray_quote_costs_no_memory_and_no_rows() {
    let row = |i: u32| format!("{:.3},{}\n", f64::from(i) / 1e3, i % 7);
    let rows: String = (0..1000).map(row).collect();
    let text = format!("t,\"v\n{rows}");
    let reading = read_text(&text).unwrap();
    assert_eq!((reading.record.len(), &reading.channel[..]), (1000, "\"v"));
    let error = read_text(&text.replace("0.500,3", "0.500,\"3")).unwrap_err().to_string();
    assert_eq!(error, "line 502, column \"\"v\": \"\"3\" is not a number");
}

#[test]
fn no_row_is_lost_above_the_first() {
    for (text, line) in
        [("t,v\n0,n/a\n1,5\n2,6\n", 2), ("t,v\n,1\n0.5,2\n1.0,3\n", 2), ("t,v\n0,1\n1,x\n2,3\n3,4\n", 3)]
    {
        let error = read_text(text).unwrap_err();
        assert!(matches!(error, RecordError::Damaged { line: Some(at), .. } if at == line), "{text:?}: {error}");
    }
}

#[test]
fn thousands_and_quoted_decimal_commas() {
    for text in [
        "t [s];v [m/s]\n0,0;299,5\n0,5;-6.174,0\n1,0;12.345,25\n",
        "t [s],v [m/s]\n\"0,0\",\"299,5\"\n\"0,5\",\"-6174,0\"\n\"1,0\",\"12345,25\"\n",
        "t [s],v [m/s]\n0.0,299.5\n0.5,\"-6,174\"\n1.0,\"12,345.25\"\n",
        "t [s]\tv [m/s]\n0,0\t299,5\n0,5\t-6 174,0\n1,0\t12\u{a0}345,25\n",
    ] {
        let reading = read_text(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!((reading.record.values(), reading.record.rate()), (&[299.5, -6174.0, 12_345.25][..], 2.0), "{text}");
    }
}

#[test]
fn text_in_utf_16_is_read_with_and_without_its_mark() {
    let text = "Zeit [s]\tv [µm/s]\r\n0,0\t1,5\r\n0,5\t2,5\r\n1,0\t-1\r\n";
    let units: Vec<u16> = text.encode_utf16().collect();
    let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
    for bytes in [[&b"\xff\xfe"[..], &little].concat(), [&b"\xfe\xff"[..], &big].concat(), little, big] {
        let reading = Reader::default().read_from(bytes).unwrap();
        assert_eq!((reading.record.values(), &reading.channel[..]), (&[1.5, 2.5, -1.0][..], "v [µm/s]"));
    }
}

#[cfg(feature = "gzip")]
#[test]
fn a_compressed_file_is_what_is_in_it() {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    io::Write::write_all(&mut encoder, b"t [s],v [m/s]\n0,1.5\n1,2.5\n").unwrap();
    let bytes = encoder.finish().unwrap();
    assert_eq!(Reader::default().read_from(&bytes[..]).unwrap().record.values(), [1.5, 2.5]);
    assert!(says(&Reader::default().read_from(&bytes[..20]), "the gzip file is damaged"));
}

#[test]
fn empty_rows_at_the_end_lose_nothing() {
    let text = "t [s],v [m/s],\n0.0,1.5,\n0.5,2.5,\n1.0,-1,\n,,\n,,\n,,\n,,\n";
    assert_eq!(values(text), [1.5, 2.5, -1.0]);
    assert!(says(&read_text(",,\n,,\n"), "no rows"));
}

#[test]
fn damaged_lines_are_named_and_used_around_on_request() {
    let text = "4, 0.01\u{fffd}7\n0.0, 1.0\n0.5, 2.0\n1.0, 3?5\n1.5, 4.0\n2.0\n2.5, 6.0\n3.0, 7.0\n3";
    assert!(message(text).starts_with("line 1, column \"1\": \"0.01\u{fffd}7\" is not a number"), "{}", message(text));
    let reading = Reader::default().repair().read_from(text).unwrap();
    assert_eq!((reading.record.values(), reading.record.rate()), (&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0][..], 2.0));
    let serial =
        text.replace("0.0,", "1234,").replace("0.5,", "1236,").replace("1.0,", "1238,").replace("1.5,", "1240,");
    let serial = serial.replace("2.5,", "1244,").replace("3.0,", "1246,");
    let file = Reader::default().repair().time_unit("ms").parse(serial).unwrap();
    assert_eq!(file.channels().unwrap().len(), 1, "the first column is time in spite of the damage in others");
    assert_eq!(file.reading().unwrap().record.rate(), 500.0);
    assert_eq!(reading.remarks.len(), 5, "{:?}", reading.remarks);
    assert_eq!(reading.remarks[1], "line 4, column \"1\": \"3?5\" is not a number; the line was not used");
    assert!(reading.remarks[4].starts_with("straight lines between their neighbours stand for 2 damaged lines"));
}

#[test]
fn tables_of_a_text_are_joined_or_told() {
    let goes_on = "t [s],v [m/s]\n0,1\n1,2\n2,3\nt [s],v [m/s]\n3,4\n4,5\n5,6\n";
    let joined = read_text(goes_on).unwrap();
    assert_eq!(joined.record.len(), 6);
    assert!(joined.remarks[0].starts_with("the file has 2 tables whose times go on"), "{:?}", joined.remarks);
    let second = Reader::default().table(2).read_from(goes_on).unwrap().record;
    assert_eq!((second.start(), second.values()), (3.0, &[4.0, 5.0, 6.0][..]));
    let begins_anew = goes_on.replace("\n3,4", "\n0,4").replace("\n4,5", "\n1,5").replace("\n5,6", "\n2,6");
    let first = read_text(&begins_anew).unwrap();
    assert_eq!(first.record.values(), [1.0, 2.0, 3.0]);
    assert!(first.remarks[0].contains("the first was read, which has 3 of 6 samples; `table`"), "{:?}", first.remarks);
    assert!(says(&Reader::default().table(3).read_from(&begins_anew[..]), "there is no table 3; the file has 2"));
}

#[test]
fn lines_above_the_table_are_found() {
    let rows = "0.0,1.5\n0.5,2.5\n1.0,-1\n";
    let names = "time [s],velocity [mm/s]\n";
    for above in [
        format!("Operator,Bob\nSpecimen,12\nDate,2024-01-02\n{names}"),
        format!("My test, run 3, hot, dry\n\nMass [kg],10.391\n{names}"),
        format!("a,b,c,d\n1,2,3,4\n{names}"),
        format!("Start,10:00:00.000\n{names}-----,-----\n"),
        "time,velocity\n[s],[mm/s]\n".to_owned(),
        format!("[Header]\nName=abc\n[Data]\n{names}"),
    ] {
        let reading = read_text(&format!("{above}{rows}")).unwrap_or_else(|error| panic!("{above}: {error}"));
        assert_eq!((reading.record.values(), reading.record.rate()), (&[1.5, 2.5, -1.0][..], 2.0), "{above}");
        assert_eq!(reading.channel, "velocity [mm/s]", "{above}");
    }
}
