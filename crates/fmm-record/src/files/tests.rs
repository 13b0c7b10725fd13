//! Files of every format through the one door.

use std::path::{Path, PathBuf};

use super::*;
use crate::error::says;
use crate::files::reading::Column;
use crate::sampling::Sampling;
use crate::units::Quantity;
use crate::units::request::Request;

fn bundled(name: &str) -> PathBuf {
    let folder = if name.starts_with("../") { "" } else { "tests/data/" };
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("{folder}{name}"))
}

/// File, format, position and name of a channel, its rate (Hz) and number of samples.
const FILES: [(&str, Format, usize, &str, f64, usize); 10] = [
    ("two_v.csv", Format::Text, 1, "v [m/s]", 1000.0, 4000),
    ("../../examples/data/bicycle_wheel_radial_gyro.csv", Format::Text, 1, "angular_velocity", 500.0, 1001),
    ("../../examples/data/BrowserForkCompoundFirst1.mat", Format::Matlab, 0, "data", 1000.0, 30_000),
    ("../../examples/data/hammer_1.mat", Format::Matlab, 1, "acceleration", 25_600.0, 25_600),
    ("matlab_v73.mat", Format::Hdf5, 1, "NF20mm1(:,2)", 1000.0, 400),
    ("stored.npz", Format::Numpy, 2, "v[:,1]", 512.0, 100),
    ("deflated.npz", Format::Numpy, 1, "v[:,0]", 512.0, 100),
    ("impact_time_ascii.uff", Format::Universal, 1, "velocity trial 2", 512.0, 1024),
    ("impact_time_binary.uff", Format::Universal, 0, "force trial 2", 512.0, 1024),
    ("microphone_binary.uff", Format::Universal, 0, "Mic 01.0Scalar", 65_536.0, 600),
];

#[test]
fn every_format_by_content_and_under_a_wrong_name() {
    let folder = std::env::temp_dir().join(format!("fmm_record_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for (index, (name, format, position, channel, rate, length)) in FILES.into_iter().enumerate() {
        let path = bundled(name);
        let file = open(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        let wrong = folder.join(format!("{index}.{}", ["csv", "mat", "uff", "npy", "txt"][index % 5]));
        std::fs::copy(&path, &wrong).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        for file in [file, open(&wrong).unwrap(), Reader::default().parse(bytes).unwrap()] {
            assert_eq!(file.format(), format, "{name}");
            let channels = file.channels().unwrap();
            let names: Vec<&str> = channels.iter().map(|channel| channel.label.name()).collect();
            let found = channels.iter().find(|channel| channel.position == position);
            let found = found.unwrap_or_else(|| panic!("{name}: {names:?}"));
            assert_eq!((found.label.name(), found.rate), (channel, Some(rate)), "{name}: {names:?}");
            let by_position = file.channel(position).unwrap();
            assert_eq!((by_position.record.len(), by_position.record.rate()), (length, rate), "{name}");
            let by_name = file.channel(Column::Name(channel.into())).unwrap();
            assert_eq!(by_name.record, by_position.record, "{name}");
        }
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_a_format_states_itself_is_not_said_beside_it() {
    let refused = |reader: Reader, name: &str| reader.open(bundled(name)).unwrap_err().to_string();
    let universal = "a Universal File states its own sampling; leave out the rate and the time";
    assert_eq!(refused(Reader::default().rate(1.0), "impact_time_ascii.uff"), universal);
    assert_eq!(refused(Reader::default().time(0), "impact_time_ascii.uff"), universal);
    for name in ["stored.npz", "matlab_v73.mat", "impact_time_binary.uff"] {
        for reader in [Reader::default().skip(2), Reader::default().separator(b';')] {
            assert!(refused(reader, name).ends_with("leave out the separator and the lines to skip"), "{name}");
        }
    }
    for name in ["two_v.csv", "stored.npz", "matlab_v73.mat"] {
        let both = refused(Reader::default().time("t").rate(1.0), name);
        assert_eq!(both, "both time stamps and a rate were given; give one of them", "{name}");
    }
}

#[test]
fn the_caller_says_what_the_file_does_not() {
    let said = Reader::default().channel("v[:,1]").rate(10.0).quantity(Quantity::Velocity).unit("m/s");
    let reading = said.read(bundled("stored.npz")).unwrap();
    assert_eq!((reading.record.rate(), reading.record.unit()), (10.0, "m/s"));
    assert_eq!((reading.record.quantity(), reading.sampling), (Quantity::Velocity, Sampling::Given { rate: 10.0 }));
    // What the format states stands above it.
    let reader = Reader::default().channel(1).quantity(Quantity::Acceleration).unit("V");
    let stated = reader.read(bundled("impact_time_ascii.uff")).unwrap().record;
    assert_eq!((stated.quantity(), stated.unit()), (Quantity::Velocity, "m/s"));
}

#[test]
fn the_channel_that_is_meant_is_chosen_in_every_format() {
    let velocity = Request::default().quantity(Quantity::Velocity);
    let chosen = open(bundled("impact_time_ascii.uff")).unwrap().choose(&velocity).unwrap();
    assert_eq!(chosen.channel, "velocity trial 2");
    let two = "t [s],v1 [m/s],v2 [m/s]\n0.0,1,2\n0.5,2,3\n";
    let refused = Reader::default().parse(two).unwrap().choose(&velocity);
    assert!(says(&refused, "it is not clear which channel is the velocity"));
    let only = open(bundled("../../examples/data/BrowserForkCompoundFirst1.mat")).unwrap();
    assert_eq!(only.choose(&Request::default()).unwrap().channel, "data");
    let numpy = open(bundled("stored.npz")).unwrap();
    assert!(says(&numpy.choose(&Request::default()), "it is not clear which channel is the motion"));
}

#[test]
fn other_files_are_refused_with_what_they_are() {
    let parse = |bytes: &[u8]| Reader::default().parse(bytes);
    assert!(says(&parse(b"\xFD7zXZ\0"), "this file is compressed by xz; unpack it; text, workbooks"));
    assert!(says(&parse(&[0; 99]), "neither text nor a binary format"));
    let missing = open("/no/such/file.mat");
    assert!(matches!(&missing, Err(RecordError::Io { .. })) && says(&missing, "cannot read /no/such/file.mat: "));
    assert!(says(&Reader::default().read_from(""), "empty"));
    // A function that is no record is listed, and says why it is none where it is asked for.
    let spectra = open(bundled("impact_frf_binary.uff")).unwrap();
    assert!(spectra.channels().unwrap().iter().all(|channel| channel.rate.is_none()));
    assert!(says(&spectra.channel(0), "is no record over time, but a frequency response"));
}
