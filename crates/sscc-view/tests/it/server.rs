//! The server: access control, limits, and robustness against any bytes.

use std::io::{ErrorKind, Read, Write};
use std::net::Shutdown;
use std::thread;
use std::time::{Duration, Instant};

use crate::common::{Client, next_head, next_reply, read_reply, status, with_server};

const CHECK: &str = r#"{"q":[0,0,0],"serial":7}"#;

/// Checks that the server still answers.
fn check_alive(client: &Client) {
    let reply = client.post("/api/check", CHECK);
    assert_eq!((reply.status, &reply.json()["serial"]), (200, &7.into()));
}

#[test]
fn the_page_has_protective_headers() {
    with_server(|client| {
        let Client { port, token } = client;
        let page = client.send(
            format!("GET /?token={token} HTTP/1.1\r\nHost: localhost:{port}\r\nOrigin: http://127.0.0.1:{port}\r\n\r\n")
                .as_bytes(),
        );
        let page = page.unwrap();
        assert_eq!(page.status, 200);
        assert_eq!(page.body, sscc_view::PAGE.as_bytes());
        for line in [
            "Content-Type: text/html; charset=utf-8",
            "Cache-Control: no-store",
            "Content-Security-Policy: default-src 'none'; ",
            "connect-src 'self'; ",
            "frame-ancestors 'none'",
            "Cross-Origin-Resource-Policy: same-origin",
            "Referrer-Policy: no-referrer",
            "X-Content-Type-Options: nosniff",
        ] {
            assert!(page.head.contains(line), "{line}: {}", page.head);
        }
        // The page contains no data, so it can be reloaded without the token.
        let again =
            client.send(format!("GET / HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n").as_bytes()).unwrap();
        assert_eq!((again.status, again.body), (200, page.body));
    });
}

#[test]
fn requests_without_access_are_refused() {
    with_server(|client| {
        let Client { port, token } = client;
        let here = format!("Host: 127.0.0.1:{port}\r\n");
        let known = format!("X-Sscc-Token: {token}\r\n");
        let wrong = format!("X-Sscc-Token: {}\r\n", "0".repeat(64));
        let refused = [
            (here.clone(), "token"),
            (format!("{here}{wrong}"), "token"),
            (format!("{here}X-Sscc-Token: {}\r\n", &token[1..]), "token"),
            (known.clone(), "127.0.0.1"),
            (format!("Host: example.com\r\n{known}"), "127.0.0.1"),
            (format!("Host: 127.0.0.1\r\n{known}"), "127.0.0.1"),
            (format!("Host: example.com:{port}\r\n{known}"), "127.0.0.1"),
            (format!("{here}{known}Origin: http://example.com\r\n"), "page itself"),
            (format!("{here}{known}Origin: null\r\n"), "page itself"),
            (format!("{here}{known}Origin: https://127.0.0.1:{port}\r\n"), "page itself"),
        ];
        for (lines, reason) in refused {
            for first in ["GET /api/scene", "POST /api/check", "GET /api/array/modes-0", "GET /nowhere"] {
                let reply = client.send(format!("{first} HTTP/1.1\r\n{lines}\r\n").as_bytes()).unwrap();
                assert_eq!(reply.status, 403, "{first} {lines}");
                assert!(reply.error().contains(reason), "{first} {lines}");
            }
        }
        for path in [
            "/?token=",
            "/?token=x",
            "/?token=0000000000000000000000000000000000000000000000000000000000000000",
        ] {
            let reply = client.send(format!("GET {path} HTTP/1.1\r\n{here}\r\n").as_bytes()).unwrap();
            assert_eq!(reply.status, 403, "{path}");
        }
        check_alive(client);
    });
}

#[test]
fn unknown_paths_and_methods_are_refused() {
    with_server(|client| {
        for (method, path, status) in [
            ("GET", "/nowhere", 404),
            ("GET", "/api/array/none", 404),
            ("GET", "/api/array/../scene", 404),
            ("GET", "/../../etc/passwd", 404),
            ("GET", "/api/check", 405),
            ("POST", "/api/scene", 405),
            ("PUT", "/api/check", 405),
            ("OPTIONS", "/api/check", 405),
        ] {
            let reply = client.send(&client.request(method, path, "", "")).unwrap();
            assert_eq!(reply.status, status, "{method} {path}");
            reply.error();
        }
    });
}

