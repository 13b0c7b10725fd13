//! Rooms of a crate: the files and folders of its `src`, each of which imports only rooms below it.

use std::collections::BTreeSet;

use super::source::{code, crates, files, first_names, text};

/// The rooms of each crate from the bottom to the top. `lib.rs` and `main.rs` are above all.
const ROOMS: &[(&str, &str)] = &[
    (
        "fmm-cli",
        "refusal figure files host answer input output page backbone budget force frf batch posterior report identify scenario \
         design lists simulate commands schemas",
    ),
    (
        "fmm-fit",
        "error algebra problem solver result diagnostics fitting uncertainty robust regression comparison \
         design posterior",
    ),
    ("fmm-frf", "error channel impulse response average friction decay modal modes serialised"),
    ("fmm-friction", "law laws catalogue"),
    (
        "fmm-identify",
        "written error finding law linear_algebra machine candidate threads warning experiment quantities problem residuals \
         fit identification friction_curve design judgement posterior report",
    ),
    (
        "fmm-model",
        "math dimension estimate error parameter scalar damping dual flexure restoring oscillator student symbol unit \
         widest",
    ),
    ("fmm-record", "error numerics sampling units record calculus examination spacing growing serialised files"),
    (
        "fmm-sim",
        "error scenario mechanics trajectory automaton dormand_prince exact fixed_step runge_kutta bristle simulate stepper",
    ),
    (
        "fmm-uq",
        "failure error model moments region rounding conformity distributions groups inputs gum stream validation monte_carlo",
    ),
];

/// A path that leaves a room: the room, the file, and the first name of the path.
struct Import {
    room: String,
    file: String,
    name: String,
}

/// The rooms of a crate, and what they import from each other or from the root of the crate.
fn read(name: &str) -> (BTreeSet<String>, Vec<Import>) {
    let folder = format!("crates/{name}/src");
    let (mut rooms, mut imports) = (BTreeSet::new(), Vec::new());
    for path in files(&folder, &["rs"]) {
        let file = path.strip_prefix(&folder).unwrap().to_str().unwrap().to_owned();
        let parts: Vec<&str> = file.trim_end_matches(".rs").split('/').collect();
        if matches!(parts[0], "lib" | "main") || parts.contains(&"tests") {
            continue;
        }
        let room = parts[0].to_owned();
        rooms.insert(room.clone());
        // The module of the file is so many steps away from the root.
        let depth = parts.iter().filter(|part| **part != "mod").count();
        let code = code(&text(&path));
        for prefix in ["crate::".to_owned(), "super::".repeat(depth)] {
            let names = first_names(&code, &prefix);
            let names = names.into_iter().filter(|name| !matches!(*name, "super" | "self"));
            imports.extend(names.map(|name| Import { room: room.clone(), file: file.clone(), name: name.to_owned() }));
        }
    }
    (rooms, imports)
}

/// Faults in the imports of a crate whose rooms are in this order.
fn faults(name: &str, order: &str) -> Vec<String> {
    let order: Vec<&str> = order.split_whitespace().collect();
    let (rooms, imports) = read(name);
    let place = |room: &str| order.iter().position(|other| *other == room);
    let mut faults = Vec::new();
    let known: BTreeSet<String> = order.iter().map(ToString::to_string).collect();
    faults.extend(rooms.difference(&known).map(|room| format!("{name}: the room {room} is not in the table")));
    faults.extend(known.difference(&rooms).map(|room| format!("{name}: there is no room {room}")));
    for Import { room, file, name: imported } in imports {
        if !rooms.contains(&imported) {
            faults.push(format!("{name}/src/{file}: {imported} comes through the root of the crate; name its module"));
        } else if imported != room && place(&imported) >= place(&room) {
            faults.push(format!("{name}/src/{file}: {imported} is not below {room}"));
        }
    }
    faults
}

#[test]
fn every_room_imports_rooms_below_it_only() {
    let faults: Vec<String> = ROOMS.iter().flat_map(|(name, order)| faults(name, order)).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_crate_has_its_rooms_in_the_table() {
    let mut named: Vec<&str> = ROOMS.iter().map(|(name, _)| *name).collect();
    named.sort_unstable();
    assert_eq!(named, crates());
}
