//! The journal of a bake, beside the file that it will be: what has been found so far, so that a bake that was killed goes on
//! where it was.
//!
//! A header (that of the bake, under a magic of its own), then records, only ever appended: u32 point, u32 what (as in the
//! bake's table, or 0xFFFFFFFD: it can be reached, but has not been looked from), the objects seen, and a u64 sum of the
//! record. A kill may tear the last record, a power cut may leave rubbish: reading stops at the first record that is not
//! whole, the rest is cut off and done again. So the final bytes never depend on what a journal held. While it is open it is
//! locked: of two bakes of one file the second is an error.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::select::{BACK_SIDES, BakeHeader, ENCLOSED, HEADER, Sight, checksum};

const MAGIC: [u8; 8] = *b"HOMBAKE+";
const REACHED: u32 = u32::MAX - 2;

/// What is known of a view point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Known {
    /// Nothing yet.
    Nothing,
    /// It can be reached; what is seen from there is not known.
    Reached,
    /// All.
    All(Sight),
}

/// An open journal.
pub(super) struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Where the journal of a bake stands.
    pub fn path_of(bake: &Path) -> PathBuf {
        let mut name = bake.file_name().unwrap_or_default().to_owned();
        name.push(".part");
        bake.with_file_name(name)
    }

    /// Opens the journal of a bake, or begins it; gives what it knows of each point.
    ///
    /// # Errors
    /// [`Error::File`] when it cannot be written, or another bake is writing it; [`Error::Format`] when it is no journal, or
    /// one of another bake.
    pub fn open(bake: &Path, header: &BakeHeader) -> Result<(Journal, Vec<Known>)> {
        let path = Journal::path_of(bake);
        let fail = |e: std::io::Error| Error::file(&path, e);
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path).map_err(fail)?;
        file.try_lock().map_err(|e| match e {
            TryLockError::WouldBlock => Error::file(&path, "another bake is writing it"),
            TryLockError::Error(e) => fail(e),
        })?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(fail)?;
        let begin = header.encode(MAGIC);
        let foreign = |reason: &str| Error::Format { path: path.clone(), line: None, reason: reason.into() };
        if !begin.starts_with(&bytes[..bytes.len().min(8)]) {
            return Err(foreign("is no journal of a bake"));
        }
        if !begin.starts_with(&bytes[..bytes.len().min(HEADER)]) {
            let reason = "is the journal of another scene or grid; finish that bake, or remove it";
            return Err(foreign(reason));
        }
        let mut known = vec![Known::Nothing; header.grid.points()];
        let whole = if bytes.len() < HEADER { 0 } else { HEADER + replay(&bytes[HEADER..], header, &mut known) };
        file.set_len(whole as u64).and_then(|()| file.seek(SeekFrom::End(0))).map_err(fail)?;
        if whole == 0 {
            file.write_all(&begin).map_err(fail)?;
        }
        Ok((Journal { path, file }, known))
    }

    /// Appends what has been found of points.
    pub fn append<'k>(&mut self, found: impl IntoIterator<Item = (usize, &'k Known)>) -> Result<()> {
        let mut bytes = Vec::new();
        for (point, known) in found {
            let (word, seen): (u32, &[(u32, u32)]) = match known {
                Known::Nothing => continue,
                Known::Reached => (REACHED, &[]),
                Known::All(Sight::Enclosed) => (ENCLOSED, &[]),
                Known::All(Sight::BackSides) => (BACK_SIDES, &[]),
                Known::All(Sight::Seen(seen)) => (seen.len() as u32, seen),
            };
            let from = bytes.len();
            let words = [point as u32, word].into_iter().chain(seen.iter().flat_map(|&(id, samples)| [id, samples]));
            words.for_each(|w| bytes.extend(w.to_le_bytes()));
            let sum = checksum(&bytes[from..]);
            bytes.extend(sum.to_le_bytes());
        }
        self.file.write_all(&bytes).map_err(|e| Error::file(&self.path, e))
    }

    /// Removes the journal: the bake is there.
    pub fn remove(self) -> Result<()> {
        std::fs::remove_file(&self.path).map_err(|e| Error::file(&self.path, e))
    }
}

/// Takes in whole records; gives the bytes that they have.
fn replay(bytes: &[u8], header: &BakeHeader, known: &mut [Known]) -> usize {
    let mut at = 0;
    while let Some((length, point, what)) = record(&bytes[at..], header) {
        known[point] = what;
        at += length;
    }
    at
}

/// The record that bytes begin with, if it is whole: its length, its point, and what it says.
fn record(bytes: &[u8], header: &BakeHeader) -> Option<(usize, usize, Known)> {
    let word = |i: usize| Some(u32::from_le_bytes(*bytes.get(4 * i..)?.first_chunk()?));
    let (point, what) = (word(0)? as usize, word(1)?);
    let seen = if what >= REACHED { 0 } else { what as usize };
    let end = seen.checked_mul(8)?.checked_add(8)?;
    let sum = u64::from_le_bytes(*bytes.get(end..)?.first_chunk()?);
    if sum != checksum(&bytes[..end]) || point >= header.grid.points() {
        return None;
    }
    let known = match what {
        REACHED => Known::Reached,
        ENCLOSED => Known::All(Sight::Enclosed),
        BACK_SIDES => Known::All(Sight::BackSides),
        _ => Known::All(Sight::Seen(
            (0..seen).map(|i| Some((word(2 + 2 * i)?, word(3 + 2 * i)?))).collect::<Option<_>>()?,
        )),
    };
    Some((end + 8, point, known))
}
