//! Load of the server: many clients at once, some slow or hostile, get right answers, and memory does not grow.

use std::io::{Read, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::common::{Client, next_reply, with_server};

/// Numbers of clients that send queries, that send random bytes, and that send single bytes slowly. Their sum is the server's
/// limit.
const CLIENTS: [usize; 3] = [48, 8, 8];

/// Sends queries until `end`, and checks every answer. Connects again when the server closes a connection. Returns the number
/// of answers.
fn ask(client: &Client, end: Instant, seed: u64) -> u64 {
    let mut answers = 0;
    while Instant::now() < end {
        let (mut stream, mut bytes) = (client.connect(), Vec::new());
        while Instant::now() < end {
            // Mode 0 lowers the upper strip onto the lower one.
            let serial = seed * 1_000_000 + answers;
            let is_colliding = serial.is_multiple_of(3);
            let body = format!(r#"{{"q":[{},0,0],"serial":{serial}}}"#, if is_colliding { 1 } else { 0 });
            if stream.write_all(&client.request("POST", "/api/check", "", &body)).is_err() {
                break;
            }
            let Ok(reply) = next_reply(&mut stream, &mut bytes) else { break };
            let answer = reply.json();
            assert_eq!((reply.status, &answer["serial"]), (200, &serial.into()));
            assert_eq!(answer["colliding"], is_colliding, "{answer}");
            answers += 1;
        }
    }
    answers
}

/// Sends random bytes and incomplete requests, and disconnects.
fn disturb(client: &Client, end: Instant, seed: u64) {
    let mut state = seed;
    while Instant::now() < end {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let mut bytes = client.request("POST", "/api/check", "", r#"{"q":[0,0,0],"serial":1}"#);
        bytes.truncate((state >> 33) as usize % bytes.len());
        bytes.extend((0..64).map(|k| (state >> (k % 57)) as u8));
        let mut stream = client.connect();
        let _ = stream.write_all(&bytes);
        let _ = stream.set_read_timeout(Some(Duration::from_millis(20)));
        let _ = stream.read(&mut [0; 256]);
        // The number of ports is limited, and a closed connection blocks its port for a while.
        thread::sleep(Duration::from_millis(5));
    }
}

/// Sends requests one byte at a time, slowly.
fn dawdle(client: &Client, end: Instant) {
    while Instant::now() < end {
        let mut stream = client.connect();
        for byte in client.request("GET", "/", "", "") {
            if Instant::now() >= end || stream.write_all(&[byte]).is_err() {
                break;
            }
            thread::sleep(Duration::from_millis(100));
        }
    }
}

/// Returns the resident memory of this process in kB, on Linux.
fn memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmRSS:")?.trim().strip_suffix(" kB")?.parse().ok())
}

#[test]
fn many_clients_are_answered_beside_hostile_ones() {
    // A long run takes ten minutes, to measure memory.
    let is_long = std::env::var_os("SSCC_LONG").is_some();
    let time = Duration::from_secs(if is_long { 600 } else { 3 });
    with_server(|client| {
        let begin = Instant::now();
        let (end, answers) = (begin + time, AtomicU64::new(0));
        let mut early = None;
        thread::scope(|scope| {
            let [asking, disturbing, dawdling] = CLIENTS;
            for k in 0..asking as u64 {
                let answers = &answers;
                scope.spawn(move || {
                    let own = ask(client, end, k + 1);
                    answers.fetch_add(own, Ordering::Relaxed);
                    assert!(own > 0, "client {k} has no answer");
                });
            }
            (0..disturbing as u64).for_each(|k| _ = scope.spawn(move || disturb(client, end, k + 1)));
            (0..dawdling).for_each(|_| _ = scope.spawn(move || dawdle(client, end)));
            thread::sleep(time / 3);
            early = memory();
        });
        let answers = answers.into_inner();
        assert!(answers >= CLIENTS[0] as u64);
        // Only a long run, which is one test alone, measures memory: else other tests run in this process, too.
        if let (true, Some(early), Some(late)) = (is_long, early, memory()) {
            // Threads and buffers of all clients exist after a third of the time.
            assert!(late < early + (32 << 10), "{early} to {late} kB after {answers} answers");
        }
    });
}
