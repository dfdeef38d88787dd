//! Dependencies between the source files of a crate.
//!
//! Files are parsed by syn. Uses are imports, paths in code, and paths in the tokens of a macro. Declarations of
//! modules and re-exports (`pub use`, `pub(crate) use`) are no uses: a use of a re-exported name counts as a use of the
//! file that defines the name. If the methods of a type are spread over several files, a call of `self.method()` or
//! `Self::method()` is a use of the file with the method. Code under `#[cfg(test)]` is ignored.

use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use syn::visit::{self, Visit};
use syn::{Attribute, Item, ItemMod, ItemUse, UseTree, Visibility};

/// Files used by each file, by paths such as `run/drive` or `run/mod`.
pub(crate) type Uses = BTreeMap<String, BTreeSet<String>>;

/// Names of nested modules, starting at the root of the crate.
pub(crate) type ModulePath = Vec<String>;

/// The files of a crate, parsed, by their modules: each with its path, such as `run/drive`. Modules for tests are left out.
pub(crate) type Parsed = BTreeMap<ModulePath, (String, syn::File)>;

/// Parses all files in a crate's source folder.
pub(crate) fn parsed(source: &Path) -> Parsed {
    let mut texts = BTreeMap::new();
    collect(source, source, &mut texts);
    parsed_texts(&texts)
}

fn collect(folder: &Path, source: &Path, texts: &mut BTreeMap<String, String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, source, texts);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let name = path.strip_prefix(source).unwrap().with_extension("");
            let name: Vec<_> = name.iter().map(|part| part.to_str().unwrap()).collect();
            texts.insert(name.join("/"), fs::read_to_string(&path).unwrap());
        }
    }
}

/// Parses files with the given contents.
pub(crate) fn parsed_texts(texts: &BTreeMap<String, String>) -> Parsed {
    let mut parsed = BTreeMap::new();
    // The main file of a crate with a library uses the library from outside.
    let has_library = texts.contains_key("lib");
    for (name, text) in texts.iter().filter(|(name, _)| *name != "main" || !has_library) {
        let file = syn::parse_file(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        parsed.insert(module_of(name), (name.clone(), file));
    }
    let mut skipped = BTreeSet::new();
    for (module, (_, file)) in &parsed {
        for item in &file.items {
            if let Item::Mod(item) = item
                && is_for_tests(&item.attrs)
            {
                skipped.insert(child(module, &item.ident.to_string()));
            }
        }
    }
    parsed.retain(|module, _| !(1..=module.len()).any(|n| skipped.contains(&module[..n])));
    parsed
}

/// Returns the files that each file uses.
pub(crate) fn uses_of(parsed: &Parsed) -> Uses {
    let exports: BTreeMap<&ModulePath, BTreeMap<String, ModulePath>> = parsed
        .iter()
        .map(|(module, (_, file))| {
            let imports = file.items.iter().filter_map(|item| match item {
                Item::Use(item) => Some(leaves(item, module)),
                _ => None,
            });
            (module, imports.flatten().collect())
        })
        .collect();
    // Returns the module of the file that defines the last name of a path.
    let defined_in = |path: &[String]| -> Option<ModulePath> {
        let mut path = path.to_vec();
        for _ in 0..10 {
            let length = (0..=path.len()).rev().find(|&n| parsed.contains_key(&path[..n]))?;
            let module = path[..length].to_vec();
            match path.get(length).and_then(|name| exports[&module].get(name)) {
                Some(to) => path = [to, &path[length + 1..]].concat(),
                None => return Some(module),
            }
        }
        None
    };
    let names_in = |module: &ModulePath| -> BTreeMap<String, ModulePath> {
        let children = parsed.keys().filter(|own| own.len() == module.len() + 1);
        let children =
            children.filter(|own| own.starts_with(module)).map(|own| own[module.len()].clone());
        let mut names = exports[module].clone();
        names.extend(children.map(|name| (name.clone(), child(module, &name))));
        names
    };
    // The module that defines each method, by the definition of its type.
    let mut methods: BTreeMap<(ModulePath, String), ModulePath> = BTreeMap::new();
    for (module, (_, file)) in parsed {
        let names = names_in(module);
        for item in &file.items {
            let Item::Impl(item) = item else { continue };
            if item.trait_.is_some() || is_for_tests(&item.attrs) {
                continue;
            }
            let Some(owner) = owner_of(item, module, &names) else { continue };
            let Some(owner) = definition(&owner, &defined_in) else { continue };
            for item in &item.items {
                if let syn::ImplItem::Fn(own) = item {
                    methods.insert((owner.clone(), own.sig.ident.to_string()), module.clone());
                }
            }
        }
    }
    let mut uses = Uses::new();
    for (module, (name, file)) in parsed {
        let names = names_in(module);
        let mut paths = Paths {
            module: module.clone(),
            names,
            found: Vec::new(),
            owner: None,
            called: Vec::new(),
        };
        paths.visit_file(file);
        let called = paths.called.iter().filter_map(|(owner, method)| {
            methods.get(&(definition(owner, &defined_in)?, method.clone())).cloned()
        });
        let used = paths.found.iter().filter_map(|path| defined_in(path)).chain(called);
        let used = used.filter(|used| used != module).map(|used| parsed[&used].0.clone());
        uses.insert(name.clone(), used.collect());
    }
    uses
}

/// Returns the absolute path of the type in an `impl`.
fn owner_of(
    item: &syn::ItemImpl,
    module: &[String],
    names: &BTreeMap<String, ModulePath>,
) -> Option<ModulePath> {
    let syn::Type::Path(path) = &*item.self_ty else { return None };
    let parts: Vec<String> = path.path.segments.iter().map(|part| part.ident.to_string()).collect();
    let imported = || Some([names.get(parts.first()?)?, &parts[1..]].concat());
    absolute(&parts, module).or_else(imported).or(Some([module, &parts].concat()))
}

/// Returns the module that defines the type of a path, followed by the type's name.
fn definition(
    path: &[String],
    defined_in: &impl Fn(&[String]) -> Option<ModulePath>,
) -> Option<ModulePath> {
    Some(child(&defined_in(path)?, path.last()?))
}

fn module_of(name: &str) -> ModulePath {
    let mut parts: ModulePath = name.split('/').map(str::to_owned).collect();
    if matches!(parts.last().map(String::as_str), Some("mod")) || name == "lib" || name == "main" {
        parts.pop();
    }
    parts
}

pub(crate) fn child(module: &[String], name: &str) -> ModulePath {
    [module, &[name.to_owned()]].concat()
}

pub(crate) fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let tokens = || attribute.meta.require_list().map(|list| list.tokens.to_string());
        attribute.path().is_ident("cfg")
            && tokens().is_ok_and(|tokens| tokens.contains("test") && !tokens.contains("not"))
    })
}

