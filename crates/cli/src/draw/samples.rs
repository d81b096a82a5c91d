//! What a plot needs of a run, in memory that does not grow with the run.

use equip_scalar::Float;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Coordinates kept of all paths together, and points of the energy.
const MOST_COORDINATES: usize = 24_000;
const MOST_BUCKETS: usize = 1_000;

/// All that is drawn of a run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Picture {
    pub(crate) path: Path,
    pub(crate) energy: Envelope,
    /// What was seen of Lyapunov exponents: t, λ, t, MEGNO.
    pub(crate) chaos: Path,
}

impl Picture {
    /// Of paths through these components of y = (q, p).
    pub(crate) fn new(components: Vec<usize>) -> Self {
        Picture {
            path: Path::new(components),
            energy: Envelope::default(),
            chaos: Path::new(vec![0, 1, 2, 3]),
        }
    }

    /// Whether both are drawn of the same components.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        let same = |one: &Path, other: &Path| one.components == other.components;
        same(&self.path, &other.path) && same(&self.chaos, &other.chaos)
    }
}

/// Chosen components of the state at every k-th step; k doubles whenever too many are kept.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Path {
    components: Vec<usize>,
    #[serde(serialize_with = "write_bits", deserialize_with = "read_bits")]
    points: Vec<f64>,
    stride: u64,
    /// Coordinates kept at most. Paths that checkpoints hold have the room of a run.
    #[serde(skip, default = "room_of_a_run")]
    most: usize,
}

impl Path {
    pub(crate) fn new(components: Vec<usize>) -> Self {
        Path::with_room(components, MOST_COORDINATES)
    }

    /// One that keeps at most so many coordinates.
    pub(crate) fn with_room(components: Vec<usize>, most: usize) -> Self {
        Path {
            components,
            points: Vec::new(),
            stride: 1,
            most,
        }
    }

    /// Takes the state y = (q, p) of step `index`, as a function of the component.
    pub(crate) fn see(&mut self, index: u64, y: impl Fn(usize) -> f64) {
        if self.components.is_empty() || !index.is_multiple_of(self.stride) {
            return;
        }
        self.points.extend(self.components.iter().map(|&i| y(i)));
        if self.points.len() > self.most {
            let width = self.components.len();
            let kept = self
                .points
                .chunks_exact(width)
                .step_by(2)
                .flatten()
                .copied();
            self.points = kept.collect();
            self.stride *= 2;
        }
    }

    /// The same for the state (q, p) in the numbers of a run.
    pub(crate) fn see_state<T: Float>(&mut self, index: u64, q: &[T], p: &[T]) {
        let component = |i: usize| if i < q.len() { q[i] } else { p[i - q.len()] };
        self.see(index, |i| component(i).to_f64());
    }

    /// Every how many steps a point was kept.
    pub(crate) fn stride(&self) -> u64 {
        self.stride
    }

    /// The points of path number `i`: components 2i and 2i + 1 of those chosen.
    pub(crate) fn pairs(&self, i: usize) -> impl Iterator<Item = (f64, f64)> + Clone {
        let width = self.components.len().max(1);
        self.points
            .chunks_exact(width)
            .map(move |row| (row[2 * i], row[2 * i + 1]))
    }
}

fn room_of_a_run() -> usize {
    MOST_COORDINATES
}

/// The largest |value| over consecutive buckets of steps; buckets are joined in pairs when there are too
/// many.
#[derive(Debug, Default, Clone, Serialize, Deserialize)]
pub(crate) struct Envelope {
    #[serde(serialize_with = "write_pairs", deserialize_with = "read_pairs")]
    points: Vec<(f64, f64)>,
    width: u64,
    filled: u64,
}

impl Envelope {
    pub(crate) fn see(&mut self, time: f64, value: f64) {
        let value = value.abs();
        match self.points.last_mut() {
            Some(last) if self.filled < self.width => {
                last.1 = last.1.max(value);
                self.filled += 1;
            }
            _ => {
                self.points.push((time, value));
                self.filled = 1;
            }
        }
        if self.points.len() > MOST_BUCKETS {
            let joined = self.points.chunks(2).map(|pair| {
                (
                    pair[0].0,
                    pair.iter().fold(0.0, |most: f64, point| most.max(point.1)),
                )
            });
            self.points = joined.collect();
            self.width = self.width.max(1) * 2;
            // The last bucket was alone: it has room for as many steps again.
            self.filled = self.width / 2;
        }
    }

    /// The same in at most `most` points.
    pub(crate) fn coarse(&self, most: usize) -> Vec<(f64, f64)> {
        let joined = self.points.chunks(self.points.len().div_ceil(most).max(1));
        let largest = |points: &[(f64, f64)]| points.iter().map(|p| p.1).fold(0.0, f64::max);
        joined
            .map(|points| (points[0].0, largest(points)))
            .collect()
    }

    /// Start time and largest |value| of each bucket.
    #[cfg(test)]
    fn points(&self) -> &[(f64, f64)] {
        &self.points
    }
}

/// By their bits: text knows no infinity.
fn write_bits<S: Serializer>(points: &[f64], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(points.iter().map(|x| x.to_bits()))
}

fn read_bits<'a, D: Deserializer<'a>>(from: D) -> Result<Vec<f64>, D::Error> {
    let bits = Vec::<u64>::deserialize(from)?;
    Ok(bits.into_iter().map(f64::from_bits).collect())
}

fn write_pairs<S: Serializer>(points: &[(f64, f64)], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(points.iter().map(|(x, y)| (x.to_bits(), y.to_bits())))
}

fn read_pairs<'a, D: Deserializer<'a>>(from: D) -> Result<Vec<(f64, f64)>, D::Error> {
    let bits = Vec::<(u64, u64)>::deserialize(from)?;
    let pair = |(x, y)| (f64::from_bits(x), f64::from_bits(y));
    Ok(bits.into_iter().map(pair).collect())
}

#[cfg(test)]
mod tests {
    use super::{Envelope, MOST_BUCKETS, MOST_COORDINATES, Path};

    #[test]
    fn long_runs_keep_their_shape_and_their_peak() {
        let (mut path, mut energy) = (Path::new(vec![0, 1]), Envelope::default());
        for index in 0..1_000_000_u64 {
            path.see(index, |i| index as f64 + i as f64);
            energy.see(index as f64, if index == 765_432 { -9.0 } else { 1.0 });
        }
        assert!(
            2 * path.pairs(0).count() <= MOST_COORDINATES && energy.points().len() <= MOST_BUCKETS
        );
        let step = path.stride() as f64;
        assert!(
            path.pairs(0)
                .enumerate()
                .all(|(k, (x, y))| x == k as f64 * step && y == x + 1.0)
        );
        assert_eq!(
            energy
                .points()
                .iter()
                .filter(|point| point.1 == 9.0)
                .count(),
            1
        );
        assert!(energy.points().is_sorted_by(|a, b| a.0 < b.0));
    }
}
