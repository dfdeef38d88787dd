"""The progress of a run."""

from __future__ import annotations

from typing import NamedTuple


class Progress(NamedTuple):
    """Progress of a run, as passed to the function `on_sweep`."""

    phase: str
    """`"untangling"`, `"reference"` (the search for the desired f), `"smoothing"` or `"improving"`."""
    sweep: int
    """Number of completed sweeps of the phase."""
    value: float
    """f by the first metric of the scheme; while untangling, the number of inverted or flat triangles."""
