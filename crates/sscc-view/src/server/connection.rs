//! One connection: a sequence of requests, with a time limit on each step.

use std::io::{self, ErrorKind, Read};
use std::net::{Shutdown, TcpStream};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use sscc::CancelToken;

use super::access::Access;
use super::deadline::DeadlineStream;
use super::request::{BadHead, Buffer, Head};
use super::response::Response;
use super::routes::Content;

/// Longest pause between requests.
const IDLE_TIMEOUT: Duration = Duration::from_secs(60);

/// Longest time to receive a head: the first from the start of the connection, others from their first byte. A client
/// without the token has the same time to receive the answer.
const HEAD_TIMEOUT: Duration = Duration::from_secs(5);

/// Longest time to receive a body.
const BODY_TIMEOUT: Duration = Duration::from_secs(20);

/// Longest time to send an answer.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(60);

/// After a refusal the server reads and drops input for this time: closing at once could discard the answer of a client
/// that is still sending.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(2);

/// Answers all requests of a connection.
pub(super) fn serve(
    stream: TcpStream,
    access: &Access,
    content: &Content<'_>,
    is_stopped: &(dyn Fn() -> bool + Sync),
) -> io::Result<()> {
    stream.set_nodelay(true)?;
    let within = |time| DeadlineStream::new(&stream, time, is_stopped);
    let mut buffer = Buffer::default();
    for number in 0.. {
        if number > 0 && buffer.is_empty() {
            buffer.read(&mut within(IDLE_TIMEOUT))?;
        }
        let (mut close, mut is_known, mut is_head) = (true, false, false);
        let response = match buffer.head(&mut within(HEAD_TIMEOUT)) {
            Ok(head) => {
                // A connection stays open only for a client with the token. Other clients could otherwise take all
                // connections.
                is_known = access.is_known(&head);
                is_head = head.method == "HEAD";
                let refusal = refusal(&head, access, content);
                close = head.close || !is_known || refusal.is_some() && head.length > 0;
                match refusal {
                    Some(refusal) => refusal,
                    None => {
                        let body = buffer.body(head.length, &mut within(BODY_TIMEOUT))?;
                        let presence = Presence::of(&stream)?;
                        content.answer(&head, &body, &presence.token)
                    }
                }
            }
            Err(BadHead::Refused(status, message)) => Response::error(status, message),
            Err(BadHead::Missing(error)) => return Err(error),
        };
        let time = if is_known { ANSWER_TIMEOUT } else { HEAD_TIMEOUT };
        response.write(&mut within(time), close, is_head)?;
        if close {
            stream.shutdown(Shutdown::Write)?;
            let mut rest = within(DRAIN_TIMEOUT);
            let mut dropped = [0; 1 << 16];
            while rest.read(&mut dropped)? > 0 {}
            return Ok(());
        }
    }
    Ok(())
}

/// Checks periodically, during the computation of an answer, whether the client still waits for it.
struct Presence<'a> {
    stream: &'a TcpStream,
    /// Cancelled when the client has left. A client that closes one direction counts as gone, since browsers close both.
    token: CancelToken,
}

impl<'a> Presence<'a> {
    /// Interval between two checks.
    const CHECK_INTERVAL: Duration = Duration::from_millis(50);

    fn of(stream: &'a TcpStream) -> io::Result<Self> {
        stream.set_nonblocking(true)?;
        let same = stream.try_clone()?;
        // The time of the next check; `None` after the client has left.
        let next_check = Mutex::new(Some(Instant::now()));
        let is_gone = move || {
            let mut next_check = next_check.lock().unwrap_or_else(PoisonError::into_inner);
            let now = Instant::now();
            if next_check.is_some_and(|next| next <= now) {
                let has_left = match same.peek(&mut [0]) {
                    Ok(bytes) => bytes == 0,
                    Err(error) => !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted),
                };
                *next_check = (!has_left).then_some(now + Self::CHECK_INTERVAL);
            }
            next_check.is_none()
        };
        Ok(Self { stream, token: CancelToken::when(is_gone) })
    }
}

impl Drop for Presence<'_> {
    fn drop(&mut self) {
        let _ = self.stream.set_nonblocking(false);
    }
}

/// Returns the response to a request that is refused before its body is read; `None` if it is accepted.
fn refusal(head: &Head, access: &Access, content: &Content<'_>) -> Option<Response<'static>> {
    if let Err(refusal) = access.check(head, content.is_open(&head.path)) {
        return Some(Response::error(403, refusal.message()));
    }
    content.check(head).err()
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::net::TcpListener;
    use std::thread;

    use super::*;

    #[test]
    fn a_client_that_leaves_cancels_its_token() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut there = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (here, _) = listener.accept().unwrap();
        let presence = Presence::of(&here).unwrap();
        let gone_within = |times: usize| {
            (0..times).any(|_| {
                thread::sleep(Presence::CHECK_INTERVAL);
                presence.token.is_cancelled()
            })
        };
        assert!(!gone_within(3));
        there.write_all(b"the next request").unwrap();
        assert!(!gone_within(3));
        drop(presence);
        let mut read = [0; 16];
        // The stream blocks again, and the bytes that `peek` saw are still there.
        (&here).read_exact(&mut read).unwrap();
        assert_eq!(&read, b"the next request");
        let presence = Presence::of(&here).unwrap();
        drop(there);
        assert!((0..1200).any(|_| {
            thread::sleep(Presence::CHECK_INTERVAL);
            presence.token.is_cancelled()
        }));
        // The token stays cancelled, also between two checks.
        assert!(presence.token.is_cancelled());
    }
}
