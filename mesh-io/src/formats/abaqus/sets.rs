//! Sets of elements or nodes: defined by `*ELSET` and `*NSET`, or named by element and node lists.

use super::blocks::Block;
use super::deck::{ASSEMBLY, Deck};
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::text::token::{integer, unquoted};
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// All element sets, or all node sets, of an input file.
#[derive(Default)]
pub(super) struct Sets {
    sets: Vec<Set>,
    numbers: HashMap<Key, usize>,
}

/// The identity of a set: the scope, and the name in capital letters, as names ignore case.
pub(super) type Key = (usize, Vec<u8>);

struct Set {
    key: Key,
    /// The name, spelled like the first occurrence in the file.
    name: Vec<u8>,
    /// Whether the set has the parameter `INTERNAL`: Abaqus/CAE generated the set, not a user.
    is_internal: bool,
    items: Vec<Item>,
}

/// One entry of a set's list of members.
enum Item {
    /// The ids from `first` to `last`, both inclusive, in steps of `step`.
    Numbers {
        first: u64,
        last: u64,
        step: u64,
    },
    /// A range of positions of nodes or elements in the file.
    Positions(Range<u32>),
    Set(Key),
}

/// The ids of nodes or elements, sorted, each with its position in the file.
pub(super) struct IdPositions(Vec<(u64, u32)>);

impl IdPositions {
    pub(super) fn new(tags: &[u64]) -> IdPositions {
        let mut all: Vec<(u64, u32)> = tags.iter().copied().zip(0..).collect();
        if !all.is_sorted() {
            all.sort_unstable();
        }
        IdPositions(all)
    }

    /// Returns the entries whose ids are from `first` to `last`, both inclusive.
    fn within(&self, first: u64, last: u64) -> &[(u64, u32)] {
        let start = self.0.partition_point(|&(tag, _)| tag < first);
        let end = self.0.partition_point(|&(tag, _)| tag <= last);
        &self.0[start..end.max(start)]
    }

    /// Returns the positions of nodes or elements whose id is the whole number `word` plus `offset`; none for any other word.
    pub(super) fn of_word(&self, word: &[u8], offset: u64) -> impl Iterator<Item = u32> {
        let number = integer(word).map(|number| number.saturating_add(offset));
        let found = number.map(|number| self.within(number, number));
        found.unwrap_or_default().iter().map(|&(_, place)| place)
    }
}

/// Remaining number of steps for listing the members of sets. The limit stops damaged files whose sets include each
/// other many times.
pub(super) struct WorkBudget(usize);

impl WorkBudget {
    pub(super) fn of(source: &Source) -> WorkBudget {
        WorkBudget(source.bytes.len().saturating_mul(8).max(1 << 20))
    }

    fn spend(&mut self, source: &Source, steps: usize) -> Result<(), ReadError> {
        match self.0.checked_sub(steps) {
            Some(left) => {
                self.0 = left;
                Ok(())
            }
            None => {
                let problem = "its sets have more members than any mesh of this size";
                Err(source.error(problem, "Write the mesh again, with fewer sets"))
            }
        }
    }
}

impl Sets {
    /// Returns the index of the set with the given name. A set with a new name is added, without members.
    pub(super) fn number(&mut self, scope: usize, name: &[u8]) -> usize {
        let key = (scope, name.to_ascii_uppercase());
        let next = self.sets.len();
        let number = *self.numbers.entry(key.clone()).or_insert(next);
        if number == next {
            let name = name.to_vec();
            self.sets.push(Set { key, name, is_internal: false, items: Vec::new() });
        }
        number
    }

    /// Adds a range of positions to a set of a scope of the mesh.
    pub(super) fn add(&mut self, scope: usize, name: &[u8], places: Range<u32>) {
        let number = self.number(scope, name);
        self.sets[number].items.push(Item::Positions(places));
    }

    /// Reads the sets of all blocks with the keyword `ELSET` or `NSET`, in the mesh and in the assembly.
    pub(super) fn read(&mut self, source: &Source, deck: &Deck<'_>, keyword: &str) {
        let of_assembly = deck.of_assembly(keyword).map(|block| (block, ASSEMBLY));
        for (block, scope) in deck.of_mesh(keyword).chain(of_assembly) {
            if let Some(name) = block.name(keyword) {
                let number = self.number(scope, name);
                let items = items(source, deck, block, scope);
                self.sets[number].is_internal |= block.parameter("INTERNAL").is_some();
                self.sets[number].items.extend(items);
            }
        }
    }

