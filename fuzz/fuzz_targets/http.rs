//! Requests to the page: heads and bodies, in pieces of any size.
#![no_main]

use std::io::Read;

use libfuzzer_sys::fuzz_target;
use sscc_fuzz::bounded;

#[allow(dead_code)]
#[path = "../../crates/sscc-view/src/server/request.rs"]
mod request;

/// A connection that delivers a few bytes at once.
struct Pieces<'a, 'b> {
    bytes: &'a mut &'b [u8],
    size: usize,
}

impl Read for Pieces<'_, '_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = buffer.len().min(self.size);
        self.bytes.read(&mut buffer[..count])
    }
}

fuzz_target!(|bytes: &[u8]| bounded(bytes, attack));

fn attack(bytes: &[u8]) {
    let (Some(size), mut rest) = (bytes.first(), bytes.get(1..).unwrap_or_default()) else { return };
    let mut connection = Pieces { bytes: &mut rest, size: usize::from(*size) + 1 };
    let mut buffer = request::Buffer::default();
    while let Ok(head) = buffer.head(&mut connection) {
        _ = head.parameter("token");
        if buffer.body(head.length.min(1 << 20), &mut connection).is_err() {
            break;
        }
    }
}