#[test]
fn refused_methods_name_the_one_that_is_allowed() {
    with_server(|client| {
        for (method, path, allowed) in [
            ("GET", "/api/check", Some("POST")),
            ("OPTIONS", "/api/glb", Some("POST")),
            ("POST", "/api/scene", Some("GET")),
            ("PUT", "/", Some("GET")),
            ("GET", "/api/scene", None),
            ("GET", "/nowhere", None),
        ] {
            let reply = client.send(&client.request(method, path, "", "")).unwrap();
            let found = reply.head.lines().find_map(|line| line.strip_prefix("Allow: "));
            assert_eq!(found, allowed, "{method} {path}");
        }
    });
}

/// Clients of HTTP read no body after `HEAD`: the next answer follows the head.
#[test]
fn answers_to_head_have_no_body() {
    with_server(|client| {
        let (mut stream, mut bytes) = (client.connect(), Vec::new());
        for (path, expected) in [("/", 405), ("/api/scene", 405), ("/api/check", 405), ("/nowhere", 404)] {
            stream.write_all(&client.request("HEAD", path, "", "")).unwrap();
            stream.write_all(&client.request("POST", "/api/check", "", CHECK)).unwrap();
            let head = next_head(&mut stream, &mut bytes).unwrap();
            assert_eq!(status(&head), expected, "{path}");
            assert!(head.contains("Connection: keep-alive"), "{head}");
            assert_eq!(next_reply(&mut stream, &mut bytes).unwrap().json()["serial"], 7, "{path}");
        }
        // Without the token the connection ends after the head.
        let mut stream = client.connect();
        let head = format!("HEAD /api/scene HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", client.port);
        stream.write_all(head.as_bytes()).unwrap();
        assert_eq!(status(&next_head(&mut stream, &mut bytes).unwrap()), 403);
        assert!(bytes.is_empty() && stream.read(&mut [0; 1]).unwrap() == 0);
    });
}

#[test]
fn the_size_of_bodies_is_limited() {
    with_server(|client| {
        let Client { port, token } = client;
        let lines = format!("Host: 127.0.0.1:{port}\r\nX-Sscc-Token: {token}\r\n");
        // The announced length is refused before the body arrives.
        for length in ["1048577", "67108865", "99999999999999999999999999"] {
            let head = format!("POST /api/check HTTP/1.1\r\n{lines}Content-Length: {length}\r\n\r\n");
            let reply = client.send(head.as_bytes()).unwrap();
            assert_eq!(reply.status, 413, "{length}");
            assert!(reply.head.contains("Connection: close"));
        }
        // The limit of a motion is larger.
        let head = format!("POST /api/glb HTTP/1.1\r\n{lines}Content-Length: 67108865\r\n\r\n");
        assert_eq!(client.send(head.as_bytes()).unwrap().status, 413);
        let motion = format!(r#"{{"q":[[0,0,0]],"times":[0]{}}}"#, " ".repeat(2 << 20));
        assert_eq!(client.post("/api/glb", &motion).status, 200);
        // A client that sends the whole body still receives the answer.
        let body = format!("{{\"q\":[{}0]}}", "0,".repeat(1 << 20));
        let reply = client.post("/api/check", &body);
        assert_eq!(reply.status, 413);
        reply.error();
        let scene = client.send(&client.request("GET", "/api/scene", "", "{}")).unwrap();
        assert_eq!(scene.status, 413);
        let chunked = client.request("POST", "/api/check", "Transfer-Encoding: chunked\r\n", "");
        assert_eq!(client.send(&chunked).unwrap().status, 411);
        check_alive(client);
    });
}

#[test]
fn random_bytes_do_not_stop_the_server() {
    with_server(|client| {
        let good = client.request("POST", "/api/check", "", CHECK);
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as usize
        };
        for round in 0..300 {
            let mut bytes = good.clone();
            if round % 3 == 0 {
                bytes = (0..random() % 4096).map(|_| random() as u8).collect();
            } else {
                for _ in 0..=random() % 4 {
                    let at = random() % bytes.len();
                    bytes[at] = random() as u8;
                }
            }
            let mut stream = client.connect();
            stream.write_all(&bytes).unwrap();
            stream.shutdown(Shutdown::Write).unwrap();
            match read_reply(&mut stream) {
                Ok(reply) => {
                    assert!([200, 400, 403, 404, 405, 411, 413, 431].contains(&reply.status), "{reply:?}")
                }
                Err(error) => assert!(
                    matches!(error.kind(), ErrorKind::UnexpectedEof | ErrorKind::ConnectionReset),
                    "{error}"
                ),
            }
        }
        let long = [b"GET /".to_vec(), vec![b'x'; 1 << 17]].concat();
        assert_eq!(client.send(&long).unwrap().status, 431);
        check_alive(client);
    });
}

