//! What stands in place of an operator, and of the body of a function.

use syn::{BinOp, Expr, ReturnType};

/// Returns wrong operators for an operator, as text.
pub fn of_operator(operator: &BinOp) -> &'static [&'static str] {
    match operator {
        BinOp::Add(_) => &["-", "*"],
        BinOp::Sub(_) => &["+", "/"],
        BinOp::Mul(_) => &["+", "/"],
        BinOp::Div(_) => &["*", "%"],
        BinOp::Rem(_) => &["/", "+"],
        BinOp::And(_) => &["||"],
        BinOp::Or(_) => &["&&"],
        BinOp::BitAnd(_) => &["|", "^"],
        BinOp::BitOr(_) => &["&", "^"],
        BinOp::BitXor(_) => &["|", "&"],
        BinOp::Shl(_) => &[">>"],
        BinOp::Shr(_) => &["<<"],
        BinOp::Eq(_) => &["!="],
        BinOp::Ne(_) => &["=="],
        BinOp::Lt(_) => &[">", "<="],
        BinOp::Le(_) => &[">", "<"],
        BinOp::Gt(_) => &["<", ">="],
        BinOp::Ge(_) => &["<", ">"],
        BinOp::AddAssign(_) => &["-=", "*="],
        BinOp::SubAssign(_) => &["+=", "/="],
        BinOp::MulAssign(_) => &["+=", "/="],
        BinOp::DivAssign(_) => &["*=", "%="],
        BinOp::BitAndAssign(_) => &["|="],
        BinOp::BitOrAssign(_) => &["&="],
        _ => &[],
    }
}

/// Returns values for a function that returns this type, as text. Those of another type do not compile, and are excluded.
pub fn of_body(output: &ReturnType) -> &'static [&'static str] {
    let ReturnType::Type(_, kind) = output else { return &["()"] };
    let kind = quote::quote!(#kind).to_string().replace(' ', "");
    let begins = |start: &str| kind.starts_with(start);
    match kind.as_str() {
        "bool" => &["true", "false"],
        "f64" => &["0.0", "1.0", "-1.0"],
        "f32" => &["0.0", "1.0"],
        "usize" | "u32" | "u64" | "i32" | "i8" | "u8" | "u16" => &["0", "1"],
        "DVec3" => &["DVec3::ZERO"],
        _ if begins("Option<bool") => &["None", "Some(true)", "Some(false)"],
        _ if begins("Option<") => &["None"],
        _ if begins("Result<()") => &["Ok(())"],
        _ if begins("Result<bool") => &["Ok(true)", "Ok(false)"],
        _ if begins("Result<f64") => &["Ok(0.0)", "Ok(1.0)"],
        _ if begins("Result<Option") => &["Ok(None)"],
        _ if begins("Result<") => &["Ok(Default::default())"],
        _ if begins("Vec<") => &["Vec::new()"],
        _ if begins("&[") => &["&[]"],
        _ => &["Default::default()"],
    }
}

/// Whether the operator changes its left operand.
pub fn is_assignment(operator: &BinOp) -> bool {
    matches!(
        operator,
        BinOp::AddAssign(_)
            | BinOp::SubAssign(_)
            | BinOp::MulAssign(_)
            | BinOp::DivAssign(_)
            | BinOp::BitAndAssign(_)
            | BinOp::BitOrAssign(_)
    )
}

/// Whether the operator compares its operands, which it does not consume.
pub fn is_comparison(operator: &BinOp) -> bool {
    matches!(
        operator,
        BinOp::Eq(_) | BinOp::Ne(_) | BinOp::Lt(_) | BinOp::Le(_) | BinOp::Gt(_) | BinOp::Ge(_)
    )
}

/// Parses a value or an operator of this file.
pub fn parse<T: syn::parse::Parse>(text: &str) -> T {
    syn::parse_str(text).expect("the texts of this file are valid")
}

/// Whether the expression is a number or another literal.
pub fn is_literal(expression: &Expr) -> bool {
    matches!(expression, Expr::Lit(_))
}
