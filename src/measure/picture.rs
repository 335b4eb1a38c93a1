//! Pictures of what the culler sees, as PNG: frames, pyramids, depth, and what was culled.
//!
//! All drawing here is on plain 8-bit buffers, row by row from the top left; nothing decides
//! anything about visibility. The pyramid's levels stand side by side at one height, as in the
//! thesis' figures 4.3 and 8.4, each scaled by whole pixels so that every map pixel stays a square
//! one can count. Culled geometry is tinted, as in its figure 1.1. Sizes that are impossible (a side
//! of 0 or beyond [`MAX_SIDE`]) are typed errors; rectangles and tints beyond the border are cut off.

use std::io;
use std::path::Path;

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

use super::report_target::atomically;
use crate::error::{Error, Result};

/// The longest side of a picture, in pixels: four views of the greatest size beside each other.
pub const MAX_SIDE: u32 = 65_536;

/// Between the pictures of a sheet or the levels of a pyramid: a muted blue, found in no grey map.
const SEPARATOR: Rgb = Rgb([86, 120, 168]);
/// The width of that line, in pixels.
const SEPARATOR_WIDTH: u32 = 2;
/// What a smaller picture leaves of its place on a sheet.
const PAPER: Rgb = Rgb([236, 236, 236]);

/// Red, green, blue; 8 bits each, sRGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rgb(pub [u8; 3]);

impl Rgb {
    /// The tint of what is hidden and was culled (red in the thesis' figure 1.1).
    pub const CULLED: Rgb = Rgb([213, 40, 30]);
    /// The tint of what is visible (blue there).
    pub const VISIBLE: Rgb = Rgb([0, 114, 178]);
    /// The tint of occluders.
    pub const OCCLUDER: Rgb = Rgb([230, 159, 0]);
}

/// A picture of 8-bit colours, never empty.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RgbImage {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

/// A picture of 8-bit greys, never empty: an occlusion map, or a depth buffer made visible.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GreyImage {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

/// The number of bytes of a picture, if its size is possible.
fn byte_count(width: u32, height: u32, channels: usize) -> Result<usize> {
    let possible = 1..=MAX_SIDE;
    let bytes = (width as usize)
        .checked_mul(height as usize)
        .and_then(|pixels| pixels.checked_mul(channels))
        .filter(|_| possible.contains(&width) && possible.contains(&height));
    bytes.ok_or(Error::Size { width: width.into(), height: height.into() })
}

fn check_length(given: usize, wanted: usize) -> Result<()> {
    if given == wanted {
        return Ok(());
    }
    Err(Error::parameter("pixels", given, format!("this size takes {wanted} bytes")))
}

impl RgbImage {
    /// A picture of one colour.
    ///
    /// # Errors
    ///
    /// [`Error::Size`] if a side is 0 or beyond [`MAX_SIDE`].
    pub fn new(width: u32, height: u32, colour: Rgb) -> Result<RgbImage> {
        let bytes = byte_count(width, height, 3)?;
        Ok(RgbImage { width, height, pixels: colour.0.repeat(bytes / 3) })
    }

    /// A picture from its bytes: red, green, blue, row by row from the top left, without padding.
    ///
    /// # Errors
    ///
    /// [`Error::Size`] as for [`RgbImage::new`], [`Error::Parameter`] if the length does not fit it.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<u8>) -> Result<RgbImage> {
        check_length(pixels.len(), byte_count(width, height, 3)?)?;
        Ok(RgbImage { width, height, pixels })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The bytes, three a pixel, row by row.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The colour at a pixel, if it is one.
    pub fn get(&self, x: u32, y: u32) -> Option<Rgb> {
        let at = self.offset(x, y)?;
        Some(Rgb([self.pixels[at], self.pixels[at + 1], self.pixels[at + 2]]))
    }

    /// Sets a pixel; nothing happens beyond the border.
    pub fn set(&mut self, x: u32, y: u32, colour: Rgb) {
        if let Some(at) = self.offset(x, y) {
            self.pixels[at..at + 3].copy_from_slice(&colour.0);
        }
    }

    fn offset(&self, x: u32, y: u32) -> Option<usize> {
        let inside = x < self.width && y < self.height;
        inside.then(|| (y as usize * self.width as usize + x as usize) * 3)
    }

    /// Mixes a pixel with `colour`; `strength` 0 leaves it, 255 replaces it. The pixel's own
    /// brightness stays legible in between.
    pub fn tint(&mut self, x: u32, y: u32, colour: Rgb, strength: u8) {
        if let Some(at) = self.offset(x, y) {
            for (channel, &target) in self.pixels[at..at + 3].iter_mut().zip(&colour.0) {
                *channel = mix(*channel, target, strength);
            }
        }
    }

