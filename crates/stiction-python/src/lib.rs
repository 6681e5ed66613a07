//! Python binding of stiction-core: module `stiction._native`.

mod arguments;
mod arrays;
mod cancel;
mod catalogue;
mod ensemble;
mod error;
mod friction_model;
mod interrupt;
mod kernel;
mod least_squares;
mod motion;
mod motor;
mod real;
mod shared;
mod smoothing;
mod state;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::cancel::CancelToken;
    #[pymodule_export]
    use super::catalogue::{called, effects, laws};
    #[pymodule_export]
    use super::ensemble::Ensemble;
    #[pymodule_export]
    use super::friction_model::FrictionModel;
    #[pymodule_export]
    use super::kernel::RowKernel;
    #[pymodule_export]
    use super::least_squares::least_squares;
    #[pymodule_export]
    use super::motion::Motion;
    #[pymodule_export]
    use super::motor::Motor;
    #[pymodule_export]
    use super::smoothing::{adaptively_smoothed, played};

    #[pymodule_export]
    #[allow(non_upper_case_globals)] // Python's own name for it
    const __version__: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    #[allow(non_upper_case_globals)] // likewise
    const __profile__: &str = env!("STICTION_PROFILE");

    use pyo3::prelude::*;

    use super::real::real;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        // The list of laws is the catalogue's, and not written down twice.
        let friction_model = module.getattr("FrictionModel")?;
        let doc: String = friction_model.getattr("__doc__")?.extract()?;
        let laws = super::catalogue::list_of_laws();
        friction_model.setattr(
            "__doc__",
            format!("{doc}\n\nLaws (``stiction laws NAME`` shows one):\n\n{laws}"),
        )?;
        super::shared::count_forks(module)
    }

    /// Two floats in, one out: what any method costs before it does anything.
    #[pyclass(frozen, module = "stiction._native")]
    pub(super) struct Nothing;

    #[pymethods]
    impl Nothing {
        #[new]
        fn new() -> Self {
            Self
        }

        /// Returns its first argument.
        #[pyo3(text_signature = "($self, velocity, dt)")]
        fn step(
            &self,
            #[pyo3(from_py_with = real)] velocity: f64,
            #[pyo3(from_py_with = real)] dt: f64,
        ) -> f64 {
            let _ = dt;
            velocity
        }
    }
}