/// Makes a path absolute; `None` for paths out of the crate.
pub(crate) fn absolute(path: &[String], module: &[String]) -> Option<ModulePath> {
    let ups = path.iter().take_while(|part| *part == "super").count();
    match path.first()?.as_str() {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some([module, &path[1..]].concat()),
        "super" => Some([&module[..module.len().checked_sub(ups)?], &path[ups..]].concat()),
        _ => None,
    }
}

/// Returns the names that an import declares, with their full paths.
pub(crate) fn leaves(item: &ItemUse, module: &[String]) -> Vec<(String, ModulePath)> {
    fn walk(tree: &UseTree, before: &[String], found: &mut Vec<(String, ModulePath)>) {
        let with = |name: &syn::Ident| child(before, &name.to_string());
        match tree {
            UseTree::Path(path) => walk(&path.tree, &with(&path.ident), found),
            UseTree::Name(name) if name.ident == "self" => {
                found.extend(before.last().map(|last| (last.clone(), before.to_vec())));
            }
            UseTree::Name(name) => found.push((name.ident.to_string(), with(&name.ident))),
            UseTree::Rename(name) => found.push((name.rename.to_string(), with(&name.ident))),
            UseTree::Glob(_) => found.push(("*".into(), before.to_vec())),
            UseTree::Group(group) => group.items.iter().for_each(|tree| walk(tree, before, found)),
        }
    }
    let mut found = Vec::new();
    walk(&item.tree, &[], &mut found);
    // A facade refers to its children without `self`.
    let inside = |path: Vec<String>| absolute(&path, module).or(Some([module, &path].concat()));
    found.into_iter().filter_map(|(name, path)| Some((name, inside(path)?))).collect()
}

/// Collector of the paths into the crate that occur in a file.
struct Paths {
    module: ModulePath,
    /// Full paths of names that can begin other paths: imports and child modules.
    names: BTreeMap<String, ModulePath>,
    found: Vec<ModulePath>,
    /// Path of the type whose `impl` is visited.
    owner: Option<ModulePath>,
    /// Methods that types call on themselves.
    called: Vec<(ModulePath, String)>,
}

impl Paths {
    fn add(&mut self, path: &[String]) {
        let found = absolute(path, &self.module).or_else(|| {
            let start = self.names.get(path.first()?)?;
            Some([start, &path[1..]].concat())
        });
        self.found.extend(found);
    }

