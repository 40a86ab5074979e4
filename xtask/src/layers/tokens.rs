//! Finds paths in token streams: arguments of macros and of attributes, and bodies of `macro_rules!`.

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// A path of at least two names, or the name of a macro that is called.
#[derive(Debug, PartialEq)]
pub struct TokenPath {
    pub names: Vec<String>,
    pub line: usize,
    pub is_macro: bool,
}

/// Returns all paths in order. `$crate` becomes `crate`; paths that begin with another macro variable are ignored.
pub fn paths(stream: TokenStream) -> Vec<TokenPath> {
    let mut found = Vec::new();
    scan(stream, &mut found);
    found
}

fn scan(stream: TokenStream, found: &mut Vec<TokenPath>) {
    let tokens: Vec<TokenTree> = stream.into_iter().collect();
    let is_punct = |at: usize, wanted: char| matches!(tokens.get(at), Some(TokenTree::Punct(punct)) if punct.as_char() == wanted);
    let is_separator = |at: usize| is_punct(at, ':') && is_punct(at + 1, ':');
    let ident = |at: usize| match tokens.get(at) {
        Some(TokenTree::Ident(ident)) => Some(ident),
        _ => None,
    };
    let mut at = 0;
    while at < tokens.len() {
        let Some(first) = ident(at) else {
            if let TokenTree::Group(group) = &tokens[at] {
                scan(group.stream(), found);
            }
            at += 1;
            continue;
        };
        let mut names = vec![super::items::name(first)];
        let mut end = at + 1;
        while is_separator(end)
            && let Some(next) = ident(end + 2)
        {
            names.push(super::items::name(next));
            end += 3;
        }
        let before = |punct: char| at > 0 && is_punct(at - 1, punct);
        // Not the start of a path: a field or method, a lifetime, a macro variable, a name after `<T as Trait>::`.
        let is_range = before('.') && at > 1 && is_punct(at - 2, '.');
        let is_variable = before('$') && first != "crate";
        let is_start =
            !(before('.') && !is_range || before('\'') || is_variable || at > 1 && is_separator(at - 2));
        if is_start {
            let line = first.span().start().line;
            let is_macro = is_punct(end, '!') && matches!(tokens.get(end + 1), Some(TokenTree::Group(_)));
            match tokens.get(end + 2) {
                Some(TokenTree::Group(group))
                    if is_separator(end) && group.delimiter() == Delimiter::Brace =>
                {
                    for suffix in group_of_use(group.stream()) {
                        let names = [names.as_slice(), &suffix].concat();
                        found.push(TokenPath { names, line, is_macro: false });
                    }
                    end += 3;
                }
                _ if is_macro || names.len() > 1 => found.push(TokenPath { names, line, is_macro }),
                _ => {}
            }
        }
        at = end;
    }
}

/// Returns the paths in the braces of a `use`.
fn group_of_use(stream: TokenStream) -> Vec<Vec<String>> {
    let mut paths = vec![Vec::new()];
    let mut is_alias = false;
    for token in stream {
        match token {
            TokenTree::Punct(punct) if punct.as_char() == ',' => {
                paths.push(Vec::new());
                is_alias = false;
            }
            TokenTree::Ident(ident) if ident == "as" => is_alias = true,
            TokenTree::Ident(ident) if !is_alias && ident != "self" => {
                let last = paths.len() - 1;
                paths[last].push(super::items::name(&ident));
            }
            TokenTree::Group(group) => {
                let prefix = paths.pop().unwrap_or_default();
                paths.extend(
                    group_of_use(group.stream()).into_iter().map(|path| [prefix.clone(), path].concat()),
                );
            }
            _ => {}
        }
    }
    paths
}
