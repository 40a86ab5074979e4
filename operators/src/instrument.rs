//! Puts wrong variants of the operators and functions of a file behind a switch.
//!
//! Operands are evaluated once and stand once in the new code, since code with copies of them would grow exponentially with the
//! depth of an expression.

use std::collections::BTreeSet;

use quote::{ToTokens, quote};
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::visit_mut::{self, VisitMut};
use syn::{
    Attribute, BinOp, Block, Expr, ExprBinary, ExprConst, ExprLet, File, GenericArgument, ImplItemConst,
    ImplItemFn, ItemConst, ItemFn, ItemMod, ItemStatic, Pat, Signature, Stmt, TraitItemConst, Type, UnOp,
    parse_quote, parse2,
};

use crate::replacements::{is_assignment, is_comparison, is_literal, of_body, of_operator, parse};

/// Numbers the variants of all files.
pub struct Instrument {
    excluded: BTreeSet<u32>,
    next: u32,
    lines: Vec<String>,
    file: String,
    functions: Vec<String>,
}

impl Instrument {
    /// Leaves out the variants with these numbers, which begin at 1.
    pub fn new(excluded: BTreeSet<u32>) -> Self {
        Self { excluded, next: 1, lines: Vec::new(), file: String::new(), functions: Vec::new() }
    }

    /// Puts the variants of a file behind the switch.
    pub fn file(&mut self, name: &str, file: &mut File) {
        self.file = name.to_owned();
        self.visit_file_mut(file);
    }

    /// The list of the variants so far.
    pub fn lines(&self) -> &[String] {
        &self.lines
    }

    /// Returns the number of a new variant unless it is excluded.
    fn variant(&mut self, line: usize, change: &str) -> Option<u32> {
        let number = self.next;
        self.next += 1;
        if self.excluded.contains(&number) {
            return None;
        }
        let function = self.functions.last().map_or("", String::as_str);
        self.lines.push(format!("{number}\t{}\t{line}\t{function}\t{change}\n", self.file));
        Some(number)
    }

