//! The public items of a crate, from its sources: what users can name, with signatures.
//!
//! Sources are parsed by syn, so the listing needs no nightly rustdoc, whose JSON has another version in each toolchain. Types
//! are written as in the sources. Items under `#[doc(hidden)]` are no promise and are left out. Items that a macro of the same
//! file makes are listed as the rows of the macro's call; implementations of traits by macros are left out.

mod macros;

use macros::{calls, tidy};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use syn::{Attribute, Fields, ImplItem, Item, TraitItem, Visibility};

use crate::dependencies::{ModulePath, Parsed, absolute, child, is_for_tests, leaves};
use crate::{PUBLIC_CRATES, crate_of, parsed_texts, root, text_of};

/// Returns the public items of a crate, a line each, sorted by path.
pub(crate) fn public_items(parsed: &Parsed) -> Vec<String> {
    let mut sources = Sources::default();
    parsed.iter().for_each(|(module, (_, file))| sources.add(module, &file.items));
    let mut listing = Listing { sources: &sources, names: BTreeMap::new(), lines: BTreeSet::new() };
    listing.find_names(&[], &[], &mut Vec::new());
    listing.list();
    listing.lines.into_iter().collect()
}

/// The modules of a crate.
#[derive(Default)]
struct Sources<'p> {
    items: BTreeMap<ModulePath, &'p [Item]>,
    /// The full paths of the names that each module imports.
    imports: BTreeMap<ModulePath, BTreeMap<String, ModulePath>>,
    /// The macros by which each module makes public items, with the rows of the call.
    calls: BTreeMap<ModulePath, Vec<(String, Vec<String>)>>,
}

/// An item by the module that defines it, and its name there.
type Definition = (ModulePath, String);

impl<'p> Sources<'p> {
    fn add(&mut self, module: &ModulePath, items: &'p [Item]) {
        for item in items {
            if let Item::Mod(inner) = item
                && let Some((_, items)) = &inner.content
                && !is_for_tests(&inner.attrs)
            {
                self.add(&child(module, &inner.ident.to_string()), items);
            }
        }
        let imports = items.iter().filter_map(|item| match item {
            Item::Use(item) => Some(leaves(item, module)),
            _ => None,
        });
        self.imports.insert(module.clone(), imports.flatten().collect());
        self.calls.insert(module.clone(), calls(items));
        self.items.insert(module.clone(), items);
    }

    /// Follows imports to the definition of a path. The name is empty if the path is a module.
    fn resolve(&self, path: &[String]) -> Option<Definition> {
        let mut path = path.to_vec();
        for _ in 0..10 {
            let mut length =
                (0..=path.len()).rev().find(|&n| self.items.contains_key(&path[..n]))?;
            // A function may have the name of the private module that defines it.
            if let Some((name, outer)) = path.split_last()
                && length == path.len()
                && self.imports[outer].contains_key(name)
            {
                length -= 1;
            }
            let module = path[..length].to_vec();
            let Some(name) = path.get(length) else { return Some((module, String::new())) };
            match self.imports[&module].get(name) {
                Some(to) if to != &path => path = [to, &path[length + 1..]].concat(),
                _ => return self.is_defined(&module, name).then(|| (module, name.clone())),
            }
        }
        None
    }

    fn defined(&self, module: &[String], name: &str) -> impl Iterator<Item = &'p Item> {
        self.items[module].iter().filter(move |item| ident(item).is_some_and(|own| own == name))
    }

    /// Returns whether a module defines a name, by an item or by a macro.
    fn is_defined(&self, module: &[String], name: &str) -> bool {
        self.defined(module, name).next().is_some() || !self.calls[module].is_empty()
    }

    /// Returns the definition of the type of an `impl`; `None` for types of other crates.
    fn owner(&self, module: &ModulePath, ty: &syn::Type) -> Option<Definition> {
        let ty = match ty {
            syn::Type::Reference(reference) => &reference.elem,
            other => other,
        };
        let syn::Type::Path(path) = ty else { return None };
        let parts: Vec<_> = path.path.segments.iter().map(|part| part.ident.to_string()).collect();
        let path = absolute(&parts, module).unwrap_or_else(|| [module, &parts[..]].concat());
        self.resolve(&path)
    }
}

