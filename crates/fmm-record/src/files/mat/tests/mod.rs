use std::io::Write;

use super::{class, parse as parse_bytes};
use crate::error::{RecordError, says};
use crate::files::Reader;
use crate::files::arrays::{Array, ArrayFile};
use crate::files::reading::MOST_INFLATED;
use crate::sampling::Sampling;
use crate::tests::synthetic::{Noise, fork_path};

/// Writes the parts of a file, in either order of bytes.
struct Writer {
    big: bool,
}

const LITTLE: Writer = Writer { big: false };
const BIG: Writer = Writer { big: true };

impl Writer {
    fn number(&self, number: u32) -> [u8; 4] {
        if self.big { number.to_be_bytes() } else { number.to_le_bytes() }
    }

    fn file(&self, variables: &[Vec<u8>]) -> Vec<u8> {
        let mut file = vec![b' '; 124];
        file[..10].copy_from_slice(b"MATLAB 5.0");
        file.extend_from_slice(if self.big { b"\x01\x00MI" } else { b"\x00\x01IM" });
        file.extend(variables.concat());
        file
    }

    fn part(&self, code: u32, data: &[u8]) -> Vec<u8> {
        let mut part = Vec::new();
        part.extend_from_slice(&self.number(code));
        part.extend_from_slice(&self.number(data.len() as u32));
        part.extend_from_slice(data);
        part.resize(part.len().next_multiple_of(8), 0);
        part
    }

    fn array(&self, class: u32, name: &str, dimensions: &[u32], stored: u32, data: &[u8]) -> Vec<u8> {
        let mut flags = self.number(class).to_vec();
        flags.extend_from_slice(&[0; 4]);
        let sizes: Vec<u8> = dimensions.iter().flat_map(|size| self.number(*size)).collect();
        let body = [self.part(6, &flags), self.part(5, &sizes), self.part(1, name.as_bytes()), self.part(stored, data)];
        self.part(14, &body.concat())
    }

    fn doubles(&self, name: &str, dimensions: &[u32], values: &[f64]) -> Vec<u8> {
        let bytes = |value: &f64| if self.big { value.to_be_bytes() } else { value.to_le_bytes() };
        self.array(6, name, dimensions, 9, &values.iter().flat_map(bytes).collect::<Vec<u8>>())
    }
}

fn compressed(variable: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(variable).unwrap();
    let data = encoder.finish().unwrap();
    let mut element = LITTLE.number(15).to_vec();
    element.extend_from_slice(&LITTLE.number(data.len() as u32));
    element.extend_from_slice(&data);
    element
}

fn parse(variables: &[Vec<u8>]) -> Result<ArrayFile, RecordError> {
    parse_bytes(&LITTLE.file(variables))
}

#[test]
fn fork_is_read_with_its_own_rate() {
    let file = parse_bytes(&std::fs::read(fork_path()).unwrap()).unwrap();
    assert_eq!(file.arrays.iter().map(Array::name).collect::<Vec<_>>(), ["duration", "ActualRate", "data"]);
    assert!(file.others.contains(&("bicycle".into(), class::TEXT.to_string())));
    let reading = file.channel("data").unwrap();
    let record = &reading.record;
    assert_eq!((record.len(), record.rate()), (30_000, 1000.0));
    // As scipy 1.17.1 reads them.
    assert_eq!((record.values()[0], record.values()[29_999]), (0.330_341_827_160_909_3, 1.102_990_257_657_255_7));
    assert_eq!(reading.sampling, Sampling::RateVariable { name: "ActualRate".into(), rate: 1000.0 });
    assert_eq!(Reader::default().read(fork_path()).unwrap(), reading, "the channel is the only candidate");
    assert_eq!(
        file.channel("Data").unwrap_err().to_string(),
        "there is no variable \"Data\"; the file has: duration (1×1), ActualRate (1×1), data (30000×1)"
    );
    assert!(file.channel("part").unwrap_err().to_string().starts_with("the variable \"part\" is text, not"));
}

