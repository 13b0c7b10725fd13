//! Paths in sentences and documents, folders, and files that are written, with errors that name the path.

use std::fmt::Display;
use std::path::Path;

use serde::Serializer;

use crate::refusal::{Kind, OfKind};

/// Puts the path of a file before a sentence.
pub(crate) fn named<E: Display>(path: &Path) -> impl Fn(E) -> String {
    move |sentence| format!("{}: {sentence}", path.display())
}

/// Says of an error that a path cannot be written.
pub(crate) fn unwritable(path: &Path) -> impl Fn(std::io::Error) -> OfKind {
    move |error| Kind::Unwritable.refusal(format!("cannot write {}: {error}", path.display()))
}

/// Name of a file without its folder.
pub(crate) fn name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Path in a document for readers, with a sign in place of what is not Unicode.
pub(crate) fn shown<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}

/// Path in a document that finds the file again: as text, or by its bytes where these are not Unicode.
pub(crate) mod exact {
    use std::ffi::OsString;
    use std::path::{Path, PathBuf};

    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
        match path.to_str() {
            Some(text) => serializer.serialize_str(text),
            None => path.as_os_str().serialize(serializer),
        }
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PathBuf, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Text(String),
            Bytes(OsString),
        }
        Ok(match Written::deserialize(deserializer)? {
            Written::Text(text) => text.into(),
            Written::Bytes(name) => name.into(),
        })
    }
}

/// Creates a folder unless it exists.
pub(crate) fn create_folder(path: &Path) -> Result<(), OfKind> {
    let refused = |error| Kind::Unwritable.refusal(format!("cannot create {}: {error}", path.display()));
    std::fs::create_dir_all(path).map_err(refused)
}

/// Refuses a path at which no file can be, before work is done for it.
pub(crate) fn require_writable(path: &Path) -> Result<(), OfKind> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if path.is_dir() {
        let what = format!("cannot write {}: it is a folder; give the name of a file", path.display());
        return Err(Kind::Unwritable.refusal(what));
    }
    if folder.is_dir() {
        Ok(())
    } else {
        let what = format!("cannot write {}: there is no folder {}", path.display(), folder.display());
        Err(Kind::Unwritable.refusal(what))
    }
}

/// Writes a file at once: no other process ever sees a part of it.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), String> {
    // Another process may write the same file with the same content.
    let mut part = path.as_os_str().to_owned();
    part.push(format!(".part-{}", std::process::id()));
    let unwritable = |error| format!("cannot write {}: {error}", path.display());
    std::fs::write(&part, text).map_err(unwritable)?;
    std::fs::rename(&part, path).map_err(unwritable)
}