    /// Finds a set by name in a scope. `INSTANCE.SET` also finds a set of the mesh if `INSTANCE` refers to the mesh.
    pub(super) fn find(&self, deck: &Deck<'_>, scope: usize, name: &[u8]) -> Option<usize> {
        let by = |scope, name: &[u8]| self.numbers.get(&(scope, name.to_ascii_uppercase()));
        let of_instance = || {
            let point = memchr::memchr(b'.', name)?;
            by(deck.instance(&name[..point])?, &name[point + 1..])
        };
        by(scope, name).or_else(of_instance).copied()
    }

    /// Returns the positions of a set's members, ascending and without repeats. Members of included sets count.
    ///
    /// # Errors
    /// If the budget `effort` is exhausted.
    pub(super) fn members(
        &self,
        number: usize,
        all: &IdPositions,
        source: &Source,
        effort: &mut WorkBudget,
    ) -> Result<Vec<u32>, ReadError> {
        let mut members = Vec::new();
        let (mut seen, mut open) = (HashSet::from([number]), vec![number]);
        while let Some(number) = open.pop() {
            for item in &self.sets[number].items {
                let before = members.len();
                let mut passed = 1;
                match item {
                    &Item::Numbers { first, last, step } => {
                        let within = all.within(first, last);
                        passed += within.len();
                        let is_hit = |&&(tag, _): &&(u64, u32)| (tag - first).is_multiple_of(step);
                        members.extend(within.iter().filter(is_hit).map(|&(_, place)| place));
                    }
                    Item::Positions(places) => members.extend(places.clone()),
                    Item::Set(key) => {
                        open.extend(self.numbers.get(key).filter(|&&other| seen.insert(other)));
                    }
                }
                effort.spend(source, passed.max(members.len() - before))?;
            }
        }
        members.sort_unstable();
        members.dedup();
        Ok(members)
    }

    /// Lists the indices and names of sets, without internal sets. A set of the mesh whose name is that of a set of another scope
    /// gets a prefix: the name of its part if several parts have elements, else `part.`.
    pub(super) fn named(&self, deck: &Deck<'_>) -> impl Iterator<Item = (usize, Vec<u8>)> {
        let mut scopes_of: HashMap<&[u8], u32> = HashMap::new();
        self.sets.iter().for_each(|set| *scopes_of.entry(&set.key.1).or_default() += 1);
        let own = self.sets.iter().enumerate().filter(|(_, set)| !set.is_internal);
        own.map(move |(number, set)| {
            let (scope, key) = &set.key;
            let is_alone = *scope == ASSEMBLY || scopes_of[&key[..]] == 1;
            let part = deck.name(*scope).unwrap_or(b"part");
            let name = if is_alone || part.is_empty() {
                set.name.clone()
            } else {
                [part, b".", &set.name].concat()
            };
            (number, name)
        })
    }
}

/// Reads the entries in the data lines of a set's block.
fn items(source: &Source, deck: &Deck<'_>, block: &Block<'_>, scope: usize) -> Vec<Item> {
    // In an assembly, plain numbers are ids of the block's instance. Without an instance, nodes and elements of the
    // assembly itself are meant, and skipped.
    let of_assembly = scope == ASSEMBLY;
    let scope = match of_assembly {
        true => block.name("INSTANCE").and_then(|name| deck.instance(name)).unwrap_or(ASSEMBLY),
        false => scope,
    };
    let is_plain = scope != ASSEMBLY;
    let in_scope = |number: u64, scope: usize| number.saturating_add(deck.offset(scope));
    let mut items = Vec::new();
    if block.parameter("GENERATE").is_some() {
        let mut row = Vec::new();
        for (item, is_last) in block.items(source) {
            row.push(integer(item));
            if is_last {
                if let [Some(first), Some(last), rest @ ..] = &row[..]
                    && is_plain
                {
                    let step = rest.first().copied().flatten().unwrap_or(1).max(1);
                    let [first, last] = [first, last].map(|&number| in_scope(number, scope));
                    items.push(Item::Numbers { first, last, step });
                }
                row.clear();
            }
        }
        return items;
    }
    let one = |number| Item::Numbers { first: number, last: number, step: 1 };
    for (item, _) in block.items(source).filter(|(item, _)| !item.is_empty()) {
        let item = unquoted(item);
        match (integer(item), memchr::memchr(b'.', item)) {
            (Some(number), _) if is_plain => items.push(one(in_scope(number, scope))),
            (Some(_), _) => {}
            // A member or a set of an instance: `Part-1-1.7` or `Part-1-1.inlet`.
            (None, Some(point)) if of_assembly && deck.instance(&item[..point]).is_some() => {
                let of_mesh = deck.instance(&item[..point]).unwrap_or(scope);
                let rest = &item[point + 1..];
                items.push(match integer(rest) {
                    Some(number) => one(in_scope(number, of_mesh)),
                    None => Item::Set((of_mesh, rest.to_ascii_uppercase())),
                });
            }
            _ => items.push(Item::Set((scope, item.to_ascii_uppercase()))),
        }
    }
    items
}
