//! The paths of the server, and their answers.

use serde::de::DeserializeOwned;

use super::request::Head;
use super::response::Response;
use crate::{Live, PAGE, ViewError};

/// Largest size of a body (bytes), enough for a q of 10,000 numbers.
const MAX_BODY_BYTES: usize = 1 << 20;

/// Largest size of a body with a motion (bytes).
const MAX_MOTION_BYTES: usize = 64 << 20;

const NOT_FOUND: &str = "the server has no such path";

/// The content of a server.
pub(super) enum Content<'a, 'm> {
    /// A live page.
    Live(&'a Live<'m>),
    /// A report as one HTML file.
    Report(&'a str),
}

/// The HTTP method of a path, the largest size of its body (bytes), and its handler.
struct Route<'a> {
    method: &'static str,
    max_body: usize,
    answer: Answer<'a>,
}

/// Whether the client has left.
pub(super) type IsGone<'g> = &'g (dyn Fn() -> bool + Sync);

/// Computes the response from the body.
type Answer<'a> = Box<dyn Fn(&[u8], IsGone<'_>) -> Response<'a> + 'a>;

impl<'a> Content<'a, '_> {
    /// Whether the path needs no token. This is the live page itself, which contains no data, so a browser can reload
    /// it after the page has removed the token from the address. A report contains data.
    pub(super) fn is_open(&self, path: &str) -> bool {
        matches!((self, path), (Self::Live(_), "/"))
    }

    /// Checks a request before its body is read. An error is a status and a message of one line.
    pub(super) fn check(&self, head: &Head) -> Result<(), (u16, &'static str)> {
        let route = self.route(&head.path).ok_or((404, NOT_FOUND))?;
        if route.method != head.method {
            return Err((405, "this path needs another HTTP method"));
        }
        if head.length > route.max_body {
            Err((413, "the body is larger than this path allows"))
        } else {
            Ok(())
        }
    }

    /// Returns the response to a request that [`Content::check`] has accepted.
    pub(super) fn answer(&self, head: &Head, body: &[u8], is_gone: IsGone<'_>) -> Response<'a> {
        match self.route(&head.path) {
            Some(route) => (route.answer)(body, is_gone),
            None => Response::error(404, NOT_FOUND),
        }
    }

    fn route(&self, path: &str) -> Option<Route<'a>> {
        let live = match (self, path) {
            (Self::Live(_), "/") => return Some(get(|| Response::html(PAGE))),
            (Self::Report(html), "/") => {
                let html = *html;
                return Some(get(move || Response::html(html)));
            }
            (Self::Report(_), _) => return None,
            (Self::Live(live), _) => *live,
        };
        if let Some(name) = path.strip_prefix("/api/array/") {
            let bytes = live.array(name)?;
            return Some(get(move || Response::binary(bytes)));
        }
        Some(match path {
            "/api/scene" => get(|| Response::json(live.scene())),
            "/api/nodes" => get(|| Response::json(&live.nodes())),
            "/api/check" => post(MAX_BODY_BYTES, |request, _| Ok(Response::json(&live.check(&request)?))),
            "/api/traditional" => {
                post(MAX_BODY_BYTES, |request, _| Ok(Response::json(&live.traditional(&request)?)))
            }
            "/api/safe_scale" => post(MAX_BODY_BYTES, |request, is_gone| {
                Ok(Response::json(&live.safe_scale(&request, is_gone)?))
            }),
            "/api/sweep" => {
                post(MAX_BODY_BYTES, |request, is_gone| Ok(Response::json(&live.sweep(&request, is_gone)?)))
            }
            "/api/boxes" => post(MAX_BODY_BYTES, |request, _| Ok(Response::json(&live.boxes(&request)?))),
            "/api/glb" => {
                post(MAX_MOTION_BYTES, |request, _| Ok(Response::binary(live.animation(&request)?)))
            }
            _ => return None,
        })
    }
}

fn get<'a>(answer: impl Fn() -> Response<'a> + 'a) -> Route<'a> {
    Route { method: "GET", max_body: 0, answer: Box::new(move |_, _| answer()) }
}

/// A route whose request is JSON.
fn post<'a, T: DeserializeOwned>(
    max_body: usize,
    answer: impl Fn(T, IsGone<'_>) -> Result<Response<'a>, ViewError> + 'a,
) -> Route<'a> {
    let answer = move |body: &[u8], is_gone: IsGone<'_>| {
        let refused = |error: &dyn ToString| Response::error(400, &error.to_string());
        match serde_json::from_slice(body) {
            Ok(request) => answer(request, is_gone).unwrap_or_else(|error| refused(&error)),
            Err(error) => refused(&error),
        }
    };
    Route { method: "POST", max_body, answer: Box::new(answer) }
}
