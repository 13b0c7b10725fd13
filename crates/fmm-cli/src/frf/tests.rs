//! The command `frf`: the same blows from files of every format, and files that should be refused.

use std::io::Write;
use std::path::{Path, PathBuf};

use fmm_frf::ResponseForm;
use fmm_record::uff::{ByteOrder, DataSet, Form, UffFile, write};
use fmm_record::{Quantity, Record};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::analysis::{Analysis, Window};
use super::trials::{Channels, Trial};
use crate::host::Host;
use crate::input::Layout;

const ACCELERATION: Channels = Channels {
    force: None,
    response: None,
    quantity: Some(Quantity::Acceleration),
    force_scale: None,
    response_scale: None,
    rate: None,
    layout: Layout { skip: 0, table: None, repair: false },
};

const VELOCITY: Channels = Channels { quantity: Some(Quantity::Velocity), ..ACCELERATION };

/// A new folder for the files of a test.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join("fmm-cli").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn workspace(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// The hammer records that come with the examples.
fn hammers() -> Vec<PathBuf> {
    (1..=3).map(|hit| workspace(&format!("examples/data/hammer_{hit}.mat"))).collect()
}

fn read(choice: &Channels, path: &Path) -> Trial {
    choice.read(path, &Host::default()).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn refusal(choice: &Channels, path: &Path) -> String {
    choice
        .read(path, &Host::default())
        .err()
        .map_or_else(|| panic!("{} was read", path.display()), |error| error.to_string())
}

fn bundled() -> Vec<Trial> {
    hammers().iter().map(|path| read(&ACCELERATION, path)).collect()
}

/// The bytes of an npy file.
pub(super) fn npy(shape: &str, values: &[f64]) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    let mut file = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    file.extend(format!("{header:<117}\n").bytes());
    file.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    file
}

fn write_npz(path: &Path, arrays: &[(&str, &str, &[f64])]) {
    let mut archive = ZipWriter::new(std::fs::File::create(path).unwrap());
    for (name, shape, values) in arrays {
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        archive.start_file(format!("{name}.npy"), options).unwrap();
        archive.write_all(&npy(shape, values)).unwrap();
    }
    archive.finish().unwrap();
}

/// Function that makes a file of a blow, in one format.
type Writer = fn(&Path, &Trial);

fn sets(trial: &Trial) -> [DataSet; 2] {
    let mut sets = [DataSet::of_record(&trial.response), DataSet::of_record(&trial.force)];
    for set in &mut sets {
        set.header.lines[0] = "channel".into();
    }
    sets
}

