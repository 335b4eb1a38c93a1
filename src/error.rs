//! The one error type: bad input, with the file, line, object or value at fault. Panics are bugs.

use std::fmt;
use std::path::PathBuf;

/// What was wrong with the input, or with the machine that was asked to serve it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be opened, read or written; `reason` is the system's own word.
    File {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// A file was read but is not what it should be.
    Format {
        /// The file.
        path: PathBuf,
        /// The 1-based line, where the format has lines.
        line: Option<usize>,
        /// What is wrong there.
        reason: String,
    },
    /// A mesh cannot be used: an index out of range, a vertex that is no finite number.
    Mesh {
        /// The object's or mesh's name.
        object: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A view, camera or camera path cannot be used.
    View(String),
    /// A width or height outside 1 to 16384.
    Size {
        /// Width in pixels, as asked.
        width: u64,
        /// Height in pixels, as asked.
        height: u64,
    },
    /// A parameter or argument has a value that it cannot take.
    Parameter {
        /// Its name, as the user writes it.
        name: String,
        /// Its value, as given.
        value: String,
        /// What it may be.
        reason: String,
    },
    /// A SIMD level was asked for that this CPU lacks.
    SimdLevel(String),
    /// A stage of the pipeline failed: with an error of its own, by a panic, or because its thread could not be started.
    Stage {
        /// `OccSel`, `OccDraw`, `Cull`, `FinalDraw`; or `Draw`, for what the caller does between the stages.
        stage: &'static str,
        /// The frame that it was at, from 0.
        frame: usize,
        /// What happened.
        reason: String,
    },
}

/// `Result` with this crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::File { path, reason } => write!(f, "{}: {reason}", path.display()),
            Error::Format { path, line: Some(line), reason } => write!(f, "{}:{line}: {reason}", path.display()),
            Error::Format { path, line: None, reason } => write!(f, "{}: {reason}", path.display()),
            Error::Mesh { object, reason } => write!(f, "object '{object}': {reason}"),
            Error::View(reason) => write!(f, "view: {reason}"),
            Error::Size { width, height } => write!(f, "size {width}x{height}: each side must be 1 to 16384"),
            Error::Parameter { name, value, reason } => write!(f, "{name} '{value}': {reason}"),
            Error::Stage { stage, frame, reason } => write!(f, "{stage} of frame {frame}: {reason}"),
            Error::SimdLevel(level) => write!(f, "SIMD level '{level}': this CPU does not have it"),
        }
    }
}

impl std::error::Error for Error {}

impl Error {
    /// Wraps an I/O error with the path it happened at.
    pub fn file(path: impl Into<PathBuf>, reason: impl fmt::Display) -> Error {
        Error::File { path: path.into(), reason: reason.to_string() }
    }

    /// A parameter with a value that it cannot take.
    pub fn parameter(name: impl Into<String>, value: impl fmt::Display, reason: impl Into<String>) -> Error {
        Error::Parameter { name: name.into(), value: value.to_string(), reason: reason.into() }
    }
}