struct Listing<'s> {
    sources: &'s Sources<'s>,
    /// The public paths of each definition.
    names: BTreeMap<Definition, BTreeSet<ModulePath>>,
    lines: BTreeSet<String>,
}

impl Listing<'_> {
    /// Finds the public names in a module, which users name by `public`.
    fn find_names(&mut self, module: &[String], public: &[String], open: &mut Vec<ModulePath>) {
        if open.iter().any(|outer| outer == module) {
            return;
        }
        open.push(module.to_vec());
        for item in self.sources.items[module] {
            if is_private(item) {
                continue;
            }
            if let Item::Use(item) = item {
                for (name, path) in leaves(item, module) {
                    let own = child(public, &name);
                    match self.sources.resolve(&path) {
                        Some((module, name)) if name.is_empty() => {
                            self.lines.insert(format!("{}: module", own.join("::")));
                            self.find_names(&module, &own, open);
                        }
                        Some(definition) => {
                            self.names.entry(definition).or_default().insert(own);
                        }
                        None => {
                            self.lines.insert(format!("{}: of another crate", own.join("::")));
                        }
                    }
                }
                continue;
            }
            let Some(name) = ident(item) else { continue };
            let own = child(public, &name);
            match item {
                Item::Mod(_) => {
                    self.lines.insert(format!("{}: module", own.join("::")));
                    self.find_names(&child(module, &name), &own, open);
                }
                _ => {
                    self.names.entry((module.to_vec(), name)).or_default().insert(own);
                }
            }
        }
        open.pop();
    }

    /// Returns the path by which a definition is listed: the shortest.
    fn path(&self, definition: &Definition) -> Option<String> {
        let paths = self.names.get(definition)?;
        Some(paths.iter().min_by_key(|path| path.len())?.join("::"))
    }

    fn list(&mut self) {
        let sources = self.sources;
        for (definition, paths) in self.names.clone() {
            let path = self.path(&definition).unwrap();
            let others = paths.iter().map(|path| path.join("::")).filter(|other| *other != path);
            others.for_each(|other| self.add(&other, &format!("same as {path}")));
            let (module, name) = &definition;
            let mut is_written = false;
            for item in sources.defined(module, name) {
                is_written = true;
                self.add_item(&path, item);
            }
            if !is_written {
                self.add(&path, "made by a macro");
            }
        }
        for (module, items) in &sources.items {
            for item in *items {
                if let Item::Impl(item) = item
                    && !is_hidden(&item.attrs)
                {
                    self.add_impl(module, item);
                }
            }
            if self.names.keys().any(|(defined, _)| defined == module) {
                for (name, rows) in &sources.calls[module] {
                    rows.iter().for_each(|row| self.add(&format!("{name}!"), row));
                }
            }
        }
    }

    fn add(&mut self, path: &str, text: &str) {
        self.lines.insert(format!("{path}: {text}"));
    }

    fn add_item(&mut self, path: &str, item: &Item) {
        match item {
            Item::Fn(item) => self.add(path, &signature(&item.sig)),
            Item::Struct(item) => {
                self.add_type(path, "struct", &item.attrs, &item.generics);
                self.add_fields(path, &item.fields, is_public);
            }
            Item::Enum(item) => {
                self.add_type(path, "enum", &item.attrs, &item.generics);
                for variant in &item.variants {
                    let inner = format!("{path}::{}", variant.ident);
                    self.add(&inner, "variant");
                    self.add_fields(&inner, &variant.fields, |_| true);
                }
            }
            Item::Trait(item) => {
                self.add_type(path, "trait", &item.attrs, &item.generics);
                let supertraits = &item.supertraits;
                if !supertraits.is_empty() {
                    self.add(path, &format!("supertraits {}", tokens(supertraits)));
                }
                for inner in &item.items {
                    if let TraitItem::Fn(function) = inner
                        && !is_hidden(&function.attrs)
                    {
                        let is_provided = if function.default.is_some() { "provided " } else { "" };
                        let text = format!("{is_provided}{}", signature(&function.sig));
                        self.add(&format!("{path}::{}", function.sig.ident), &text);
                    }
                }
            }
            Item::Const(item) => self.add(path, &format!("const {}", tokens(&item.ty))),
            Item::Static(item) => self.add(path, &format!("static {}", tokens(&item.ty))),
            Item::Type(item) => self.add(path, &format!("type {}", tokens(&item.ty))),
            other => panic!("{path}: {}", tokens(other)),
        }
    }

    fn add_type(
        &mut self,
        path: &str,
        kind: &str,
        attributes: &[Attribute],
        generics: &syn::Generics,
    ) {
        let is_open = attributes.iter().any(|own| own.path().is_ident("non_exhaustive"));
        let open = if is_open { "non_exhaustive " } else { "" };
        self.add(path, &format!("{open}{kind}{}", tokens(generics)));
        for own in attributes.iter().filter(|own| own.path().is_ident("derive")) {
            let derived = tidy(&own.meta.require_list().unwrap().tokens);
            derived.split(", ").for_each(|name| self.add(path, &format!("impl {name}")));
        }
    }

    fn add_fields(&mut self, path: &str, fields: &Fields, is_seen: impl Fn(&Visibility) -> bool) {
        for (index, field) in fields.iter().enumerate() {
            if is_seen(&field.vis) && !is_hidden(&field.attrs) {
                let name = field.ident.as_ref().map_or(index.to_string(), ToString::to_string);
                self.add(&format!("{path}::{name}"), &tokens(&field.ty));
            }
        }
    }

    fn add_impl(&mut self, module: &ModulePath, item: &syn::ItemImpl) {
        let Some(owner) = self.sources.owner(module, &item.self_ty) else { return };
        let Some(path) = self.path(&owner) else { return };
        if let Some((_, of, _)) = &item.trait_ {
            let generics = tokens(&item.generics);
            self.add(
                &path,
                &format!("impl{generics} {} for {}", tokens(of), tokens(&item.self_ty)),
            );
            return;
        }
        for inner in &item.items {
            match inner {
                ImplItem::Fn(own) if is_public(&own.vis) && !is_hidden(&own.attrs) => {
                    self.add(&format!("{path}::{}", own.sig.ident), &signature(&own.sig));
                }
                ImplItem::Const(own) if is_public(&own.vis) && !is_hidden(&own.attrs) => {
                    self.add(
                        &format!("{path}::{}", own.ident),
                        &format!("const {}", tokens(&own.ty)),
                    );
                }
                _ => {}
            }
        }
    }
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

