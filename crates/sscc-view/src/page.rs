//! The page itself: one file of HTML, made from `viewer/`.

use serde::Serialize;

/// As it was built.
pub const PAGE: &str = include_str!("../page/index.html");

/// Where the data of a report goes: in live pages it stays as it is.
const BEFORE: &str = "<script type=\"application/json\" id=\"sscc-report\">";
const AFTER: &str = "</script>";

/// A report may load nothing, not even from its own folder.
const POLICY: &str = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
     script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; media-src data: blob:\">";

/// The page with data put in.
pub(crate) fn with_data(data: &impl Serialize) -> serde_json::Result<String> {
    Ok(with_json(&serde_json::to_string(data)?))
}

/// The text of the data in a page.
pub(crate) fn json_in(page: &str) -> Option<&str> {
    let (_head, rest) = page.split_once(BEFORE)?;
    Some(rest.split_once(AFTER)?.0)
}

/// The page with JSON put in. `<` is written as its number, so that no text of the data can end the element.
pub(crate) fn with_json(json: &str) -> String {
    let json = json.replace('<', "\\u003c");
    let (head, rest) = PAGE.split_once(BEFORE).unwrap_or((PAGE, ""));
    let (_null, tail) = rest.split_once(AFTER).unwrap_or(("", rest));
    let head = head.replacen("<head>", &format!("<head>{POLICY}"), 1);
    [&head, BEFORE, &json, AFTER, tail].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_a_place_for_data() {
        let whole = format!("{BEFORE}null{AFTER}");
        assert_eq!(PAGE.matches(&whole).count(), 1);
        assert_eq!(PAGE.matches(BEFORE).count(), 1);
        assert_eq!(PAGE.matches("<head>").count(), 1);
        assert!(PAGE.find("<head>") < PAGE.find("<script"), "the policy comes before the first script");
    }

    #[test]
    fn no_text_ends_the_element() {
        let page = with_data(&"a</script><script>alert(1)</script><!--").unwrap();
        let data = page.split_once(BEFORE).unwrap().1.split_once(AFTER).unwrap().0;
        assert_eq!(serde_json::from_str::<String>(data).unwrap(), "a</script><script>alert(1)</script><!--");
        assert!(!data.contains('<'));
        assert!(page.contains("<head><meta http-equiv"));
    }
}
