//! With what the numbers were made.

const LOCK: &str = include_str!("../../../../Cargo.lock");

/// Crates outside this repository that make numbers or pictures.
const OTHERS: [&str; 9] =
    ["argmin", "kuva", "nalgebra", "pulp", "rand", "rand_chacha", "rand_distr", "rayon", "realfft"];

/// Names and versions of the crates of this repository and of those that make numbers or pictures for it.
pub(super) fn versions() -> Vec<(&'static str, &'static str)> {
    locked(LOCK).filter(|(name, _)| name.starts_with("fmm-") || OTHERS.contains(name)).collect()
}

/// The packages of a lock file.
fn locked(lock: &str) -> impl Iterator<Item = (&str, &str)> {
    lock.split("[[package]]").skip(1).filter_map(|package| {
        let value = |key: &str| package.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
        Some((value("name")?.trim_matches('"'), value("version")?.trim_matches('"')))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_are_found() {
        let versions = versions();
        for name in OTHERS.into_iter().chain(["fmm-model", "fmm-sim", "fmm-identify", "fmm-thesis"]) {
            assert!(versions.iter().any(|(found, version)| *found == name && version.contains('.')), "{name}");
        }
    }
}
