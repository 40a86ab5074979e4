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
                // Connections are kept for those who know the token: others could hold all that there may be.
                is_known = access.is_known(&head);
                let refusal = refusal(&head, access, site);
                close = head.close || !is_known || refusal.is_some() && head.length > 0;
                match refusal {
                    Some(refusal) => refusal,
                    None => {
                        let body = buffer.body(head.length, &mut within(BODY))?;
                        site.answer(&head, &body)
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

/// What is said to a request whose body is not even read.
fn refusal(head: &Head, access: &Access, site: &Site<'_, '_>) -> Option<Response<'static>> {
    if let Err(refusal) = access.check(head, site.is_open(&head.path)) {
        return Some(Response::error(403, refusal.message()));
    }
    site.check(head).err().map(|(status, message)| Response::error(status, message))
}
