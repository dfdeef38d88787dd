//! Greedy coloring of a graph in smallest-last order (Matula & Beck, J. ACM 30, 1983).

/// Color of a vertex that is not free.
pub const UNCOLORED: u32 = u32::MAX;

/// Neighbors of each vertex, in compressed rows.
pub(crate) struct Graph<I> {
    start: Vec<u32>,
    neighbors: Vec<I>,
}

impl<I: Copy + Into<u32>> Graph<I> {
    pub(crate) fn with_capacity(vertices: usize) -> Self {
        let mut start = Vec::with_capacity(vertices + 1);
        start.push(0);
        Self { start, neighbors: Vec::with_capacity(6 * vertices) }
    }

    /// Appends a vertex with its neighbors.
    pub(crate) fn push(&mut self, neighbors: impl Iterator<Item = I>) {
        self.neighbors.extend(neighbors);
        self.start.push(self.neighbors.len() as u32);
    }

    /// Removes all neighbors of the last vertex.
    pub(crate) fn clear_last(&mut self) {
        self.start.pop();
        self.neighbors.truncate(self.start.last().map_or(0, |&start| start as usize));
        self.start.push(self.neighbors.len() as u32);
    }

    pub(crate) fn row(&self, v: u32) -> &[I] {
        &self.neighbors[self.start[v as usize] as usize..self.start[v as usize + 1] as usize]
    }

    /// Removes vertices until none is left, each time a vertex with the fewest remaining neighbors. Returns the order
    /// of removal, and empties `degrees`.
    pub(crate) fn smallest_last_order(&self, degrees: &mut Degrees) -> Vec<u32> {
        let Degrees { of, buckets } = degrees;
        for (v, &degree) in of.iter().enumerate().rev().filter(|(_, degree)| **degree != STAYS) {
            if buckets.len() <= degree as usize {
                buckets.resize_with(degree as usize + 1, Vec::new);
            }
            buckets[degree as usize].push(v as u32);
        }
        let mut order = Vec::with_capacity(of.len());
        let mut least = 0;
        while least < buckets.len() {
            let Some(v) = buckets[least].pop() else {
                least += 1;
                continue;
            };
            // A vertex has an entry in the bucket of each degree that it ever had. Only the entry for the present
            // degree is valid.
            if of[v as usize] as usize != least {
                continue;
            }
            of[v as usize] = STAYS;
            order.push(v);
            for &u in self.row(v) {
                let u: u32 = u.into();
                let degree = &mut of[u as usize];
                if *degree != STAYS {
                    *degree -= 1;
                    buckets[*degree as usize].push(u);
                }
            }
            least = least.saturating_sub(1);
        }
        of.clear();
        order
    }

    /// Gives each vertex the least possible color, in the reverse of `order`. Returns the number of colors.
    pub(crate) fn color(&self, order: &[u32], colors: &mut [u32]) -> u32 {
        let mut count = 0;
        for &v in order.iter().rev() {
            colors[v as usize] = self.least_color(v, UNCOLORED, colors);
            count = count.max(colors[v as usize] + 1);
        }
        count
    }

    /// Tries to eliminate colors 4 and above, which few vertices have, by recoloring one vertex at a time. Returns the
    /// number of colors.
    pub(crate) fn save_colors(&self, order: &[u32], count: u32, colors: &mut [u32]) -> u32 {
        for color in (FOUR..count).rev() {
            for &v in order {
                if colors[v as usize] == color {
                    self.lower(v, colors);
                }
            }
        }
        order.iter().map(|&v| colors[v as usize] + 1).max().unwrap_or(0)
    }

    fn colors_around<'a>(&'a self, v: u32, colors: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
        self.row(v).iter().map(|&u| colors[u.into() as usize])
    }

    /// Returns the least color other than `but` that no neighbor of `v` has.
    #[inline]
    fn least_color(&self, v: u32, but: u32, colors: &[u32]) -> u32 {
        let taken = self.colors_around(v, colors).chain([but]);
        let taken = taken.filter(|&c| c < 64).fold(0u64, |set, c| set | 1 << c);
        let mut color = (!taken).trailing_zeros();
        // A planar graph takes at most 6 colors. A mesh that overlaps itself may take more, but reaches 64 only if
        // every vertex of some subgraph has at least 64 neighbors.
        while color >= 64 && self.colors_around(v, colors).chain([but]).any(|c| c == color) {
            color += 1;
        }
        color
    }

    /// Gives `v` a lower color that exactly one neighbor has, if this neighbor can take another color below the present
    /// color of `v`.
    fn lower(&self, v: u32, colors: &mut [u32]) {
        let color = colors[v as usize];
        // Bit sets of the colors of neighbors, and of the colors that several neighbors have.
        let (mut taken, mut shared) = (0u64, 0u64);
        for c in self.colors_around(v, colors).filter(|&c| c < 64) {
            shared |= taken & 1 << c;
            taken |= 1 << c;
        }
        for &u in self.row(v) {
            let u = u.into();
            let wanted = colors[u as usize];
            // Vertices between blocks have no row in the graph and keep their colors. Neighbors of high degree keep
            // their colors too: each of their neighbors might try to recolor them, at a cost proportional to their
            // degree.
            if wanted < color.min(64)
                && shared & 1 << wanted == 0
                && (1..=MANY).contains(&self.row(u).len())
            {
                let other = self.least_color(u, wanted, colors);
                if other < color {
                    colors[u as usize] = other;
                    colors[v as usize] = wanted;
                    return;
                }
            }
        }
    }
}

/// Number of colors that suffice for every planar graph, though such a coloring may be hard to find.
const FOUR: u32 = 4;

/// Largest degree of a vertex that [`Graph::save_colors`] recolors.
const MANY: usize = 64;

/// Marker that replaces the degree of removed vertices and of vertices to be kept.
const STAYS: u32 = u32::MAX;

/// Vertices sorted by degree, the number of neighbors that are not yet removed.
#[derive(Default)]
pub(crate) struct Degrees {
    of: Vec<u32>,
    buckets: Vec<Vec<u32>>,
}

impl Degrees {
    /// Appends a vertex with its degree; `None` keeps the vertex out of the removal.
    pub(crate) fn put(&mut self, degree: Option<u32>) {
        self.of.push(degree.unwrap_or(STAYS));
    }
}
