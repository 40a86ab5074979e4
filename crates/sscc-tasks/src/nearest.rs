//! The nearest known name to a mistyped one.

use strsim::levenshtein;

/// Returns the name with the smallest edit distance to `typed`; the first if several have it. None if there are no names.
pub fn nearest<'a>(typed: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    names.into_iter().min_by_key(|name| levenshtein(typed, name))
}

/// Returns "; did you mean 'NAME'?" with the nearest name if its edit distance to `typed` is at most half the length of
/// the longer one, else an empty text.
pub fn did_you_mean<'a>(typed: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let typed: String = typed.chars().take(MAX_COMPARED).collect();
    let is_near =
        |name: &&str| 2 * levenshtein(&typed, name) <= name.chars().count().max(typed.chars().count());
    match nearest(&typed, names).filter(is_near) {
        Some(name) => format!("; did you mean '{name}'?"),
        None => String::new(),
    }
}

/// Maximum number of characters that are compared with a name: longer texts are not mistyped names.
const MAX_COMPARED: usize = 100;

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
    fn only_near_names_are_meant() {
        let names = ["poisson", "youngs", "steel"];
        assert_eq!(did_you_mean("possion", names), "; did you mean 'poisson'?");
        assert_eq!(did_you_mean("Steel", names), "; did you mean 'steel'?");
        assert_eq!(did_you_mean("E", names), "");
        assert_eq!(did_you_mean(&"steel".repeat(1_000_000), names), "");
    }
}
