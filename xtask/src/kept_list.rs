//! The kept list of public items. Each item at the root has one line with its names, and the reason for it on the next line.

use std::collections::BTreeMap;

/// The reason of an item that `--write` has added.
const NO_REASON: &str = "(give the reason)";

/// Items at the root: fields, variants and methods, sorted, by the name of the item.
pub type Items = BTreeMap<String, Vec<String>>;

/// A list: its first lines, and items with reasons.
pub struct KeptList {
    head: String,
    items: Items,
    reasons: BTreeMap<String, String>,
}

impl KeptList {
    pub fn parse(text: &str) -> Self {
        let mut list = Self { head: String::new(), items: Items::new(), reasons: BTreeMap::new() };
        let mut last = String::new();
        for line in text.lines() {
            if line.starts_with('#') || line.is_empty() {
                list.head += &format!("{line}\n");
            } else if let Some(reason) = line.strip_prefix("    ") {
                list.reasons.insert(last.clone(), reason.to_owned());
            } else {
                let (name, members) = line.split_once(": ").unwrap_or((line, ""));
                let members = members.split(", ").filter(|name| !name.is_empty()).map(str::to_owned);
                list.items.insert(name.to_owned(), members.collect());
                last = name.to_owned();
            }
        }
        list
    }

    /// Returns the differences from the items of the code, one a line, and the items without a reason.
    pub fn differences(&self, found: &Items) -> Vec<String> {
        let flat = |items: &Items| -> Vec<String> {
            let with_members = |(name, members): (&String, &Vec<String>)| {
                let members: Vec<_> = members.iter().map(|member| format!("{name}::{member}")).collect();
                [vec![name.clone()], members].concat()
            };
            items.iter().flat_map(with_members).collect()
        };
        let (listed, found) = (flat(&self.items), flat(found));
        let without = |all: &[String], others: &[String], sign: &str| -> Vec<String> {
            // A name may occur twice: a method and a function may have the same name.
            let count = |names: &[String], name: &String| names.iter().filter(|other| *other == name).count();
            let more = all.iter().filter(|name| count(all, name) > count(others, name));
            more.map(|name| format!("{sign} {name}")).collect()
        };
        let has_reason = |name: &&String| {
            self.reasons.get(*name).is_some_and(|reason| reason != NO_REASON && !reason.is_empty())
        };
        let unexplained = self.items.keys().filter(|name| !has_reason(name));
        let mut lines = [without(&found, &listed, "+"), without(&listed, &found, "-")].concat();
        lines.dedup();
        lines.extend(unexplained.map(|name| format!("? {name}: no reason is given")));
        lines
    }

    /// Returns the text of the list with the items of the code, and the reasons of this list.
    pub fn updated(&self, found: &Items) -> String {
        let mut text = self.head.clone();
        for (name, members) in found {
            let colon = if members.is_empty() { "" } else { ": " };
            let reason = self.reasons.get(name).map_or(NO_REASON, String::as_str);
            text += &format!("{name}{colon}{}\n    {reason}\n", members.join(", "));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn items(all: &[(&str, &[&str])]) -> Items {
        let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        all.iter().map(|(name, members)| ((*name).to_owned(), names(members))).collect()
    }

    #[test]
    fn differences_name_each_changed_item() {
        let text = "# A head.\n\nA: b, c\n    For A.\nf\n    For f.\ng\n    (give the reason)\n";
        let list = KeptList::parse(text);
        let same = items(&[("A", &["b", "c"]), ("f", &[]), ("g", &[])]);
        assert_eq!(list.differences(&same), ["? g: no reason is given"]);
        assert_eq!(list.updated(&same), text);
        let other = items(&[("A", &["b", "d"]), ("g", &[]), ("h", &[])]);
        assert_eq!(list.differences(&other), ["+ A::d", "+ h", "- A::c", "- f", "? g: no reason is given"]);
        let updated = KeptList::parse(&list.updated(&other));
        assert_eq!(updated.differences(&other), ["? g: no reason is given", "? h: no reason is given"]);
    }
}
