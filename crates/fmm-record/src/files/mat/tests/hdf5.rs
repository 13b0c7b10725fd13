use crate::error::RecordError;
use crate::sampling::Sampling;
use crate::tests::synthetic::Noise;
use super::{class, parse_hdf5 as parse_bytes};

fn file() -> Vec<u8> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/matlab_v73.mat");
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn variables_of_all_classes() {
    let file = parse_bytes(&file()).unwrap();
    let arrays: Vec<String> = file.arrays.iter().map(ToString::to_string).collect();
    assert_eq!(
        arrays,
        ["Fs (1×1)", "NF20mm1 (400×2)", "counts (2×3)", "empty (0×0)", "flag (1×1)", "s (5×1)", "info.mass (1×1)"]
    );
    let mut others = file.others.clone();
    others.sort_by(|a, b| a.0.cmp(&b.0));
    let expected = [("c", class::CELL), ("info", class::STRUCTURE), ("note", class::TEXT), ("z", class::COMPLEX)];
    assert_eq!(others, expected.map(|(name, kind)| (name.to_owned(), kind.to_string())));
    // Rows of HDF5 are columns of MATLAB.
    assert_eq!(file.array("counts").unwrap().values(), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(file.array("s").unwrap().values(), [0.0, 0.25, 0.5, 0.75, 1.0]);
    assert!(file.channel("z").unwrap_err().to_string().starts_with("the variable \"z\" is complex"));
}

#[test]
fn a_matrix_in_deflated_chunks() {
    let file = parse_bytes(&file()).unwrap();
    let reading = file.channel("NF20mm1").unwrap();
    assert_eq!((reading.record.rate(), reading.record.len(), &reading.channel[..]), (1000.0, 400, "NF20mm1(:,2)"));
    for (time, value) in reading.record.times().zip(reading.record.values()) {
        let exact = (-3.0 * time).exp() * (std::f64::consts::TAU * 6.0 * time).cos();
        // Rounded to 12 bits when it was written.
        assert!((value - exact).abs() <= 0.5 / 4096.0 + 1e-12, "{value} for {exact} at {time} s");
    }
    let by_rate = file.channel("s").unwrap();
    assert_eq!(by_rate.sampling, Sampling::RateVariable { name: "Fs".into(), rate: 1000.0 });
}

#[test]
fn a_file_cut_off_anywhere_is_an_error() {
    let bytes = file();
    for length in (0..bytes.len()).step_by(64) {
        let error = parse_bytes(&bytes[..length]).unwrap_err();
        let typed = matches!(error, RecordError::Damaged { .. });
        assert!(typed, "{length} bytes: {error}");
    }
}

#[test]
fn damaged_files_never_panic() {
    let bytes = file();
    let mut random = Noise::new(73);
    let (mut read, mut refused) = (0, 0);
    for _ in 0..1000 {
        let mut damaged = bytes.clone();
        for _ in 0..=random.next() % 3 {
            let at = 512 + (random.next() % (bytes.len() as u64 - 512)) as usize;
            damaged[at] = if random.next().is_multiple_of(2) {
                random.next() as u8
            } else {
                damaged[at] ^ (1 << (random.next() % 8))
            };
        }
        match parse_bytes(&damaged) {
            Ok(file) => {
                read += 1;
                let _ = file.channel("NF20mm1");
            }
            Err(_) => refused += 1,
        }
    }
    assert!(read > 0 && refused > 0, "{read} files were read, {refused} refused");
}

#[test]
fn promises_beyond_the_file_are_refused() {
    let bytes = file();
    // The dimensions of the chunked matrix, 2 and 400, as they stand in the file, made far larger.
    let dimensions: Vec<u8> = [2u64, 400].iter().flat_map(|size| size.to_le_bytes()).collect();
    let at = bytes.windows(16).position(|window| window == dimensions).unwrap();
    for (rows, columns) in [(2, 2_508_876), (1 << 24, 400), (u64::MAX, u64::MAX), (1 << 13, 1 << 12)] {
        let mut damaged = bytes.clone();
        damaged[at..at + 8].copy_from_slice(&u64::to_le_bytes(rows));
        damaged[at + 8..at + 16].copy_from_slice(&u64::to_le_bytes(columns));
        let error = parse_bytes(&damaged).unwrap().channel("NF20mm1").unwrap_err();
        assert!(matches!(error, RecordError::Damaged { .. }), "{error}");
    }
}

#[test]
fn a_damaged_variable_leaves_the_others() {
    let mut bytes = file();
    let dimensions: Vec<u8> = [2u64, 400].iter().flat_map(|size| size.to_le_bytes()).collect();
    let at = bytes.windows(16).position(|window| window == dimensions).unwrap();
    bytes[at..at + 8].copy_from_slice(&u64::MAX.to_le_bytes());
    let file = parse_bytes(&bytes).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.channel("s").unwrap().record.rate(), 1000.0);
    assert!(file.channel("NF20mm1").unwrap_err().to_string().starts_with("the variable \"NF20mm1\" cannot be read"));
}