#[test]
fn all_types_of_numbers_in_both_orders_of_bytes() {
    for writer in [LITTLE, BIG] {
        let data = |little: &[u8], width: usize| -> Vec<u8> {
            let mut bytes = little.to_vec();
            if writer.big {
                bytes.chunks_mut(width).for_each(<[u8]>::reverse);
            }
            bytes
        };
        let pair = |a: &[u8], b: &[u8]| data(&[a, b].concat(), a.len());
        for (class, stored, bytes) in [
            (8, 1, pair(&(-3i8).to_le_bytes(), &100i8.to_le_bytes())),
            (10, 3, pair(&(-3i16).to_le_bytes(), &100i16.to_le_bytes())),
            (12, 5, pair(&(-3i32).to_le_bytes(), &100i32.to_le_bytes())),
            (14, 12, pair(&(-3i64).to_le_bytes(), &100i64.to_le_bytes())),
            (7, 7, pair(&(-3f32).to_le_bytes(), &100f32.to_le_bytes())),
            (6, 9, pair(&(-3f64).to_le_bytes(), &100f64.to_le_bytes())),
            // MATLAB stores doubles that are small whole numbers in small types.
            (6, 1, pair(&(-3i8).to_le_bytes(), &100i8.to_le_bytes())),
            (6, 5, pair(&(-3i32).to_le_bytes(), &100i32.to_le_bytes())),
        ] {
            let file = writer.file(&[writer.array(class, "x", &[2, 1], stored, &bytes)]);
            let file = parse_bytes(&file).unwrap();
            assert_eq!(file.array("x").unwrap().values(), [-3.0, 100.0], "class {class}, type {stored}");
        }
        for (class, stored, bytes) in [
            (9, 2, pair(&[3], &[200])),
            (11, 4, pair(&3u16.to_le_bytes(), &200u16.to_le_bytes())),
            (13, 6, pair(&3u32.to_le_bytes(), &200u32.to_le_bytes())),
            (15, 13, pair(&3u64.to_le_bytes(), &200u64.to_le_bytes())),
        ] {
            let file = writer.file(&[writer.array(class, "x", &[1, 2], stored, &bytes)]);
            assert_eq!(parse_bytes(&file).unwrap().array("x").unwrap().values(), [3.0, 200.0], "type {stored}");
        }
    }
}

#[test]
fn matrices_with_time_and_vectors_beside_time() {
    let thesis = LITTLE.doubles("NF20mm1", &[3, 2], &[0.0, 0.001, 0.002, 5.0, 6.0, 7.0]);
    let reading = parse(std::slice::from_ref(&thesis)).unwrap().channel("NF20mm1").unwrap();
    assert_eq!((reading.record.values(), reading.record.rate()), (&[5.0, 6.0, 7.0][..], 1000.0));
    assert_eq!((&reading.channel[..], reading.time.as_deref()), ("NF20mm1(:,2)", Some("NF20mm1(:,1)")));
    let explicit = parse(&[thesis]).unwrap().read(&Reader::default().channel("NF20mm1(:,1)").rate(10.0));
    assert_eq!(explicit.unwrap().record.values(), [0.0, 0.001, 0.002]);

    let file = parse(&[
        LITTLE.doubles("t", &[1, 3], &[1.0, 1.5, 2.0]),
        compressed(&LITTLE.doubles("v", &[3, 1], &[5.0, 6.0, 7.0])),
        LITTLE.doubles("Ts", &[1, 1], &[0.25]),
    ])
    .unwrap();
    let reading = file.read(&Reader::default()).unwrap();
    assert_eq!((reading.record.start(), reading.record.interval(), &reading.channel[..]), (1.0, 0.5, "v"));
    assert_eq!(reading.sampling.to_string(), "found from the time stamps in \"t\"");

    // Whole numbers count samples.
    let counted = LITTLE.doubles("m", &[3, 2], &[1.0, 2.0, 3.0, 5.0, 6.0, 7.0]);
    let counted = parse(&[counted, LITTLE.doubles("fs", &[1, 1], &[50.0])]).unwrap().channel("m").unwrap();
    assert_eq!((counted.record.rate(), counted.record.values(), counted.time), (50.0, &[5.0, 6.0, 7.0][..], None));
    let millis = [LITTLE.doubles("time_ms", &[1, 3], &[1.0, 2.0, 3.0]), LITTLE.doubles("v", &[1, 3], &[5.0, 6.0, 7.0])];
    assert_eq!(parse(&millis).unwrap().channel("v").unwrap().record.rate(), 1000.0);

    let three = parse(&[LITTLE.doubles("m", &[2, 3], &[0.0, 0.5, 2.5, 3.0, 4.0, 5.0])]).unwrap();
    let error = three.channel("m").unwrap_err().to_string();
    assert_eq!(error, "\"m\" has 2 rows and 3 columns; choose one, as in m(1,:) or m(:,1)");
    assert_eq!(three.channel("m(:,3)").unwrap().record.values(), [4.0, 5.0]);
    assert!(says(&three.channel("m(:,4)"), "there is no"));
    assert!(says(&three.channel("m(:,0)"), "there is no"));
}

