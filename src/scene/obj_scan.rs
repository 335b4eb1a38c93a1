//! The pass over an OBJ's text that comes before tobj: it finds what is wrong, with the line, and writes a text that tobj
//! reads without surprises.
//!
//! tobj 4.0.5 names no line, lets NaN, infinity and 1e400 pass, makes filled triangles of `l`, and fails on `\`
//! continuations and comments behind a face. The text that this pass writes has only vertices of three finite numbers, all
//! of them first, then faces by absolute position indices, and an `o N` wherever the part (object and material) changes.
//! One pass, about 0.2 s for a million triangles; memory: the text twice.

use std::collections::HashMap;
use std::io::Write;
use std::path::Path;

use crate::error::{Error, Result};

/// What a scan brings out.
#[derive(Debug, Default)]
pub(crate) struct Scan {
    /// The `v` lines for tobj.
    pub vertices: Vec<u8>,
    /// The `o` and `f` lines for tobj, to follow the vertices.
    pub faces: Vec<u8>,
    /// Part `N` of the text's `o N`.
    pub parts: Vec<Part>,
    /// Names of materials, as `usemtl` gives them.
    pub materials: Vec<String>,
    /// What `mtllib` asks for, in order.
    pub libraries: Vec<String>,
}

/// Faces of one object and one material.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Part {
    /// How many `o` statements came before: two objects of one name stay two.
    pub object: usize,
    /// The object's name; empty where the file gives none.
    pub name: String,
    /// Index into [`Scan::materials`].
    pub material: Option<usize>,
}

/// Scans the bytes of an OBJ file. `path` is for errors only.
///
/// # Errors
/// [`Error::Format`] with the line of a malformed or infinite number, an index out of range, a face of fewer than three
/// vertices; without faces, one that says what the file lacks.
pub(crate) fn scan(path: &Path, bytes: &[u8]) -> Result<Scan> {
    let fail = |line, reason| Error::Format { path: path.into(), line, reason };
    let mut scanner = Scanner::default();
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut lines = Lines { rest: bytes, number: 0, joined: Vec::new() };
    while let Some((number, text)) = lines.next() {
        scanner.line(text, number).map_err(|reason| fail(Some(number), reason))?;
    }
    scanner.finish().map_err(|(line, reason)| fail(line, reason))
}

/// Logical lines: joined where a backslash ends them, but a comment is never continued.
struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
    joined: Vec<u8>,
}

impl<'a> Lines<'a> {
    /// The number of the next line (that of its first piece) and its text.
    fn next(&mut self) -> Option<(usize, &[u8])> {
        let raw = self.raw()?;
        let number = self.number;
        let Some(piece) = continued(raw) else { return Some((number, raw)) };
        self.joined.clear();
        self.joined.extend_from_slice(piece);
        while let Some(raw) = self.raw() {
            self.joined.push(b' ');
            match continued(raw) {
                Some(piece) => self.joined.extend_from_slice(piece),
                None => {
                    self.joined.extend_from_slice(raw);
                    break;
                }
            }
        }
        Some((number, &self.joined))
    }

    fn raw(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let rest = self.rest;
        let end = rest.iter().position(|&b| b == b'\n');
        self.rest = end.map_or(&[], |end| &rest[end + 1..]);
        Some(&rest[..end.unwrap_or(rest.len())])
    }
}

/// The line without its continuation mark, if it has one.
fn continued(line: &[u8]) -> Option<&[u8]> {
    let piece = line.trim_ascii_end().strip_suffix(b"\\")?;
    (!piece.trim_ascii_start().starts_with(b"#")).then_some(piece)
}

type Outcome<T> = std::result::Result<T, String>;

#[derive(Default)]
struct Scanner {
    scan: Scan,
    vertex_count: usize,
    objects: usize,
    object: String,
    group: String,
    material: Option<usize>,
    part_ids: HashMap<Part, usize>,
    material_ids: HashMap<String, usize>,
    /// The part of the last `o N` written, and whether names or material have changed since.
    written: Option<usize>,
    changed: bool,
    /// Faces that name vertices still to come: line and index.
    ahead: Vec<(usize, usize)>,
    /// The first statement that no OBJ has.
    unknown: Option<(usize, String)>,
}

impl Scanner {
    fn line(&mut self, text: &[u8], number: usize) -> Outcome<()> {
        let text = text.trim_ascii();
        let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
        let (word, rest) = text.split_at(end);
        match word {
            b"v" => self.vertex(rest),
            b"f" | b"fo" => self.face(rest, number),
            b"o" => {
                (self.object, self.changed) = (name(rest), true);
                self.objects += 1;
                self.group.clear();
                Ok(())
            }
            b"g" => {
                (self.group, self.changed) = (name(rest), true);
                Ok(())
            }
            b"usemtl" => {
                self.use_material(name(rest));
                Ok(())
            }
            b"mtllib" => {
                self.scan.libraries.push(name(rest));
                Ok(())
            }
            _ => {
                let known = word.is_empty() || word[0] == b'#' || IGNORED.iter().any(|s| s.as_bytes() == word);
                if !known && self.unknown.is_none() {
                    self.unknown = Some((number, excerpt(word)));
                }
                Ok(())
            }
        }
    }

