"""Ends of groups of lines and of vertices, which stay where other vertices slide."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from gpu_smooth._options import Integers

# Least number of vertices at which the numbers of lines are compared before they can count as a mere numbering.
MIN_PLACES = 6


def ends_of_numbers(lines: Integers, numbers: npt.NDArray[Any]) -> Integers:
    """Return the vertices at which lines of one number end; none if the numbers differ for nearly every line.

    `lines` has shape (k, 2), `numbers` shape (k,). As in mesh files, nearly every line is more than three of four.
    """
    at, number = lines.ravel(), np.repeat(numbers, 2)
    order = np.lexsort((number, at))
    at, number = at[order], number[order]
    starts = np.flatnonzero(np.diff(at, prepend=at[:1] - 1))
    counts = np.diff(starts, append=len(at))
    differ = number[starts] != number[starts + counts - 1]
    places = np.count_nonzero(counts > 1)
    if places >= MIN_PLACES and 4 * np.count_nonzero(differ[counts > 1]) > 3 * places:
        if 4 * len(np.unique(numbers)) > 3 * len(numbers):
            return np.empty(0, np.int64)
    found = [ends_of_lines(lines[numbers == own]) for own in np.unique(numbers)]
    return np.concatenate([np.empty(0, np.int64), *found])


def ends_of_lines(lines: Integers) -> Integers:
    """Return the vertices of lines of shape (k, 2) at which other than two of the lines meet."""
    edges = np.unique(np.sort(lines, axis=1), axis=0)
    vertices, counts = np.unique(edges[edges[:, 0] != edges[:, 1]], return_counts=True)
    ends: Integers = vertices[counts != 2]
    return ends


def ends_of_vertices(vertices: Integers, boundary: Integers, lines: Integers) -> Integers:
    """Return those of the vertices from which an edge of the boundary or of a line leads to another vertex.

    `boundary` and `lines` have shape (k, 2).
    """
    curves = np.concatenate([boundary, lines])
    first, second = np.isin(curves, vertices).T
    return np.unique(np.concatenate([curves[first & ~second, 0], curves[second & ~first, 1]]))


def between_regions(
    regions: npt.NDArray[Any], triangles: Integers, quadrilaterals: Integers, vertices: int
) -> Integers:
    """Return the vertices of elements of several regions.

    `triangles` has shape (m, 3), `quadrilaterals` (k, 4), and `regions` (m + k,).
    """
    number = np.unique(regions, return_inverse=True)[1].ravel()
    low, high = np.full(vertices, number.max(initial=0)), np.zeros(vertices, np.int64)
    of_triangles, of_others = np.split(number, [len(triangles)])
    for corners, own in ((triangles, of_triangles), (quadrilaterals, of_others)):
        np.minimum.at(low, corners.ravel(), np.repeat(own, corners.shape[1]))
        np.maximum.at(high, corners.ravel(), np.repeat(own, corners.shape[1]))
    return np.flatnonzero(low < high)


def boundary_of(triangles: Integers, quadrilaterals: Integers) -> Integers:
    """Return the edges of exactly one element, of shape (k, 2)."""
    sides = [triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), quadrilaterals[:, [0, 1, 1, 2, 2, 3, 3, 0]].reshape(-1, 2)]
    edges, counts = np.unique(np.sort(np.concatenate(sides), axis=1), axis=0, return_counts=True)
    boundary: Integers = edges[counts == 1]
    return boundary
