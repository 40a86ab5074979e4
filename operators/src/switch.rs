//! Selects one of the wrong variants of the code: the one whose number is in `SSCC_VARIANT`. With `SSCC_REACHED`, the name of a
//! file, none is selected, and the file receives the numbers of the variants that the program reaches.
#![allow(clippy::all, clippy::unwrap_used, missing_docs)]

use std::fs::OpenOptions;
use std::io::Write;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

const UNKNOWN: u32 = u32::MAX;
const RECORDING: u32 = u32::MAX - 1;

static SELECTED: AtomicU32 = AtomicU32::new(UNKNOWN);
static REACHED: [AtomicBool; 1 << 16] = [const { AtomicBool::new(false) }; 1 << 16];

/// Whether the variant is selected.
#[inline(always)]
pub(crate) fn is_on(variant: u32) -> bool {
    let selected = SELECTED.load(Relaxed);
    if selected < RECORDING {
        return selected == variant;
    }
    // What was recorded is not recorded again: a test should take about as long as without a record.
    let is_recorded = selected == RECORDING && REACHED[variant as usize].load(Relaxed);
    !is_recorded && first(variant)
}

#[cold]
#[inline(never)]
fn first(variant: u32) -> bool {
    let recording = std::env::var_os("SSCC_REACHED");
    if SELECTED.load(Relaxed) == UNKNOWN {
        let named = std::env::var("SSCC_VARIANT").ok().and_then(|number| number.parse().ok());
        SELECTED.store(if recording.is_some() { RECORDING } else { named.unwrap_or(0) }, Relaxed);
    }
    match recording {
        None => SELECTED.load(Relaxed) == variant,
        Some(path) => {
            if !REACHED[variant as usize].swap(true, Relaxed) {
                let mut file = OpenOptions::new().append(true).create(true).open(path).unwrap();
                file.write_all(format!("{variant}\n").as_bytes()).unwrap();
            }
            false
        }
    }
}
