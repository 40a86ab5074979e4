//! The subset of HTTP/1.1 requests that the page uses.

use std::io::{self, ErrorKind, Read};

/// Largest size of a head (bytes).
const MAX_HEAD_BYTES: usize = 16 << 10;

/// Largest number of headers.
const MAX_HEADERS: usize = 64;

/// Largest number of bytes of one read.
const CHUNK_BYTES: usize = 16 << 10;

/// The request line and the headers of a request.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Head {
    pub(super) method: String,
    pub(super) path: String,
    /// The part of the address after `?`.
    pub(super) query: String,
    pub(super) host: Option<String>,
    pub(super) origin: Option<String>,
    pub(super) token: Option<String>,
    /// Size of the body (bytes).
    pub(super) length: usize,
    /// Whether the connection ends after this request.
    pub(super) close: bool,
}

impl Head {
    /// Returns a parameter of the query, without percent-decoding.
    pub(super) fn parameter(&self, name: &str) -> Option<&str> {
        self.query.split('&').find_map(|pair| pair.strip_prefix(name)?.strip_prefix('='))
    }
}

/// The reason for a missing head.
#[derive(Debug)]
pub(super) enum BadHead {
    /// The client has left, or the head took too long.
    Missing(io::Error),
    /// The request is refused with a status and a message of one line.
    Refused(u16, &'static str),
}

/// Bytes that were read from a connection and not yet used.
#[derive(Default)]
pub(super) struct Buffer {
    bytes: Vec<u8>,
}

impl Buffer {
    /// Whether no byte of the next request has been read.
    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Reads once. The end of the stream is an error.
    pub(super) fn read(&mut self, from: &mut impl Read) -> io::Result<()> {
        let mut chunk = [0; CHUNK_BYTES];
        match from.read(&mut chunk)? {
            0 => Err(ErrorKind::UnexpectedEof.into()),
            n => {
                self.bytes.extend(&chunk[..n]);
                Ok(())
            }
        }
    }

    /// Returns the next head.
    pub(super) fn head(&mut self, from: &mut impl Read) -> Result<Head, BadHead> {
        loop {
            if let Some((head, used)) = parse(&self.bytes)? {
                self.bytes.drain(..used);
                return Ok(head);
            }
            if self.bytes.len() >= MAX_HEAD_BYTES {
                return Err(BadHead::Refused(431, "the head of the request is larger than 16 KiB"));
            }
            self.read(from).map_err(BadHead::Missing)?;
        }
    }