    /// Tints every pixel for which `chosen(x, y)` holds.
    pub fn tint_where(&mut self, colour: Rgb, strength: u8, chosen: impl Fn(u32, u32) -> bool) {
        for y in 0..self.height {
            for x in 0..self.width {
                if chosen(x, y) {
                    self.tint(x, y, colour, strength);
                }
            }
        }
    }

    /// Draws the one pixel wide outline of the rectangle from (`x0`, `y0`) to (`x1`, `y1`), both
    /// inside it, in pixels.
    pub fn outline(&mut self, [x0, y0, x1, y1]: [u32; 4], colour: Rgb) {
        if x0 > x1 || y0 > y1 {
            return;
        }
        for x in x0..=x1.min(self.width) {
            self.set(x, y0, colour);
            self.set(x, y1, colour);
        }
        for y in y0..=y1.min(self.height) {
            self.set(x0, y, colour);
            self.set(x1, y, colour);
        }
    }

    /// Copies `source` with its top left corner at (`x`, `y`), what lies beyond the border cut off.
    pub fn paste(&mut self, source: &RgbImage, x: u32, y: u32) {
        if x >= self.width || y >= self.height {
            return;
        }
        let columns = source.width.min(self.width - x) as usize * 3;
        let rows = source.height.min(self.height - y);
        for row in 0..rows {
            let from = row as usize * source.width as usize * 3;
            let to = ((y + row) as usize * self.width as usize + x as usize) * 3;
            self.pixels[to..to + columns].copy_from_slice(&source.pixels[from..from + columns]);
        }
    }

    /// The picture at 1/`factor` of its size, each pixel the mean of a square; incomplete squares
    /// at the right and bottom count with the pixels they have. A factor of 0 counts as 1.
    pub fn reduced(&self, factor: u32) -> RgbImage {
        let factor = factor.max(1);
        let (width, height) = (self.width.div_ceil(factor), self.height.div_ceil(factor));
        let mut pixels = Vec::with_capacity(width as usize * height as usize * 3);
        for y in 0..height {
            for x in 0..width {
                pixels.extend(self.mean_of_square(x * factor, y * factor, factor));
            }
        }
        RgbImage { width, height, pixels }
    }

    fn mean_of_square(&self, x0: u32, y0: u32, side: u32) -> [u8; 3] {
        let mut sums = [0u64; 3];
        let (x1, y1) = ((x0 + side).min(self.width), (y0 + side).min(self.height));
        for y in y0..y1 {
            let row = y as usize * self.width as usize;
            for pixel in self.pixels[(row + x0 as usize) * 3..(row + x1 as usize) * 3].chunks_exact(3) {
                for (sum, &channel) in sums.iter_mut().zip(pixel) {
                    *sum += u64::from(channel);
                }
            }
        }
        let count = u64::from(x1 - x0) * u64::from(y1 - y0);
        // A mean of bytes is a byte.
        sums.map(|sum| ((sum + count / 2) / count) as u8)
    }

    /// Writes the picture as PNG, whole or not at all.
    ///
    /// # Errors
    ///
    /// [`Error::File`] with the path and the system's reason.
    pub fn write_png(&self, path: &Path) -> Result<()> {
        write_png(path, &self.pixels, self.width, self.height, ExtendedColorType::Rgb8)
    }
}

