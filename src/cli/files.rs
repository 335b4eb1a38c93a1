//! The folder that pictures and plots go to.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// A folder that exists and can be written to.
pub fn folder(path: &Path) -> Result<PathBuf> {
    std::fs::create_dir_all(path).map_err(|e| Error::file(path, e))?;
    let probe = path.join(format!(".homcull-{}", std::process::id()));
    std::fs::write(&probe, b"").and_then(|()| std::fs::remove_file(&probe)).map_err(|e| Error::file(path, e))?;
    Ok(path.to_owned())
}
