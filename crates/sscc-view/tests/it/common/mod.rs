//! A small model, a server of its page, and a client that can send any bytes.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use glam::DVec3;
use serde_json::Value;
use sscc::{Certificates, CertifyOptions, Modes, ReducedModel, TriMesh};
use sscc_view::{Arrays, Live, ModelDetails, ModelScene, Scene, Server};

/// Number of vertices of a strip.
const STRIP: usize = 40;

/// Returns two strips of triangles at distance 1, one above the other. Mode 0 lowers the upper strip, mode 1 shifts it
/// lengthwise, mode 2 bends its end down.
pub fn strips() -> (ReducedModel, Certificates) {
    let vertex = |i: usize, z: f64| DVec3::new((i / 2) as f64, (i % 2) as f64, z);
    let positions = [0.0, 1.0].map(|z| (0..STRIP).map(|i| vertex(i, z)).collect::<Vec<_>>()).concat();
    let face = |first: usize, i: usize| [first + i, first + i + 1, first + i + 2].map(|v| v as u32);
    let faces = [0, STRIP].map(|first| (0..STRIP - 2).map(|i| face(first, i)).collect::<Vec<_>>()).concat();
    let modes = Modes::from_matrix(2 * STRIP, 3, |row, k| {
        let (vertex, axis) = (row / 3, row % 3);
        let along = (vertex % STRIP / 2) as f64 / (STRIP / 2) as f64;
        match (vertex >= STRIP, axis, k) {
            (true, 2, 0) => -1.0,
            (true, 0, 1) => 1.0,
            (true, 2, 2) => -along * along,
            _ => 0.0,
        }
    });
    let model = ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes.unwrap()).unwrap();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    (model, certificates)
}

/// Returns the scene of the strips and its arrays.
pub fn scene(model: &ReducedModel, certificates: &Certificates) -> (Scene, Arrays) {
    let (mut scene, mut arrays) = (Scene::new("strips"), Arrays::default());
    let details = ModelDetails { frequencies: Some(vec![1.0, 2.0, 3.0]), ..ModelDetails::default() };
    scene.models.push(ModelScene::new(0, "strips", model, certificates, details, &mut arrays).unwrap());
    (scene, arrays)
}

/// Stops the server when it is dropped, also after a panic.
struct StopOnDrop<'a>(&'a AtomicBool);

impl Drop for StopOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Runs a test with a client of a server of the strips.
pub fn with_server(test: impl FnOnce(&Client)) {
    let (model, certificates) = strips();
    let (scene, arrays) = scene(&model, &certificates);
    let live = Live::new(&model, &certificates, scene, arrays, None).unwrap();
    let server = Server::bind(0).unwrap();
    let stopped = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| server.serve(&live, &|| stopped.load(Ordering::Relaxed)).unwrap());
        let _stop = StopOnDrop(&stopped);
        test(&Client::of(&server.address()));
    });
}

/// A client of the server: its port and token.
pub struct Client {
    pub port: u16,
    pub token: String,
}

/// A reply of the server.
#[derive(Debug)]
pub struct Reply {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Reply {
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap()
    }

    /// Returns the message of a refusal: one line.
    pub fn error(&self) -> String {
        let line = self.json()["error"].as_str().unwrap().to_owned();
        assert!(!line.is_empty() && !line.contains('\n'));
        line
    }
}

impl Client {
    pub fn of(address: &str) -> Self {
        let rest = address.strip_prefix("http://127.0.0.1:").unwrap();
        let (port, token) = rest.split_once("/?token=").unwrap();
        Self { port: port.parse().unwrap(), token: token.to_owned() }
    }

    pub fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(120))).unwrap();
        stream
    }

    /// Sends bytes over a new connection, and reads the reply.
    pub fn send(&self, bytes: &[u8]) -> io::Result<Reply> {
        let mut stream = self.connect();
        stream.write_all(bytes)?;
        read_reply(&mut stream)
    }

    /// Returns a valid request with further header lines.
    pub fn request(&self, method: &str, path: &str, more: &str, body: &str) -> Vec<u8> {
        let Self { port, token } = self;
        let length = body.len();
        format!(
            "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nX-Sscc-Token: {token}\r\n\
             Content-Length: {length}\r\n\
             {more}\r\n{body}"
        )
        .into_bytes()
    }

    pub fn get(&self, path: &str) -> Reply {
        self.send(&self.request("GET", path, "", "")).unwrap()
    }

    pub fn post(&self, path: &str, body: &str) -> Reply {
        self.send(&self.request("POST", path, "", body)).unwrap()
    }
}

pub fn read_reply(stream: &mut TcpStream) -> io::Result<Reply> {
    next_reply(stream, &mut Vec::new())
}

/// Reads the next reply; `bytes` are bytes that were read beyond the previous reply.
pub fn next_reply(stream: &mut TcpStream, bytes: &mut Vec<u8>) -> io::Result<Reply> {
    let head = next_head(stream, bytes)?;
    let length = head.lines().find_map(|line| line.strip_prefix("Content-Length: ")).unwrap();
    let length = length.parse().unwrap();
    while bytes.len() < length {
        read_some(stream, bytes)?;
    }
    Ok(Reply { status: status(&head), head, body: bytes.drain(..length).collect() })
}

/// Reads the head of the next reply, which is all of the reply to `HEAD`.
pub fn next_head(stream: &mut TcpStream, bytes: &mut Vec<u8>) -> io::Result<String> {
    loop {
        if let Some(end) = bytes.windows(4).position(|window| window == b"\r\n\r\n") {
            return Ok(String::from_utf8(bytes.drain(..end + 4).collect()).unwrap());
        }
        read_some(stream, bytes)?;
    }
}

/// Returns the status in a head.
pub fn status(head: &str) -> u16 {
    head.split(' ').nth(1).unwrap().parse().unwrap()
}

fn read_some(stream: &mut TcpStream, into: &mut Vec<u8>) -> io::Result<()> {
    let mut chunk = [0; 1 << 16];
    match stream.read(&mut chunk)? {
        0 => Err(io::ErrorKind::UnexpectedEof.into()),
        n => {
            into.extend(&chunk[..n]);
            Ok(())
        }
    }
}
