//! Where a report goes: standard output or a file, and a file only whole.
//!
//! A file is written under a temporary name in its own folder and renamed when it is complete, so
//! that a reader never sees half a report and a failed run leaves the former one in place.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::error::{Error, Result};

/// Where a report goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// Standard output, written `-`.
    Stdout,
    /// A file, replaced whole.
    File(PathBuf),
}

impl Target {
    /// `-` is standard output; everything else is a path.
    pub fn parse(text: impl Into<OsString>) -> Target {
        let text = text.into();
        if text == "-" { Target::Stdout } else { Target::File(text.into()) }
    }

    /// Writes the report with `write`, buffered: see [`atomically`] for files.
    ///
    /// A reader of standard output that stopped listening (`| head`) has had what it wanted and is
    /// no error.
    ///
    /// # Errors
    ///
    /// [`Error::File`] with the path, or with `stdout`, and the system's reason.
    pub fn write(&self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
        match self {
            Target::File(path) => atomically(path, write),
            Target::Stdout => {
                let mut out = BufWriter::new(io::stdout().lock());
                match write(&mut out).and_then(|()| out.flush()) {
                    Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Error::file("stdout", error)),
                    _ => Ok(()),
                }
            }
        }
    }
}

/// Writes a file under a temporary name in the same folder, then renames it to `path`.
///
/// When anything fails the temporary is removed and whatever stood at `path` is left as it was.
///
/// # Errors
///
/// [`Error::File`] with `path` and the system's reason.
pub fn atomically(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    let temporary = temporary_beside(path)?;
    let written = File::create(&temporary).and_then(|file| {
        let mut out = BufWriter::new(file);
        write(&mut out)?;
        out.flush()
    });
    written.and_then(|()| fs::rename(&temporary, path)).map_err(|error| {
        // Nothing better can be done when the removal fails too; the first error is the cause.
        let _ = fs::remove_file(&temporary);
        Error::file(path, error)
    })
}

/// A name of this process and call, hidden, in the folder of `path`.
fn temporary_beside(path: &Path) -> Result<PathBuf> {
    static CALL: AtomicU32 = AtomicU32::new(0);
    let name = path.file_name().ok_or_else(|| Error::file(path, "not the name of a file"))?;
    let mut hidden = OsString::from(".");
    hidden.push(name);
    hidden.push(format!(".{}-{}.tmp", process::id(), CALL.fetch_add(1, Ordering::Relaxed)));
    Ok(path.with_file_name(hidden))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("homcull-{name}-{}", process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = folder("failed-write");
        let path = folder.join("report.json");
        atomically(&path, |out| out.write_all(b"old")).unwrap();
        let failed = atomically(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("the disk is on fire"))
        });
        let text = failed.unwrap_err().to_string();
        assert!(text.contains("report.json") && text.contains("on fire"), "{text}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_missing_folder_is_an_error_with_the_path() {
        let error = atomically(Path::new("/no/such/folder/x.csv"), |_| Ok(())).unwrap_err();
        assert!(error.to_string().starts_with("/no/such/folder/x.csv: "), "{error}");
    }

    #[test]
    fn a_folder_is_no_file_name() {
        assert!(atomically(Path::new(".."), |_| Ok(())).is_err());
    }

    #[test]
    fn a_dash_is_standard_output() {
        assert_eq!(Target::parse("-"), Target::Stdout);
        assert_eq!(Target::parse("-.json"), Target::File("-.json".into()));
    }
}
