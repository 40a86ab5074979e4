//! Reads and writes with a deadline.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Interval between two checks of `is_stopped`.
const SLICE: Duration = Duration::from_millis(100);

/// A connection with one deadline for all reads and writes together, however slow the client is.
pub(super) struct DeadlineStream<'a> {
    stream: &'a TcpStream,
    end: Instant,
    is_stopped: &'a (dyn Fn() -> bool + Sync),
}

impl<'a> DeadlineStream<'a> {
    pub(super) fn new(
        stream: &'a TcpStream,
        time: Duration,
        is_stopped: &'a (dyn Fn() -> bool + Sync),
    ) -> Self {
        Self { stream, end: Instant::now() + time, is_stopped }
    }

    /// Returns the timeout of the next system call.
    fn slice(&self) -> io::Result<Duration> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() || (self.is_stopped)() {
            Err(ErrorKind::TimedOut.into())
        } else {
            Ok(left.min(SLICE))
        }
    }

    /// Repeats a system call until it is done or the deadline has passed.
    fn until_done(
        &self,
        set: impl Fn(Duration) -> io::Result<()>,
        mut work: impl FnMut() -> io::Result<usize>,
    ) -> io::Result<usize> {
        loop {
            set(self.slice()?)?;
            match work() {
                Err(error)
                    if matches!(
                        error.kind(),
                        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
                    ) => {}
                done => return done,
            }
        }
    }
}

impl Read for DeadlineStream<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let mut stream = self.stream;
        self.until_done(|slice| self.stream.set_read_timeout(Some(slice)), || stream.read(into))
    }
}

impl Write for DeadlineStream<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut stream = self.stream;
        self.until_done(|slice| self.stream.set_write_timeout(Some(slice)), || stream.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;
    use std::thread;

    use super::*;

    #[test]
    fn slow_clients_cannot_extend_the_deadline() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut there = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (here, _) = listener.accept().unwrap();
        thread::scope(|scope| {
            scope.spawn(move || {
                // Writes until the other end closes the connection.
                while there.write_all(b"x").is_ok() {
                    thread::sleep(Duration::from_millis(10));
                }
            });
            let (time, begin) = (Duration::from_millis(300), Instant::now());
            let mut timed = DeadlineStream::new(&here, time, &|| false);
            let error = timed.read_to_end(&mut Vec::new()).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::TimedOut);
            assert!(begin.elapsed() >= time);
            drop(here);
        });
    }
}
