//! [`from_bytes`]: a table from its bytes.

use crate::bytes::{Content, read};
use crate::error::TableError;
use crate::{Table, Table2, whole};
use equip_scalar::Outside;
use std::sync::Arc;

/// The table of which [`Outside::to_bytes`] made these bytes; every bit of it is the same. For
/// `Hamiltonian::from_bytes_with`.
///
/// # Errors
/// [`TableError`] if they are no table.
pub fn from_bytes(bytes: &[u8]) -> Result<Arc<dyn Outside>, TableError> {
    if whole::is_floor(bytes) {
        return Ok(whole::outside());
    }
    let Content { ends, axes, values } = read(bytes)?;
    match &axes[..] {
        [x] => Ok(Table::new(x, &values, ends)?.outside()),
        [x, y] => Ok(Table2::new(x, y, &values, ends[0])?.outside()),
        _ => Err(TableError::Damaged),
    }
}