    fn vertex(&mut self, rest: &[u8]) -> Outcome<()> {
        let mut words = words(rest);
        self.scan.vertices.push(b'v');
        for axis in ["x", "y", "z"] {
            let Some(word) = words.next() else { return Err(format!("a vertex needs x, y and z; {axis} is missing")) };
            let number: Option<f32> = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
            match number {
                None => return Err(format!("{axis} of a vertex: '{}' is not a number", excerpt(word))),
                Some(n) if !n.is_finite() => {
                    return Err(format!("{axis} of a vertex: '{}' is not a finite f32", excerpt(word)));
                }
                Some(_) => {
                    self.scan.vertices.push(b' ');
                    self.scan.vertices.extend_from_slice(word);
                }
            }
        }
        self.scan.vertices.push(b'\n');
        self.vertex_count += 1;
        Ok(())
    }

    fn face(&mut self, rest: &[u8], number: usize) -> Outcome<()> {
        self.begin_part();
        self.scan.faces.push(b'f');
        let mut corners = 0;
        for word in words(rest) {
            let index = self.corner(word)?;
            if index > self.vertex_count {
                self.ahead.push((number, index));
            }
            corners += 1;
            if write!(self.scan.faces, " {index}").is_err() {
                return Err("out of memory".into());
            }
        }
        self.scan.faces.push(b'\n');
        if corners < 3 {
            return Err(format!("a face needs at least 3 vertices, this one has {corners}"));
        }
        Ok(())
    }

    /// The 1-based position index of `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &[u8]) -> Outcome<usize> {
        let mut parts = word.split(|&b| b == b'/');
        let malformed = || format!("'{}' is not a face vertex: v, v/vt, v//vn or v/vt/vn", excerpt(word));
        let index = integer(parts.next().unwrap_or_default()).ok_or_else(malformed)?;
        let others = parts.by_ref().take(2).all(|part| part.is_empty() || integer(part).is_some());
        if !others || parts.next().is_some() {
            return Err(malformed());
        }
        let count = self.vertex_count;
        match index {
            0 => Err("index 0: vertices count from 1".into()),
            1.. => usize::try_from(index).map_err(|_| out_of_range(index, count)),
            _ => {
                let back = usize::try_from(index.unsigned_abs()).ok().filter(|&back| back <= count);
                back.map(|back| count - back + 1).ok_or_else(|| out_of_range(index, count))
            }
        }
    }

    fn use_material(&mut self, name: String) {
        let Scanner { scan, material_ids, .. } = self;
        let next = material_ids.len();
        let id = *material_ids.entry(name).or_insert_with_key(|name| {
            scan.materials.push(name.clone());
            next
        });
        (self.material, self.changed) = (Some(id), true);
    }

    /// Writes an `o N` when the face to come is of another part than the last.
    fn begin_part(&mut self) {
        if !self.changed && self.written.is_some() {
            return;
        }
        self.changed = false;
        let name = match (self.object.as_str(), self.group.as_str()) {
            (object, "") => object.to_owned(),
            ("", group) => group.to_owned(),
            (object, group) if object == group => object.to_owned(),
            (object, group) => format!("{object}/{group}"),
        };
        let part = Part { object: self.objects, name, material: self.material };
        let Scanner { scan, part_ids, .. } = self;
        let id = *part_ids.entry(part).or_insert_with_key(|part| {
            scan.parts.push(part.clone());
            scan.parts.len() - 1
        });
        if self.written != Some(id) {
            self.scan.faces.extend_from_slice(format!("o {id}\n").as_bytes());
            self.written = Some(id);
        }
    }

    fn finish(self) -> std::result::Result<Scan, (Option<usize>, String)> {
        let count = self.vertex_count;
        if let Some(&(line, index)) = self.ahead.iter().find(|&&(_, index)| index > count) {
            return Err((Some(line), out_of_range(index as i64, count)));
        }
        match self.unknown {
            Some((line, word)) if self.scan.faces.is_empty() && count == 0 => {
                Err((Some(line), format!("is not an OBJ: unknown statement '{word}'")))
            }
            _ if self.scan.faces.is_empty() => Err((None, "has no triangles".into())),
            _ => Ok(self.scan),
        }
    }
}

/// Statements of the format that a culler has no use for: attributes, lines and points, free-form geometry, display.
const IGNORED: [&str; 38] = [
    "vt",
    "vn",
    "vp",
    "l",
    "p",
    "s",
    "mg",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "usemap",
    "maplib",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "call",
    "csh",
    "res",
    "bsp",
    "bzp",
    "cdc",
    "cdp",
];

fn out_of_range(index: i64, count: usize) -> String {
    format!("index {index} is out of range: there are {count} vertices")
}

/// Words of a line of numbers, up to a comment.
fn words(rest: &[u8]) -> impl Iterator<Item = &[u8]> {
    let end = rest.iter().position(|&b| b == b'#').unwrap_or(rest.len());
    rest[..end].split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A name: the rest of the line, up to a word that starts with `#` (a `#` within a word is part of the name).
fn name(rest: &[u8]) -> String {
    let text = String::from_utf8_lossy(rest);
    let text = text.trim();
    let comment = text.match_indices('#').map(|(at, _)| at).find(|&at| at > 0 && text[..at].ends_with([' ', '\t']));
    text[..comment.unwrap_or(text.len())].trim_end().to_owned()
}

/// At most 32 characters of a word of the file, safe to print.
fn excerpt(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(128)]);
    text.chars().take(32).flat_map(char::escape_debug).collect()
}

fn integer(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    if digits.is_empty() || digits.len() > 18 || !digits.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let value = digits.iter().fold(0, |n, &digit| n * 10 + i64::from(digit - b'0'));
    Some(if negative { -value } else { value })
}
