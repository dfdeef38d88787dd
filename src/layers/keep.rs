//! The rows of a march that are a layer.

use crate::layers::front::{SEED_ASPECT, close};
use crate::layers::march::Rows;
use crate::layers::sectors::{NONE, Sectors};
use crate::layers::vector::median;

/// Least aspect of a vertex that stays. Below, triangles gain more than they lose by moving.
pub(super) const ASPECT: f64 = 1.5;

/// Least number of kept rows of a column that counts.
pub(super) const ROWS: u32 = 3;

/// Least number of columns that count above a connected run of wall vertices.
const COLUMNS: usize = 8;

/// Least share of the wall vertices of a run above which columns count.
const SHARE: f64 = 0.7;

/// Least median over the columns of a run of the last height divided by the first. Structured meshes of beams and
/// channels have rows of equal heights and are no layers.
const GROWTH: f64 = 1.2;

/// Returns the nodes that stay, row 0 included.
pub(super) fn kept(rows: &Rows) -> Vec<bool> {
    let mut kept = vec![false; rows.row.len()];
    rows.lists[0].iter().for_each(|&n| kept[n as usize] = true);
    for row in &rows.lists[1..] {
        let (high, flat): (Vec<u32>, Vec<u32>) = row
            .iter()
            .filter(|n| kept[rows.parent[**n as usize] as usize])
            .partition(|n| rows.aspect[**n as usize] < ASPECT);
        flat.iter().for_each(|&n| kept[n as usize] = true);
        close(&mut kept, &high, &rows.height, 2.0, |n| rows.beside(n), |_| true);
    }
    kept
}

/// A column of kept rows above a node of a wall.
#[derive(Clone, Copy, Default)]
pub(super) struct Column {
    rows: u32,
    first_height: f64,
    first_aspect: f64,
    last_height: f64,
}

/// Returns the nodes of the front whose connected runs have a layer.
pub(super) fn judged(sectors: &Sectors, rows: &Rows, kept: &[bool]) -> Vec<bool> {
    judged_by(|run| is_deep(run) && grows(run), sectors, rows, kept)
}

/// Returns the nodes of the front in whose connected runs the columns are a layer by `is_layer`.
pub(super) fn judged_by(
    is_layer: impl Fn(&[Column]) -> bool,
    sectors: &Sectors,
    rows: &Rows,
    kept: &[bool],
) -> Vec<bool> {
    let mut column = vec![Column::default(); rows.row.len()];
    let mut root = vec![NONE; rows.row.len()];
    rows.lists[0].iter().for_each(|&n| root[n as usize] = n);
    for (row, nodes) in (1..).zip(&rows.lists[1..]) {
        for &node in nodes.iter().filter(|n| kept[**n as usize]) {
            let (height, aspect) = (rows.height[node as usize], rows.aspect[node as usize]);
            let of = root[rows.parent[node as usize] as usize];
            root[node as usize] = of;
            let own = &mut column[of as usize];
            if own.rows == row {
                continue;
            }
            if row == 1 {
                (own.first_height, own.first_aspect) = (height, aspect);
            }
            (own.rows, own.last_height) = (row, height);
        }
    }
    let mut front = vec![false; rows.row.len()];
    rows.lists[0].iter().for_each(|&n| front[n as usize] = true);
    for run in runs(sectors, &rows.lists[0]) {
        let columns: Vec<Column> = run.iter().map(|&n| column[n as usize]).collect();
        if !is_layer(&columns) {
            run.iter().for_each(|&n| front[n as usize] = false);
        }
    }
    front
}

/// Returns the connected runs along walls of a list of nodes.
fn runs(sectors: &Sectors, nodes: &[u32]) -> Vec<Vec<u32>> {
    let mut is_left = vec![false; sectors.len()];
    nodes.iter().for_each(|&n| is_left[n as usize] = true);
    let mut runs = Vec::new();
    for &start in nodes {
        if !std::mem::take(&mut is_left[start as usize]) {
            continue;
        }
        let (mut run, mut at) = (vec![start], 0);
        while let Some(&node) = run.get(at) {
            at += 1;
            for other in sectors.wall[node as usize].into_iter().filter(|n| *n != NONE) {
                if std::mem::take(&mut is_left[other as usize]) {
                    run.push(other);
                }
            }
        }
        runs.push(run);
    }
    runs
}

/// Returns the columns above a run of a wall that have enough rows.
fn high(run: &[Column]) -> impl Iterator<Item = &Column> {
    run.iter().filter(|column| column.rows >= ROWS)
}

/// Returns whether the columns above a run of a wall are a layer as far as their first [`ROWS`] rows tell.
pub(super) fn is_deep(run: &[Column]) -> bool {
    let aspects: Vec<f64> = high(run).map(|column| column.first_aspect).collect();
    aspects.len() >= COLUMNS
        && aspects.len() as f64 >= SHARE * run.len() as f64
        && median(aspects).is_some_and(|aspect| aspect >= SEED_ASPECT)
}

/// Returns whether the heights of the columns above a run of a wall grow as those of a layer.
fn grows(run: &[Column]) -> bool {
    let growths = high(run).map(|column| column.last_height / column.first_height).collect();
    median(growths).is_some_and(|growth| growth >= GROWTH)
}
