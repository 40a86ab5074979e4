//! One connection: request after request, each within its time.

use std::io::{self, Read};
use std::net::{Shutdown, TcpStream};
use std::time::Duration;

use super::access::Access;
use super::deadline::Timed;
use super::request::{BadHead, Buffer, Head};
use super::response::Response;
use super::routes::Site;

/// A connection may be quiet so long between requests.
const QUIET: Duration = Duration::from_secs(60);

/// The first head may take so long to come, and each that has begun.
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
        if buffer.is_empty() {
            buffer.read(&mut within(if number == 0 { HEAD } else { QUIET }))?;
        }
        let (response, close) = match buffer.head(&mut within(HEAD)) {
            Ok(head) => match refusal(&head, access, site) {
                Some(refusal) => (refusal, head.length > 0 || head.close),
                None => {
                    let body = buffer.body(head.length, &mut within(BODY))?;
                    (site.answer(&head, &body), head.close)
                }
            },
            Err(BadHead::Refused(status, message)) => (Response::error(status, message), true),
            Err(BadHead::Nothing(error)) => return Err(error),
        };
        response.write(&mut within(ANSWER), close)?;
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

/// What is said to a request whose body is not even read.
fn refusal(head: &Head, access: &Access, site: &Site<'_, '_>) -> Option<Response<'static>> {
    if let Err(refusal) = access.check(head, site.is_open(&head.path)) {
        return Some(Response::error(403, refusal.message()));
    }
    site.check(head).err().map(|(status, message)| Response::error(status, message))
}
