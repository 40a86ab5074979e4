//! HTTP responses.

use std::borrow::Cow;
use std::io::{self, Write};

use serde::Serialize;
use serde_json::json;

/// Content security policy: the page runs only its own scripts, connects only to this server, and no other page can
/// embed it.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
     media-src data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// An HTTP response.
pub(super) struct Response<'a> {
    pub(super) status: u16,
    kind: &'static str,
    pub(super) body: Cow<'a, [u8]>,
}

impl<'a> Response<'a> {
    pub(super) fn html(text: &'a str) -> Self {
        Self { status: 200, kind: "text/html; charset=utf-8", body: text.as_bytes().into() }
    }

    pub(super) fn binary(bytes: impl Into<Cow<'a, [u8]>>) -> Self {
        Self { status: 200, kind: "application/octet-stream", body: bytes.into() }
    }

    pub(super) fn json(value: &impl Serialize) -> Self {
        match serde_json::to_vec(value) {
            Ok(body) => Self { status: 200, kind: JSON, body: body.into() },
            Err(error) => Self::error(500, &error.to_string()),
        }
    }

    /// Returns an error with a message of one line.
    pub(super) fn error(status: u16, message: &str) -> Self {
        Self { status, kind: JSON, body: json!({"error": message}).to_string().into_bytes().into() }
    }

    pub(super) fn write(&self, to: &mut impl Write, close: bool) -> io::Result<()> {
        let head = format!(
            "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: {}\r\nCache-Control: no-store\r\n\
             Content-Security-Policy: {POLICY}\r\nCross-Origin-Resource-Policy: same-origin\r\n\
             Referrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\n\r\n",
            self.status,
            reason(self.status),
            self.kind,
            self.body.len(),
            if close { "close" } else { "keep-alive" },
        );
        // A small response is one write.
        if self.body.len() < 1 << 16 {
            return to.write_all(&[head.as_bytes(), &self.body].concat());
        }
        to.write_all(head.as_bytes())?;
        to.write_all(&self.body)
    }
}

const JSON: &str = "application/json";

fn reason(status: u16) -> &'static str {
    match status {
        200 => "OK",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        408 => "Request Timeout",
        411 => "Length Required",
        413 => "Content Too Large",
        431 => "Request Header Fields Too Large",
        _ => "Internal Server Error",
    }
}
