//! Reports: one file with all its data.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use sscc_view::Report;

use crate::common::{scene, strips};

#[test]
fn a_report_contains_all_its_data() {
    let (model, certificates) = strips();
    let (mut scene, arrays) = scene(&model, &certificates);
    scene.title = "</script><img src=x onerror=alert(1)>".into();
    scene.summary.push(("a".into(), "<!-- & \u{2028}".into()));
    let html = Report { scene: scene.clone(), arrays: arrays.clone(), checks: None }.html().unwrap();

    let start = "<script type=\"application/json\" id=\"sscc-report\">";
    let [before, rest] = html.split(start).collect::<Vec<_>>()[..] else {
        panic!("not exactly one element for data")
    };
    let (data, _) = rest.split_once("</script>").unwrap();
    let data: Value = serde_json::from_str(data).unwrap();
    assert_eq!(data["scene"], serde_json::to_value(&scene).unwrap());
    for name in ["positions-0", "faces-0", "modes-0"] {
        let bytes = STANDARD.decode(data["arrays"][name].as_str().unwrap()).unwrap();
        assert_eq!(Some(&bytes[..]), arrays.get(name));
    }
    // The content security policy comes before the first script and forbids all requests.
    let policy = "<head><meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; ";
    assert!(before.find(policy).unwrap() < before.find("<script").unwrap_or(before.len()));
    assert!(!html.contains("<img src=x"));
    for outside in ["src=\"http", "src='http", "href=\"http", "href='http", "src=http", "@import", "url(http"]
    {
        assert!(!html.contains(outside), "{outside}");
    }
}

#[test]
fn a_report_is_rebuilt_from_its_data_alone() {
    let (model, certificates) = strips();
    let (mut scene, arrays) = scene(&model, &certificates);
    scene.title = "</script><img src=x onerror=alert(1)>".into();
    let html = Report { scene, arrays, checks: None }.html().unwrap();
    let hostile = html.replacen("<head>", "<head><script>steal()</script>", 1) + "<script>steal()</script>";
    assert_eq!(Report::rebuild(&hostile).unwrap(), html);
    // Only the data of another program's page are used.
    let start = "<script type=\"application/json\" id=\"sscc-report\">";
    let foreign = format!("<script>steal()</script>{start}{{\"scene\":\"<b>\",\"arrays\":{{}}}}</script>");
    let shown = Report::rebuild(&foreign).unwrap();
    assert!(!shown.contains("steal") && shown.contains(r#"{"scene":"\u003cb>","arrays":{}}"#));
    for data in ["", "null", "{}", "{\"scene\":{}}", "alert(1)", "{\"scene\":{},\"arrays\":{}};alert(1)"] {
        let error = Report::rebuild(&format!("{start}{data}</script>")).unwrap_err().to_string();
        assert!(error.starts_with("not a report of sscc: ") && !error.contains('\n'), "{data}: {error}");
    }
    for html in [String::new(), "<script>steal()</script>".into(), format!("{start}{{}}")] {
        assert!(Report::rebuild(&html).is_err(), "{html}");
    }
}
