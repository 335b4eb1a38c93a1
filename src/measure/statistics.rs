//! Median, percentile and mean, each with its definition, so that two reports can be compared.
//!
//! Frame times have a long tail, therefore reports lead with the median and the 95th percentile; the
//! mean stands beside them only where the papers print means. Values are ordered by
//! [`f64::total_cmp`], so a NaN sorts last instead of upsetting the order. Cost: one sort a call.

/// The middle value; of an even number of values, the mean of the two in the middle.
///
/// `None` without values.
///
/// ```
/// use homcull::measure::statistics::median;
/// assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
/// assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), Some(2.5));
/// ```
pub fn median(values: &[f64]) -> Option<f64> {
    let sorted = sorted(values);
    let upper = *sorted.get(sorted.len() / 2)?;
    if sorted.len() % 2 == 1 {
        return Some(upper);
    }
    let lower = sorted[sorted.len() / 2 - 1];
    Some(lower + (upper - lower) / 2.0)
}

/// The nearest-rank percentile: the smallest value that at least `percent` percent of the values do
/// not exceed. It is always one of the values, never an interpolation.
///
/// `percent` is held to 0 to 100; 0 gives the least value, 100 the greatest. `None` without values.
pub fn percentile(values: &[f64], percent: f64) -> Option<f64> {
    let sorted = sorted(values);
    let last = sorted.len().checked_sub(1)?;
    let rank = (percent.clamp(0.0, 100.0) / 100.0 * sorted.len() as f64).ceil();
    // A NaN percent casts to 0, the least value.
    Some(sorted[(rank as usize).saturating_sub(1).min(last)])
}

/// The arithmetic mean, summed in the order given. `None` without values.
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.into_iter().fold((0.0, 0u64), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f64)
}

/// The least and the greatest value. `None` without values.
pub fn range(values: &[f64]) -> Option<(f64, f64)> {
    let least = values.iter().copied().min_by(f64::total_cmp)?;
    let greatest = values.iter().copied().max_by(f64::total_cmp)?;
    Some((least, greatest))
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_has_no_statistics() {
        assert_eq!(median(&[]), None);
        assert_eq!(percentile(&[], 95.0), None);
        assert_eq!(mean([]), None);
        assert_eq!(range(&[]), None);
    }

    #[test]
    fn one_value_is_every_statistic() {
        assert_eq!(median(&[7.0]), Some(7.0));
        assert_eq!(percentile(&[7.0], 0.0), Some(7.0));
        assert_eq!(percentile(&[7.0], 100.0), Some(7.0));
        assert_eq!(mean([7.0]), Some(7.0));
        assert_eq!(range(&[7.0]), Some((7.0, 7.0)));
    }

    #[test]
    fn the_percentile_is_the_nearest_rank() {
        let hundred: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(percentile(&hundred, 95.0), Some(95.0));
        assert_eq!(percentile(&hundred, 95.5), Some(96.0));
        assert_eq!(percentile(&hundred, 0.0), Some(1.0));
        assert_eq!(percentile(&hundred, 1000.0), Some(100.0));
        assert_eq!(percentile(&[1.0, 2.0, 3.0, 4.0], 50.0), Some(2.0));
    }

    #[test]
    fn the_mean_of_no_order_is_the_same_value() {
        assert_eq!(mean([1.0, 2.0, 6.0]), Some(3.0));
        assert_eq!(median(&[1.0, 2.0, 6.0]), Some(2.0));
    }

    #[test]
    fn a_nan_sorts_last_and_panics_nowhere() {
        assert_eq!(median(&[f64::NAN, 1.0, 2.0]), Some(2.0));
        assert_eq!(percentile(&[f64::NAN, 1.0], f64::NAN), Some(1.0));
    }
}
