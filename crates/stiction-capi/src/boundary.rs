//! What every function at the boundary does: check, catch, report.

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

use stiction_core::error::Error;

/// What became of a call.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// The request cannot be carried out; nothing has changed.
    Refused = 1,
    /// A pointer that is needed is NULL; nothing has changed.
    Null = 2,
    /// An error of the library: free the handle, and please report it.
    Internal = 3,
}

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::new(CString::default());
}

/// Why a call did not do what was asked.
pub(crate) enum Problem {
    Refused(String),
    Null(&'static str),
}

impl From<Error> for Problem {
    fn from(error: Error) -> Self {
        Self::Refused(error.to_string())
    }
}

pub(crate) fn message() -> *const c_char {
    MESSAGE.with_borrow(|message| message.as_ptr())
}

fn report(text: String) {
    let text = CString::new(text.replace('\0', "?")).unwrap_or_default();
    MESSAGE.with_borrow_mut(|message| *message = text);
}

/// Runs the body of a function; no panic gets beyond.
pub(crate) fn guarded(body: impl FnOnce() -> Result<(), Problem>) -> Status {
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(Problem::Refused(text))) => {
            report(text);
            Status::Refused
        }
        Ok(Err(Problem::Null(name))) => {
            report(format!("{name} is NULL; give a valid pointer"));
            Status::Null
        }
        Err(_) => {
            report("stiction failed inside; free this handle and report it".to_owned());
            Status::Internal
        }
    }
}

/// The object behind a handle.
///
/// # Safety
/// `handle` is NULL or was made by this library, not freed, and is used by no other thread.
pub(crate) unsafe fn held<'a, T>(handle: *mut T, name: &'static str) -> Result<&'a mut T, Problem> {
    // SAFETY: by the contract above the pointer is NULL or points to a live T that is ours alone.
    unsafe { handle.as_mut() }.ok_or(Problem::Null(name))
}

/// Writes a result.
///
/// # Safety
/// `target` is NULL or points to a T that may be written.
pub(crate) unsafe fn put<T>(target: *mut T, value: T, name: &'static str) -> Result<(), Problem> {
    if target.is_null() {
        return Err(Problem::Null(name));
    }
    // SAFETY: not NULL, and writable by the contract above; nothing old is dropped.
    unsafe { target.write(value) };
    Ok(())
}

/// An array of the caller's; NULL is allowed where it is empty.
///
/// # Safety
/// `first` is NULL or points to `count` initialised values that nobody changes meanwhile.
pub(crate) unsafe fn slice<'a, T>(
    first: *const T,
    count: usize,
    name: &'static str,
) -> Result<&'a [T], Problem> {
    if count == 0 {
        return Ok(&[]);
    }
    if first.is_null() {
        return Err(Problem::Null(name));
    }
    // SAFETY: not NULL, and `count` initialised values by the contract above.
    Ok(unsafe { std::slice::from_raw_parts(first, count) })
}

/// A word of the caller's.
///
/// # Safety
/// `text` is NULL or ends in a zero byte.
pub(crate) unsafe fn word<'a>(text: *const c_char, name: &'static str) -> Result<&'a str, Problem> {
    if text.is_null() {
        return Err(Problem::Null(name));
    }
    // SAFETY: not NULL, and it ends in a zero byte by the contract above.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| Problem::Refused(format!("{name} is not UTF-8; give plain words")))
}

/// Names and values of parameters.
///
/// # Safety
/// Both arrays are NULL or hold `count` initialised values that nobody changes meanwhile, and each name
/// is NULL or ends in a zero byte.
pub(crate) unsafe fn numbers(
    names: *const *const c_char,
    values: *const f64,
    count: usize,
) -> Result<Vec<(String, f64)>, Problem> {
    // SAFETY: by the contract above.
    let (names, values) =
        unsafe { (slice(names, count, "names")?, slice(values, count, "values")?) };
    let mut stated = Vec::with_capacity(count);
    for (name, value) in names.iter().zip(values) {
        // SAFETY: by the contract above.
        stated.push((unsafe { word(*name, "name") }?.to_owned(), *value));
    }
    Ok(stated)
}

/// A number that is NaN where nobody knows it.
pub(crate) fn known(name: &str, given: f64) -> Result<Option<f64>, Problem> {
    if given.is_nan() { Ok(None) } else { bounded(name, given, f64::MAX).map(Some) }
}

/// Refuses what is not a finite number within ± `most`.
pub(crate) fn bounded(name: &str, given: f64, most: f64) -> Result<f64, Problem> {
    if !given.is_finite() {
        return Err(Error::NotFinite { name: name.to_owned(), given }.into());
    }
    if given.abs() > most {
        let (name, unit) = (name.to_owned(), String::new());
        return Err(Error::OutOfBounds { name, given, lower: -most, upper: most, unit }.into());
    }
    Ok(given)
}

/// Refuses what is no duration of a step, as the other interfaces do.
pub(crate) fn duration(given: f64) -> Result<f64, Problem> {
    if given > 0.0 && given <= 1e6 {
        return Ok(given);
    }
    let (name, unit) = ("dt".to_owned(), " s".to_owned());
    Err(Error::OutOfBounds { name, given, lower: f64::MIN_POSITIVE, upper: 1e6, unit }.into())
}
