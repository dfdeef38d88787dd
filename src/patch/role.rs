//! The place of a visited vertex in the corners around the vertex.

use crate::metric::Given;

/// The place of a visited vertex in a corner. Three corners of a quadrilateral have the vertex: the corner at
/// the vertex, the corner at the next vertex and the corner at the last vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Role {
    /// Any vertex of a triangle, which is then written with the visited vertex first.
    #[default]
    Triangle,
    /// First vertex of its own corner of a quadrilateral.
    Own,
    /// Third vertex of the corner at the next vertex of a quadrilateral.
    Next,
    /// Second vertex of the corner at the previous vertex of a quadrilateral.
    Last,
}

/// A quadrilateral among the corners around a visited vertex, which has the corners at the vertex, at the next and at the last
/// vertex of the quadrilateral one after the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AroundVertex {
    /// The index of the corner at the visited vertex.
    pub(crate) first: usize,
    /// The vertices of the corner opposite the visited vertex, that vertex first.
    pub(crate) opposite: [u32; 3],
}

impl AroundVertex {
    /// Returns the quadrilaterals of a list of corners, each with its role and with the two vertices of [`Role::of`].
    pub(crate) fn all(
        corners: impl Iterator<Item = (Role, [u32; 2])> + Clone,
    ) -> impl Iterator<Item = Self> {
        let pairs = corners.clone().zip(corners.skip(1)).enumerate();
        pairs.filter(|(_, ((role, _), _))| *role == Role::Own).map(
            |(first, ((_, [next, last]), (_, [_, opposite])))| Self {
                first,
                opposite: [opposite, last, next],
            },
        )
    }
}

impl Role {
    /// Returns the place of a vertex in a corner, and the other two vertices, counter-clockwise. `is_right` tells whether the
    /// corner is of a quadrilateral.
    pub(crate) fn of([p, q, r]: [u32; 3], is_right: bool, vertex: u32) -> (Self, [u32; 2]) {
        match (is_right, vertex) {
            (false, v) if v == q => (Self::Triangle, [r, p]),
            (false, v) if v == r => (Self::Triangle, [p, q]),
            (false, _) => (Self::Triangle, [q, r]),
            (true, v) if v == r => (Self::Next, [p, q]),
            (true, v) if v == q => (Self::Last, [p, r]),
            (true, _) => (Self::Own, [q, r]),
        }
    }

    /// Returns whether the corner is of a quadrilateral.
    #[inline(always)]
    pub(crate) fn is_right(self) -> bool {
        self != Self::Triangle
    }

    /// Returns the vertices of the corner, counter-clockwise, given the visited vertex and the other two of [`Self::of`].
    #[inline(always)]
    pub(crate) fn vertices<P>(self, at: P, [p, q]: [P; 2]) -> [P; 3] {
        match self {
            Self::Triangle | Self::Own => [at, p, q],
            Self::Next => [p, q, at],
            Self::Last => [p, at, q],
        }
    }

    /// Returns the slopes of the edges of the corner in the form of the metrics, in which the corner of a quadrilateral is
    /// sheared.
    #[inline(always)]
    pub(crate) fn slopes(self) -> Given {
        const OWN: Given = Given::of_right_angle(-1.0, -1.0);
        const NEXT: Given = Given::of_right_angle(0.0, 1.0);
        const LAST: Given = Given::of_right_angle(1.0, 0.0);
        match self {
            Self::Triangle => Given(-1.0, -1.0),
            Self::Own => OWN,
            Self::Next => NEXT,
            Self::Last => LAST,
        }
    }

    /// Returns the slopes of the edges of the corner in the plane.
    pub(crate) fn plane_slopes(self) -> Given {
        match self {
            Self::Triangle | Self::Own => Given(-1.0, -1.0),
            Self::Next => Given(0.0, 1.0),
            Self::Last => Given(1.0, 0.0),
        }
    }

    /// Returns a term of the corner times its weight: 1 for a triangle, 1/4 for a corner of a quadrilateral.
    #[inline(always)]
    pub(crate) fn weighted<V: std::ops::Mul<f64, Output = V>>(self, term: V) -> V {
        if self.is_right() { term * 0.25 } else { term }
    }
}
