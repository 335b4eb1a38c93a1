//! The paper that plots are drawn on: a plotters backend in memory, with its own lettering.
//!
//! Why not the ready-made one: plotters' text loses each glyph's left bearing and rounds glyphs to
//! whole pixels, and its bitmap backend brings a second PNG writer. Here text is set at fractions
//! of a pixel from the font in this program (Ubuntu Light, by the crate `epaint_default_fonts`), so
//! that no system font is needed and pictures are equal everywhere; everything is drawn at
//! [`SCALE`] times the size and averaged down, which smooths the lines; and the file is written by
//! [`super::picture`], whole or not at all.

use std::convert::Infallible;
use std::path::Path;

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{BackendColor, BackendCoord, BackendTextStyle, DrawingErrorKind};

use super::picture::RgbImage;
use crate::error::{Error, Result};

/// Drawn pixels for each pixel of the picture, in both directions.
const SCALE: i32 = 2;

/// The area that plots are drawn on, in drawn pixels: see [`px`].
pub(super) type Area<'a> = DrawingArea<Canvas<'a>, Shift>;
/// What drawing can fail with: nothing that happens in memory.
pub(super) type DrawResult<T = ()> = std::result::Result<T, DrawingAreaErrorKind<Infallible>>;

/// A length in the picture's pixels as drawn pixels.
pub(super) const fn px(pixels: i32) -> i32 {
    pixels * SCALE
}

/// A text style of the plots' one typeface, its line `pixels` high in the picture.
pub(super) fn text(pixels: i32, colour: RGBColor) -> TextStyle<'static> {
    ("plot", px(pixels)).into_font().color(&colour)
}

/// Draws a picture of `width` times `height` pixels on white and writes it as PNG.
///
/// # Errors
///
/// [`Error::File`] with the path and the reason, [`Error::Size`] for an impossible size.
pub(super) fn paint(
    path: &Path,
    (width, height): (u32, u32),
    draw: impl FnOnce(&Area<'_>) -> DrawResult,
) -> Result<()> {
    let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).map_err(|error| Error::file(path, error))?;
    let size = (width * SCALE as u32, height * SCALE as u32);
    let mut rgb = vec![255; size.0 as usize * size.1 as usize * 3];
    let area = Canvas { size, rgb: &mut rgb, font }.into_drawing_area();
    draw(&area).and_then(|()| area.present()).map_err(|error| Error::file(path, error))?;
    drop(area);
    RgbImage::from_pixels(size.0, size.1, rgb)?.reduced(SCALE as u32).write_png(path)
}

/// The plotters backend over a buffer of colours.
pub(super) struct Canvas<'a> {
    size: (u32, u32),
    rgb: &'a mut [u8],
    font: FontRef<'static>,
}

impl Canvas<'_> {
    /// The width of a line of text and each glyph's start, in drawn pixels.
    fn set_text(&self, text: &str, line_height: f32) -> (f32, Vec<f32>) {
        let font = self.font.as_scaled(PxScale::from(line_height));
        let mut starts = Vec::with_capacity(text.len());
        let mut end = 0.0;
        let mut last = None;
        for glyph in text.chars().map(|letter| font.glyph_id(letter)) {
            end += last.map_or(0.0, |last| font.kern(last, glyph));
            starts.push(end);
            end += font.h_advance(glyph);
            last = Some(glyph);
        }
        (end, starts)
    }
}

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> std::result::Result<(), DrawingErrorKind<Infallible>> {
        Ok(())
    }

    fn present(&mut self) -> std::result::Result<(), DrawingErrorKind<Infallible>> {
        Ok(())
    }

    fn draw_pixel(
        &mut self,
        (x, y): BackendCoord,
        colour: BackendColor,
    ) -> std::result::Result<(), DrawingErrorKind<Infallible>> {
        let (width, height) = (self.size.0 as i32, self.size.1 as i32);
        if (0..width).contains(&x) && (0..height).contains(&y) {
            let at = (y as usize * self.size.0 as usize + x as usize) * 3;
            let (red, green, blue) = colour.rgb;
            for (channel, ink) in self.rgb[at..at + 3].iter_mut().zip([red, green, blue]) {
                let mixed = f64::from(*channel) * (1.0 - colour.alpha) + f64::from(ink) * colour.alpha;
                *channel = mixed.round() as u8;
            }
        }
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        origin: BackendCoord,
    ) -> std::result::Result<(), DrawingErrorKind<Infallible>> {
        let line_height = style.size() as f32;
        let (width, starts) = self.set_text(text, line_height);
        let left = match style.anchor().h_pos {
            HPos::Left => 0.0,
            HPos::Center => -width / 2.0,
            HPos::Right => -width,
        };
        let top = match style.anchor().v_pos {
            VPos::Top => 0.0,
            VPos::Center => -line_height / 2.0,
            VPos::Bottom => -line_height,
        };
        let scale = PxScale::from(line_height);
        let baseline = top + self.font.as_scaled(scale).ascent();
        let colour = style.color();
        let turn = style.transform();
        for (letter, start) in text.chars().zip(starts) {
            let place = point(left + start, baseline);
            let glyph = self.font.glyph_id(letter).with_scale_and_position(scale, place);
            let Some(outline) = self.font.outline_glyph(glyph) else {
                continue;
            };
            let corner = outline.px_bounds().min;
            let mut dots = Vec::new();
            outline.draw(|x, y, cover| dots.push((x as i32, y as i32, cover)));
            for (x, y, cover) in dots {
                let (x, y) = turn.transform(corner.x as i32 + x, corner.y as i32 + y);
                let alpha = f64::from(cover.clamp(0.0, 1.0)) * colour.alpha;
                self.draw_pixel((origin.0 + x, origin.1 + y), BackendColor { alpha, ..colour })?;
            }
        }
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> std::result::Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let (width, _) = self.set_text(text, style.size() as f32);
        Ok((width.ceil() as u32, style.size().ceil() as u32))
    }
}
