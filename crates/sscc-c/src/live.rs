//! The list of live handles, by which libraries with debug assertions refuse pointers that are not live handles.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::status::{Failure, Result, sscc_status};

/// Addresses of handles, and the names of their types.
static LIVE: Mutex<BTreeMap<usize, &'static str>> = Mutex::new(BTreeMap::new());

fn live() -> MutexGuard<'static, BTreeMap<usize, &'static str>> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Adds a handle.
pub fn add(address: usize, name: &'static str) {
    if cfg!(debug_assertions) {
        live().insert(address, name);
    }
}

/// Refuses an address that is not a live handle of that type.
#[inline(always)]
pub fn check(address: usize, name: &'static str) -> Result<()> {
    if cfg!(debug_assertions) && live().get(&address) != Some(&name) {
        let message = format!("{name} is no live handle: it was freed, or is of another type");
        return Err(Failure::new(sscc_status::Handle, message));
    }
    Ok(())
}

/// Removes a handle.
pub fn remove(address: usize) {
    if cfg!(debug_assertions) {
        live().remove(&address);
    }
}
