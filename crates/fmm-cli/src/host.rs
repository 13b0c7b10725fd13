//! Surroundings of a command: its files, and who sees how far it is.

use std::collections::BTreeMap;
use std::error::Error;
use std::io::Read;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use fmm_friction::OwnLaw;
use fmm_identify::{Candidate, IdentifyError};
use fmm_record::{DataFile, Reader, RecordError};
use indicatif::{ProgressBar, ProgressStyle};
use serde::de::DeserializeOwned;

use crate::refusal::{Kind, placed};

/// Sees how far a command is, from any thread, and may stop it.
type Watcher<'a> = Box<dyn Fn(&str) -> ControlFlow<()> + Send + Sync + 'a>;

/// Surroundings of a command: files that are not on the disk, laws that are not in the catalogue, and who sees how far it
/// is. The default is a shell: files are those of the disk and standard input, and a line on standard error tells how far
/// it is.
#[derive(Default)]
pub struct Host<'a> {
    /// Files by name before those of the disk; pipes and standard input join them when they are read.
    kept: Mutex<BTreeMap<PathBuf, Vec<u8>>>,
    laws: Vec<&'static OwnLaw>,
    watcher: Option<Watcher<'a>>,
    is_stopped: AtomicBool,
}

impl<'a> Host<'a> {
    /// The same with a file of this name and content, which is read instead of one on the disk.
    #[must_use]
    pub fn with_file(self, name: impl Into<PathBuf>, bytes: Vec<u8>) -> Self {
        self.kept().insert(name.into(), bytes);
        self
    }

    /// The same with a law of one's own, which options name like those of the catalogue, and before them.
    #[must_use]
    pub fn with_law(mut self, law: &'static OwnLaw) -> Self {
        self.laws.push(law);
        self
    }

    /// The same with a watcher in place of the line on standard error: it is told each step in words, from any thread,
    /// and stops a search or a fit at its next step by `Break`.
    #[must_use]
    pub fn watched_by(self, watcher: impl Fn(&str) -> ControlFlow<()> + Send + Sync + 'a) -> Self {
        Self { watcher: Some(Box::new(watcher)), ..self }
    }

    fn kept(&self) -> std::sync::MutexGuard<'_, BTreeMap<PathBuf, Vec<u8>>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The laws that are not in the catalogue.
    pub(crate) fn laws(&self) -> &[&'static OwnLaw] {
        &self.laws
    }

    /// The law with terms beside it that is called `name`.
    pub(crate) fn candidate(&self, name: &str) -> Result<Candidate, IdentifyError> {
        Candidate::named_among(name, &self.laws)
    }

    /// Bytes of a file; those of a pipe, or of standard input where the path is `-`, are read once and kept.
    pub(crate) fn bytes(&self, path: &Path) -> Result<Vec<u8>, RecordError> {
        let cannot = |error| RecordError::Io { what: format!("read {}", path.display()), source: Arc::new(error) };
        let mut kept = self.kept();
        if let Some(bytes) = kept.get(path) {
            return Ok(bytes.clone());
        }
        if is_file(path) {
            return std::fs::read(path).map_err(cannot);
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

    /// A file of measured channels, which may come out of a pipe.
    pub(crate) fn open(&self, reader: &Reader, path: &Path) -> Result<DataFile, RecordError> {
        if is_file(path) && !self.kept().contains_key(path) {
            return reader.open(path);
        }
        reader.parse(self.bytes(path)?)
    }

    /// Text of a file.
    pub(crate) fn text(&self, path: &Path) -> Result<String, Box<dyn Error>> {
        let unreadable = |error| Kind::Unreadable.refusal(format!("cannot read {}: {error}", path.display()));
        Ok(String::from_utf8(self.bytes(path)?).map_err(unreadable)?)
    }

    /// Result of the content of a file, which is JSON if its name ends so, and TOML otherwise.
    pub(crate) fn document<F: DeserializeOwned, T>(
        &self,
        path: &Path,
        of: impl FnOnce(F) -> Result<T, Box<dyn Error>>,
    ) -> Result<T, Box<dyn Error>> {
        let text = self.text(path)?;
        let is_json = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
        let wrong = |error: Box<dyn Error>| Kind::Document.unless_known(placed(path.display())(error));
        let file = if is_json {
            serde_json::from_str(&text).map_err(|error| wrong(error.into()))?
        } else {
            toml::from_str(&text).map_err(|error| wrong(error.into()))?
        };
        Ok(of(file).map_err(wrong)?)
    }

    /// Result of `work`, which tells how far it is by the function that it gets; refused if the watcher stopped it.
    pub(crate) fn while_working<T>(
        &self,
        work: impl FnOnce(&(dyn Fn(String) -> ControlFlow<()> + Sync)) -> T,
    ) -> Result<T, Box<dyn Error>> {
        let bar = self.bar()?;
        let done = work(&|message| self.told(&bar, message));
        bar.finish_and_clear();
        if self.is_stopped.load(Ordering::Relaxed) {
            Err(Kind::Stopped.refusal("stopped before the end").into())
        } else {
            Ok(done)
        }
    }

    /// Result of `work` of unknown length, of which only `what` it is can be told.
    pub(crate) fn while_busy<T>(&self, what: &str, work: impl FnOnce() -> T) -> Result<T, Box<dyn Error>> {
        self.while_working(|tell| {
            let _ = tell(format!("{what} …"));
            work()
        })
    }

    /// True if a watcher is told how far a command is.
    pub(crate) fn is_watched(&self) -> bool {
        self.watcher.is_some()
    }

    /// Bar of progress over `count` tasks.
    pub(crate) fn tasks(&self, count: u64, template: &str) -> Result<ProgressBar, Box<dyn Error>> {
        let bar = if self.watcher.is_some() { ProgressBar::hidden() } else { ProgressBar::no_length() };
        bar.set_length(count);
        Ok(bar.with_style(ProgressStyle::with_template(template)?))
    }

    /// A line on standard error that turns while work of unknown length is done.
    fn bar(&self) -> Result<ProgressBar, Box<dyn Error>> {
        if self.watcher.is_some() {
            return Ok(ProgressBar::hidden());
        }
        let bar = ProgressBar::new_spinner().with_style(ProgressStyle::with_template("{spinner} {msg}")?);
        bar.enable_steady_tick(Duration::from_millis(100));
        Ok(bar)
    }

    /// Shows or passes on a `message`.
    pub(crate) fn told(&self, bar: &ProgressBar, message: String) -> ControlFlow<()> {
        let Some(watcher) = &self.watcher else {
            bar.set_message(message);
            return ControlFlow::Continue(());
        };
        let flow = watcher(&message);
        if flow.is_break() {
            self.is_stopped.store(true, Ordering::Relaxed);
        }
        flow
    }
}

/// True unless the path is one of a pipe or of standard input.
fn is_file(path: &Path) -> bool {
    path.is_file() || (!path.exists() && path != Path::new("-"))
}