#[test]
fn the_same_blows_from_every_format() {
    let folder = folder("formats");
    let blows = bundled();
    let expected = Analysis::of(&blows, ResponseForm::Accelerance, Window::None, 0.01).unwrap();
    let formats: [(&str, Writer); 4] = [
        // Both data sets have one name, so that their quantities must tell them apart.
        ("bytes.uff", |path, trial| write(path, &sets(trial), Form::Binary(ByteOrder::default())).unwrap()),
        ("text.58", |path, trial| write(path, &sets(trial), Form::Ascii).unwrap()),
        ("archive.npz", |path, trial| {
            let rate = [trial.force.rate()];
            let (force, response) = (trial.force.values(), trial.response.values());
            let shape = format!("({},)", force.len());
            write_npz(path, &[("fs", "()", &rate), ("acceleration", &shape, response), ("force", &shape, force)]);
        }),
        ("matrix.npy", |path, trial| {
            let (times, count) = (trial.force.times(), trial.force.len());
            let rows = times.chain(trial.force.values().iter().copied()).chain(trial.response.values().iter().copied());
            std::fs::write(path, npy(&format!("(3, {count})"), &rows.collect::<Vec<_>>())).unwrap();
        }),
    ];
    for (name, write) in formats {
        let from_files = blows.iter().enumerate().map(|(hit, trial)| {
            let path = folder.join(format!("{hit}_{name}"));
            write(&path, trial);
            read(&ACCELERATION, &path)
        });
        let trials: Vec<Trial> = from_files.collect();
        let found = Analysis::of(&trials, ResponseForm::Accelerance, Window::None, 0.01).unwrap();
        // Text has 13 digits, half a unit of which is 5e-13 of every sample; summed over a pulse and its noise they
        // stay below 1e-11 of the best lines of the force, and at the last usable line it is a tenth of that. Time
        // stamps give the rate to 1e-11 or so.
        let relative = 1e-9;
        for (found, expected) in found.impulses.iter().zip(&expected.impulses) {
            assert!((found / expected - 1.0).abs() < relative, "{name}: {found} N s, not {expected} N s");
        }
        let lines = expected.h1.frequencies().iter().take_while(|frequency| **frequency <= expected.usable).count();
        assert!(lines > 1000, "{lines} lines");
        let scale = expected.h1.values()[..lines].iter().map(|value| value.norm()).fold(0.0, f64::max);
        for line in 0..lines {
            let (found, expected) = (found.h1.values()[line], expected.h1.values()[line]);
            let off = (found - expected).norm();
            assert!(off <= relative * scale, "{name}, line {line}: {found}, not {expected} (largest {scale}) 1/kg");
        }
        let peaks = |analysis: &Analysis| analysis.peaks.iter().map(|peak| peak.line.frequency).collect::<Vec<_>>();
        let (found, expected) = (peaks(&found), peaks(&expected));
        assert_eq!(found.len(), expected.len(), "{name}");
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found / expected - 1.0).abs() < relative, "{name}: a peak at {found} Hz, not {expected} Hz");
        }
    }
}

/// Two programs wrote one measurement: as whole numbers of 1e-4 N and 1e-8 m/s, and its second trial in Universal
/// Files.
#[test]
fn a_measurement_in_universal_files() {
    let measured = fmm_record::open(workspace("crates/fmm-frf/tests/data/impact4.mat")).unwrap();
    let numbers = |name: &str, unit: f64| -> Vec<f64> {
        measured.array(name).unwrap().values()[..1024].iter().map(|value| value / unit).collect()
    };
    // Doubles in bytes are exact, and text has 13 digits.
    for (file, relative) in [("impact_time_binary.uff", 0.0), ("impact_time_ascii.uff", 5e-13)] {
        let path = workspace("crates/fmm-record/tests/data").join(file);
        for choice in [
            VELOCITY,
            Channels { force: Some("0".to_owned()), response: Some("velocity trial 2".to_owned()), ..VELOCITY },
        ] {
            let trial = read(&choice, &path);
            assert_eq!((trial.force.rate(), trial.response.rate(), trial.warnings), (512.0, 512.0, vec![]), "{file}");
            assert!(trial.origin.starts_with("force trial 2 and velocity trial 2;"), "{}", trial.origin);
            for (record, expected) in
                [(trial.force, numbers("force2", 1e4)), (trial.response, numbers("velocity2", 1e8))]
            {
                assert_eq!(record.len(), expected.len(), "{file}");
                for (found, expected) in record.values().iter().zip(expected) {
                    // One more rounding from decimals.
                    let limit = if relative > 0.0 { (relative + f64::EPSILON) * expected.abs() } else { 0.0 };
                    assert!((found - expected).abs() <= limit, "{file}: {found}, not {expected}");
                }
            }
        }
    }
}