#[test]
fn rates_come_from_known_scalars_or_not_at_all() {
    let v = LITTLE.doubles("v", &[3, 1], &[5.0, 6.0, 7.0]);
    let scalar = |name: &str, value: f64| LITTLE.doubles(name, &[1, 1], &[value]);
    for (name, value) in [("Fs", 50.0), ("sample_rate", 50.0), ("dt", 0.02), ("SamplingFrequency", 50.0)] {
        let reading = parse(&[v.clone(), scalar(name, value)]).unwrap().channel("v").unwrap();
        assert!((reading.record.rate() - 50.0).abs() < 1e-12, "{name}");
    }
    let none = parse(&[v.clone(), scalar("mass", 50.0)]).unwrap().channel("v").unwrap_err();
    assert!(none.to_string().ends_with("the file has: v (3×1), mass (1×1)"), "{none}");
    let both = parse(&[v.clone(), scalar("fs", 50.0), scalar("dt", 0.01)]).unwrap().channel("v");
    assert!(says(&both, "give the rate"));
    let zero = parse(&[v.clone(), scalar("fs", 0.0)]).unwrap().channel("v");
    assert!(says(&zero, "the sampling rate must be positive"));
    let two = parse(&[v.clone(), LITTLE.doubles("w", &[3, 1], &[0.0; 3])]).unwrap();
    assert!(says(&two.read(&Reader::default()), "name the channel"));
}

#[test]
fn other_kinds_are_listed_and_named() {
    let complex = LITTLE.array(0x0806, "z", &[1, 1], 9, &[0; 8]);
    let cube = LITTLE.doubles("cube", &[1, 1, 2], &[1.0, 2.0]);
    let empty = LITTLE.doubles("none", &[0, 0], &[]);
    let cell = LITTLE.array(1, "c", &[1, 1], 9, &[]);
    let object = {
        let flags = LITTLE.part(6, &[17, 0, 0, 0, 0, 0, 0, 0]);
        LITTLE.part(14, &[flags, LITTLE.part(1, b"table"), LITTLE.part(1, b"MCOS")].concat())
    };
    let file = parse(&[complex, cube, empty, cell, object]).unwrap();
    assert_eq!(
        file.others,
        [("z", class::COMPLEX), ("c", class::CELL), ("table", class::OBJECT)]
            .map(|(name, kind)| (name.to_owned(), kind.to_string()))
    );
    assert!(says(&file.channel("z"), "is complex, not a real numeric array"));
    assert!(says(&file.channel("cube"), "dimensions; a record is a vector"));
    assert!(says(&file.channel("none"), "there is no"));
}

