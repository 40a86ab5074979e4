//! The paths of the server, and their answers.

use serde::de::DeserializeOwned;
use sscc::CancelToken;

use super::request::Head;
use super::response::Response;
use crate::{Live, PAGE, ViewError};

/// Largest size of a body (bytes), enough for a q of 10,000 numbers.
const MAX_BODY_BYTES: usize = 1 << 20;

/// Largest size of a body with a motion (bytes).
const MAX_MOTION_BYTES: usize = 64 << 20;

const NOT_FOUND: &str = "the server has no such path";

/// The content of a server.
pub(super) enum Content<'a> {
    /// A live page.
    Live(&'a Live),
    /// A report as one HTML file.
    Report(&'a str),
}

/// The HTTP method of a path, the largest size of its body (bytes), and its handler.
struct Route<'a> {
    method: &'static str,
    max_body: usize,
    answer: Answer<'a>,
}

/// Computes the response from the body. The token is cancelled when the client has left.
type Answer<'a> = Box<dyn Fn(&[u8], &CancelToken) -> Response<'a> + 'a>;

impl<'a> Content<'a> {
    /// Whether the path needs no token. This is the live page itself, which contains no data, so a browser can reload
    /// it after the page has removed the token from the address. A report contains data.
    pub(super) fn is_open(&self, path: &str) -> bool {
        matches!((self, path), (Self::Live(_), "/"))
    }

    /// Checks a request before its body is read. An error is the response.
    pub(super) fn check(&self, head: &Head) -> Result<(), Response<'static>> {
        let route = self.route(&head.path).ok_or_else(|| Response::error(404, NOT_FOUND))?;
        if route.method != head.method {
            return Err(Response::wrong_method(route.method));
        }
        if head.length > route.max_body {
            Err(Response::error(413, "the body is larger than this path allows"))
        } else {
            Ok(())
        }
    }

    /// Returns the response to a request that [`Content::check`] has accepted.
    pub(super) fn answer(&self, head: &Head, body: &[u8], client: &CancelToken) -> Response<'a> {
        match self.route(&head.path) {
            Some(route) => (route.answer)(body, client),
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
            "/api/safe_scale" => post(MAX_BODY_BYTES, |request, client| {
                Ok(Response::json(&live.safe_scale(&request, client)?))
            }),
            "/api/sweep" => {
                post(MAX_BODY_BYTES, |request, client| Ok(Response::json(&live.sweep(&request, client)?)))
            }
            "/api/intervals" => {
                post(MAX_BODY_BYTES, |request, client| Ok(Response::json(&live.intervals(&request, client)?)))
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

/// Returns a route whose request is JSON.
fn post<'a, T: DeserializeOwned>(
    max_body: usize,
    answer: impl Fn(T, &CancelToken) -> Result<Response<'a>, ViewError> + 'a,
) -> Route<'a> {
    let answer = move |body: &[u8], client: &CancelToken| {
        let refused = |error: &dyn ToString| Response::error(400, &error.to_string());
        match serde_json::from_slice(body) {
            Ok(request) => answer(request, client).unwrap_or_else(|error| refused(&error)),
            Err(error) => refused(&error),
        }
    };
    Route { method: "POST", max_body, answer: Box::new(answer) }
}
