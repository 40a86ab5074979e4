//! Names, visibility and test attributes of single items of a parsed file.

use syn::{Attribute, Ident, ImplItem, Item, ItemImpl, Meta, TraitItem, Type, UseTree, Visibility};

/// Returns the name of an identifier without `r#`.
pub fn name(ident: &Ident) -> String {
    let name = ident.to_string();
    name.strip_prefix("r#").map(str::to_owned).unwrap_or(name)
}

/// Whether an item is compiled for tests alone: `#[test]`, `#[cfg(test)]`, `#[cfg(all(test, ...))]`.
pub fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let cfg = attribute.path().is_ident("cfg");
        attribute.path().is_ident("test") || cfg && attribute.parse_args().is_ok_and(|meta| needs_test(&meta))
    })
}

fn needs_test(condition: &Meta) -> bool {
    match condition {
        Meta::Path(path) => path.is_ident("test"),
        Meta::List(list) if list.path.is_ident("all") => {
            let parser = syn::punctuated::Punctuated::<Meta, syn::Token![,]>::parse_terminated;
            list.parse_args_with(parser).is_ok_and(|all| all.iter().any(needs_test))
        }
        _ => false,
    }
}

/// Returns the attributes of an item.
pub fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::ExternCrate(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::ForeignMod(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::TraitAlias(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

pub fn attributes_in_impl(item: &ImplItem) -> &[Attribute] {
    match item {
        ImplItem::Const(item) => &item.attrs,
        ImplItem::Fn(item) => &item.attrs,
        ImplItem::Macro(item) => &item.attrs,
        ImplItem::Type(item) => &item.attrs,
        _ => &[],
    }
}

pub fn attributes_in_trait(item: &TraitItem) -> &[Attribute] {
    match item {
        TraitItem::Const(item) => &item.attrs,
        TraitItem::Fn(item) => &item.attrs,
        TraitItem::Macro(item) => &item.attrs,
        TraitItem::Type(item) => &item.attrs,
        _ => &[],
    }
}

/// An item that a path can name, other than modules and macros.
pub struct NamedItem<'a> {
    pub ident: &'a Ident,
    pub visibility: &'a Visibility,
    /// Whether a path can continue after it, as in `Type::function`.
    pub is_type: bool,
}

/// Returns the name of an item that a path can name; none for other items.
pub fn named_item(item: &Item) -> Option<NamedItem<'_>> {
    let (ident, visibility, is_type) = match item {
        Item::Const(item) => (&item.ident, &item.vis, false),
        Item::Enum(item) => (&item.ident, &item.vis, true),
        Item::Fn(item) => (&item.sig.ident, &item.vis, false),
        Item::Static(item) => (&item.ident, &item.vis, false),
        Item::Struct(item) => (&item.ident, &item.vis, true),
        Item::Trait(item) => (&item.ident, &item.vis, true),
        Item::TraitAlias(item) => (&item.ident, &item.vis, true),
        Item::Type(item) => (&item.ident, &item.vis, true),
        Item::Union(item) => (&item.ident, &item.vis, true),
        _ => return None,
    };
    Some(NamedItem { ident, visibility, is_type })
}

/// Returns the path of the type of an `impl` block; none if the block is of a trait or the type is not a path.
pub fn type_of_impl(item: &ItemImpl) -> Option<Vec<String>> {
    match &*item.self_ty {
        Type::Path(path) if path.qself.is_none() && item.trait_.is_none() => {
            Some(path.path.segments.iter().map(|segment| name(&segment.ident)).collect())
        }
        _ => None,
    }
}

/// Returns the functions and constants of an `impl` block.
pub fn names_in_impl(item: &ItemImpl) -> Vec<String> {
    let items = item.items.iter().filter(|item| !is_for_tests(attributes_in_impl(item)));
    let names = items.filter_map(|item| match item {
        ImplItem::Const(item) => Some(name(&item.ident)),
        ImplItem::Fn(item) => Some(name(&item.sig.ident)),
        _ => None,
    });
    names.collect()
}

/// One name that a `use` imports.
pub struct UseLeaf {
    pub path: Vec<String>,
    /// The name in the importing module; none for a glob.
    pub alias: Option<String>,
    pub line: usize,
}

/// Returns all names that a `use` imports: `use a::{self, b::c as d, e::*}` has three.
pub fn use_leaves(tree: &UseTree) -> Vec<UseLeaf> {
    let mut leaves = Vec::new();
    add_leaves(tree, &mut Vec::new(), &mut leaves);
    leaves
}

fn add_leaves(tree: &UseTree, prefix: &mut Vec<String>, leaves: &mut Vec<UseLeaf>) {
    let mut add = |ident: &Ident, alias: &Ident| {
        let mut path = prefix.clone();
        let mut alias = name(alias);
        if ident == "self" && !prefix.is_empty() {
            if alias == "self" {
                alias.clone_from(&prefix[prefix.len() - 1]);
            }
        } else {
            path.push(name(ident));
        }
        leaves.push(UseLeaf { path, alias: Some(alias), line: ident.span().start().line });
    };
    match tree {
        UseTree::Name(leaf) => add(&leaf.ident, &leaf.ident),
        UseTree::Rename(leaf) => add(&leaf.ident, &leaf.rename),
        UseTree::Glob(leaf) => {
            let line = leaf.star_token.spans[0].start().line;
            leaves.push(UseLeaf { path: prefix.clone(), alias: None, line });
        }
        UseTree::Path(path) => {
            prefix.push(name(&path.ident));
            add_leaves(&path.tree, prefix, leaves);
            prefix.pop();
        }
        UseTree::Group(group) => group.items.iter().for_each(|tree| add_leaves(tree, prefix, leaves)),
    }
}