impl GreyImage {
    /// A picture from its bytes, one a pixel, row by row from the top left, 255 white.
    ///
    /// # Errors
    ///
    /// [`Error::Size`] as for [`RgbImage::new`], [`Error::Parameter`] if the length does not fit it.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<u8>) -> Result<GreyImage> {
        check_length(pixels.len(), byte_count(width, height, 1)?)?;
        Ok(GreyImage { width, height, pixels })
    }

    /// An occlusion map: opacities from 0 (black, nothing covered) to 1 (white, opaque). White is
    /// only what is wholly opaque: anything less is at most 254.
    ///
    /// # Errors
    ///
    /// As [`GreyImage::from_pixels`].
    pub fn from_opacity(width: u32, height: u32, opacities: &[f32]) -> Result<GreyImage> {
        let grey = |opacity: f32| {
            // The cast takes NaN and what is below zero to 0.
            if opacity >= 1.0 { 255 } else { ((opacity * 255.0) as u8).min(254) }
        };
        GreyImage::from_pixels(width, height, opacities.iter().copied().map(grey).collect())
    }

    /// A reversed depth buffer (larger is nearer, 0 the background) on a logarithmic scale between
    /// its least and greatest depth, nearest white. Background and NaN are black, an infinite
    /// depth white; what is covered is never black.
    ///
    /// # Errors
    ///
    /// As [`GreyImage::from_pixels`].
    pub fn from_depth(width: u32, height: u32, depths: &[f32]) -> Result<GreyImage> {
        let covered = depths.iter().copied().filter(|depth| *depth > 0.0 && depth.is_finite());
        let (least, greatest) =
            covered.fold((f32::INFINITY, 0.0f32), |(least, greatest), depth| (least.min(depth), greatest.max(depth)));
        let span = (f64::from(greatest) / f64::from(least)).ln();
        let grey = |depth: f32| {
            if depth == f32::INFINITY {
                255
            } else if depth > 0.0 {
                let part = (f64::from(depth) / f64::from(least)).ln() / span;
                // One depth alone spans nothing: 0 / 0, shown white.
                if part.is_nan() { 255 } else { (40.0 + part * 215.0).round() as u8 }
            } else {
                0
            }
        };
        GreyImage::from_pixels(width, height, depths.iter().copied().map(grey).collect())
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The bytes, one a pixel, row by row.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The picture with each pixel a square of `factor` pixels, in colour so that it can be marked.
    ///
    /// # Errors
    ///
    /// [`Error::Size`] if the result is too large, or `factor` is 0.
    pub fn enlarged(&self, factor: u32) -> Result<RgbImage> {
        let width = self.width.saturating_mul(factor);
        let height = self.height.saturating_mul(factor);
        let mut pixels = Vec::with_capacity(byte_count(width, height, 3)?);
        for row in self.pixels.chunks_exact(self.width as usize) {
            let row: Vec<u8> = row.iter().flat_map(|&grey| std::iter::repeat_n(grey, 3 * factor as usize)).collect();
            (0..factor).for_each(|_| pixels.extend_from_slice(&row));
        }
        RgbImage::from_pixels(width, height, pixels)
    }

    /// Writes the picture as PNG, whole or not at all.
    ///
    /// # Errors
    ///
    /// [`Error::File`] with the path and the system's reason.
    pub fn write_png(&self, path: &Path) -> Result<()> {
        write_png(path, &self.pixels, self.width, self.height, ExtendedColorType::L8)
    }
}

/// `from` moved towards `to` by `strength` / 255, rounded.
fn mix(from: u8, to: u8, strength: u8) -> u8 {
    let (from, to, strength) = (u32::from(from), u32::from(to), u32::from(strength));
    // At most (255 * 255 + 127) / 255 = 255.
    ((from * (255 - strength) + to * strength + 127) / 255) as u8
}

fn write_png(path: &Path, pixels: &[u8], width: u32, height: u32, kind: ExtendedColorType) -> Result<()> {
    atomically(path, |out| PngEncoder::new(out).write_image(pixels, width, height, kind).map_err(io::Error::other))
}

/// The levels of a pyramid side by side, the first (finest) at its own size, the others scaled up
/// by the greatest whole factor that keeps within its height, thin lines between them.
///
/// # Errors
///
/// [`Error::Parameter`] without a level, [`Error::Size`] if the picture becomes too large.
pub fn side_by_side(levels: &[GreyImage]) -> Result<RgbImage> {
    let finest =
        levels.first().ok_or_else(|| Error::parameter("levels", "none", "a pyramid has at least one level"))?;
    let enlarged = |level: &GreyImage| level.enlarged((finest.height / level.height).max(1));
    let pictures = levels.iter().map(enlarged).collect::<Result<Vec<RgbImage>>>()?;
    in_rows(&pictures, pictures.len())
}

/// Pictures in rows of `columns`, thin lines between them; rows and columns are as large as their
/// largest picture, and what a picture leaves of its place is light grey.
///
/// # Errors
///
/// [`Error::Parameter`] without a picture or column, [`Error::Size`] if the sheet becomes too large.
pub fn contact_sheet(pictures: &[RgbImage], columns: usize) -> Result<RgbImage> {
    in_rows(pictures, columns)
}

fn in_rows(pictures: &[RgbImage], columns: usize) -> Result<RgbImage> {
    if pictures.is_empty() || columns == 0 {
        return Err(Error::parameter("pictures", pictures.len(), "a sheet takes at least one picture and column"));
    }
    let columns = columns.min(pictures.len());
    let mut widths = vec![0; columns];
    let mut heights = vec![0; pictures.len().div_ceil(columns)];
    for (index, picture) in pictures.iter().enumerate() {
        let (row, column) = (index / columns, index % columns);
        widths[column] = picture.width.max(widths[column]);
        heights[row] = picture.height.max(heights[row]);
    }
    let (lefts, width) = starts(&widths);
    let (tops, height) = starts(&heights);
    let mut sheet = RgbImage::new(width, height, SEPARATOR)?;
    for (&top, &rows) in tops.iter().zip(&heights) {
        for (&left, &across) in lefts.iter().zip(&widths) {
            sheet.paste(&RgbImage::new(across, rows, PAPER)?, left, top);
        }
    }
    for (index, picture) in pictures.iter().enumerate() {
        sheet.paste(picture, lefts[index % columns], tops[index / columns]);
    }
    Ok(sheet)
}

