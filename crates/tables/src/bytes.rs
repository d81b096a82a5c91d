//! Tables as bytes: number of axes (plus 16 if the table is extrapolated), two end conditions, lengths of the
//! axes, then knots and values as pairs of doubles. The least significant byte comes first.

use crate::error::TableError;
use crate::spline::End;
use equip_scalar::DoubleDouble;

/// What a table is made of.
pub(crate) struct Content {
    pub(crate) ends: [End; 2],
    pub(crate) is_extrapolated: bool,
    pub(crate) axes: Vec<Vec<DoubleDouble>>,
    pub(crate) values: Vec<DoubleDouble>,
}

/// Added to the number of axes.
const EXTRAPOLATED: u8 = 16;

pub(crate) fn write(
    (ends, is_extrapolated): ([End; 2], bool),
    axes: &[&[DoubleDouble]],
    values: &[DoubleDouble],
) -> Vec<u8> {
    let flag = if is_extrapolated { EXTRAPOLATED } else { 0 };
    let mut bytes = vec![axes.len() as u8 | flag];
    let number = |bytes: &mut Vec<u8>, x: &DoubleDouble| {
        bytes.extend(x.hi().to_le_bytes());
        bytes.extend(x.lo().to_le_bytes());
    };
    for end in ends {
        let (kind, x) = match end {
            End::Slope(x) => (1, x),
            End::Curvature(x) => (2, x),
            End::NotAKnot => (3, DoubleDouble::ZERO),
        };
        bytes.push(kind);
        number(&mut bytes, &x);
    }
    for axis in axes {
        bytes.extend((axis.len() as u64).to_le_bytes());
    }
    for x in axes.iter().copied().flatten().chain(values) {
        number(&mut bytes, x);
    }
    bytes
}

pub(crate) fn read(bytes: &[u8]) -> Result<Content, TableError> {
    let mut rest = bytes;
    let head = byte(&mut rest)?;
    let (axes, is_extrapolated) = (head & !EXTRAPOLATED, head & EXTRAPOLATED != 0);
    if !(1..=2).contains(&axes) {
        return Err(TableError::Damaged);
    }
    let mut end = || match (byte(&mut rest)?, number(&mut rest)?) {
        (1, x) => Ok(End::Slope(x)),
        (2, x) => Ok(End::Curvature(x)),
        (3, _) => Ok(End::NotAKnot),
        _ => Err(TableError::Damaged),
    };
    let ends = [end()?, end()?];
    let mut lengths = Vec::new();
    for _ in 0..axes {
        let length = u64::from_le_bytes(take(&mut rest)?);
        lengths.push(usize::try_from(length).map_err(|_| TableError::Damaged)?);
    }
    let count = (lengths.iter()).try_fold(1_usize, |count, &n| count.checked_mul(n));
    let mut numbers = |n: usize| (0..n).map(|_| number(&mut rest)).collect();
    let axes = lengths.iter().map(|&n| numbers(n));
    let axes: Vec<Vec<DoubleDouble>> = axes.collect::<Result<_, _>>()?;
    let values = numbers(count.ok_or(TableError::Damaged)?)?;
    if !rest.is_empty() {
        return Err(TableError::Damaged);
    }
    Ok(Content {
        ends,
        is_extrapolated,
        axes,
        values,
    })
}

fn take<const N: usize>(rest: &mut &[u8]) -> Result<[u8; N], TableError> {
    let (head, tail) = rest.split_first_chunk().ok_or(TableError::Damaged)?;
    *rest = tail;
    Ok(*head)
}

fn byte(rest: &mut &[u8]) -> Result<u8, TableError> {
    Ok(take::<1>(rest)?[0])
}

fn number(rest: &mut &[u8]) -> Result<DoubleDouble, TableError> {
    let [hi, lo] = [take(rest)?, take(rest)?].map(f64::from_le_bytes);
    Ok(DoubleDouble::new(hi, lo))
}