    fn add_tokens(&mut self, tokens: TokenStream) {
        let (mut path, mut colons) = (Vec::new(), 0);
        for token in tokens {
            match token {
                TokenTree::Ident(name) if path.is_empty() || colons == 2 => {
                    path.push(name.to_string());
                    colons = 0;
                }
                TokenTree::Punct(sign) if sign.as_char() == ':' => colons += 1,
                other => {
                    if path.len() > 1 {
                        self.add(&path);
                    }
                    path.clear();
                    colons = 0;
                    match other {
                        TokenTree::Group(group) => self.add_tokens(group.stream()),
                        TokenTree::Ident(name) => path.push(name.to_string()),
                        _ => {}
                    }
                }
            }
        }
        if path.len() > 1 {
            self.add(&path);
        }
    }
}

impl<'a> Visit<'a> for Paths {
    fn visit_item(&mut self, item: &'a Item) {
        let attributes = match item {
            Item::Fn(item) => &item.attrs,
            Item::Impl(item) => &item.attrs,
            Item::Mod(item) => &item.attrs,
            Item::Use(item) => &item.attrs,
            Item::Const(item) => &item.attrs,
            Item::Static(item) => &item.attrs,
            Item::Struct(item) => &item.attrs,
            _ => &Vec::new(),
        };
        if !is_for_tests(attributes) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'a ItemUse) {
        if matches!(item.vis, Visibility::Inherited) {
            self.found.extend(leaves(item, &self.module).into_iter().map(|(_, path)| path));
        }
    }

    fn visit_item_mod(&mut self, item: &'a ItemMod) {
        if item.content.is_some() {
            self.module.push(item.ident.to_string());
            visit::visit_item_mod(self, item);
            self.module.pop();
        }
    }

    fn visit_item_impl(&mut self, item: &'a syn::ItemImpl) {
        let before = self.owner.take();
        self.owner = owner_of(item, &self.module, &self.names);
        visit::visit_item_impl(self, item);
        self.owner = before;
    }

    fn visit_expr_method_call(&mut self, call: &'a syn::ExprMethodCall) {
        if let syn::Expr::Path(receiver) = &*call.receiver
            && receiver.path.is_ident("self")
        {
            self.called.extend(self.owner.clone().map(|owner| (owner, call.method.to_string())));
        }
        visit::visit_expr_method_call(self, call);
    }

    fn visit_impl_item_fn(&mut self, item: &'a syn::ImplItemFn) {
        if !is_for_tests(&item.attrs) {
            visit::visit_impl_item_fn(self, item);
        }
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        let parts: Vec<String> = path.segments.iter().map(|part| part.ident.to_string()).collect();
        if let [first, method] = &parts[..]
            && first == "Self"
        {
            self.called.extend(self.owner.clone().map(|owner| (owner, method.clone())));
        } else if parts.len() > 1 {
            self.add(&parts);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'a syn::Macro) {
        self.add_tokens(item.tokens.clone());
    }
}

/// Returns circular uses of files or folders: each strongly connected component of more than one, sorted.
pub(crate) fn circles(uses: &Uses) -> Vec<Vec<String>> {
    let reached = |from: &str| -> BTreeSet<&str> {
        let (mut open, mut done) = (vec![from], BTreeSet::new());
        while let Some(at) = open.pop() {
            for used in uses.get(at).into_iter().flatten() {
                if done.insert(used.as_str()) {
                    open.push(used);
                }
            }
        }
        done
    };
    let all: BTreeMap<&str, BTreeSet<&str>> =
        uses.keys().map(|name| (name.as_str(), reached(name))).collect();
    let mut found = BTreeSet::new();
    for (name, reached) in &all {
        let back = |other: &&&str| all.get(**other).is_some_and(|others| others.contains(name));
        let circle: Vec<String> =
            reached.iter().filter(back).map(|name| (*name).to_owned()).collect();
        if circle.len() > 1 {
            found.insert(circle);
        }
    }
    found.into_iter().collect()
}

/// Merges the files of each folder at depth `depth`. Files at lower depths stay separate.
pub(crate) fn by_folder(uses: &Uses, depth: usize) -> Uses {
    let folder = |file: &str| {
        let parts: Vec<&str> = file.split('/').collect();
        if parts.len() > depth { parts[..depth].join("/") } else { file.to_owned() }
    };
    let mut folders = Uses::new();
    for (file, used) in uses {
        let own = folder(file);
        let others = used.iter().map(|used| folder(used)).filter(|used| *used != own);
        folders.entry(own.clone()).or_default().extend(others);
    }
    folders
}
