//! Camera paths as JSON files: `fov_y_deg`, `near`, `far` (null or absent is infinity), `up`, `keys`, and maybe `frames`.
//!
//! Read through `serde_json`'s value, not a derived type, so that an error can name the key at fault in the user's words.
//! Fields that are not known are left alone: a newer file still loads.

use std::path::Path;

use glam::DVec3;
use serde_json::Value;

use super::{CameraPath, PathKey};
use crate::error::{Error, Result};

/// A path as a file gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct PathFile {
    /// The path, checked.
    pub path: CameraPath,
    /// How many frames the file asks for, if it says so.
    pub frames: Option<usize>,
}

/// Reads a camera path. `far` may be null or absent: infinite.
///
/// # Errors
/// As for [`load_path_file`].
pub fn load_path(path: &Path) -> Result<CameraPath> {
    load_path_file(path).map(|file| file.path)
}

/// Reads a camera path together with its number of frames.
///
/// # Errors
/// [`Error::File`] when the file cannot be read; [`Error::Format`] naming the line of a syntax error, or the key that is
/// missing, of the wrong kind or of an impossible value.
pub fn load_path_file(path: &Path) -> Result<PathFile> {
    parse(&read_json(path)?).map_err(|reason| Error::Format { path: path.into(), line: None, reason })
}

/// The JSON of a file.
///
/// # Errors
/// [`Error::File`] when it cannot be read; [`Error::Format`] naming the line of a syntax error.
pub(crate) fn read_json(path: &Path) -> Result<Value> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e))?;
    serde_json::from_str(&text).map_err(|e| Error::Format {
        path: path.into(),
        line: Some(e.line()).filter(|&line| line > 0),
        reason: format!("is not JSON: {e}"),
    })
}

fn parse(value: &Value) -> std::result::Result<PathFile, String> {
    if !value.is_object() {
        return Err("a camera path is an object with fov_y_deg, near, far, up and keys".into());
    }
    let far = match value.get("far") {
        None | Some(Value::Null) => None,
        Some(far) => Some(number(far, "far")?),
    };
    let frames = match value.get("frames") {
        None | Some(Value::Null) => None,
        Some(frames) => Some(count(frames, "frames")?),
    };
    let keys = field(value, "", "keys")?.as_array().ok_or("'keys' must be an array")?;
    let keys = keys.iter().enumerate().map(|(i, key)| parse_key(i, key)).collect::<std::result::Result<Vec<_>, _>>()?;
    let path = CameraPath {
        fov_y_deg: number(field(value, "", "fov_y_deg")?, "fov_y_deg")?,
        near: number(field(value, "", "near")?, "near")?,
        far,
        up: vector(field(value, "", "up")?, "up")?,
        keys,
    };
    match path.check() {
        Ok(()) => Ok(PathFile { path, frames }),
        Err(Error::View(reason)) => Err(reason),
        Err(other) => Err(other.to_string()),
    }
}

fn parse_key(index: usize, key: &Value) -> std::result::Result<PathKey, String> {
    let place = format!("keys[{index}].");
    let part = |name: &str| vector(field(key, &place, name)?, &format!("{place}{name}"));
    Ok(PathKey { eye: part("eye")?, target: part("target")? })
}

/// A field that must be there; `place` is what stands before its name in a message.
pub(crate) fn field<'a>(value: &'a Value, place: &str, name: &str) -> std::result::Result<&'a Value, String> {
    value.get(name).ok_or_else(|| format!("'{place}{name}' is missing"))
}

fn number(value: &Value, name: &str) -> std::result::Result<f64, String> {
    value.as_f64().filter(|n| n.is_finite()).ok_or_else(|| format!("'{name}' must be a finite number, not {value}"))
}

fn count(value: &Value, name: &str) -> std::result::Result<usize, String> {
    let whole = value.as_u64().and_then(|n| usize::try_from(n).ok()).filter(|&n| n > 0);
    whole.ok_or_else(|| format!("'{name}' must be a whole number above 0, not {value}"))
}

/// An array of three finite numbers.
pub(crate) fn vector(value: &Value, name: &str) -> std::result::Result<DVec3, String> {
    let parts: Vec<f64> = match value.as_array() {
        Some(parts) if parts.len() == 3 => {
            parts.iter().map(|p| number(p, name)).collect::<std::result::Result<_, _>>()?
        }
        _ => return Err(format!("'{name}' must be an array of three numbers")),
    };
    Ok(DVec3::new(parts[0], parts[1], parts[2]))
}
