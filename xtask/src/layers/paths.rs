//! The paths in the code of a file.

use crate::sources::{Source, without_text};

/// A path in the code.
#[derive(Clone, Debug, PartialEq)]
pub struct CodePath {
    pub line: usize,
    /// The names of the path; the last is `*` for a glob.
    pub names: Vec<String>,
    /// The name that a `use` gives it.
    pub known_as: Option<String>,
    /// Whether the path is re-exported.
    pub is_public: bool,
    /// Number of modules within the file that contain the path.
    pub inner: usize,
}

/// A name, `::`, or another character, with its line.
type Token = (usize, String);

/// Returns the paths of at least two names, one for each item of a `use`, and the names of the items that the file defines.
pub fn paths_and_items(source: &Source) -> (Vec<CodePath>, Vec<String>) {
    let tokens: Vec<Token> = source.lines.iter().flat_map(|(line, text)| tokens(*line, text)).collect();
    let (mut paths, mut items) = (Vec::new(), Vec::new());
    // The depths of braces at which modules within the file end.
    let (mut depth, mut modules) = (0, Vec::new());
    let (mut at, mut is_public) = (0, false);
    while let Some((line, token)) = tokens.get(at) {
        let here = at;
        let next = |i: usize| tokens.get(here + i).map_or("", |(_, token)| token.as_str());
        at += 1;
        match token.as_str() {
            "{" => depth += 1,
            "}" => {
                depth -= 1;
                if modules.last() == Some(&depth) {
                    modules.pop();
                }
            }
            "pub" => {
                is_public = true;
                if next(1) == "(" {
                    at += tokens[at..].iter().position(|(_, token)| token == ")").map_or(0, |end| end + 1);
                }
            }
            "mod" if next(2) == "{" => modules.push(depth),
            "use" => {
                let start = CodePath {
                    line: *line,
                    names: Vec::new(),
                    known_as: None,
                    is_public,
                    inner: modules.len(),
                };
                at = use_tree(&tokens, at, &start, &mut paths);
            }
            "struct" | "enum" | "trait" | "fn" | "const" | "static" | "type" | "union" | "macro_rules" => {
                items.extend([next(1), next(2)].map(str::to_owned));
            }
            name if is_name(name) && next(1) == "::" => {
                let mut names = vec![name.to_owned()];
                while tokens.get(at).is_some_and(|(_, token)| token == "::")
                    && let Some((_, name)) = tokens.get(at + 1).filter(|(_, name)| is_name(name))
                {
                    names.push(name.clone());
                    at += 2;
                }
                let inner = modules.len();
                paths.push(CodePath { line: *line, names, known_as: None, is_public: false, inner });
            }
            _ => {}
        }
        if token != "pub" {
            is_public = false;
        }
    }
    (paths, items)
}

/// Adds the paths of a `use`; returns the token after it.
fn use_tree(tokens: &[Token], mut at: usize, start: &CodePath, paths: &mut Vec<CodePath>) -> usize {
    let (mut path, mut is_itself) = (start.clone(), false);
    while let Some((line, token)) = tokens.get(at) {
        at += 1;
        match token.as_str() {
            "::" | "$" => {}
            "{" => loop {
                at = use_tree(tokens, at, &path, paths);
                // The position is after a comma or the brace.
                if tokens.get(at - 1).is_none_or(|(_, token)| token != ",") {
                    path.names.clear();
                    break;
                }
            },
            "as" => {
                path.known_as = tokens.get(at).map(|(_, name)| name.clone());
                at += 1;
            }
            "self" if !path.names.is_empty() => is_itself = true,
            ";" | "," | "}" => break,
            name => {
                path.line = *line;
                path.names.push(name.to_owned());
            }
        }
    }
    if path.names.len() > start.names.len() || is_itself {
        path.known_as = path.known_as.or_else(|| path.names.last().cloned());
        paths.push(path);
    }
    at
}

fn is_name(token: &str) -> bool {
    token.starts_with(|first: char| first.is_alphabetic() || first == '_')
}

fn tokens(line: usize, text: &str) -> Vec<Token> {
    let code = without_text(text);
    let mut tokens = Vec::new();
    let mut rest = code.as_str();
    while let Some(first) = rest.chars().next() {
        let is_in_name = |c: char| c.is_alphanumeric() || c == '_';
        let length = if is_in_name(first) {
            rest.find(|c| !is_in_name(c)).unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        if !first.is_whitespace() {
            tokens.push((line, rest[..length].to_owned()));
        }
        rest = &rest[length..];
    }
    tokens
}