#[test]
fn requests_follow_each_other_on_one_connection() {
    with_server(|client| {
        let mut stream = client.connect();
        let one = client.request("POST", "/api/check", "", CHECK);
        // All requests at once; the replies arrive in order.
        stream.write_all(&one.repeat(5)).unwrap();
        let mut bytes = Vec::new();
        for _ in 0..5 {
            assert_eq!(next_reply(&mut stream, &mut bytes).unwrap().json()["serial"], 7);
        }
        // A refusal of a request without a body keeps the connection open.
        stream.write_all(&client.request("GET", "/nowhere", "", "")).unwrap();
        assert_eq!(read_reply(&mut stream).unwrap().status, 404);
        stream.write_all(&client.request("GET", "/api/nodes", "Connection: close\r\n", "")).unwrap();
        let last = read_reply(&mut stream).unwrap();
        assert!(last.head.contains("Connection: close"));
        assert_eq!(stream.read(&mut [0; 1]).unwrap(), 0);
    });
}

#[test]
fn connections_stay_open_only_with_the_token() {
    with_server(|client| {
        let here = format!("Host: 127.0.0.1:{}\r\n", client.port);
        let wrong = format!("{here}X-Sscc-Token: {}\r\n", "0".repeat(64));
        for (first, lines, status) in
            [("GET /", &here, 200), ("GET /api/scene", &here, 403), ("GET /", &wrong, 403)]
        {
            let mut stream = client.connect();
            stream.write_all(format!("{first} HTTP/1.1\r\n{lines}\r\n").as_bytes()).unwrap();
            let reply = read_reply(&mut stream).unwrap();
            assert_eq!(reply.status, status, "{first} {lines}");
            assert!(reply.head.contains("Connection: close"), "{first} {lines}");
            assert_eq!(stream.read(&mut [0; 1]).unwrap(), 0);
        }
        let known = client.get("/");
        assert!(known.head.contains("Connection: keep-alive"));
    });
}

#[test]
fn slow_clients_are_disconnected_and_delay_no_other_client() {
    with_server(|client| {
        thread::scope(|scope| {
            // One byte at intervals, without end: neither a first nor a later head is ever complete.
            let later = client.request("POST", "/api/check", "", CHECK);
            let starts = [Vec::new(), b"GET / HTTP/1.1\r\nX: ".to_vec(), [&later[..], b"GET /"].concat()];
            for (start, answers) in starts.into_iter().zip([0, 0, 1]) {
                scope.spawn(move || {
                    let (mut stream, begin) = (client.connect(), Instant::now());
                    stream.write_all(&start).unwrap();
                    for _ in 0..answers {
                        assert_eq!(read_reply(&mut stream).unwrap().status, 200);
                    }
                    stream.set_read_timeout(Some(Duration::from_millis(200))).unwrap();
                    loop {
                        match stream.read(&mut [0; 64]) {
                            Ok(0) => break,
                            Err(error) if error.kind() == ErrorKind::ConnectionReset => break,
                            Ok(_) => panic!("an answer without a request"),
                            Err(_) => {}
                        }
                        if !start.is_empty() && stream.write_all(b"x").is_err() {
                            break;
                        }
                    }
                    assert!(begin.elapsed() >= Duration::from_secs(5), "disconnected too early");
                });
            }
            // Meanwhile other clients receive answers.
            (0..10).for_each(|_| check_alive(client));
        });
        // With too many connections, a new client is answered after some of them have ended.
        let many: Vec<_> = (0..80).map(|_| client.connect()).collect();
        drop(many);
        let answered = (0..200).any(|_| {
            thread::sleep(Duration::from_millis(50));
            client
                .send(&client.request("POST", "/api/check", "", CHECK))
                .is_ok_and(|reply| reply.status == 200)
        });
        assert!(answered);
    });
}