#[test]
fn other_files_are_told_apart() {
    let mut hdf5 = vec![0; 600];
    hdf5[512..520].copy_from_slice(b"\x89HDF\r\n\x1a\n");
    let mut newest = LITTLE.file(&[]);
    newest[..10].copy_from_slice(b"MATLAB 7.3");
    let mut version = LITTLE.file(&[]);
    version[125] = 2;
    for file in [&hdf5[..], b"\x89HDF\r\n\x1a\n", &newest, &version] {
        let error = Reader::default().parse(file).unwrap_err();
        // Nothing but a header is no HDF5 file either.
        let expected = if cfg!(feature = "hdf5") {
            error.to_string().contains("(HDF5) cannot be read")
        } else {
            error.to_string().contains("7.3")
        };
        assert!(expected, "{error}");
    }
    version[125] = 7;
    assert!(says(&parse_bytes(&version), "unknown version 0x0700"));
    // Version 4 has no header of a file.
    let version_4: Vec<u8> = [0u32, 2, 1, 0, 2].iter().flat_map(|n| n.to_le_bytes()).chain(*b"x\0").collect();
    assert_eq!(parse_bytes(&[&version_4[..], &[0; 16]].concat()).unwrap().array("x").unwrap().values(), [0.0, 0.0]);
    for file in [&b""[..], b"t,v\n0,1\n", &[0; 4000], &[b'x'; 4000]] {
        assert!(says(&parse_bytes(file), "not a MATLAB file"), "{} bytes", file.len());
    }
}

#[test]
fn lies_about_sizes_are_found_out() {
    let mut promise = LITTLE.number(14).to_vec();
    promise.extend_from_slice(&LITTLE.number(u32::MAX));
    let error = parse(&[promise]).unwrap_err();
    assert!(error.to_string().contains("cut off"), "{error}");
    let unknown = parse(&[LITTLE.part(9, &[0; 8])]);
    assert!(says(&unknown, "the variable at byte 128 is of type 9"));
    for dimensions in [&[4, 1][..], &[u32::MAX, u32::MAX], &[70_000, 70_000, 0, 9], &[1 << 31, 2]] {
        let error = parse(&[LITTLE.doubles("x", dimensions, &[1.0, 2.0])]).unwrap().channel("x").unwrap_err();
        assert!(matches!(error, RecordError::Damaged { .. }), "{dimensions:?}: {error}");
    }
    // A promise of more than the limit is refused before anything is expanded.
    let mut bomb = LITTLE.number(14).to_vec();
    bomb.extend_from_slice(&LITTLE.number(MOST_INFLATED as u32 + 8));
    let reason = |variable: &[u8]| parse(&[compressed(variable)]).unwrap().damaged[0].1.to_string();
    assert_eq!(reason(&bomb), "the variables of the file expand to more than 268435456 bytes");
    // Data behind the array that it promises are not expanded either.
    let more = [LITTLE.doubles("x", &[1, 1], &[1.0]), vec![0; 1 << 20]].concat();
    assert!(reason(&more).ends_with("data follow the array"));
}

#[test]
fn a_file_cut_off_anywhere_is_an_error_or_has_fewer_variables() {
    let bytes = std::fs::read(fork_path()).unwrap();
    let whole = parse_bytes(&bytes).unwrap();
    for length in (0..bytes.len()).step_by(97) {
        match parse_bytes(&bytes[..length]) {
            Ok(file) => assert!(whole.arrays.starts_with(&file.arrays), "{length} bytes"),
            Err(RecordError::Damaged { .. } | RecordError::UnknownFormat { .. }) => {}
            Err(error) => panic!("{length} bytes: {error}"),
        }
    }
}

