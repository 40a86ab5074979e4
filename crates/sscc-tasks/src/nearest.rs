//! The nearest known name to a mistyped one.

use strsim::levenshtein;

/// Returns the name with the smallest edit distance to `typed`; the first if several have it. None if there are no names. Of
/// longer texts the first 100 characters are compared.
pub fn nearest<'a>(typed: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let typed = compared(typed);
    names.into_iter().min_by_key(|name| levenshtein(typed, compared(name)))
}

/// Returns "; did you mean 'NAME'?" with the nearest name if its edit distance to `typed` is at most half the length of
/// the longer one, else an empty text. A text of more than 100 characters has no near name.
pub fn did_you_mean<'a>(typed: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let is_near = |name: &&str| {
        let are_whole = compared(typed).len() == typed.len() && compared(name).len() == name.len();
        are_whole && 2 * levenshtein(typed, name) <= name.chars().count().max(typed.chars().count())
    };
    match nearest(typed, names).filter(is_near) {
        Some(name) => format!("; did you mean '{name}'?"),
        None => String::new(),
    }
}

/// Maximum number of characters of a text that are compared: the edit distance takes the product of both lengths, and longer
/// texts are not mistyped names.
const MAX_COMPARED: usize = 100;

/// Returns the part of a text that is compared.
fn compared(text: &str) -> &str {
    text.char_indices().nth(MAX_COMPARED).map_or(text, |(end, _)| &text[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_has_the_fewest_edits() {
        assert_eq!(["", "spring", "sprnig", "string"].map(|name| levenshtein(name, "spring")), [6, 0, 2, 1]);
        assert_eq!(nearest("sprng", ["bunny", "spring"]), Some("spring"));
        assert_eq!(nearest("x", []), None);
    }

    #[test]
    fn long_texts_are_compared_by_their_beginnings() {
        let [start, half] = [100, 60].map(|count| "\u{e4}".repeat(count));
        let [typed, near] = [&start, &half].map(|text| text.to_owned() + &"b".repeat(1000));
        assert_eq!(nearest(&typed, [near.as_str(), start.as_str()]), Some(start.as_str()));
        assert_eq!(did_you_mean(&typed, [typed.as_str()]), "");
        assert_eq!(did_you_mean(&start, [typed.as_str()]), "");
        assert_eq!(did_you_mean(&start, [start.as_str()]), format!("; did you mean '{start}'?"));
    }

    #[test]
    fn only_near_names_are_meant() {
        let names = ["poisson", "youngs", "steel"];
        assert_eq!(did_you_mean("possion", names), "; did you mean 'poisson'?");
        assert_eq!(did_you_mean("Steel", names), "; did you mean 'steel'?");
        assert_eq!(did_you_mean("E", names), "");
        assert_eq!(did_you_mean(&"steel".repeat(1_000_000), names), "");
    }
}
