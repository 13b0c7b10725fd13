//! Campaigns of simulated records: no file is lost, any split gives the same bytes, and the interval holds.

mod manifest;
mod pooled;
mod summary;

use std::path::{Path, PathBuf};

use std::collections::BTreeMap;

use super::row::{Found, Outcome, Part, Told};
use super::*;

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join("fmm-cli").join(format!("batch-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A decay with friction of this level (m/s²) and white-looking noise, as text.
fn decay(level: f64, seed: u64) -> String {
    use fmm_friction::CoulombViscous;
    use fmm_model::Oscillator;
    use fmm_sim::{Engine, Exact, Sampling, Scenario};
    let law = CoulombViscous::new(level, 0.05).unwrap();
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
    let scenario = scenario.starting_at(0.02, 0.0).unwrap();
    let motion = Exact.run(&scenario, &Sampling::uniform(5e-3, 800).unwrap()).unwrap();
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut text = "t [s],v [mm/s]\n".to_owned();
    for (i, velocity) in motion.velocity().values().iter().enumerate() {
        text.extend([format!("{:.3},{:.6}\n", i as f64 * 5e-3, 1e3 * (velocity + 1e-3 * noise()))]);
    }
    text
}

fn records(folder: &Path, levels: &[f64]) -> Vec<PathBuf> {
    let one = |(i, level): (usize, &f64)| {
        let path = folder.join(format!("run_{i:02}.csv"));
        std::fs::write(&path, decay(*level, i as u64)).unwrap();
        path
    };
    levels.iter().enumerate().map(one).collect()
}

/// No question beside the rows.
const NOTHING: Asked = Asked { joint: false, count_doubtful: false, against: Vec::new() };

fn law() -> Vec<String> {
    vec!["--law".to_owned(), LAW.to_owned()]
}

#[test]
fn parts_are_read_as_they_are_meant() {
    assert_eq!((shard("1/1"), shard("3/10")), (Ok((1, 1)), Ok((3, 10))));
    for wrong in ["0/3", "4/3", "1", "a/b", "1/0", "-1/3"] {
        assert!(shard(wrong).is_err(), "{wrong}");
    }
}

/// Broken files are rows with their reason, and any split into parts, in any order, with parts done twice, gives the
/// same bytes.
#[test]
fn any_split_gives_the_same_bytes() {
    let home = folder("split");
    let data = home.join("data");
    std::fs::create_dir_all(&data).unwrap();
    records(&data, &[0.02, 0.021, 0.019, 0.02, 0.022]);
    std::fs::write(data.join("empty.csv"), "").unwrap();
    std::fs::write(data.join("words.csv"), "this,is\nno,record\n").unwrap();
    std::fs::write(data.join("noise.bin"), [0_u8, 159, 146, 150]).unwrap();
    let campaign = Campaign::of_files(&[data], law()).unwrap();
    assert_eq!(campaign.entries.len(), 8);
    assert!(campaign.require_column("lab").unwrap_err().ends_with("; there are file"));
    let done = |name: &str, parts: &[(usize, usize)]| {
        let out = home.join(name);
        campaign.keep(&out).unwrap();
        for (part, parts) in parts {
            for index in
                (part - 1..8).step_by(*parts).filter(|index| Row::is_due(&out, *index, &campaign.entries[*index]))
            {
                Row::of(&campaign, index, &Host::default()).write(&out, index).unwrap();
            }
        }
        put_together(&out, campaign.clone(), &NOTHING, &Host::default()).unwrap();
        ["campaign.csv", "campaign.json", "campaign.html", "campaign.jsonld"]
            .map(|name| std::fs::read(out.join(name)).unwrap())
    };
    let whole = done("whole", &[(1, 1)]);
    assert!(
        whole == done("three", &[(3, 3), (1, 3), (2, 3), (1, 3)]) && whole == done("mixed", &[(2, 2), (1, 5), (1, 1)])
    );
    let read = |index: usize| Row::read(&home.join("whole"), index, &campaign.entries[index]);
    let rows: Vec<Row> = (0..8).map(|index| read(index).unwrap()).collect();
    assert_eq!(rows.iter().filter_map(Row::found).count(), 5);
    assert!(rows.iter().all(|row| !matches!(&row.outcome, Outcome::Refused(why) if why.is_empty())));
    // A row of which only a part was written is done again, and one that does not say what was stated.
    std::fs::write(home.join("whole/rows/0000003.json"), "{\"file\":").unwrap();
    let found =
        home.join("whole/rows").join(format!("{:07}.json", rows.iter().position(|row| row.found().is_some()).unwrap()));
    let text = std::fs::read_to_string(&found).unwrap();
    std::fs::write(&found, text.replace("\"stated\":[],", "")).unwrap();
    assert_eq!((0..8).filter(|index| read(*index).is_none()).count(), 2);
    assert!(whole == done("whole", &[(1, 1)]));
    // Another campaign does not go into the same folder.
    let other = Campaign { options: Vec::new(), ..campaign.clone() };
    assert!(other.keep(&home.join("whole")).is_err());
}

/// Runs at three loads, listed as CSV and as TOML.
fn three_loads(home: &Path) -> [PathBuf; 2] {
    let loads = [2.0, 2.0, 4.0, 4.0, 8.0, 8.0];
    // Friction of μ N by 10 kg, with a coefficient of 0.1 that differs by a hundredth.
    let levels: Vec<f64> =
        loads.iter().zip([1.01, 0.99, 1.0, 1.012, 0.992, 0.997]).map(|(load, factor)| 0.1 * load * factor).collect();
    records(home, &levels.iter().map(|level| level / 10.0).collect::<Vec<_>>());
    let mut csv = "file,mass,mass_u,normal_load,unit,operator,temperature\n".to_owned();
    let mut toml = "group = \"operator\"\n[common]\nmass = 10\nmass_u = 0.01\nunit = \"mm/s\"\n".to_owned();
    for (run, load) in loads.iter().enumerate() {
        let (operator, temperature) = (["A", "B"][run % 2], 20 + run);
        csv.extend([format!("run_{run:02}.csv,10,0.01,{load},mm/s,{operator},{temperature}\n")]);
        toml.extend([format!(
            "[[record]]\nfile = \"run_{run:02}.csv\"\nnormal_load = {load}\noperator = \"{operator}\"\ntemperature = \
             {temperature}\n"
        )]);
    }
    toml += "[sheet]\nmoving_material = \"steel\"\nnormal_load = \"dead weight\"\n[sheet.further]\ngrease_batch = 7\n";
    [("runs.csv", csv), ("runs.toml", toml)].map(|(name, text)| {
        std::fs::write(home.join(name), text).unwrap();
        home.join(name)
    })
}

fn rows(campaign: &Campaign) -> Vec<Row> {
    (0..campaign.entries.len()).map(|index| Row::of(campaign, index, &Host::default())).collect()
}

/// Records that were excluded, corrected or added since, and those that were measured anew, are done again in the same
/// folder, and nothing else is.
#[test]
fn what_changed_is_done_again() {
    let home = folder("changed");
    records(&home, &[0.02, 0.0202, 0.03]);
    let (manifest, out) = (home.join("runs.csv"), home.join("out"));
    let listed = |lines: &str| {
        std::fs::write(&manifest, format!("file,exclude,operator\n{lines}")).unwrap();
        let campaign = Campaign::of_manifest(&manifest, law(), None, &Host::default()).unwrap();
        campaign.keep(&out).unwrap();
        let due = |index: &usize| Row::is_due(&out, *index, &campaign.entries[*index]);
        let due: Vec<usize> = (0..campaign.entries.len()).filter(due).collect();
        for index in &due {
            Row::of(&campaign, *index, &Host::default()).write(&out, *index).unwrap();
        }
        due
    };
    assert_eq!(listed("run_00.csv,,A\nrun_01.csv,,B\n"), [0, 1]);
    assert!(listed("run_00.csv,,A\nrun_01.csv,,B\n").is_empty());
    assert_eq!(listed("run_00.csv,,A\nrun_01.csv,a finger,B\nrun_02.csv,,A\n"), [1, 2]);
    let later = std::time::SystemTime::now() + std::time::Duration::from_secs(5);
    std::fs::File::options().append(true).open(home.join("run_02.csv")).unwrap().set_modified(later).unwrap();
    assert_eq!(listed("run_00.csv,,A\nrun_01.csv,a finger,B\nrun_02.csv,,A\n"), [2]);
}

/// A name that is not Unicode is found, printed with a sign, and found again.
#[cfg(unix)]
#[test]
fn names_that_are_not_unicode_are_found() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let home = folder("bytes");
    let data = home.join("data");
    std::fs::create_dir_all(&data).unwrap();
    records(&data, &[0.02]);
    std::fs::rename(data.join("run_00.csv"), data.join(OsStr::from_bytes(b"caf\xe9.csv"))).unwrap();
    let campaign = Campaign::of_files(&[data], law()).unwrap();
    let all = rows(&campaign);
    let summary = Summary::of(&campaign, &all, &NOTHING, None);
    assert!(
        all[0].found().is_some() && table::document(&all, &summary).unwrap().contains("caf\u{fffd}.csv"),
        "{all:?}"
    );
    let out = home.join("out");
    campaign.keep(&out).unwrap();
    all[0].write(&out, 0).unwrap();
    assert!(
        Row::read(&out, 0, &campaign.entries[0]).is_some_and(|row| row.found().is_some())
            && Campaign::read(&out).unwrap() == campaign
    );
}
