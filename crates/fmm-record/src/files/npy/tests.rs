use std::io::Write;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::parse as parse_bytes;
use crate::error::says;
use crate::files::Reader;
use crate::files::arrays::Array;
use crate::sampling::Sampling;
use crate::tests::synthetic::Noise;

/// An array in version `version` of the format, with `data` behind a header for `shape`.
fn npy(version: u8, descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}");
    // The data begin at a multiple of 64 bytes.
    while (header.len() + 11) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut file = b"\x93NUMPY".to_vec();
    file.extend([version, 0]);
    match version {
        1 => file.extend((header.len() as u16).to_le_bytes()),
        _ => file.extend((header.len() as u32).to_le_bytes()),
    }
    file.extend(header.bytes());
    file.extend_from_slice(data);
    file
}

fn doubles(shape: &str, values: &[f64]) -> Vec<u8> {
    npy(1, "<f8", false, shape, &values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>())
}

fn npz(method: CompressionMethod, entries: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, data) in entries {
        writer.start_file(*name, SimpleFileOptions::default().compression_method(method)).unwrap();
        writer.write_all(data).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn file(name: &str) -> Vec<u8> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn files_of_numpy() {
    // numpy 2.4.6: savez and savez_compressed of t, v (Fortran order, two columns), fs, counts, note.
    for name in ["stored.npz", "deflated.npz"] {
        let file = parse_bytes(&file(name)).unwrap();
        assert_eq!(file.arrays.iter().map(Array::name).collect::<Vec<_>>(), ["t", "v", "fs", "counts"], "{name}");
        assert_eq!(
            file.others,
            [(
                "note".to_owned(),
                "of type <U4 (read are integers of up to 64 bits, and real numbers of 32 or 64)".to_owned()
            )]
        );
        let reading = file.channel("v[:,1]").unwrap();
        assert_eq!((reading.record.len(), reading.record.rate(), reading.time.as_deref()), (100, 512.0, Some("t")));
        let expected: Vec<f64> = (0..100).map(|i| f64::from(i * i) / 8.0).collect();
        assert_eq!(reading.record.values(), expected);
        assert_eq!(file.array("counts").unwrap().values(), [-3.0, 200.0, 5.0]);
        assert_eq!(
            file.channel("note").unwrap_err().to_string(),
            "the variable \"note\" is of type <U4 (read are integers of up to 64 bits, and real numbers of 32 or 64), \
             not a real numeric array; the file has: t (100), v (100, 2), fs (), counts (3)"
        );
    }
    // numpy.save of a matrix in Fortran order and of the other order of bytes.
    let single = parse_bytes(&file("big_endian.npy")).unwrap();
    assert_eq!(single.array("").unwrap().shape(), [2, 3]);
    assert_eq!(single.array("").unwrap().values(), [0.0, 0.5, 1.0, -3.5, 4.25, 1e-300]);
}

#[test]
fn all_types_of_numbers_in_both_orders_of_bytes() {
    for big in [false, true] {
        for (descr, little, expected) in [
            ("i1", vec![(-3i8).to_le_bytes().to_vec(), 100i8.to_le_bytes().to_vec()], [-3.0, 100.0]),
            ("i2", vec![(-3i16).to_le_bytes().to_vec(), 100i16.to_le_bytes().to_vec()], [-3.0, 100.0]),
            ("i4", vec![(-3i32).to_le_bytes().to_vec(), 100i32.to_le_bytes().to_vec()], [-3.0, 100.0]),
            ("i8", vec![(-3i64).to_le_bytes().to_vec(), 100i64.to_le_bytes().to_vec()], [-3.0, 100.0]),
            ("u1", vec![vec![3], vec![200]], [3.0, 200.0]),
            ("b1", vec![vec![0], vec![1]], [0.0, 1.0]),
            ("u2", vec![3u16.to_le_bytes().to_vec(), u16::MAX.to_le_bytes().to_vec()], [3.0, 65_535.0]),
            ("u4", vec![3u32.to_le_bytes().to_vec(), u32::MAX.to_le_bytes().to_vec()], [3.0, 4_294_967_295.0]),
            ("u8", vec![3u64.to_le_bytes().to_vec(), (1u64 << 63).to_le_bytes().to_vec()], [3.0, 2f64.powi(63)]),
            ("f4", vec![(-3f32).to_le_bytes().to_vec(), 0.1f32.to_le_bytes().to_vec()], [-3.0, f64::from(0.1f32)]),
            ("f8", vec![(-3f64).to_le_bytes().to_vec(), 0.1f64.to_le_bytes().to_vec()], [-3.0, 0.1]),
        ] {
            let order = |mut bytes: Vec<u8>| {
                if big {
                    bytes.reverse();
                }
                bytes
            };
            let data = little.into_iter().flat_map(order).collect::<Vec<u8>>();
            let mark = if descr.ends_with('1') {
                "|"
            } else if big {
                ">"
            } else {
                "<"
            };
            for version in 1..=3 {
                let file = parse_bytes(&npy(version, &format!("{mark}{descr}"), false, "(2,)", &data)).unwrap();
                assert_eq!(file.array("").unwrap().values(), expected, "{mark}{descr}");
            }
        }
    }
}

#[test]
fn fortran_order_becomes_row_after_row() {
    let columns: Vec<u8> = vec![0, 10, 20, 1, 11, 21, 100, 110, 120, 101, 111, 121];
    let file = parse_bytes(&npy(1, "|u1", true, "(3, 2, 2)", &columns)).unwrap();
    let expected = [0.0, 100.0, 1.0, 101.0, 10.0, 110.0, 11.0, 111.0, 20.0, 120.0, 21.0, 121.0];
    assert_eq!(file.array("").unwrap().values(), expected);
    assert!(says(&file.channel(""), "dimensions; a record is a vector"));
    let none = parse_bytes(&npy(1, "|u1", true, "(3, 0)", &[])).unwrap();
    assert_eq!((none.array("").unwrap().values(), none.array("").unwrap().shape()), (&[][..], &[3, 0][..]));
    assert!(says(&none.channel("[:,0]"), "there is no"));
}

#[test]
fn channels_with_time_beside_them() {
    let rows = parse_bytes(&doubles("(2, 3)", &[0.0, 0.5, 1.0, 5.0, 6.0, 7.0])).unwrap();
    let columns = parse_bytes(&doubles("(3, 2)", &[0.0, 5.0, 0.5, 6.0, 1.0, 7.0])).unwrap();
    for (file, channel, time) in [(&rows, "[1]", "[0]"), (&columns, "[:,1]", "[:,0]")] {
        let found = file.read(&Reader::default()).unwrap();
        assert_eq!((found.record.values(), found.record.rate()), (&[5.0, 6.0, 7.0][..], 2.0));
        assert_eq!((&found.channel[..], found.time.as_deref()), (channel, Some(time)));
        assert_eq!(file.channel(channel).unwrap(), found);
        let given = file.read(&Reader::default().channel(time).rate(10.0)).unwrap();
        assert_eq!((given.record.values(), given.record.rate()), (&[0.0, 0.5, 1.0][..], 10.0));
    }
    let three = parse_bytes(&doubles("(3, 2)", &[5.0, 0.0, 6.0, 1.0, 8.0, 3.0])).unwrap();
    assert_eq!(
        three.channel("").unwrap_err().to_string(),
        "the array has 3 rows and 2 columns; choose one, as in [0] or [:,0]"
    );
    assert_eq!(three.channel("[:,2]").unwrap_err().to_string(), "there is no [:,2]; the array is (3, 2)");
    assert!(says(&three.channel("[1]"), "the sampling rate is not known"));
    assert!(says(&three.channel("x"), "there is no variable"));

    let stored = CompressionMethod::Stored;
    let with = |name: &str, value: f64| {
        let entries = [("v.npy", doubles("(1, 3)", &[5.0, 6.0, 7.0])), (name, doubles("()", &[value]))];
        parse_bytes(&npz(stored, &entries)).unwrap().read(&Reader::default())
    };
    let fs = with("fs.npy", 50.0).unwrap();
    assert_eq!(fs.sampling, Sampling::RateVariable { name: "fs".into(), rate: 50.0 });
    assert!((with("dt.npy", 0.02).unwrap().record.rate() - 50.0).abs() < 1e-12);
    assert!(says(&with("mass.npy", 50.0), "the sampling rate is not known"));
    assert!(says(&with("fs.npy", -1.0), "the sampling rate must be positive"));
    let both = [
        ("v.npy", doubles("(2,)", &[5.0, 6.0])),
        ("fs.npy", doubles("(1,)", &[50.0])),
        ("dt.npy", doubles("()", &[0.01])),
        ("w.npy", doubles("(2,)", &[5.0, 6.0])),
    ];
    let both = parse_bytes(&npz(stored, &both)).unwrap();
    assert!(says(&both.channel("v"), "give the rate"));
    assert!(says(&both.read(&Reader::default()), "name the channel"));
    let empty = parse_bytes(&npz(stored, &[])).unwrap();
    assert_eq!(empty.read(&Reader::default()).unwrap_err().to_string(), "the file has no real numeric arrays");
}

#[test]
fn lies_about_sizes_are_found_out() {
    for shape in ["(3,)", "(2508876,)", "(1000000, 1000000)"] {
        let error = parse_bytes(&doubles(shape, &[1.0, 2.0])).unwrap_err();
        assert!(error.to_string().contains("cut off"), "{shape}: {error}");
    }
    assert!(says(&parse_bytes(&doubles("(1,)", &[1.0, 2.0])), "data follow the array"));
    let mut header = npy(2, "<f8", false, "(1,)", &[0; 8]);
    header[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(says(&parse_bytes(&header), "the array is cut off"));
    header[6] = 4;
    assert!(says(&parse_bytes(&header), "known are 1 to 3"));
    let deflated = CompressionMethod::Deflated;
    let reason = |entries: &[(&str, Vec<u8>)]| {
        let error = parse_bytes(&npz(deflated, entries)).unwrap().channel("x").unwrap_err();
        error.to_string().strip_prefix("the variable \"x\" cannot be read: ").unwrap().to_owned()
    };
    let many = [("x.npy", doubles("(40000000,)", &[0.0; 1000]))];
    assert_eq!(reason(&many), "the variables of the file expand to more than 268435456 bytes");
    let few = [("x.npy", doubles("(2000,)", &[0.0; 1000]))];
    assert!(reason(&few).ends_with("it promises 16000 bytes, but 8000 are there"));
    let more = [("x.npy", doubles("(1,)", &vec![0.0; 100_000]))];
    assert!(reason(&more).starts_with("data follow the array"));
    let text = [("x.txt", b"text".to_vec()), ("x.npy", b"text".to_vec())];
    assert!(reason(&text).ends_with("it promises 8 bytes, but 4 are there"));
    for bytes in [&b""[..], b"t,v\n0,1\n", &[0; 500], b"P"] {
        assert!(says(&parse_bytes(bytes), "not a file of NumPy"), "{bytes:?}");
    }
    assert!(says(&parse_bytes(b"PK"), "the archive cannot be read"));
}

#[test]
fn files_cut_off_anywhere_are_errors() {
    for name in ["stored.npz", "deflated.npz", "big_endian.npy"] {
        let bytes = file(name);
        for length in (0..bytes.len()).step_by(64).chain(bytes.len() - 64..bytes.len()) {
            assert!(parse_bytes(&bytes[..length]).is_err(), "{name}, {length} bytes");
        }
    }
}

#[test]
fn damaged_files_never_panic() {
    let mut random = Noise::new(80);
    for name in ["stored.npz", "deflated.npz", "big_endian.npy"] {
        let bytes = file(name);
        for _ in 0..1000 {
            let mut damaged = bytes.clone();
            for _ in 0..=random.next() % 3 {
                let at = (random.next() % bytes.len() as u64) as usize;
                damaged[at] = if random.next().is_multiple_of(2) {
                    random.next() as u8
                } else {
                    damaged[at] ^ (1 << (random.next() % 8))
                };
            }
            // Whether damage shows depends on where it is; reading on must not panic either way.
            if let Ok(file) = parse_bytes(&damaged) {
                let _ = (file.read(&Reader::default()), file.channel("v[:,1]"), file.channel("[1]"));
            }
        }
    }
}

#[test]
fn a_damaged_array_leaves_the_others() {
    let mut archive = npz(
        CompressionMethod::Stored,
        &[
            ("x.npy", doubles("(4,)", &[1.0; 4])),
            ("v.npy", doubles("(3,)", &[5.0, 6.0, 7.0])),
            ("fs.npy", doubles("()", &[50.0])),
            ("y.npy", b"text".to_vec()),
        ],
    );
    // LZMA (14) is what the first member is said to be compressed with, in its own header and in the directory.
    for (signature, at) in [(b"PK\x03\x04", 8), (b"PK\x01\x02", 10)] {
        let header = archive.windows(4).position(|window| window == signature).unwrap();
        archive[header + at] = 14;
    }
    let file = parse_bytes(&archive).unwrap_or_else(|error| panic!("{error}"));
    let reading = file.channel("v").unwrap();
    assert_eq!((reading.record.values(), reading.record.rate()), (&[5.0, 6.0, 7.0][..], 50.0));
    for name in ["x", "y"] {
        let error = file.channel(name).unwrap_err().to_string();
        assert!(error.starts_with(&format!("the variable \"{name}\" cannot be read: ")), "{error}");
    }
    assert!(says(&file.read(&Reader::default()), "name the channel"), "which one is not known");
}

#[test]
fn an_array_is_found_without_its_unit() {
    let vector = |value: f64| doubles("(2,)", &[value, value]);
    let entries = [
        ("t [s].npy", doubles("(2,)", &[0.0, 0.5])),
        ("velocity [m/s].npy", vector(1.0)),
        ("x [m].npy", vector(2.0)),
        ("x [mm].npy", vector(3.0)),
    ];
    let file = parse_bytes(&npz(CompressionMethod::Stored, &entries)).unwrap();
    let reading = file.channel("velocity").unwrap();
    assert_eq!(
        (&*reading.channel, reading.record.values(), reading.record.rate()),
        ("velocity [m/s]", &[1.0, 1.0][..], 2.0)
    );
    assert!(says(
        &file.channel("x"),
        "2 variables are called \"x\": \"x [m]\" at position 2, \"x [mm]\" at position 3"
    ));
}
