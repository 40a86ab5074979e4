//! `sscc view`: the printed address, answers of the server, refusals.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

use serde_json::{Value, json};

use crate::common::{command, sscc, strips};

/// A running `sscc view`.
struct Viewer {
    child: Child,
    stdout: BufReader<ChildStdout>,
    port: u16,
    token: String,
}

impl Drop for Viewer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Viewer {
    fn of(folder: &Path, args: &[&str]) -> Self {
        let args = [&["view", "--no-open"], args].concat();
        let mut child = command(folder, &args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        stdout.read_line(&mut line).unwrap();
        let rest = line.strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{line:?}"));
        let (port, token) = rest.strip_suffix('\n').unwrap().split_once("/?token=").unwrap();
        assert!(token.len() >= 32 && token.bytes().all(|b| b.is_ascii_alphanumeric()), "{token}");
        let (port, token) = (port.parse().unwrap(), token.to_owned());
        Self { child, stdout, port, token }
    }

    fn request(&self, method: &str, path: &str, body: &str) -> (u16, String) {
        let Self { port, token, .. } = self;
        let mut stream = TcpStream::connect(("127.0.0.1", *port)).unwrap();
        write!(
            stream,
            "{method} {path} HTTP/1.1\r\nHost: localhost:{port}\r\nX-Sscc-Token: {token}\r\nConnection: close\r\n\
             Content-Length: {}\r\n\r\n{body}",
            body.len()
        )
        .unwrap();
        let mut reply = String::new();
        stream.read_to_string(&mut reply).unwrap();
        let (head, body) = reply.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().parse().unwrap(), body.to_owned())
    }

    /// Sends SIGINT. Returns the exit code, and standard output and standard error after the address.
    #[cfg(unix)]
    fn interrupt(mut self) -> (Option<i32>, String, String) {
        let pid = self.child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
        let code = self.child.wait().unwrap().code();
        let (mut stdout, mut stderr) = (String::new(), String::new());
        self.stdout.read_to_string(&mut stdout).unwrap();
        self.child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
        (code, stdout, stderr)
    }
}

const MODEL: [&str; 3] = ["strips.model.safetensors", "--certificates", "strips.sscc.safetensors"];

#[test]
#[cfg(unix)]
fn a_page_answers_as_check_does_until_ctrl_c() {
    let folder = strips();
    let viewer = Viewer::of(folder.path(), &MODEL);
    for q in [[0.0, 0.0], [0.5, 3.0], [1.0, 0.25], [1.25, -2.0], [2.0, 0.0]] {
        let (status, answer) = viewer.request("POST", "/api/check", &json!({"q": q}).to_string());
        assert_eq!(status, 200, "{answer}");
        let answer: Value = serde_json::from_str(&answer).unwrap();
        let at = format!("--q={},{}", q[0], q[1]);
        let known = &sscc(folder.path(), &[&["check"], &MODEL[..], &[&at, "--json"]].concat()).json()[0];
        for key in [
            "norm",
            "colliding",
            "count",
            "complete",
            "pairs",
            "root_certified",
            "proof",
            "opened",
            "box_tests",
            "triangle_tests",
        ] {
            assert_eq!(answer[key], known[key], "{key}");
        }
    }
    let (status, scene) = viewer.request("GET", "/api/scene", "");
    let scene: Value = serde_json::from_str(&scene).unwrap();
    assert_eq!((status, &scene["title"]), (200, &json!("strips.model.safetensors")));
    // An open connection does not delay the end.
    let _idle = TcpStream::connect(("127.0.0.1", viewer.port)).unwrap();
    assert_eq!(viewer.interrupt(), (Some(0), String::new(), String::new()));
}

#[test]
#[cfg(unix)]
fn certificates_are_computed_where_none_are_given() {
    let folder = strips();
    let viewer = Viewer::of(
        folder.path(),
        &["mesh.obj", "--modes", "modes.npy", "--metric", "identity", "--center=0.5,0"],
    );
    let (_, scene) = viewer.request("GET", "/api/scene", "");
    let scene: Value = serde_json::from_str(&scene).unwrap();
    let model = &scene["models"][0];
    assert_eq!((&model["metric"], &model["center"]), (&json!("identity"), &json!([0.5, 0.0])));
    assert_eq!(model["resolved_up_to"], Value::Null);
    let (code, _, stderr) = viewer.interrupt();
    assert_eq!(code, Some(0));
    assert_eq!(
        stderr,
        "note: no --certificates given: computing them first (sscc certify keeps them in a file)\n"
    );
}

#[test]
#[cfg(unix)]
fn the_report_of_a_folder_is_served() {
    let folder = tempfile::tempdir().unwrap();
    let data = r#"<script type="application/json" id="sscc-report">{"scene":{},"arrays":{}}</script>"#;
    let html = format!("<html><script>steal()</script>{data}<script>steal()</script></html>");
    fs::write(folder.path().join("report.html"), html).unwrap();
    let viewer = Viewer::of(folder.path(), &["."]);
    let (status, body) = viewer.request("GET", &format!("/?token={}", viewer.token), "");
    // The server sends the data in the page of the program, and nothing else of the file.
    assert!(status == 200 && body.contains(data) && !body.contains("steal()"));
    assert_eq!(viewer.request("GET", "/api/scene", "").0, 404);
    assert_eq!(viewer.interrupt().0, Some(0));
}

