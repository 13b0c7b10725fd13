//! The commands of the program `fmm` for Python. What is friendly about them is written in Python, in `fmm_friction`.

use pyo3::prelude::*;

mod law;

/// Core of the package `fmm_friction`: arguments in, answers out.
#[pymodule(gil_used = false)]
mod _core {
    use std::ffi::OsString;
    use std::fmt::Display;
    use std::ops::ControlFlow;
    use std::path::PathBuf;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::{Mutex, PoisonError};

    use fmm_cli::{Detail, FittedRecord, Host, Refusal};
    use numpy::PyArray1;
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::law::Law;

    /// Sees how far a command is, and stops it.
    #[pyclass(frozen)]
    #[derive(Default)]
    struct Watch {
        message: Mutex<String>,
        is_stopped: AtomicBool,
    }

    #[pymethods]
    impl Watch {
        #[new]
        fn new() -> Self {
            Self::default()
        }

        /// Last step in words.
        #[getter]
        fn message(&self) -> String {
            self.message.lock().unwrap_or_else(PoisonError::into_inner).clone()
        }

        /// Stops the command at its next step.
        fn stop(&self) {
            self.is_stopped.store(true, Ordering::Relaxed);
        }
    }

    impl Watch {
        fn see(&self, message: &str) -> ControlFlow<()> {
            message.clone_into(&mut self.message.lock().unwrap_or_else(PoisonError::into_inner));
            if self.is_stopped.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
    }

    /// Unit, times, measured and fitted values.
    type Fit<'py> = (String, [Bound<'py, PyArray1<f64>>; 3]);

    /// Result of a command.
    #[pyclass(frozen)]
    struct Answer {
        found: Box<dyn fmm_cli::Answer>,
        /// Asked again where a motion is drawn.
        _laws: Vec<Py<Law>>,
    }

    #[pymethods]
    impl Answer {
        fn text(&self, py: Python<'_>) -> PyResult<String> {
            py.detach(|| self.found.text().map_err(failed)).map_err(|refusal| raised(py, refusal))
        }

        fn document(&self, py: Python<'_>, full: bool) -> PyResult<String> {
            let detail = if full { Detail::Full } else { Detail::Brief };
            py.detach(|| self.found.document(detail).map_err(failed)).map_err(|refusal| raised(py, refusal))
        }

        fn pictures(&self, py: Python<'_>) -> PyResult<Vec<(String, String)>> {
            py.detach(|| self.found.pictures().map_err(failed)).map_err(|refusal| raised(py, refusal))
        }

        /// Samples of each record and of the preferred fit.
        fn fits<'py>(&self, py: Python<'py>) -> PyResult<Vec<Fit<'py>>> {
            let fits = py.detach(|| self.found.fits().map_err(failed)).map_err(|refusal| raised(py, refusal))?;
            let arrays = |fit: FittedRecord| {
                (fit.unit, [fit.time, fit.measured, fit.fitted].map(|values| PyArray1::from_vec(py, values)))
            };
            Ok(fits.into_iter().map(arrays).collect())
        }

        fn page(&self, py: Python<'_>) -> PyResult<Option<String>> {
            py.detach(|| self.found.page().map_err(failed)).map_err(|refusal| raised(py, refusal))
        }

        #[getter]
        fn remarks(&self) -> Vec<String> {
            self.found.remarks().to_vec()
        }

        /// Why what was found is a failure nevertheless.
        #[getter]
        fn failure(&self) -> Option<String> {
            self.found.verdict().err()
        }
    }

    /// Answer of the program to `arguments`, of which the first is its command, by `files` that are not on the disk and
    /// `laws` that are not in the catalogue. What a function of a law raised is raised again.
    #[pyfunction]
    fn answer(
        py: Python<'_>,
        arguments: Vec<OsString>,
        files: Vec<(PathBuf, Vec<u8>)>,
        laws: Vec<Py<Law>>,
        watch: &Watch,
    ) -> PyResult<Answer> {
        let arguments = [OsString::from("fmm")].into_iter().chain(arguments);
        let found = py.detach(|| {
            let has_raised = || laws.iter().any(|law| law.get().has_raised());
            let see = |message: &str| if has_raised() { ControlFlow::Break(()) } else { watch.see(message) };
            let host = files
                .into_iter()
                .fold(Host::default().watched_by(see), |host, (name, bytes)| host.with_file(name, bytes));
            let host = laws.iter().fold(host, |host, law| host.with_law(law.get().own()));
            fmm_cli::answer(arguments, &host)
        });
        match laws.iter().find_map(|law| law.get().take_raised()) {
            Some(error) => Err(error),
            None => found.map(|found| Answer { found, _laws: laws }).map_err(|refusal| raised(py, refusal)),
        }
    }

    /// An answer that cannot be given out.
    fn failed(error: impl Display) -> Refusal {
        Refusal { code: "refused", message: error.to_string(), remedy: None }
    }

    /// The exception that a refusal is.
    fn raised(py: Python<'_>, refusal: Refusal) -> PyErr {
        let Refusal { code, message, remedy } = refusal;
        let class = py.import("fmm_friction.errors").and_then(|module| module.getattr("FmmError"));
        match class.and_then(|class| class.call1((code, message, remedy))) {
            Ok(exception) => PyErr::from_value(exception),
            Err(error) => error,
        }
    }
}
