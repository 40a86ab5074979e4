//! The server of the page, for this machine only.
//!
//! Any program on this machine can connect, and so can any page in a browser. So the server answers only requests with
//! the token of the address, a `Host` of this machine (against DNS rebinding) and, if an `Origin` is present, the
//! page's own. Limits apply to heads, bodies, times and the number of connections.
//!
//! The server uses only the parser `httparse` (`docs/notes/files-and-page.md#server`).

mod access;
mod connection;
mod deadline;
mod request;
mod response;
mod routes;

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use crate::{Live, ViewError};
use access::Access;
use routes::Content;

/// Largest number of simultaneous connections; a browser opens six.
const MAX_CONNECTIONS: usize = 64;

/// Interval between two checks of `is_stopped`.
const CHECK_INTERVAL: Duration = Duration::from_millis(50);

/// One of the simultaneous connections. Its drop frees the slot, also after a panic.
struct Slot<'a>(&'a AtomicUsize);

impl<'a> Slot<'a> {
    /// Returns a free slot; `None` if all slots are taken.
    fn take(taken: &'a AtomicUsize) -> Option<Self> {
        let before = taken.fetch_add(1, Ordering::Relaxed);
        let slot = Self(taken);
        (before < MAX_CONNECTIONS).then_some(slot)
    }
}

impl Drop for Slot<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// An HTTP server on 127.0.0.1.
pub struct Server {
    listener: TcpListener,
    access: Access,
    port: u16,
}

impl Server {
    /// Opens a port; 0 means any free port.
    ///
    /// # Errors
    /// If the port is taken, or the operating system has no random numbers.
    pub fn bind(port: u16) -> Result<Self, ViewError> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        let port = listener.local_addr()?.port();
        Ok(Self { listener, access: Access::new(port)?, port })
    }

    /// Returns the address of the page, with the token.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.access.token())
    }

    /// Serves a live page until `is_stopped` returns true. It is called every 50 ms.
    ///
    /// # Errors
    /// If the operating system refuses a thread.
    pub fn serve(&self, live: &Live, is_stopped: &(dyn Fn() -> bool + Sync)) -> io::Result<()> {
        self.run(&Content::Live(live), is_stopped)
    }

    /// Serves a report until `is_stopped` returns true.
    ///
    /// # Errors
    /// The errors are those of [`Server::serve`].
    pub fn serve_report(&self, html: &str, is_stopped: &(dyn Fn() -> bool + Sync)) -> io::Result<()> {
        self.run(&Content::Report(html), is_stopped)
    }

    fn run(&self, content: &Content<'_>, is_stopped: &(dyn Fn() -> bool + Sync)) -> io::Result<()> {
        let connections = AtomicUsize::new(0);
        let (connections, access) = (&connections, &self.access);
        thread::scope(|scope| {
            thread::Builder::new().spawn_scoped(scope, || {
                while !is_stopped() {
                    thread::sleep(CHECK_INTERVAL);
                }
                // This connection ends the blocking `accept` in the loop below.
                let here = SocketAddr::from((Ipv4Addr::LOCALHOST, self.port));
                let _ = TcpStream::connect_timeout(&here, Duration::from_secs(1));
            })?;
            while !is_stopped() {
                let Ok((stream, _)) = self.listener.accept() else {
                    // Too many open files, or a client that has already left.
                    thread::sleep(CHECK_INTERVAL);
                    continue;
                };
                let Some(slot) = Slot::take(connections) else { continue };
                let serve = move || {
                    let _slot = slot;
                    // An error means that the client has left.
                    let _ = connection::serve(stream, access, content, is_stopped);
                };
                // If no thread can be started, dropping `serve` frees the slot and closes the connection.
                let _ = thread::Builder::new().spawn_scoped(scope, serve);
            }
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_are_freed_also_after_a_panic() {
        let taken = AtomicUsize::new(0);
        let all: Vec<_> = (0..MAX_CONNECTIONS).map(|_| Slot::take(&taken).unwrap()).collect();
        assert!(Slot::take(&taken).is_none());
        drop(all);
        let ended = thread::scope(|scope| {
            let serve = || {
                let _slot = Slot::take(&taken);
                panic!("on purpose");
            };
            scope.spawn(serve).join()
        });
        assert!(ended.is_err());
        assert_eq!(taken.into_inner(), 0);
    }
}