#[test]
fn invalid_requests_are_refused() {
    let folder = strips();
    let folder = folder.path();
    // The port is taken, so that a command that is not refused for another reason ends, too.
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let refused = |args: &[&str], parts: &[&str]| {
        let run = sscc(folder, &[&["view", "--no-open", "--port", &port], args].concat());
        let message = run.refusal();
        for part in parts {
            assert!(message.contains(part), "{part}: {message}");
        }
    };
    // Flags that contradict the certificates.
    let with = |more: &[&'static str]| [&MODEL[..], more].concat();
    refused(&with(&["--epsilon", "0.5"]), &["certified with --epsilon 0.1, not 0.5"]);
    refused(&with(&["--metric", "mass"]), &["certified with another metric"]);
    refused(&with(&["--center=1,0"]), &["certified about another centre"]);
    refused(&with(&["--neighbours", "include-one-vertex"]), &["neighbours = exclude"]);
    refused(&with(&["--weld=on"]), &["without welding"]);
    // Certificates of another model.
    let text = fs::read_to_string(folder.join("mesh.obj")).unwrap().replacen("v 0 0 0", "v 0 0 0.5", 1);
    fs::write(folder.join("other.obj"), text).unwrap();
    let other = ["other.obj", "--modes", "modes.npy", "--certificates", "strips.sscc.safetensors"];
    refused(&other, &["strips.sscc.safetensors"]);
    // Ports and files.
    refused(&MODEL, &["--port", &port]);
    refused(&["missing.model.safetensors"], &["missing.model.safetensors: not found"]);
    refused(&["mesh.obj"], &["a mesh has no modes"]);
    refused(&["."], &["report.html: not found"]);
    fs::write(folder.join("report.html"), "<html></html>").unwrap();
    refused(&["."], &["report.html: not a report of sscc: it has no data"]);
    fs::write(folder.join("report.html"), "<script type=\"application/json\" id=\"sscc-report\">1</script>")
        .unwrap();
    refused(&["."], &["report.html: not a report of sscc: "]);
    // A sparse file, which takes no disk space.
    fs::File::create(folder.join("report.html")).unwrap().set_len((256 << 20) + 1).unwrap();
    refused(&["."], &["report.html: file is larger than 256 MiB, the maximum for a report"]);
    // Options that have no meaning for a folder.
    for option in
        ["--certificates=a", "--modes=a", "--compare-metrics", "--epsilon=0.5", "--weld=on", "--threads=1"]
    {
        let name = option.split('=').next().unwrap();
        refused(&[".", option], &[name, "is for models"]);
    }
    refused(
        &with(&["--compare-metrics"]),
        &["the model's own metric is displacement (diagonal), not a diagonal energy metric"],
    );
}

#[test]
fn reports_are_written_with_and_without_a_program() {
    let folder = strips();
    let folder = folder.path();
    let run = |more: &[&str]| sscc(folder, &[&["view"], &MODEL[..], more].concat());
    let report = ["--report", "page.html"];
    let package = |more: &str| fs::create_dir_all(folder.join("package").join(more)).unwrap();
    // The page without a program.
    assert_eq!(run(&report).code, Some(0));
    let plain = fs::read_to_string(folder.join("page.html")).unwrap();
    assert!(
        plain.contains("\"root_radius\"") && !plain.contains("script-src 'unsafe-inline' 'wasm-unsafe-eval'")
    );
    // A folder that is no package is refused, and no file is written.
    fs::remove_file(folder.join("page.html")).unwrap();
    let with = [&report[..], &["--wasm", "package"]].concat();
    let script = Path::new("package").join("script").join("sscc.js").display().to_string();
    let manifest = Path::new("package").join("package.json").display().to_string();
    assert!(run(&with).refusal().contains(&format!("{manifest}: not found")));
    package("");
    for (content, cause) in [
        ("{}", "package.json: not a file of the npm package sscc"),
        ("sscc", "package.json: not a file of the npm package sscc"),
        (r#"{"name":"sscc","version":"0.0.1"}"#, "package.json: the package has version 0.0.1, sscc has "),
    ] {
        fs::write(folder.join(&manifest), content).unwrap();
        assert!(run(&with).refusal().contains(cause), "{content}");
    }
    let version = env!("CARGO_PKG_VERSION");
    fs::write(folder.join(&manifest), format!(r#"{{"name":"sscc","version":"{version}"}}"#)).unwrap();
    assert!(run(&with).refusal().contains(&format!("{script}: not found")));
    package("script");
    fs::write(folder.join(&script), "alert(1)").unwrap();
    let module = folder.join("package/sscc_bg.wasm");
    fs::write(&module, b"\0asm\x01\0\0\0").unwrap();
    assert!(run(&with).refusal().contains("sscc.js: not a file of the npm package sscc"));
    fs::write(folder.join(&script), "let ssccPackage = 1;").unwrap();
    fs::write(&module, "<html>").unwrap();
    assert!(run(&with).refusal().contains("sscc_bg.wasm: not a file of the npm package sscc"));
    assert!(!folder.join("page.html").exists());
    // The page with a program.
    fs::write(&module, b"\0asm\x01\0\0\0").unwrap();
    assert_eq!(run(&with).code, Some(0));
    let html = fs::read_to_string(folder.join("page.html")).unwrap();
    assert!(
        html.contains("let ssccPackage = 1;")
            && html.contains("script-src 'unsafe-inline' 'wasm-unsafe-eval'")
    );
    // The server refuses such a page in a folder, because it must not run the scripts of a file.
    fs::rename(folder.join("page.html"), folder.join("package/report.html")).unwrap();
    let served = sscc(folder, &["view", "package", "--no-open"]);
    assert!(served.refusal().contains("report.html: not a report of sscc: it has a program"));
    // Options.
    assert!(
        run(&["--report", "page.txt"])
            .refusal()
            .contains("page.txt: the name of the output must end in .html")
    );
    assert!(sscc(folder, &["view", ".", "--report", "page.html"]).refusal().contains("--report"));
}
