//! The ends of layers: last columns where rows end abruptly, corners where rows cross, and rows that end at other walls.

use crate::layers::front::CORNER;
use crate::layers::keep::ASPECT;
use crate::layers::march::Rows;
use crate::layers::measure::Measure;
use crate::layers::sectors::{NONE, Sectors};
use crate::layers::vector::{cross, length, minus};

/// Number of wall vertices from a corner to the fronts that cross there, at most.
const NEAR: usize = 8;

/// Number of times that last corners of stretched triangles are added, at most.
const TIMES: usize = 3;

/// Adds the last columns where layers end, and the vertices at corners where rows cross, to the kept nodes.
pub(super) fn add(sectors: &Sectors, rows: &Rows, kept: &mut [bool]) {
    let traced = kept.to_vec();
    let mut added = vec![false; kept.len()];
    beside_columns(sectors, rows, &traced, &mut added);
    for _ in 0..TIMES {
        let new = last_corners(sectors, &traced, &added);
        if new.is_empty() {
            break;
        }
        new.into_iter().for_each(|n| added[n as usize] = true);
    }
    at_corners(sectors, rows, &traced, &mut added);
    kept.iter_mut().zip(added).for_each(|(kept, added)| *kept |= added);
}

/// Adds the corners of elements on edges of kept columns that reach far sideways.
fn beside_columns(sectors: &Sectors, rows: &Rows, traced: &[bool], added: &mut [bool]) {
    let is_column = |a: u32, b: u32| rows.parent[b as usize] == a && traced[b as usize];
    for h in 0..sectors.corners.len() {
        let mut corner = sectors.next[h];
        let [a, b] = [sectors.corners[h], sectors.corners[corner as usize]];
        if !is_column(a, b) && !is_column(b, a) {
            continue;
        }
        let from = sectors.point(a);
        let edge = minus(sectors.point(b), from);
        let size = length(edge);
        loop {
            corner = sectors.next[corner as usize];
            if corner as usize == h {
                break;
            }
            let node = sectors.corners[corner as usize];
            let sideways = cross(edge, minus(sectors.point(node), from)).abs() / size;
            if !traced[node as usize] && !sectors.is_wall(node) && sideways >= 1.5 * size {
                added[node as usize] = true;
            }
        }
    }
}

/// Returns the last corners of stretched triangles that have a traced and an added corner.
fn last_corners(sectors: &Sectors, traced: &[bool], added: &[bool]) -> Vec<u32> {
    let mut found = Vec::new();
    for h in 0..sectors.corners.len() {
        let second = sectors.next[h] as usize;
        let third = sectors.next[second] as usize;
        if sectors.next[third] as usize != h {
            continue;
        }
        let [a, b, c] = [h, second, third].map(|h| sectors.corners[h]);
        let has = |x: u32, y: u32| traced[x as usize] && added[y as usize];
        let is_new = !traced[c as usize] && !added[c as usize] && !sectors.is_wall(c);
        if !is_new || !(has(a, b) || has(b, a)) {
            continue;
        }
        let [p, q, r] = [a, b, c].map(|n| sectors.point(n));
        let longest =
            [minus(q, p), minus(r, q), minus(p, r)].map(length).into_iter().fold(0.0, f64::max);
        let altitude = cross(minus(q, p), minus(r, p)).abs() / longest;
        if longest / altitude >= ASPECT + 1.0 / ASPECT {
            found.push(c);
        }
    }
    found
}

/// Adds the inner neighbors of the vertices of walls between two fronts at a sharp corner.
fn at_corners(sectors: &Sectors, rows: &Rows, traced: &[bool], added: &mut [bool]) {
    let is_front = |n: u32| rows.row[n as usize] == 0 && traced[n as usize];
    for corner in (0..sectors.len() as u32).filter(|&n| sectors.is_wall(n)) {
        if sectors.fluid[corner as usize] >= CORNER {
            continue;
        }
        let mut between = Vec::new();
        let reached = [0, 1].map(|side| {
            let mut node = corner;
            for _ in 0..=NEAR {
                if is_front(node) {
                    return true;
                }
                between.push(node);
                node = sectors.wall[node as usize][side];
                if node == NONE {
                    break;
                }
            }
            false
        });
        if reached != [true; 2] {
            continue;
        }
        for &node in between.iter().flat_map(|&n| sectors.neighbors(n)) {
            if !sectors.is_wall(node) && !traced[node as usize] {
                added[node as usize] = true;
            }
        }
    }
}

/// Marks the nodes of other walls, such as an inlet, at which kept rows end.
pub(super) fn sides(sectors: &Sectors, rows: &Rows, kept: &[bool]) -> Vec<bool> {
    let mut sides = vec![false; kept.len()];
    // The row that ends at each node of a side.
    let mut ends = vec![NONE; kept.len()];
    for (row, nodes) in (0..).zip(&rows.lists).skip(1) {
        for &node in nodes.iter().filter(|n| kept[**n as usize]) {
            let parent = rows.parent[node as usize];
            let height = rows.height[node as usize];
            for &side in sectors.neighbors(node) {
                if kept[side as usize] || !sectors.is_wall(side) {
                    continue;
                }
                // Along the side, a row follows the row below, and the first row the end of the wall below. On a curved
                // wall, heights of nodes of the next column do not tell rows apart, as the wall bends by more than a row.
                let follows = sectors.wall[side as usize].iter().any(|&below| {
                    below != NONE
                        && match row {
                            1 => sectors.wall[parent as usize].contains(&below),
                            _ => ends[below as usize] == row - 1,
                        }
                });
                // A side of the row before has height 0, a side of the next row at least 4/3 of the height.
                let above = Measure::new(sectors, side, parent, rows.beside(parent)).height;
                if follows {
                    ends[side as usize] = row;
                }
                sides[side as usize] |= follows || (0.5..=4.0 / 3.0).contains(&(above / height));
            }
        }
    }
    sides
}
