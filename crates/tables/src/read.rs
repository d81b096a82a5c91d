//! [`from_bytes`]: a table from its bytes.

use crate::bytes::read;
use crate::error::TableError;
use crate::{Table, Table2, whole};
use equip_scalar::Outside;
use std::sync::Arc;

/// The table from the bytes of [`Outside::to_bytes`], bit for bit. For `Hamiltonian::from_bytes_with`.
///
/// # Errors
/// [`TableError`] if the bytes are not a table.
pub fn from_bytes(bytes: &[u8]) -> Result<Arc<dyn Outside>, TableError> {
    if whole::is_floor(bytes) {
        return Ok(whole::outside());
    }
    let content = read(bytes)?;
    let (ends, values) = (content.ends, &content.values[..]);
    match (&content.axes[..], content.is_extrapolated) {
        ([x], false) => Ok(Table::new(x, values, ends)?.outside()),
        ([x], true) => Ok(Table::new(x, values, ends)?.extrapolated().outside()),
        ([x, y], false) => Ok(Table2::new(x, y, values, ends[0])?.outside()),
        ([x, y], true) => Ok(Table2::new(x, y, values, ends[0])?.extrapolated().outside()),
        _ => Err(TableError::Damaged),
    }
}
