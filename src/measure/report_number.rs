//! How figures are written for people: three significant digits, and never more room than needed.
//!
//! Tables and plots use these; JSON and CSV carry the figures whole. What cannot be measured (a NaN
//! or an infinity) is a dash.

/// What is shown in the place of a figure that does not exist.
pub const NO_FIGURE: &str = "-";

/// Three significant digits without an exponent: `0.0123`, `1.23`, `12.3`, `123`, `1234`.
///
/// Below 0.001 there are more decimals, at most six; zero is `0`.
pub fn digits3(value: f64) -> String {
    if !value.is_finite() {
        return NO_FIGURE.to_string();
    }
    if value == 0.0 {
        return "0".to_string();
    }
    let magnitude = value.abs().log10().floor() as i32;
    let decimals = (2 - magnitude).clamp(0, 6) as usize;
    let text = format!("{value:.decimals$}");
    // 9.999 has magnitude 0 but is written 10.00: give the carried digit's room back.
    let digits = text.bytes().filter(u8::is_ascii_digit).skip_while(|&digit| digit == b'0').count();
    if digits > 3 && decimals > 0 {
        return format!("{value:.*}", decimals - 1);
    }
    text
}

/// A count: whole below 10,000, then `312k`, `12.7M`, `1.02G`.
pub fn count(value: f64) -> String {
    if !value.is_finite() {
        return NO_FIGURE.to_string();
    }
    // From where on a unit is used, so that 999,950 is written 1.00M and not 1000k.
    for (from, unit, name) in [(999.5e6, 1e9, "G"), (999.5e3, 1e6, "M"), (9999.5, 1e3, "k")] {
        if value.abs() >= from {
            return format!("{}{name}", digits3(value / unit));
        }
    }
    if value.abs() >= 10.0 || value.fract() == 0.0 { format!("{value:.0}") } else { format!("{value:.1}") }
}

/// A whole count with its thousands apart, as in running text: `312,524`.
pub fn grouped(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A tick of an axis: as short as the value allows, `0`, `0.5`, `20`, `400k`, `1.2M`.
pub fn tick(value: f64) -> String {
    let (scaled, unit) = match value.abs() {
        size if size >= 1e9 => (value / 1e9, "G"),
        size if size >= 1e6 => (value / 1e6, "M"),
        size if size >= 1e4 => (value / 1e3, "k"),
        _ => (value, ""),
    };
    let text = format!("{scaled:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    format!("{}{unit}", if text == "-0" { "0" } else { text })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_say_enough() {
        let written = [0.0, 0.0123, 0.99951, 1.234, 9.999, 12.34, 99.96, 123.4, 12345.0].map(digits3);
        assert_eq!(written, ["0", "0.0123", "1.00", "1.23", "10.0", "12.3", "100", "123", "12345"]);
        assert_eq!(digits3(f64::NAN), "-");
        assert_eq!(digits3(-1.5), "-1.50");
        assert_eq!(digits3(0.000_001_2), "0.000001");
    }

    #[test]
    fn counts_are_short() {
        let written = [0.0, 7.5, 12.4, 9999.0, 10_000.0, 312_524.0, 999_960.0, 12_748_510.0].map(count);
        assert_eq!(written, ["0", "7.5", "12", "9999", "10.0k", "313k", "1.00M", "12.7M"]);
        assert_eq!(grouped(12_748_510), "12,748,510");
        assert_eq!(grouped(999), "999");
    }

    #[test]
    fn ticks_have_no_idle_digits() {
        let written = [0.0, -0.0, 0.5, 20.0, 2500.0, 10_000.0, 400_000.0, 1_250_000.0].map(tick);
        assert_eq!(written, ["0", "0", "0.5", "20", "2500", "10k", "400k", "1.25M"]);
    }
}
