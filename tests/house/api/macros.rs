//! Tokens as text, and the public items that macros make.

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
use std::collections::BTreeMap;
use syn::Item;

/// Returns the calls of macros, defined in the same file, that make public items.
pub(super) fn calls(items: &[Item]) -> Vec<(String, Vec<String>)> {
    let macros = || {
        items.iter().filter_map(|item| match item {
            Item::Macro(item) => Some(item),
            _ => None,
        })
    };
    let makes_public_items = |rule: &str| {
        let kinds = ["pub enum ", "pub struct ", "pub fn ", "pub const "];
        kinds.iter().any(|kind| rule.contains(kind))
    };
    let rules = macros().filter_map(|item| Some((item.ident.as_ref()?, &item.mac.tokens)));
    let mut rules: BTreeMap<String, String> =
        rules.map(|(name, tokens)| (name.to_string(), tidy(tokens))).collect();
    rules.retain(|_, rule| makes_public_items(rule));
    let names = macros().filter_map(|item| Some((item.mac.path.get_ident()?.to_string(), item)));
    let called = names.filter(|(name, _)| rules.contains_key(name));
    called.map(|(name, item)| (name, rows(item.mac.tokens.clone()))).collect()
}

/// Returns the rows of a macro's call, each without its value: parts that end at a semicolon or in braces, or at a comma if the
/// call has no semicolon.
fn rows(tokens: TokenStream) -> Vec<String> {
    let is = |token: &TokenTree, sign: char| matches!(token, TokenTree::Punct(own) if own.as_char() == sign);
    let is_semicolon = |token: TokenTree| is(&token, ';');
    let separator = if tokens.clone().into_iter().any(is_semicolon) { ';' } else { ',' };
    let (mut rows, mut row, mut is_value) = (Vec::new(), Vec::new(), false);
    for token in without_attributes(tokens) {
        let mut is_end = is(&token, separator);
        if let TokenTree::Group(group) = &token
            && group.delimiter() == Delimiter::Brace
        {
            if row.is_empty() {
                rows.extend(self::rows(group.stream()));
            }
            is_end = true;
        }
        is_value |= is(&token, '=');
        if is_end {
            rows.push(tidy(&row.drain(..).collect()));
            is_value = false;
        } else if !is_value {
            row.push(token);
        }
    }
    rows.push(tidy(&row.into_iter().collect()));
    rows.retain(|row| !row.is_empty());
    rows
}

/// Writes tokens with the spaces of rustfmt, without comments.
pub(super) fn tidy(of: &TokenStream) -> String {
    let mut text = without_attributes(of.clone()).to_string().replace('\n', " ");
    for (wide, narrow) in [
        (" :: ", "::"),
        (":: ", "::"),
        (" ::", "::"),
        (" < ", "<"),
        ("< ", "<"),
        (" >", ">"),
        (" ,", ","),
        ("& ", "&"),
        ("( ", "("),
        (" )", ")"),
        (" (", "("),
        ("[ ", "["),
        (" ]", "]"),
        (" :", ":"),
        (",)", ")"),
        (",>", ">"),
        (" ;", ";"),
        ("->(", "-> ("),
        (",(", ", ("),
    ] {
        text = text.replace(wide, narrow);
    }
    text
}

/// Drops attributes, which include comments.
fn without_attributes(of: TokenStream) -> TokenStream {
    let mut kept = Vec::new();
    let mut tokens = of.into_iter().peekable();
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Punct(sign)
                if sign.as_char() == '#' && matches!(tokens.peek(), Some(TokenTree::Group(_))) =>
            {
                tokens.next();
            }
            TokenTree::Group(group) => {
                let inner = without_attributes(group.stream());
                kept.push(Group::new(group.delimiter(), inner).into());
            }
            other => kept.push(other),
        }
    }
    kept.into_iter().collect()
}