fn is_private(item: &Item) -> bool {
    let (visibility, attributes) = match item {
        Item::Fn(item) => (&item.vis, &item.attrs),
        Item::Struct(item) => (&item.vis, &item.attrs),
        Item::Enum(item) => (&item.vis, &item.attrs),
        Item::Trait(item) => (&item.vis, &item.attrs),
        Item::Const(item) => (&item.vis, &item.attrs),
        Item::Static(item) => (&item.vis, &item.attrs),
        Item::Type(item) => (&item.vis, &item.attrs),
        Item::Use(item) => (&item.vis, &item.attrs),
        Item::Mod(item) => (&item.vis, &item.attrs),
        _ => return true,
    };
    !is_public(visibility) || is_hidden(attributes)
}

/// Returns whether an item is for tests alone or hidden from the documentation.
fn is_hidden(attributes: &[Attribute]) -> bool {
    let is_doc_hidden = |own: &Attribute| {
        let list = own.meta.require_list();
        own.path().is_ident("doc") && list.is_ok_and(|list| list.tokens.to_string() == "hidden")
    };
    is_for_tests(attributes) || attributes.iter().any(is_doc_hidden)
}

fn ident(item: &Item) -> Option<String> {
    let ident = match item {
        Item::Fn(item) => &item.sig.ident,
        Item::Struct(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Const(item) => &item.ident,
        Item::Static(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Mod(item) => &item.ident,
        _ => return None,
    };
    Some(ident.to_string())
}

/// Returns a signature without its name.
fn signature(of: &syn::Signature) -> String {
    let mut unnamed = of.clone();
    unnamed.ident = syn::Ident::new("_name", of.ident.span());
    tokens(&unnamed).replace(" _name", "")
}

fn tokens(of: &impl quote::ToTokens) -> String {
    tidy(&of.to_token_stream())
}

/// Programs of users depend on these items, so a change must be a decision.
#[test]
fn the_public_api_of_each_crate_is_as_listed() {
    let writes = std::env::var("GPU_SMOOTH_GOLDEN").is_ok_and(|value| value == "write");
    for (name, source) in PUBLIC_CRATES {
        let listed = root().join(format!("tests/house/api/{name}.txt"));
        let lines = &crate_of(source).public_items;
        assert!(lines.len() > 50, "only {} public items of {name}", lines.len());
        if writes {
            fs::create_dir_all(listed.parent().unwrap()).unwrap();
            fs::write(&listed, lines.join("\n") + "\n").unwrap();
            continue;
        }
        let text = text_of(&format!("tests/house/api/{name}.txt"));
        let before: BTreeSet<&str> = text.lines().collect();
        let now: BTreeSet<&str> = lines.iter().map(String::as_str).collect();
        let gone = before.difference(&now).map(|line| format!("- {line}"));
        let new = now.difference(&before).map(|line| format!("+ {line}"));
        let changes: Vec<String> = gone.chain(new).collect();
        assert!(
            changes.is_empty(),
            "the public API of {name} differs from {}:\n{}\nIf that is intended, renew the listing: \
             GPU_SMOOTH_GOLDEN=write cargo test --test house public_api",
            listed.display(),
            changes.join("\n"),
        );
    }
}

#[test]
fn every_kind_of_public_item_is_listed() {
    let found = public_items(&parsed_texts(&[
        (
            "lib",
            "mod a; pub mod b; #[doc(hidden)] pub mod internal; pub use a::{A as First, go}; pub use outer; \
             pub(crate) fn not_seen() {} #[cfg(test)] mod tests { pub struct InTests; }",
        ),
        (
            "a/mod",
            "mod go; pub use go::go; /// Text. \n #[derive(Clone, Debug)] #[non_exhaustive] pub struct A<'a> { \
             /// Text. \n pub x: &'a [f64; 2], y: u32 } \
             impl A<'_> { pub fn f(&mut self, n: Option<u32>) -> u32 { 0 } fn g() {} #[doc(hidden)] pub fn h() {} }",
        ),
        ("a/go", "pub fn go<T: Copy>(of: T) -> Vec<T> { vec![of] }"),
        (
            "b",
            "pub use crate::a::A as First; pub enum E { One(u8), Two { n: u8 } } pub trait T: Copy { fn f(&self); } \
             impl T for E {} impl From<u8> for super::First<'_> {} pub const N: usize = 1; \
             macro_rules! rows { ($($name:ident = $value:expr,)*) => { pub enum Made { $($name,)* } } } \
             rows! { /// Text. \n Row = 1, Other = 2, }",
        ),
        ("internal", "pub struct Hidden;"),
    ]));
    let expected = [
        "First: impl Clone",
        "First: impl Debug",
        "First: impl From<u8> for super::First<'_>",
        "First: non_exhaustive struct<'a>",
        "First::f: fn(&mut self, n: Option<u32>) -> u32",
        "First::x: &'a [f64; 2]",
        "b: module",
        "b::E: enum",
        "b::E: impl T for E",
        "b::E::One: variant",
        "b::E::One::0: u8",
        "b::E::Two: variant",
        "b::E::Two::n: u8",
        "b::First: same as First",
        "b::N: const usize",
        "b::T: supertraits Copy",
        "b::T: trait",
        "b::T::f: fn(&self)",
        "go: fn<T: Copy>(of: T) -> Vec<T>",
        "outer: of another crate",
        "rows!: Other",
        "rows!: Row",
    ];
    assert_eq!(found, expected);
}
