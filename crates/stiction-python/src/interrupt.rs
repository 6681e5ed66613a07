//! Long calls without the interpreter, and Ctrl-C while they last.

use std::cell::Cell;

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use stiction_core::interrupt::watched;

use crate::cancel::cancelled;

thread_local! {
    /// What the handler of a signal raised.
    static RAISED: Cell<Option<PyErr>> = const { Cell::new(None) };
}

/// Lets Python run the handlers of signals that have come; whether one of them raised. Signals come to
/// the main thread alone: others end where what they work under was cancelled.
fn asks() -> bool {
    if cancelled() {
        return true;
    }
    Python::try_attach(|py| match py.check_signals() {
        Ok(()) => false,
        Err(error) => {
            RAISED.set(Some(error));
            true
        }
    })
    .unwrap_or(false)
}

/// Does long work without the interpreter; a signal whose handler raises ends it with that.
pub fn detached<R: Send>(py: Python<'_>, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    let (result, stopped) = py.detach(|| watched(asks, work));
    if stopped {
        let raised = RAISED.take();
        return Err(raised.unwrap_or_else(|| PyKeyboardInterrupt::new_err(())));
    }
    Ok(result)
}
