//! Work on several threads that is ended together.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use pyo3::prelude::*;

thread_local! {
    /// The token under which this thread works.
    static TOKEN: RefCell<Option<Arc<AtomicBool>>> = const { RefCell::new(None) };
}

/// Whether the work of this thread was cancelled.
pub fn cancelled() -> bool {
    TOKEN.with_borrow(|token| token.as_ref().is_some_and(|token| token.load(Ordering::Relaxed)))
}

/// Ends what other threads do under it: a signal is heard by the main thread alone.
#[pyclass(frozen, module = "stiction._native")]
pub struct CancelToken(Arc<AtomicBool>);

#[pymethods]
impl CancelToken {
    #[new]
    fn new() -> Self {
        Self(Arc::default())
    }

    /// From now on long calls under it end with KeyboardInterrupt.
    #[pyo3(text_signature = "($self)")]
    fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Calls some work with an item, under this token.
    #[pyo3(signature = (work, item, /))]
    fn run<'py>(
        &self,
        work: &Bound<'py, PyAny>,
        item: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let before = TOKEN.replace(Some(Arc::clone(&self.0)));
        let result = work.call1((item,));
        TOKEN.set(before);
        result
    }
}