#[test]
fn channels_that_are_not_there_or_not_what_they_should_be() {
    let data = workspace("crates/fmm-record/tests/data");
    let (times, responses) = (data.join("impact_time_binary.uff"), data.join("impact_frf_binary.uff"));
    for (choice, path, expected) in [
        (
            Channels { response: Some("2".to_owned()), ..VELOCITY },
            &times,
            "there is no channel 2; there are, counted from 0: force trial 2, velocity trial 2",
        ),
        (
            Channels { response: Some("microphone".to_owned()), ..VELOCITY },
            &times,
            "there is no data set \"microphone\"; the file has: \"force trial 2\", \"velocity trial 2\"",
        ),
        (
            ACCELERATION,
            &times,
            "which channel is the acceleration? Name it, or say with --quantity what the response is; there are: force \
             trial 2, velocity trial 2",
        ),
        (
            Channels { response: Some("1".to_owned()), ..ACCELERATION },
            &times,
            "the file says that velocity trial 2 is a velocity, and no acceleration",
        ),
        (
            Channels { response: Some("force trial 2".to_owned()), ..VELOCITY },
            &times,
            "channel force trial 2 cannot be both force and response",
        ),
        (
            Channels { rate: Some(512.0), ..VELOCITY },
            &times,
            "a Universal File states its own sampling; leave out the rate and the time",
        ),
        (
            Channels { force: Some("0".to_owned()), response: Some("mobility H1".to_owned()), ..VELOCITY },
            &responses,
            "channel mobility H1 cannot be both force and response",
        ),
        (
            Channels { force: Some("mobility H1".to_owned()), response: Some("none".to_owned()), ..VELOCITY },
            &responses,
            "\"mobility H1\" is no record over time, but a frequency response",
        ),
    ] {
        assert_eq!(refusal(&choice, path), expected);
    }
}

/// Nobody is told that an acceleration is a mobility: what the response measured is said by somebody, or refused.
#[test]
fn a_response_is_what_its_channel_says_or_refused() {
    const SILENT: Channels = Channels { quantity: None, ..ACCELERATION };
    for path in hammers() {
        assert_eq!(read(&SILENT, &path).response.quantity(), Quantity::Acceleration);
    }
    let folder = folder("silent");
    let path = folder.join("x.npy");
    std::fs::write(&path, npy("(3, 4)", &[0.0, 0.5, 1.0, 1.5, 0.0, 1.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0])).unwrap();
    for choice in [SILENT, Channels { force: Some("0".to_owned()), response: Some("1".to_owned()), ..SILENT }] {
        let refused = refusal(&choice, &path);
        assert!(refused.starts_with("no channel says what the response measured; give --quantity"), "{refused}");
    }
    assert_eq!(read(&ACCELERATION, &path).response.quantity(), Quantity::Acceleration);
    let text = |header: &str| {
        let path = folder.join("x.csv");
        std::fs::write(&path, format!("{header}\n0.0,0,1\n0.1,5,2\n0.2,1,3\n")).unwrap();
        path
    };
    let trial = read(&SILENT, &text("t [s],F [N],a [m/s^2]"));
    assert_eq!((trial.response.quantity(), trial.response.values()), (Quantity::Acceleration, &[1.0, 2.0, 3.0][..]));
    assert_eq!(read(&SILENT, &text("t,hammer force,gyro velocity")).response.quantity(), Quantity::Velocity);
    let refused = refusal(&SILENT, &text("t [s],F [N],a [g]"));
    assert!(refused.ends_with("give the factor that turns it into m/s² as --response-scale"), "{refused}");
}

#[test]
fn units_are_not_taken_for_others() {
    let path = folder("units").join("millimetres.uff");
    let record = |quantity, unit: &str| {
        let values = [0.0, 1.0, 2.0, 1.0, 0.0].into();
        Record::sampled(512.0, values, quantity, unit).unwrap()
    };
    let sets =
        [record(Quantity::Force, "N"), record(Quantity::Velocity, "mm/s")].map(|record| DataSet::of_record(&record));
    write(&path, &sets, Form::Ascii).unwrap();
    let refused = refusal(&VELOCITY, &path);
    assert!(
        refused.ends_with(" is in \"mm/s\"; give the factor that turns it into m/s as --response-scale"),
        "{refused}"
    );
    let trial = read(&Channels { response_scale: Some(1e-3), ..VELOCITY }, &path);
    assert_eq!((trial.response.values()[2], trial.response.unit()), (2e-3, "m/s"));
    assert_eq!((trial.force.values()[2], trial.force.unit()), (2.0, "N"));
}

