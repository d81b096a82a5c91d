//! Distances, orders and trends.

use equip_scalar::Float;

/// max_i |a_i − b_i|; NaN if any difference is.
pub fn distance<T: Float>(a: &[T], b: &[T]) -> T {
    assert_eq!(a.len(), b.len());
    a.iter()
        .zip(b)
        .map(|(&x, &y)| (x - y).abs())
        .fold(T::int(0), nan_max)
}

/// max_i |a_i − b_i| / max_i |b_i|.
pub fn relative_distance<T: Float>(a: &[T], b: &[T]) -> T {
    let size = b.iter().map(|x| x.abs()).fold(T::int(0), nan_max);
    distance(a, b) / size
}

/// The largest of a/b − 1 in size: how far measured figures lie from the ones expected.
pub fn largest_ratio<T: Float>(pairs: &[(T, T)]) -> f64 {
    let off = |&(a, b): &(T, T)| (a / b - T::int(1)).abs().to_f64();
    pairs.iter().map(off).fold(0.0, nan_max)
}

/// The larger of two, or NaN if either is.
fn nan_max<T: Float>(a: T, b: T) -> T {
    if Float::is_nan(b) || b > a { b } else { a }
}

/// log₂ of the ratio of the errors at step h and at step h/2.
pub fn observed_order<T: Float>(coarse: T, fine: T) -> f64 {
    (coarse / fine).to_f64().log2()
}

/// −log₁₀ of an error.
pub fn decimal_digits<T: Float>(error: T) -> f64 {
    -error.to_f64().log10()
}

/// Least-squares line through a series, and how surprising its slope is.
#[derive(Debug, Clone, Copy)]
pub struct Trend {
    /// Slope per sample.
    pub slope: f64,
    /// The slope a random walk with the same steps would have, one standard deviation.
    pub random_walk: f64,
    /// Standard error of the slope if what the line leaves is independent noise.
    pub standard_error: f64,
}

/// Fits a line through `series`, samples of an error that starts at 0 at equal distances.
///
/// A random walk of N steps with variance σ² has a least-squares slope of zero mean and variance
/// (6/5) σ²/N for N ≫ 1: so a slope of a few times that is rounding, one of many times that is a drift.
pub fn trend(series: &[f64]) -> Trend {
    let n = series.len() as f64;
    let mean_x = (n - 1.0) / 2.0;
    let mean = series.iter().sum::<f64>() / n;
    let product = |(i, y): (usize, &f64)| (i as f64 - mean_x) * (y - mean);
    let covariance = series.iter().enumerate().map(product).sum::<f64>();
    let variance = n * (n * n - 1.0) / 12.0;
    let slope = covariance / variance;
    let left = |(i, y): (usize, &f64)| (y - mean - slope * (i as f64 - mean_x)).powi(2);
    let residual = series.iter().enumerate().map(left).sum::<f64>() / (n - 2.0);
    let step = |pair: &[f64]| (pair[1] - pair[0]).powi(2);
    let steps = series.windows(2).map(step).sum::<f64>() / (n - 1.0);
    Trend {
        slope,
        random_walk: (1.2 * steps / n).sqrt(),
        standard_error: (residual / variance).sqrt(),
    }
}