    /// Returns a body of `length` bytes. Memory grows with the bytes received, not with the announced length.
    pub(super) fn body(&mut self, length: usize, from: &mut impl Read) -> io::Result<Vec<u8>> {
        while self.bytes.len() < length {
            self.read(from)?;
        }
        let rest = self.bytes.split_off(length);
        Ok(std::mem::replace(&mut self.bytes, rest))
    }
}

/// Returns a head and its size; `None` if the head is incomplete.
fn parse(bytes: &[u8]) -> Result<Option<(Head, usize)>, BadHead> {
    let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    let used = match request.parse(bytes) {
        Ok(httparse::Status::Complete(used)) => used,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => {
            return Err(BadHead::Refused(431, "the request has more than 64 headers"));
        }
        Err(_) => return Err(BadHead::Refused(400, "this is not an HTTP/1.1 request")),
    };
    let (path, query) =
        request.path.unwrap_or_default().split_once('?').unwrap_or((request.path.unwrap_or_default(), ""));
    let mut head = Head {
        method: request.method.unwrap_or_default().to_owned(),
        path: path.to_owned(),
        query: query.to_owned(),
        close: request.version == Some(0),
        ..Head::default()
    };
    let mut length = None;
    for header in request.headers.iter() {
        let value = || String::from_utf8_lossy(header.value).trim().to_owned();
        // A repeated header is ambiguous: client and server could use different ones.
        let once = |place: &mut Option<String>| match place.replace(value()) {
            None => Ok(()),
            Some(_) => Err(BadHead::Refused(400, "a header occurs twice")),
        };
        match header.name.to_ascii_lowercase().as_str() {
            "host" => once(&mut head.host)?,
            "origin" => once(&mut head.origin)?,
            "x-sscc-token" => once(&mut head.token)?,
            "content-length" => once(&mut length)?,
            "transfer-encoding" => return Err(BadHead::Refused(411, "the request needs a Content-Length")),
            "connection" => head.close |= value().to_ascii_lowercase().contains("close"),
            _ => {}
        }
    }
    if let Some(length) = length {
        let is_number = !length.is_empty() && length.bytes().all(|b| b.is_ascii_digit());
        // A length beyond usize exceeds every limit.
        head.length = if is_number {
            length.parse().unwrap_or(usize::MAX)
        } else {
            return Err(BadHead::Refused(400, "Content-Length is not a number"));
        };
    }
    Ok(Some((head, used)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(bytes: &[u8]) -> Result<Head, BadHead> {
        Buffer::default().head(&mut &bytes[..])
    }

    fn status(bytes: &[u8]) -> u16 {
        match head(bytes) {
            Err(BadHead::Refused(status, _)) => status,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn heads_and_bodies_follow_each_other() {
        let text = b"POST /api/check?a=1&token=x HTTP/1.1\r\nHost: localhost:1\r\nORIGIN: http://a\r\n\
            X-Sscc-Token:  y \r\nContent-Length: 3\r\n\r\nabcGET / HTTP/1.0\r\n\r\n";
        let (mut buffer, mut from) = (Buffer::default(), &text[..]);
        let first = buffer.head(&mut from).unwrap();
        assert_eq!(
            first,
            Head {
                method: "POST".into(),
                path: "/api/check".into(),
                query: "a=1&token=x".into(),
                host: Some("localhost:1".into()),
                origin: Some("http://a".into()),
                token: Some("y".into()),
                length: 3,
                close: false,
            }
        );
        assert_eq!((first.parameter("token"), first.parameter("tok")), (Some("x"), None));
        assert_eq!(buffer.body(3, &mut from).unwrap(), b"abc");
        let second = buffer.head(&mut from).unwrap();
        assert!(second.close && second.path == "/" && second.length == 0);
        assert!(matches!(buffer.head(&mut from), Err(BadHead::Missing(_))));
    }

    #[test]
    fn invalid_requests_are_refused() {
        assert_eq!(status(b"\x16\x03\x01\x02\0\x01\0\x01\xfc\x03\x03"), 400);
        assert_eq!(status(b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n"), 400);
        assert_eq!(status(b"GET / HTTP/1.1\r\nContent-Length: -1\r\n\r\n"), 400);
        assert_eq!(status(b"GET / HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 1\r\n\r\n"), 400);
        assert_eq!(status(b"GET / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n"), 411);
        assert_eq!(status(&[b"GET / HTTP/1.1\r\n".to_vec(), b"a: b\r\n".repeat(100)].concat()), 431);
        assert_eq!(status(&[b"GET /".to_vec(), vec![b'x'; 1 << 20]].concat()), 431);
        let huge = head(b"GET / HTTP/1.1\r\nContent-Length: 99999999999999999999999\r\n\r\n").unwrap();
        assert_eq!(huge.length, usize::MAX);
    }

    #[test]
    fn random_bytes_cause_no_panic() {
        let good = b"POST /api/check?token=x HTTP/1.1\r\nHost: localhost:1\r\nContent-Length: 3\r\n\r\nabc";
        let mut state = 1_u64;
        for round in 0..20_000 {
            let mut bytes = good.to_vec();
            for _ in 0..=round % 4 {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                let at = (state >> 33) as usize % bytes.len();
                bytes[at] = (state >> 20) as u8;
            }
            bytes.truncate(1 + (state >> 40) as usize % bytes.len());
            let _ = head(&bytes);
        }
    }
}