#[test]
fn damaged_files_never_panic() {
    let bytes = std::fs::read(fork_path()).unwrap();
    let plain = BIG.file(&[BIG.doubles("t", &[1, 3], &[1.0, 1.5, 2.0]), BIG.doubles("v", &[3, 1], &[5.0, 6.0, 7.0])]);
    let mut random = Noise::new(11);
    let mut damage = |bytes: &[u8], reach: u64| {
        let mut bytes = bytes.to_vec();
        for _ in 0..=random.next() % 3 {
            let at = (random.next() % reach) as usize;
            bytes[at] = if random.next().is_multiple_of(2) {
                random.next() as u8
            } else {
                bytes[at] ^ (1 << (random.next() % 8))
            };
        }
        // Whether damage shows depends on where it is; reading on must not panic either way.
        if let Ok(file) = parse_bytes(&bytes) {
            let _ = file.read(&Reader::default());
            let _ = file.channel("v");
        }
    };
    for _ in 0..300 {
        damage(&bytes, bytes.len() as u64);
    }
    for _ in 0..3000 {
        damage(&bytes[..0x250], 0x250);
        damage(&plain, plain.len() as u64);
    }
}

/// A structure, one or several in a row, of fields whose contents are whole arrays without a name, element by element.
fn structure(name: &str, count: u32, fields: &[&str], contents: &[Vec<u8>]) -> Vec<u8> {
    let flags = LITTLE.part(6, &[2, 0, 0, 0, 0, 0, 0, 0]);
    let sizes = LITTLE.part(5, &[LITTLE.number(1), LITTLE.number(count)].concat());
    let mut names = Vec::new();
    for field in fields {
        names.extend_from_slice(field.as_bytes());
        names.resize(names.len().next_multiple_of(16), 0);
    }
    // The length of names stands in its tag.
    let length = [LITTLE.number(4 << 16 | 5), LITTLE.number(16)].concat();
    let parts = [flags, sizes, LITTLE.part(1, name.as_bytes()), length, LITTLE.part(1, &names), contents.concat()];
    LITTLE.part(14, &parts.concat())
}

