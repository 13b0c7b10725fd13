//! A law of friction whose formula is a function of Python.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use fmm_friction::{FamilyVisitor, LawFamily, LawParameter, OwnLaw, Role, SpeedFormula, family_named};
use fmm_model::{Bounds, Parameter};
use numpy::{AllowTypeChange, PyArray1, PyArrayLike1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyFloatMethods, PyTuple};

/// Formula of a law, and its derivatives if they are known.
#[derive(Debug)]
struct Functions {
    coefficient: Py<PyAny>,
    derivatives: Option<Py<PyAny>>,
    /// The first error that a function raised.
    raised: Mutex<Option<PyErr>>,
}

impl Functions {
    /// Keeps what a function raised; without a number, the fit cannot go on.
    fn kept<T>(&self, result: PyResult<T>) -> Option<T> {
        result.map_err(|error| self.keep(error)).ok()
    }

    fn keep(&self, error: PyErr) {
        let _ = self.raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }

    /// Numbers of an array, of one number for each of `points`, or of one for all.
    fn numbers(found: &Bound<'_, PyAny>, points: usize, what: &str) -> PyResult<Vec<f64>> {
        // An array of one number is no number to NumPy.
        let numbers: Vec<f64> = if let Ok(array) = found.cast::<PyArray1<f64>>() {
            array.readonly().as_array().iter().copied().collect()
        } else if let Ok(number) = found.cast::<PyFloat>() {
            return Ok(vec![number.value(); points]);
        } else if let Ok(array) = found.extract::<PyArrayLike1<'_, f64, AllowTypeChange>>() {
            array.as_array().iter().copied().collect()
        } else {
            return Ok(vec![found.extract()?; points]);
        };
        if numbers.len() == points {
            return Ok(numbers);
        }
        let length = numbers.len();
        Err(PyValueError::new_err(format!(
            "{what} must give an array as long as its arguments, {points}, or a number, but gave one of length {length}"
        )))
    }
}

/// Functions that go with the law of Python, while what the crates know of it stays.
#[derive(Debug)]
struct Lent(Weak<Functions>);

impl SpeedFormula for Lent {
    fn coefficients(&self, arguments: &[Vec<f64>]) -> Vec<f64> {
        let points = arguments.first().map_or(0, Vec::len);
        self.0
            .upgrade()
            .and_then(|functions| functions.coefficients(arguments))
            .unwrap_or_else(|| vec![f64::NAN; points])
    }

    fn derivatives(&self, arguments: &[f64]) -> Option<Vec<f64>> {
        self.0.upgrade()?.derivatives(arguments)
    }
}

impl Functions {
    fn coefficients(&self, arguments: &[Vec<f64>]) -> Option<Vec<f64>> {
        let points = arguments.first().map_or(0, Vec::len);
        Python::attach(|py| {
            let arrays = arguments.iter().map(|argument| PyArray1::from_slice(py, argument));
            let found = PyTuple::new(py, arrays).and_then(|arrays| self.coefficient.bind(py).call1(arrays));
            self.kept(found.and_then(|found| Self::numbers(&found, points, "the function of a law")))
        })
    }

    fn derivatives(&self, arguments: &[f64]) -> Option<Vec<f64>> {
        let derivatives = self.derivatives.as_ref()?;
        let found = Python::attach(|py| {
            let arrays = arguments.iter().map(|argument| PyArray1::from_slice(py, &[*argument]));
            let found = PyTuple::new(py, arrays).and_then(|arrays| derivatives.bind(py).call1(arrays));
            let numbers = found.and_then(|found| {
                let each = found.try_iter()?.map(|one| Ok(Self::numbers(&one?, 1, "each derivative")?[0]));
                let numbers: Vec<f64> = each.collect::<PyResult<_>>()?;
                if numbers.len() == arguments.len() {
                    return Ok(numbers);
                }
                let (given, wanted) = (numbers.len(), arguments.len());
                let what = "the derivatives of a law are those by the speed and by each parameter";
                Err(PyValueError::new_err(format!("{what}, {wanted}, but there are {given}")))
            });
            self.kept(numbers)
        });
        Some(found.unwrap_or_else(|| vec![f64::NAN; arguments.len()]))
    }
}

/// Names of families.
struct Names;

impl FamilyVisitor for Names {
    type Output = &'static str;

    fn visit<F: LawFamily>(&mut self) -> &'static str {
        F::NAME
    }
}

/// A law of friction of one's own. Its functions live as long as it does; name and parameters, some hundred bytes, stay
/// for the process, as the crates hold laws so.
#[pyclass(frozen)]
pub(crate) struct Law {
    own: &'static OwnLaw,
    functions: Arc<Functions>,
}

#[pymethods]
impl Law {
    /// A law by its name, its parameters (name, unit, role, relative start value, bounds), its function, and that of its
    /// derivatives.
    #[new]
    fn new(
        name: String,
        parameters: Vec<Stated>,
        coefficient: Py<PyAny>,
        derivatives: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        if let Some(taken) = family_named(&name, &mut Names) {
            return Err(PyValueError::new_err(format!("{taken} is a law of the list; give yours another name")));
        }
        let functions = Arc::new(Functions { coefficient, derivatives, raised: Mutex::default() });
        let parameters = parameters.into_iter().map(parameter).collect::<PyResult<Vec<_>>>()?;
        let law = OwnLaw::new(name, parameters, Box::new(Lent(Arc::downgrade(&functions))));
        let law = law.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Self { own: Box::leak(Box::new(law)), functions })
    }
}

impl Law {
    /// The law.
    pub(crate) fn own(&self) -> &'static OwnLaw {
        self.own
    }

    /// True if a function of it raised an exception that was not taken.
    pub(crate) fn has_raised(&self) -> bool {
        self.functions.raised.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// The exception that a function of it raised.
    pub(crate) fn take_raised(&self) -> Option<PyErr> {
        self.functions.raised.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Name, unit, role, relative start value and bounds of a parameter.
type Stated = (String, String, String, f64, (f64, f64));

/// The parameter that is stated so.
fn parameter((name, unit, role, typical, (lower, upper)): Stated) -> PyResult<LawParameter> {
    let refused = |error: &dyn std::fmt::Display| PyValueError::new_err(format!("{name}: {error}"));
    let role = match role.as_str() {
        "level" => Role::Level,
        "excess" => Role::Excess,
        "slope" => Role::Slope,
        "shape" => Role::Shape,
        _ => return Err(refused(&format!("{role:?} is no role; there are level, excess, slope and shape"))),
    };
    let bounds = Bounds::new(lower, upper).map_err(|error| refused(&error))?;
    let parameter = Parameter::named(name.clone(), name, unit).bounded(bounds);
    Ok(LawParameter::new(parameter, role).typically(typical))
}
