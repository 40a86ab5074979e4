//! The built page, and the insertion of a report's data into it.

use serde::Serialize;

/// The page as built from `viewer/`: one HTML file.
pub const PAGE: &str = include_str!("../page/index.html");

/// Start of the element with the data of a report, which is empty in live pages.
const BEFORE: &str = "<script type=\"application/json\" id=\"sscc-report\">";

/// End of this element.
const AFTER: &str = "</script>";

/// Content security policy of reports. A report loads nothing, not even from its own folder.
const POLICY: &str = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
     script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; media-src data: blob:\">";

/// Returns the page with data inserted as JSON.
pub(crate) fn with_data(data: &impl Serialize) -> serde_json::Result<String> {
    Ok(with_json(&serde_json::to_string(data)?))
}

/// Returns the JSON in a page; `None` if the page has no such element.
pub(crate) fn json_in(page: &str) -> Option<&str> {
    let (_head, rest) = page.split_once(BEFORE)?;
    Some(rest.split_once(AFTER)?.0)
}

/// Returns the page with JSON inserted. `<` is escaped, so no text in the data can end the element.
pub(crate) fn with_json(json: &str) -> String {
    let json = json.replace('<', "\\u003c");
    let (head, rest) = PAGE.split_once(BEFORE).unwrap_or((PAGE, ""));
    let (_null, tail) = rest.split_once(AFTER).unwrap_or(("", rest));
    let head = head.replacen("<head>", &format!("<head>{POLICY}"), 1);
    [&head, BEFORE, &json, AFTER, tail].concat()
}

/// Returns a page that may also run modules of WebAssembly that are within it.
pub(crate) fn allowing_modules(page: String) -> String {
    // Policies are only in the head.
    let (head, rest) = page.split_once("<body>").unwrap_or((&page, ""));
    let scripts = "script-src 'unsafe-inline'";
    [&head.replace(scripts, &format!("{scripts} 'wasm-unsafe-eval'")), "<body>", rest].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_one_element_for_data() {
        let whole = format!("{BEFORE}null{AFTER}");
        assert_eq!(PAGE.matches(&whole).count(), 1);
        assert_eq!(PAGE.matches(BEFORE).count(), 1);
        assert_eq!(PAGE.matches("<head>").count(), 1);
        assert!(PAGE.find("<head>") < PAGE.find("<script"), "the policy comes before the first script");
    }

    #[test]
    fn text_in_the_data_cannot_end_the_element() {
        let page = with_data(&"a</script><script>alert(1)</script><!--").unwrap();
        let data = page.split_once(BEFORE).unwrap().1.split_once(AFTER).unwrap().0;
        assert_eq!(serde_json::from_str::<String>(data).unwrap(), "a</script><script>alert(1)</script><!--");
        assert!(!data.contains('<'));
        assert!(page.contains("<head><meta http-equiv"));
    }
}
