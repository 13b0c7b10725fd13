//! Files: their text, the documents in them, and folders, with errors that name the path.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Display;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use fmm_record::{DataFile, Reader, RecordError};
use serde::Serializer;
use serde::de::DeserializeOwned;

/// Puts the path of a file before an error.
pub(crate) fn named<E: Display>(path: &Path) -> impl Fn(E) -> String {
    move |error| format!("{}: {error}", path.display())
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

/// Bytes of a file; those of a pipe, or of standard input where the path is `-`, are read once and kept.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>, String> {
    static KEPT: Mutex<BTreeMap<PathBuf, Vec<u8>>> = Mutex::new(BTreeMap::new());
    let cannot = |error| format!("cannot read {}: {error}", path.display());
    if is_file(path) {
        return std::fs::read(path).map_err(cannot);
    }
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(bytes) = kept.get(path) {
        return Ok(bytes.clone());
    }
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        std::io::stdin().read_to_end(&mut bytes).map_err(cannot)?;
    } else {
        bytes = std::fs::read(path).map_err(cannot)?;
    }
    kept.insert(path.to_owned(), bytes.clone());
    Ok(bytes)
}

/// True unless the path is one of a pipe or of standard input.
fn is_file(path: &Path) -> bool {
    path.is_file() || (!path.exists() && path != Path::new("-"))
}

/// A file of measured channels, which may come out of a pipe.
pub(crate) fn open(reader: &Reader, path: &Path) -> Result<DataFile, RecordError> {
    if is_file(path) {
        return reader.open(path);
    }
    let read = bytes(path).map_err(|error| RecordError::Io {
        what: format!("read {}", path.display()),
        source: Arc::new(std::io::Error::other(error)),
    });
    reader.parse(read?)
}

/// Text of a file.
pub(crate) fn text(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|error| format!("cannot read {}: {error}", path.display()))
}

/// Result of the content of a file, which is JSON if its name ends so, and TOML otherwise.
pub(crate) fn document<F: DeserializeOwned, T>(
    path: &Path,
    of: impl FnOnce(F) -> Result<T, Box<dyn Error>>,
) -> Result<T, Box<dyn Error>> {
    let text = text(path)?;
    let is_json = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    let file = if is_json {
        serde_json::from_str(&text).map_err(named(path))?
    } else {
        toml::from_str(&text).map_err(named(path))?
    };
    Ok(of(file).map_err(named(path))?)
}

/// Creates a folder unless it exists.
pub(crate) fn create_folder(path: &Path) -> Result<(), String> {
    std::fs::create_dir_all(path).map_err(|error| format!("cannot create {}: {error}", path.display()))
}

/// Refuses a path at which no file can be, before work is done for it.
pub(crate) fn require_writable(path: &Path) -> Result<(), String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if path.is_dir() {
        return Err(format!("cannot write {}: it is a folder; give the name of a file", path.display()));
    }
    if folder.is_dir() {
        Ok(())
    } else {
        Err(format!("cannot write {}: there is no folder {}", path.display(), folder.display()))
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
