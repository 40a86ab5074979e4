//! Access control of the server.

use constant_time_eq::constant_time_eq;

use super::request::Head;
use crate::ViewError;

/// Bytes of randomness in a token.
const TOKEN_BYTES: usize = 32;

/// The token and the host names of the page.
pub(super) struct Access {
    token: String,
    hosts: Vec<String>,
}

/// The reason for a refused request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    Host,
    Origin,
    Token,
}

impl Refusal {
    pub(super) fn message(self) -> &'static str {
        match self {
            Self::Host => "the page is served only at 127.0.0.1",
            Self::Origin => "only the page itself may send requests",
            Self::Token => "the token is missing or wrong: open the address that sscc printed",
        }
    }
}

impl Access {
    pub(super) fn new(port: u16) -> Result<Self, ViewError> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes).map_err(ViewError::Random)?;
        let token = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        let names = ["127.0.0.1", "localhost"];
        let mut hosts: Vec<String> = names.iter().map(|name| format!("{name}:{port}")).collect();
        // Browsers omit the default port.
        if port == 80 {
            hosts.extend(names.map(str::to_owned));
        }
        Ok(Self { token, hosts })
    }

    pub(super) fn token(&self) -> &str {
        &self.token
    }

    /// Refuses a request with a foreign host name or origin, or without the right token. An `open` path holds no data:
    /// there a request may omit the token, but a wrong token is refused.
    pub(super) fn check(&self, head: &Head, open: bool) -> Result<(), Refusal> {
        let known = |host: &str| self.hosts.iter().any(|known| known.eq_ignore_ascii_case(host));
        if !head.host.as_deref().is_some_and(known) {
            return Err(Refusal::Host);
        }
        let origin = head.origin.as_deref();
        if origin.is_some_and(|origin| !origin.strip_prefix("http://").is_some_and(known)) {
            return Err(Refusal::Origin);
        }
        let may = if given(head).is_none() { open } else { self.is_known(head) };
        if may { Ok(()) } else { Err(Refusal::Token) }
    }

    /// Whether the request has the right token. The comparison takes constant time, so its time reveals nothing about
    /// the token.
    pub(super) fn is_known(&self, head: &Head) -> bool {
        given(head).is_some_and(|given| constant_time_eq(given.as_bytes(), self.token.as_bytes()))
    }
}

/// Returns the token in the request, right or wrong.
fn given(head: &Head) -> Option<&str> {
    head.token.as_deref().or(head.parameter("token"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_are_long_and_differ() {
        let [a, b] = [0, 1].map(|_| Access::new(1).unwrap().token);
        assert_eq!(a.len(), 64);
        assert_ne!(a, b);
    }

    #[test]
    fn requests_need_the_host_the_origin_and_the_token() {
        let access = Access::new(8000).unwrap();
        let good = || Head {
            host: Some("127.0.0.1:8000".into()),
            token: Some(access.token.clone()),
            ..Head::default()
        };
        let check = |head: Head| access.check(&head, false);
        assert_eq!(check(good()), Ok(()));
        assert_eq!(check(Head { host: Some("LOCALHOST:8000".into()), ..good() }), Ok(()));
        for origin in ["http://127.0.0.1:8000", "http://localhost:8000"] {
            assert_eq!(check(Head { origin: Some(origin.into()), ..good() }), Ok(()));
        }
        for host in ["127.0.0.1", "127.0.0.1:8001", "example.com:8000", "127.0.0.1:8000.evil", ""] {
            assert_eq!(check(Head { host: Some(host.into()), ..good() }), Err(Refusal::Host), "{host}");
        }
        assert_eq!(check(Head { host: None, ..good() }), Err(Refusal::Host));
        for origin in [
            "null",
            "",
            "http://example.com",
            "https://127.0.0.1:8000",
            "http://127.0.0.1",
            "http://127.0.0.1:8001",
        ] {
            assert_eq!(
                check(Head { origin: Some(origin.into()), ..good() }),
                Err(Refusal::Origin),
                "{origin}"
            );
        }
        let query = |query: String| Head { token: None, query, ..good() };
        assert_eq!(check(query(format!("token={}", access.token))), Ok(()));
        assert_eq!(check(query(format!("a=b&token={}&c", access.token))), Ok(()));
        for wrong in ["", "x", &access.token[1..], &format!("{}0", access.token)] {
            assert_eq!(check(Head { token: Some(wrong.into()), ..good() }), Err(Refusal::Token), "{wrong}");
            assert_eq!(check(query(format!("token={wrong}"))), Err(Refusal::Token), "{wrong}");
        }
        assert_eq!(check(query(String::new())), Err(Refusal::Token));
        assert_eq!(access.check(&query(String::new()), true), Ok(()));
        assert_eq!(access.check(&query("token=".into()), true), Err(Refusal::Token));
    }
}
