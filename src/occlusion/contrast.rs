//! Contrast between an object and what covers it (Zhang 1998, 5.3.2).
//!
//! The sun behind leaves shows through the smallest hole. So the opacity threshold is raised by the contrast between the
//! tested object and the occluders: the difference of their relative luminances, that of the occluders taken as the mean over the
//! pixel in question. A mean over every layer that was submitted, hidden or not, does not depend on order; see `layers.rs`.

/// Relative luminance of an sRGB colour, 0 (black) to 255 (white), linear: 0.2126 R + 0.7152 G + 0.0722 B.
pub fn relative_luminance(srgb: [u8; 3]) -> u8 {
    let [r, g, b] = srgb.map(|channel| {
        let c = f64::from(channel) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
    });
    (255.0 * (0.2126 * r + 0.7152 * g + 0.0722 * b)).round() as u8
}

/// Luminance of what covers a pixel, summed over the samples of every layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Luminance {
    pub sum: u64,
    pub samples: u64,
}

impl std::ops::AddAssign for Luminance {
    #[inline(always)]
    fn add_assign(&mut self, o: Luminance) {
        self.sum += o.sum;
        self.samples += o.samples;
    }
}

impl Luminance {
    /// The difference of a relative luminance to the mean, from 0 to 1; 0 where nothing covers.
    #[inline(always)]
    pub fn contrast(self, luminance: u8) -> f64 {
        if self.samples == 0 {
            return 0.0;
        }
        (self.sum as f64 / self.samples as f64 - f64::from(luminance)).abs() / 255.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn luminance_runs_from_black_to_white_and_green_counts_most() {
        assert_eq!([[0; 3], [255; 3]].map(relative_luminance), [0, 255]);
        let [r, g, b] = [[255, 0, 0], [0, 255, 0], [0, 0, 255]].map(relative_luminance);
        assert_eq!((r, g, b), (54, 182, 18));
        // Half the light, not half the number.
        assert_eq!(relative_luminance([188; 3]), 128);
    }

    #[test]
    fn contrast_is_the_distance_to_the_mean() {
        let mut covers = Luminance::default();
        assert_eq!(covers.contrast(255), 0.0);
        covers += Luminance { sum: 3 * 51, samples: 3 };
        covers += Luminance { sum: 0, samples: 3 };
        assert_eq!((covers.contrast(255), covers.contrast(0)), (229.5 / 255.0, 25.5 / 255.0));
        assert_eq!(Luminance { sum: 255, samples: 1 }.contrast(0), 1.0);
    }
}