#[test]
fn a_link_that_leads_nowhere_leaves_the_others() {
    let mut bytes = file();
    // The second entry of the first node of the symbol table becomes a symbolic link.
    let node = bytes.windows(4).position(|window| window == b"SNOD").unwrap();
    let entry = node + 8 + 40;
    bytes[entry + 8..entry + 16].copy_from_slice(&u64::MAX.to_le_bytes());
    bytes[entry + 16..entry + 20].copy_from_slice(&2u32.to_le_bytes());
    let damaged = parse_bytes(&bytes).unwrap_or_else(|error| panic!("{error}"));
    let whole = parse_bytes(&file()).unwrap();
    let lost: Vec<_> = whole.arrays.iter().filter(|array| damaged.array(array.name()).is_err()).collect();
    assert!(lost.len() <= 1, "{lost:?}");
    assert_eq!(damaged.channel("NF20mm1").unwrap().record, whole.channel("NF20mm1").unwrap().record);
}

#[test]
fn a_damaged_object_header_leaves_the_others() {
    let whole = parse_bytes(&file()).unwrap();
    let mut lost = 0;
    // The entries of the first node of the symbol table: address of an object behind the header of MATLAB; the header
    // of the object begins with its version.
    let bytes = file();
    let node = bytes.windows(4).position(|window| window == b"SNOD").unwrap();
    let count = usize::from(u16::from_le_bytes([bytes[node + 6], bytes[node + 7]]));
    for entry in (0..count).map(|index| node + 8 + 40 * index) {
        let address = u64::from_le_bytes(*bytes[entry + 8..].first_chunk().unwrap()) as usize + 512;
        let mut bytes = bytes.clone();
        bytes[address] = 0xEE;
        let file = parse_bytes(&bytes).unwrap_or_else(|error| panic!("{error}"));
        let [(name, reason)] = &file.damaged[..] else { panic!("{:?}", file.damaged) };
        assert!(!reason.to_string().is_empty() && whole.damaged.is_empty());
        lost += usize::from(whole.array(name).is_ok());
        for array in whole.arrays.iter().filter(|array| array.name().split('.').next() != Some(name)) {
            assert_eq!(file.array(array.name()).unwrap(), array, "{name} is damaged");
        }
    }
    assert!(lost > 1, "{lost} arrays");
}

#[test]
fn fields_of_structures_are_variables() {
    let file = parse_bytes(&file()).unwrap();
    assert_eq!(file.array("info.mass").unwrap().values().len(), 1);
}

#[test]
fn attributes_state_unit_and_rate() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/hdf5_attributes.h5");
    let file = crate::files::open(path).unwrap();
    let reading = file.reading().unwrap();
    assert_eq!((reading.record.len(), reading.record.rate(), reading.record.unit()), (1500, 500.0, "m/s"));
    let channels = file.channels().unwrap();
    assert_eq!(channels[0].label.unit().map(crate::units::WrittenUnit::si), Some("m/s"));
}
