//! `Verdict`: the answer of one check.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::domain;

/// The answer of one check: a verdict, a number and a sentence a lab engineer can act on.
#[pyclass(frozen, get_all, module = "gonio", name = "Verdict")]
pub(crate) struct Verdict {
    /// Stable name of the check.
    pub(crate) id: String,
    /// Title for people.
    pub(crate) title: String,
    /// pass, warn, fail or info.
    pub(crate) verdict: String,
    /// The number behind it, or None.
    pub(crate) value: Option<f64>,
    /// Unit of `value`; empty when it has none.
    pub(crate) unit: String,
    /// What was found and what to do.
    pub(crate) sentence: String,
}

#[pymethods]
impl Verdict {
    #[new]
    #[pyo3(signature = (*, id, title, verdict, sentence, value=None, unit=String::new()))]
    fn new(
        id: String,
        title: String,
        verdict: String,
        sentence: String,
        value: Option<f64>,
        unit: String,
    ) -> PyResult<Self> {
        if !["pass", "warn", "fail", "info"].contains(&verdict.as_str()) {
            return Err(domain(
                "verdict",
                format!("{verdict:?}"),
                "pass, warn, fail, info",
            ));
        }
        Ok(Verdict {
            id,
            title,
            verdict,
            value,
            unit,
            sentence,
        })
    }

    /// Plain values of every field.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("id", &self.id)?;
        dict.set_item("title", &self.title)?;
        dict.set_item("verdict", &self.verdict)?;
        dict.set_item("value", self.value)?;
        dict.set_item("unit", &self.unit)?;
        dict.set_item("sentence", &self.sentence)?;
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        format!("Verdict({}: {}: {})", self.id, self.verdict, self.sentence)
    }
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Verdict>()
}
