//! The folder that pictures and plots go to.

use std::path::{Path, PathBuf};

use super::arguments::Options;
use crate::error::{Error, Result};
use crate::measure::report_target::Target;

/// That JSON and CSV can be written where they are asked for: said before the work, not after it.
pub fn check_targets(options: &Options) -> Result<()> {
    for target in [&options.json, &options.csv].into_iter().flatten() {
        let Target::File(path) = target else { continue };
        if path.is_dir() {
            return Err(Error::file(path, "is a folder"));
        }
        let parent = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        probe(parent).map_err(|e| Error::file(path, e))?;
    }
    Ok(())
}

/// Writes to a folder, and takes it back.
fn probe(folder: &Path) -> std::io::Result<()> {
    let probe = folder.join(format!(".homcull-{}", std::process::id()));
    std::fs::write(&probe, b"").and_then(|()| std::fs::remove_file(&probe))
}

/// A folder that exists and can be written to.
pub fn folder(path: &Path) -> Result<PathBuf> {
    std::fs::create_dir_all(path).map_err(|e| Error::file(path, e))?;
    probe(path).map_err(|e| Error::file(path, e))?;
    Ok(path.to_owned())
}
