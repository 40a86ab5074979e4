//! One connection: a sequence of requests, with a time limit on each step.

use std::io::{self, ErrorKind, Read};
use std::net::{Shutdown, TcpStream};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::access::Access;
use super::deadline::Timed;
use super::request::{BadHead, Buffer, Head};
use super::response::Response;
use super::routes::Site;

/// A connection may be quiet so long between requests.
const QUIET: Duration = Duration::from_secs(60);

/// A whole head may take so long to come: the first from the beginning of the connection, others from their first byte.
/// Who does not know the token has so long to take the answer, too.
const HEAD: Duration = Duration::from_secs(5);

/// The body.
const BODY: Duration = Duration::from_secs(20);

/// The answer may take so long to be taken.
const ANSWER: Duration = Duration::from_secs(60);

/// What is still on its way after a refusal is let in, and forgotten, so long: hanging up at once could take the answer
/// away from those who are still sending.
const FAREWELL: Duration = Duration::from_secs(2);

/// Answers all requests of a connection.
pub(super) fn talk(
    stream: TcpStream,
    access: &Access,
    site: &Site<'_, '_>,
    is_stopped: &(dyn Fn() -> bool + Sync),
) -> io::Result<()> {
    stream.set_nodelay(true)?;
    let within = |time| Timed::new(&stream, time, is_stopped);
    let mut buffer = Buffer::default();
    for number in 0.. {
        if number > 0 && buffer.is_empty() {
            buffer.read(&mut within(QUIET))?;
        }
        let (mut close, mut is_known) = (true, false);
        let response = match buffer.head(&mut within(HEAD)) {
            Ok(head) => {
                // A connection stays open only for a client with the token. Other clients could otherwise take all
                // connections.
                is_known = access.is_known(&head);
                let refusal = refusal(&head, access, site);
                close = head.close || !is_known || refusal.is_some() && head.length > 0;
                match refusal {
                    Some(refusal) => refusal,
                    None => {
                        let body = buffer.body(head.length, &mut within(BODY))?;
                        let presence = Presence::of(&stream)?;
                        site.answer(&head, &body, &|| presence.is_gone())
                    }
                }
            }
            Err(BadHead::Refused(status, message)) => Response::error(status, message),
            Err(BadHead::Nothing(error)) => return Err(error),
        };
        response.write(&mut within(if is_known { ANSWER } else { HEAD }), close)?;
        if close {
            stream.shutdown(Shutdown::Write)?;
            let mut rest = within(FAREWELL);
            let mut forgotten = [0; 1 << 16];
            while rest.read(&mut forgotten)? > 0 {}
            return Ok(());
        }
    }
    Ok(())
}

/// Whether the other side still waits for its answer; looked at now and then while the answer is worked on.
struct Presence<'a> {
    stream: &'a TcpStream,
    /// None once the other side has left.
    next_look: Mutex<Option<Instant>>,
}

impl<'a> Presence<'a> {
    /// Between two looks.
    const PAUSE: Duration = Duration::from_millis(50);

    fn of(stream: &'a TcpStream) -> io::Result<Self> {
        stream.set_nonblocking(true)?;
        Ok(Self { stream, next_look: Mutex::new(Some(Instant::now())) })
    }

    /// Whether the client has left. A client that closes one direction counts as gone, since browsers close both.
    fn is_gone(&self) -> bool {
        let mut next_look = self.next_look.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        if next_look.is_some_and(|next| next <= now) {
            let has_left = match self.stream.peek(&mut [0]) {
                Ok(bytes) => bytes == 0,
                Err(error) => !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted),
            };
            *next_look = (!has_left).then_some(now + Self::PAUSE);
        }
        next_look.is_none()
    }
}

impl Drop for Presence<'_> {
    fn drop(&mut self) {
        let _ = self.stream.set_nonblocking(false);
    }
}

/// The response to a request that is refused before its body is read; `None` if it is accepted.
fn refusal(head: &Head, access: &Access, site: &Site<'_, '_>) -> Option<Response<'static>> {
    if let Err(refusal) = access.check(head, site.is_open(&head.path)) {
        return Some(Response::error(403, refusal.message()));
    }
    site.check(head).err().map(|(status, message)| Response::error(status, message))
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::net::TcpListener;
    use std::thread;

    use super::*;

    #[test]
    fn who_leaves_is_missed() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut there = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (here, _) = listener.accept().unwrap();
        let presence = Presence::of(&here).unwrap();
        let looks = |times: usize| {
            (0..times).any(|_| {
                thread::sleep(Presence::PAUSE);
                presence.is_gone()
            })
        };
        assert!(!looks(3));
        there.write_all(b"the next request").unwrap();
        assert!(!looks(3));
        drop(presence);
        let mut read = [0; 16];
        // The stream blocks again, and the bytes that `peek` saw are still there.
        (&here).read_exact(&mut read).unwrap();
        assert_eq!(&read, b"the next request");
        let presence = Presence::of(&here).unwrap();
        drop(there);
        assert!((0..1200).any(|_| {
            thread::sleep(Presence::PAUSE);
            presence.is_gone()
        }));
        // And stays away, between two looks as well.
        assert!(presence.is_gone());
    }
}
