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
    /// The method that the path needs, where the request has another one.
    allow: Option<&'static str>,
    pub(super) body: Cow<'a, [u8]>,
}

impl<'a> Response<'a> {
    pub(super) fn html(text: &'a str) -> Self {
        Self::new(200, "text/html; charset=utf-8", text.as_bytes())
    }

    pub(super) fn binary(bytes: impl Into<Cow<'a, [u8]>>) -> Self {
        Self::new(200, "application/octet-stream", bytes)
    }

    pub(super) fn json(value: &impl Serialize) -> Self {
        match serde_json::to_vec(value) {
            Ok(body) => Self::new(200, JSON, body),
            Err(error) => Self::error(500, &error.to_string()),
        }
    }

    /// Returns an error with a message of one line.
    pub(super) fn error(status: u16, message: &str) -> Self {
        Self::new(status, JSON, json!({"error": message}).to_string().into_bytes())
    }

    /// Returns the error for a path that needs this method.
    pub(super) fn wrong_method(needed: &'static str) -> Self {
        Self { allow: Some(needed), ..Self::error(405, "this path needs another HTTP method") }
    }

    fn new(status: u16, kind: &'static str, body: impl Into<Cow<'a, [u8]>>) -> Self {
        Self { status, kind, allow: None, body: body.into() }
    }

    /// Writes the response. The answer to `HEAD` has no body, because clients read none there: they would take it for the next
    /// answer.
    pub(super) fn write(&self, to: &mut impl Write, close: bool, is_head: bool) -> io::Result<()> {
        let allow = self.allow.map(|method| format!("Allow: {method}\r\n")).unwrap_or_default();
        let head = format!(
            "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: {}\r\n{allow}Cache-Control: no-store\r\n\
             Content-Security-Policy: {POLICY}\r\nCross-Origin-Resource-Policy: same-origin\r\n\
             Referrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\n\r\n",
            self.status,
            reason(self.status),
            self.kind,
            self.body.len(),
            if close { "close" } else { "keep-alive" },
        );
        let body: &[u8] = if is_head { &[] } else { &self.body };
        // A small response is one write.
        if body.len() < 1 << 16 {
            return to.write_all(&[head.as_bytes(), body].concat());
        }
        to.write_all(head.as_bytes())?;
        to.write_all(body)
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