#[test]
fn fields_of_structures_are_variables() {
    let v = LITTLE.doubles("", &[3, 1], &[5.0, 6.0, 7.0]);
    let inner = structure("", 1, &["dt", "v"], &[LITTLE.doubles("", &[1, 1], &[0.5]), v.clone()]);
    let text = LITTLE.array(4, "", &[1, 2], 4, &[b'm', 0, b'm', 0]);
    let run = structure(
        "run",
        1,
        &["t_ms", "x", "unit", "gyro"],
        &[LITTLE.doubles("", &[3, 1], &[0.0, 2.0, 4.0]), v.clone(), text, inner],
    );
    let two = structure(
        "trial",
        2,
        &["fs", "v"],
        &[
            LITTLE.doubles("", &[1, 1], &[10.0]),
            v.clone(),
            LITTLE.doubles("", &[1, 1], &[20.0]),
            LITTLE.doubles("", &[3, 2], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        ],
    );
    let file = parse(&[run, compressed(&two)]).unwrap();
    for (name, rate, values) in [
        ("run.x", 500.0, [5.0, 6.0, 7.0]),
        ("run.gyro.v", 2.0, [5.0, 6.0, 7.0]),
        ("trial(1).v", 10.0, [5.0, 6.0, 7.0]),
        ("trial(2).v(:,2)", 20.0, [4.0, 5.0, 6.0]),
    ] {
        let reading = file.channel(name).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((reading.record.rate(), reading.record.values()), (rate, &values[..]), "{name}");
    }
    assert!(says(&file.channel("run"), "is a structure, not"));
    assert!(says(&file.channel("run.unit"), "is text, not"));
}

#[test]
fn rows_of_a_matrix_are_channels() {
    let file = parse(&[LITTLE.doubles("m", &[2, 4], &[0.0, 5.0, 0.5, 6.0, 1.0, 7.0, 1.5, 8.0])]).unwrap();
    for channel in ["m", "m(2,:)", " m ( 2 , : ) "] {
        let reading = file.channel(channel).unwrap();
        assert_eq!((reading.record.rate(), reading.record.values()), (2.0, &[5.0, 6.0, 7.0, 8.0][..]));
        assert_eq!((&reading.channel[..], reading.time.as_deref()), ("m(2,:)", Some("m(1,:)")));
    }
    let row = file.read(&Reader::default().channel("m(1,:)").rate(10.0)).unwrap();
    assert_eq!(row.record.values(), [0.0, 0.5, 1.0, 1.5]);
    assert!(file.channel("m(3,:)").is_err() && file.channel("m(0,:)").is_err());
    let vector =
        parse(&[LITTLE.doubles("v", &[1, 3], &[5.0, 6.0, 7.0]), LITTLE.doubles("fs", &[1, 1], &[50.0])]).unwrap();
    assert_eq!(vector.channel("v(1,:)").unwrap().record.values(), [5.0, 6.0, 7.0]);
}

#[test]
fn a_damaged_variable_leaves_the_others() {
    let v = LITTLE.doubles("v", &[3, 1], &[5.0, 6.0, 7.0]);
    let fs = LITTLE.doubles("fs", &[1, 1], &[50.0]);
    let mut broken = compressed(&LITTLE.doubles("x", &[200, 1], &[1.5; 200]));
    let end = broken.len();
    broken[end - 1] ^= 1;
    let mut bomb = LITTLE.number(14).to_vec();
    bomb.extend_from_slice(&LITTLE.number(MOST_INFLATED as u32 + 8));
    let wrong = LITTLE.doubles("w", &[4, 1], &[1.0, 2.0]);
    let file = parse(&[broken, v, wrong, compressed(&bomb), fs]).unwrap_or_else(|error| panic!("{error}"));
    let reading = file.channel("v").unwrap();
    assert_eq!((reading.record.values(), reading.record.rate()), (&[5.0, 6.0, 7.0][..], 50.0));
    let error = file.channel("w").unwrap_err().to_string();
    assert_eq!(error, "the variable \"w\" cannot be read: its dimensions do not match its amount of data");
    let none = file.channel("x").unwrap_err().to_string();
    assert!(none.contains("at byte 128"), "the name of what cannot be expanded is not known: {none}");
    // Which one is meant is not known where others cannot be read.
    assert!(says(&file.read(&Reader::default()), "name the channel"));
}

#[test]
fn version_4_is_read() {
    for big in [false, true] {
        let number = |number: u32| if big { number.to_be_bytes() } else { number.to_le_bytes() };
        let double = |value: f64| if big { value.to_be_bytes() } else { value.to_le_bytes() };
        let matrix = |kind: u32, rows: u32, name: &str, values: &[f64]| {
            let kind = kind + if big { 1000 } else { 0 };
            let header = [kind, rows, values.len() as u32 / rows, 0, name.len() as u32 + 1];
            let header = header.into_iter().flat_map(number).chain(name.bytes()).chain([0]);
            header.chain(values.iter().flat_map(|value| double(*value))).collect::<Vec<u8>>()
        };
        let unit: Vec<f64> = "mm/s".bytes().map(f64::from).collect();
        let file = [matrix(0, 1, "fs", &[500.0]), matrix(0, 3, "v", &[1.5, 2.5, -1.0]), matrix(1, 1, "v_unit", &unit)]
            .concat();
        let reading = Reader::default().read_from(&file[..]).unwrap();
        assert_eq!((reading.record.values(), reading.record.rate()), (&[1.5, 2.5, -1.0][..], 500.0));
        assert_eq!((&reading.channel[..], reading.record.unit()), ("v", "mm/s"));
        assert!(says(&parse_bytes(&file[..file.len() - 1]), "is cut off or damaged in the variable (at byte"));
    }
}

#[test]
fn structures_of_testlab_state_increment_and_unit() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/testlab_struct.mat");
    let reading = Reader::default().read(path).unwrap();
    assert_eq!((reading.record.len(), reading.record.rate(), reading.record.unit()), (1500, 500.0, "m/s"));
    assert_eq!(reading.channel, "Signal_0.y_values.values");
}