/// Each reader is told by the content of the file, and says what is wrong with it.
#[test]
fn files_that_are_something_else() {
    let folder = folder("something_else");
    for name in ["a.uff", "a.unv", "a.58", "a.UF", "a.npy", "a.npz", "a.mat", "a.csv"] {
        for bytes in
            [&b""[..], b"<!DOCTYPE html>", b"PK\x03\x04", b"\x93NUMPY", b"    -1\n    58\n", b"\x89HDF\r\n\x1a\n"]
        {
            let path = folder.join(name);
            std::fs::write(&path, bytes).unwrap();
            assert!(!refusal(&ACCELERATION, &path).is_empty(), "{name}");
        }
        assert!(refusal(&ACCELERATION, &folder.join(format!("missing_{name}"))).contains("missing_"), "{name}");
    }
    // A data set that ends early is read as far as it goes, with a warning.
    let path = folder.join("short.uff");
    write(&path, &sets(&bundled()[0]), Form::Ascii).unwrap();
    let text = std::fs::read(&path).unwrap();
    std::fs::write(&path, &text[..text.len() - 100]).unwrap();
    assert!(!UffFile::read(&path).unwrap().warnings().is_empty());
    assert!(!read(&ACCELERATION, &path).warnings.is_empty());
}

/// A blow and the velocity of modes of these frequencies (Hz), with a damping ratio of 1 %.
fn struck(frequencies: &[f64]) -> Trial {
    const RATE: f64 = 8192.0;
    let time = |i: usize| i as f64 / RATE;
    let force = |i: usize| if (100..103).contains(&i) { 50.0 } else { 0.0 };
    // A step of the force makes a sine in each mode; the blow is one up and one down.
    let step = |t: f64, frequency: &f64| {
        let angular = std::f64::consts::TAU * frequency;
        if t > 0.0 { (-0.01 * angular * t).exp() * (angular * t).sin() / angular } else { 0.0 }
    };
    let velocity = |i: usize| {
        let noise = 1e-6 * (1.7 * (i * i % 10_007) as f64).sin();
        let of_mode = |mode: &f64| 50.0 * (step(time(i) - time(100), mode) - step(time(i) - time(103), mode));
        frequencies.iter().map(of_mode).sum::<f64>() + noise
    };
    let record = |at: &dyn Fn(usize) -> f64, quantity: Quantity, unit: &str| {
        Record::sampled(RATE, (0..8192).map(at).collect(), quantity, unit).unwrap()
    };
    Trial {
        name: "struck".to_owned(),
        force: record(&force, Quantity::Force, "N"),
        response: record(&velocity, Quantity::Velocity, "m/s"),
        origin: String::new(),
        warnings: Vec::new(),
    }
}

/// Two modes that make one peak are said by what the fit of one leaves, and the change with the lines is in its
/// uncertainty; one alone is not.
#[test]
fn two_modes_in_one_peak_are_said() {
    let analysed = |modes: &[f64]| {
        let trials = [struck(modes), struck(modes)];
        Analysis::of(&trials, ResponseForm::Mobility, Window::None, 0.01).unwrap()
    };
    let is_said = |analysis: &Analysis| {
        analysis.warnings.iter().any(|warning| warning.contains("Hz by one mode leaves") && !warning.contains("2731"))
    };
    let (one, two) = (analysed(&[1000.0]), analysed(&[994.0, 1010.0]));
    assert!(!is_said(&one), "{:?}", one.warnings);
    assert!(is_said(&two), "{:?}", two.warnings);
    let [of_one, of_two] = [&one, &two].map(|analysis| analysis.peaks[0].fit.unwrap().natural_frequency);
    assert!((of_one.value - 1000.0).abs() < 0.2 && of_one.uncertainty < 0.2, "{of_one}");
    assert!(of_two.uncertainty > 5.0 * of_one.uncertainty, "{of_two} beside {of_one}");
}