/// Where each of `sizes` starts with lines between them, and where the last one ends.
fn starts(sizes: &[u32]) -> (Vec<u32>, u32) {
    let mut starts = Vec::with_capacity(sizes.len());
    let mut end = 0u32;
    for (index, &size) in sizes.iter().enumerate() {
        let start = if index == 0 { 0 } else { end.saturating_add(SEPARATOR_WIDTH) };
        starts.push(start);
        end = start.saturating_add(size);
    }
    (starts, end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_sizes_are_errors() {
        for (width, height) in [(0, 1), (1, 0), (MAX_SIDE + 1, 1)] {
            let expected = Error::Size { width: width.into(), height: height.into() };
            assert_eq!(RgbImage::new(width, height, Rgb::CULLED), Err(expected.clone()));
            assert_eq!(GreyImage::from_pixels(width, height, vec![]), Err(expected));
        }
        assert!(matches!(RgbImage::from_pixels(2, 2, vec![0; 11]), Err(Error::Parameter { .. })));
        assert!(side_by_side(&[]).is_err() && contact_sheet(&[], 3).is_err());
        let dot = RgbImage::new(1, 1, Rgb::CULLED).unwrap();
        assert!(contact_sheet(&[dot], 0).is_err());
    }

    #[test]
    fn levels_stand_side_by_side_at_one_height() {
        let fine = GreyImage::from_pixels(4, 4, vec![255; 16]).unwrap();
        let coarse = GreyImage::from_pixels(2, 2, vec![0, 255, 255, 0]).unwrap();
        let sheet = side_by_side(&[fine, coarse]).unwrap();
        assert_eq!((sheet.width(), sheet.height()), (4 + 2 + 4, 4));
        assert_eq!(sheet.get(4, 0), Some(SEPARATOR));
        assert_eq!(sheet.get(7, 1), Some(Rgb([0; 3])));
        assert_eq!(sheet.get(8, 1), Some(Rgb([255; 3])));
        assert_eq!(sheet.get(10, 0), None);
    }

    #[test]
    fn white_is_only_what_is_opaque() {
        let map = GreyImage::from_opacity(5, 1, &[0.0, 0.5, 0.9999, 1.0, f32::NAN]).unwrap();
        assert_eq!(map.pixels(), [0, 127, 254, 255, 0]);
    }

    #[test]
    fn nearer_depth_is_lighter_and_background_black() {
        let depths = [0.0, 0.001, 0.01, 1.0, f32::INFINITY, f32::NAN, -1.0];
        let picture = GreyImage::from_depth(7, 1, &depths).unwrap();
        assert_eq!(picture.pixels(), [0, 40, 112, 255, 255, 0, 0]);
        assert_eq!(GreyImage::from_depth(2, 1, &[0.5, 0.5]).unwrap().pixels(), [255, 255]);
        assert_eq!(GreyImage::from_depth(1, 1, &[0.0]).unwrap().pixels(), [0]);
    }

    #[test]
    fn tints_and_outlines_stop_at_the_border() {
        let mut picture = RgbImage::new(3, 2, Rgb([100; 3])).unwrap();
        picture.tint(0, 0, Rgb([200, 100, 0]), 255);
        picture.tint(1, 0, Rgb([200, 100, 0]), 51);
        picture.tint(9, 9, Rgb::CULLED, 255);
        picture.outline([1, 1, u32::MAX, u32::MAX], Rgb([0; 3]));
        assert_eq!(picture.get(0, 0), Some(Rgb([200, 100, 0])));
        assert_eq!(picture.get(1, 0), Some(Rgb([120, 100, 80])));
        assert_eq!(picture.get(2, 1), Some(Rgb([0; 3])));
        assert_eq!(picture.get(0, 1), Some(Rgb([100; 3])));
    }

    #[test]
    fn reducing_takes_means_of_what_is_there() {
        let pixels = [0u8, 10, 20].iter().flat_map(|&grey| [grey; 3]).collect();
        let reduced = RgbImage::from_pixels(3, 1, pixels).unwrap().reduced(2);
        assert_eq!((reduced.width(), reduced.height()), (2, 1));
        assert_eq!(reduced.pixels(), [5, 5, 5, 20, 20, 20]);
    }
}