    fn function(&mut self, attributes: &[Attribute], signature: &Signature, block: &mut Block) {
        if is_test(attributes) || signature.constness.is_some() {
            return;
        }
        self.functions.push(signature.ident.to_string());
        self.visit_block_mut(block);
        let line = signature.ident.span().start().line;
        let mut returns: Vec<Stmt> = Vec::new();
        for value in of_body(&signature.output) {
            if let Some(number) = self.variant(line, &format!("body -> {value}")) {
                let value: Expr = parse(value);
                returns.push(parse_quote! { if crate::switch::is_on(#number) { return #value; } });
            }
        }
        block.stmts.splice(0..0, returns);
        self.functions.pop();
    }

    fn binary(&mut self, binary: &mut ExprBinary) -> Option<Expr> {
        let has_let = HasLet::in_operands_of(binary);
        visit_mut::visit_expr_binary_mut(self, binary);
        if has_let {
            return None;
        }
        let (line, operator) = (binary.op.span().start().line, &binary.op);
        let mut arms = Vec::new();
        for wrong in of_operator(operator) {
            let change = format!("{} -> {wrong}", operator.to_token_stream());
            arms.extend(self.variant(line, &change).map(|number| (number, parse::<BinOp>(wrong))));
        }
        if arms.is_empty() {
            return None;
        }
        let (left, right) = (&binary.left, &binary.right);
        let is_lazy = matches!(operator, BinOp::And(_) | BinOp::Or(_));
        let (l, r) = if is_assignment(operator) {
            (quote!(#left), quote!(switch_right))
        } else if is_lazy {
            (quote!(switch_left), quote!((#right)))
        } else if is_comparison(operator) {
            (quote!(*switch_left), quote!(*switch_right))
        } else {
            (quote!(switch_left), quote!(switch_right))
        };
        let mut code = quote!({ #l #operator #r });
        for (number, wrong) in arms {
            code = quote!(if crate::switch::is_on(#number) { #l #wrong #r } else #code);
        }
        let code = if is_assignment(operator) {
            quote!({ let switch_right = #right; #code })
        } else if is_lazy {
            quote!({ let switch_left = #left; #code })
        } else if is_comparison(operator) {
            quote!(match (&(#left), &(#right)) { (switch_left, switch_right) => { #code } })
        } else {
            quote!(match (#left, #right) { (switch_left, switch_right) => { #code } })
        };
        Some(parse2(quote!((#code))).expect("an expression"))
    }
}

impl VisitMut for Instrument {
    fn visit_expr_mut(&mut self, expression: &mut Expr) {
        match expression {
            Expr::Binary(binary) => {
                if let Some(changed) = self.binary(binary) {
                    *expression = changed;
                }
            }
            Expr::Unary(unary)
                if matches!(unary.op, UnOp::Not(_) | UnOp::Neg(_)) && !is_literal(&unary.expr) =>
            {
                visit_mut::visit_expr_unary_mut(self, unary);
                let (line, operator, operand) = (unary.op.span().start().line, &unary.op, &unary.expr);
                let change = format!("delete {}", operator.to_token_stream());
                if let Some(number) = self.variant(line, &change) {
                    *expression = parse_quote!(({
                        let switch_operand = #operand;
                        if crate::switch::is_on(#number) { switch_operand } else { #operator switch_operand }
                    }));
                }
            }
            _ => visit_mut::visit_expr_mut(self, expression),
        }
    }

    fn visit_item_fn_mut(&mut self, item: &mut ItemFn) {
        self.function(&item.attrs, &item.sig, &mut item.block);
    }

    fn visit_impl_item_fn_mut(&mut self, item: &mut ImplItemFn) {
        self.function(&item.attrs, &item.sig, &mut item.block);
    }

    fn visit_item_mod_mut(&mut self, item: &mut ItemMod) {
        if !is_test(&item.attrs) {
            visit_mut::visit_item_mod_mut(self, item);
        }
    }

    // Constants, types and patterns are evaluated by the compiler.
    fn visit_item_const_mut(&mut self, _: &mut ItemConst) {}
    fn visit_item_static_mut(&mut self, _: &mut ItemStatic) {}
    fn visit_impl_item_const_mut(&mut self, _: &mut ImplItemConst) {}
    fn visit_trait_item_const_mut(&mut self, _: &mut TraitItemConst) {}
    fn visit_expr_const_mut(&mut self, _: &mut ExprConst) {}
    fn visit_type_mut(&mut self, _: &mut Type) {}
    fn visit_pat_mut(&mut self, _: &mut Pat) {}
    fn visit_attribute_mut(&mut self, _: &mut Attribute) {}
    fn visit_generic_argument_mut(&mut self, _: &mut GenericArgument) {}
    fn visit_expr_repeat_mut(&mut self, repeat: &mut syn::ExprRepeat) {
        self.visit_expr_mut(&mut repeat.expr);
    }
}

/// Whether the attributes make an item a test, or a part of tests alone.
pub fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let text = attribute.to_token_stream().to_string();
        text == "# [test]" || text.contains("cfg") && text.contains("test")
    })
}

/// Finds the `let` of a chain of conditions, whose operator cannot be another one.
struct HasLet(bool);

impl HasLet {
    fn in_operands_of(binary: &ExprBinary) -> bool {
        let mut found = Self(false);
        found.visit_expr_binary(binary);
        found.0
    }
}

impl Visit<'_> for HasLet {
    fn visit_expr(&mut self, expression: &Expr) {
        if matches!(expression, Expr::Binary(_) | Expr::Let(_) | Expr::Paren(_)) {
            visit::visit_expr(self, expression);
        }
    }

    fn visit_expr_let(&mut self, _: &ExprLet) {
        self.0 = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn instrumented(text: &str, excluded: &[u32]) -> (String, Vec<String>) {
        let mut instrument = Instrument::new(excluded.iter().copied().collect());
        let mut file = syn::parse_file(text).unwrap();
        instrument.file("a.rs", &mut file);
        (prettyplease::unparse(&file), instrument.lines().to_vec())
    }

    #[test]
    fn operators_and_bodies_have_variants() {
        let text = "fn f(a: f64, b: f64) -> bool {\n    a + b < -a\n}";
        let (code, lines) = instrumented(text, &[]);
        let changes = ["+ -> -", "+ -> *", "delete -", "< -> >", "< -> <=", "body -> true", "body -> false"];
        for (i, change) in changes.iter().enumerate() {
            let line = if change.starts_with("body") { 1 } else { 2 };
            assert_eq!(lines[i], format!("{}\ta.rs\t{line}\tf\t{change}\n", i + 1));
            assert!(code.contains(&format!("crate::switch::is_on({}u32)", i + 1)));
        }
        assert_eq!(lines.len(), changes.len());
        let (code, lines) = instrumented(text, &[3, 4]);
        assert_eq!(lines.len(), changes.len() - 2);
        assert!(!code.contains("is_on(3u32)") && code.contains("is_on(5u32)"));
    }

    #[test]
    fn tests_constants_and_conditions_with_let_have_none() {
        for text in [
            "const A: f64 = 1.0 + 2.0;",
            "const fn f() {}",
            "#[cfg(test)] mod tests { fn f() -> f64 { 1.0 + 2.0 } }",
            "#[test] fn f() { assert!(1 + 1 == 2); }",
        ] {
            assert!(instrumented(text, &[]).1.is_empty(), "{text}");
        }
        let (_, lines) = instrumented("fn f(a: Option<u8>) { if let Some(b) = a && b > 1 {} }", &[]);
        assert_eq!(lines.len(), 3, "the comparison and the body");
    }

    #[test]
    fn no_variant_is_on_without_the_variable() {
        assert!(!crate::switch::is_on(1));
    }
}
