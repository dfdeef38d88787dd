"""Mesh files: reading, byte-preserving writing, smoothing and conversion."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from gpu_smooth import _native
from gpu_smooth._errors import DeviceError, FileError, GpuSmoothError, OptionError

if TYPE_CHECKING:
    import pathlib

    from gpu_smooth._options import Array, Doubles, Integers, Path
    from gpu_smooth._result import Result


class Group(NamedTuple):
    """Group of elements and vertices to which a file gives a tag or a name."""

    kind: str
    """The format's word for the group, such as `"physical"` of gmsh."""
    dimension: int
    """0 for points, 1 for lines, 2 for triangles and quadrilaterals."""
    name: str | None
    tag: int | None
    vertices: Integers
    """Vertices of the elements of the group, ascending, of shape (k,)."""
    triangles: Integers
    """Triangles of the group, ascending, of shape (k,)."""
    quadrilaterals: Integers
    """Quadrilaterals of the group, as rows of `MeshFile.quadrilaterals`, ascending, of shape (k,)."""


class MeshFile:
    """Mesh file in memory, which can be written with moved vertices and no other change.

    Parameters
    ----------
    path : str, bytes or path-like
        File to read. The format is detected from its content. Files compressed by gzip or zstd are decompressed.
    weld : bool, default False
        Join corners of triangles at the same place to one vertex, in STL and VTK XML.
    allow_outside : bool, default False
        Let the file name files outside of its directory.
    regions : str, optional
        Name of the cell data that number the regions of elements.

    Raises
    ------
    FileError
        The file is missing, damaged or of an unknown format, or has no plane mesh of triangles or quadrilaterals. An `OSError`.
    """

    def __init__(
        self,
        path: Path,
        *,
        weld: bool = False,
        allow_outside: bool = False,
        regions: str | None = None,
    ) -> None:
        self._native = _native.MeshFile(os.fsdecode(path), weld=weld, allow_outside=allow_outside, regions=regions)

    @property
    def path(self) -> pathlib.Path:
        """Path of the file."""
        return self._native.path

    @property
    def format(self) -> str:
        """Name of the format."""
        return self._native.format

    @property
    def points(self) -> Doubles:
        """Positions of the vertices, of shape (n, 2). The array is a copy. `data("z")` has third coordinates that differ."""
        return self._native.points

    @property
    def triangles(self) -> Integers:
        """Vertices of each triangle, numbered from 0 in the order of the file, of shape (m, 3)."""
        return self._native.triangles

    @property
    def quadrilaterals(self) -> Integers:
        """Vertices of each quadrilateral, numbered from 0 in the order of the file, of shape (k, 4).

        Without those that list a vertex twice, whose vertices are among `anchored`.
        """
        return self._native.quadrilaterals

    @property
    def regions(self) -> Integers | None:
        """Region of each triangle, then of each quadrilateral, of shape (m + k,); None without regions.

        The numbers are not those of the file.
        """
        return self._native.regions

    @property
    def lines(self) -> Integers:
        """Edges of line elements, of shape (k, 2), for the option `lines`."""
        return self._native.lines

    @property
    def anchored(self) -> Integers:
        """Vertices of points and of elements other than triangles, quadrilaterals and lines, and ends of groups of lines or vertices.

        With the option `fixed`, these vertices stay where others slide, so that each group keeps its extent.
        """
        return self._native.anchored

    @property
    def periodic(self) -> Integers:
        """Periodic pairs of vertices, and pairs across weirs of ADCIRC, of shape (k, 2), for the option `periodic`."""
        return self._native.periodic

    @property
    def groups(self) -> list[Group]:
        """Groups of the file, such as gmsh's physical groups."""
        return [Group(**row) for row in self._native.groups()]

    @property
    def data_names(self) -> list[str]:
        """Names of the data of vertices and cells in the file."""
        return self._native.data_names

    @property
    def remarks(self) -> list[str]:
        """Remarks on content of the file that is not used."""
        return self._native.remarks

    def data(self, name: str) -> Doubles:
        """Return data of the vertices, of shape (n,) or (n, k).

        Parameters
        ----------
        name : str
            Name of the data in the file. Third coordinates are named `"z"`. Of several time steps, the last is returned.

        Raises
        ------
        FileError
            The file has no such data.
        """
        return self._native.data(name)

    def write(
        self,
        path: Path,
        points: Array | Result,
        *,
        slide: bool = False,
        free_lines: bool = False,
        moved_fixed: bool = False,
    ) -> None:
        """Write the file with its vertices at other points, and no other change.

        Numbers whose bits are unchanged keep their text. An existing file is replaced whole or not at all.

        Parameters
        ----------
        path : str, bytes or path-like
            File to write; may be the file that was read. A name that ends in .gz or .zst compresses the file.
        points : Result or array_like of float, shape (n, 2) or (n, 3)
            Positions of the vertices, or the result of a run, which has them. If third coordinates of the file differ, those
            of the array replace them.
        slide : bool, default False
            Whether vertices may have slid along the boundary, lines and edges between regions, as by `smooth` with
            `slide=True`. A `Result` knows. Vertices of points and other elements, and ends of groups, are still compared.
        free_lines : bool, default False
            Whether vertices on lines inside of the mesh may have moved, as by `smooth` with `free_lines=True`. A `Result`
            knows.
        moved_fixed : bool, default False
            Write any points, such as those of an application that has moved the boundary.

        Raises
        ------
        FileError
            The file cannot be written, or the files of a Triangle mesh would get another ending than that of `path`.
        TypeError
            `path` is no path, such as if the points come first.
        MeshError
            The points are not finite, or not one per vertex; or a vertex has moved that is on the boundary, on a line, between
            regions or on other elements of the file, such as if points of another mesh were passed (`MeshError.vertex`).
        """
        from gpu_smooth._result import Result

        if not isinstance(path, (str, bytes, os.PathLike)):
            found = type(path).__name__
            raise TypeError(
                f"path: the name of a file is needed, not an object of type {found}. The path comes first: "
                "write(path, points)"
            )
        if isinstance(points, Result):
            slide, free_lines = points._outcome.slides, points._outcome.frees_lines
            points = points.points
        self._native.write(os.fsdecode(path), points, slide=slide, free_lines=free_lines, moved_fixed=moved_fixed)

    def difference(self, other: MeshFile) -> str | None:
        """Return the first difference to another file apart from coordinates, None without one."""
        return self._native.difference(other._native)

    def __repr__(self) -> str:
        sizes = f"{len(self.points)} vertices, {len(self.triangles)} triangles"
        if len(self.quadrilaterals):
            sizes += f", {len(self.quadrilaterals)} quadrilaterals"
        return f"MeshFile({str(self.path)!r}, {self.format}, {sizes})"


def convert(
    source: Path,
    destination: Path,
    *,
    lossy: bool = False,
    encoding: Literal["text", "binary", "compressed"] | None = None,
) -> list[str]:
    """Write a mesh file in another format, by the ending of `destination`.

    Parameters
    ----------
    source : str, bytes or path-like
        File to read.
    destination : str, bytes or path-like
        File to write. An existing file is replaced.
    lossy : bool, default False
        Write the mesh even if the format cannot hold all of it.
    encoding : {"text", "binary", "compressed"}, optional
        Encoding of the numbers. gmsh, legacy VTK and PLY are written as text or in binary, VTK XML also compressed. The
        default is text, except for formats that are binary.

    Returns
    -------
    list of str
        What the format cannot hold.

    Raises
    ------
    FileError
        A file cannot be read or written, the format is not written in the encoding, or the format cannot hold all of the
        mesh and `lossy` is false.
    """
    return MeshFile(source)._native.convert(os.fsdecode(destination), lossy, encoding)


# Exit codes of the command line, and their exceptions.
ERRORS: dict[int, type[GpuSmoothError]] = {2: OptionError, 3: FileError, 4: FileError, 5: DeviceError}


def smooth_file(source: Path, destination: Path, **options: Any) -> dict[str, Any]:
    """Smooth a mesh file as the command line does, and return the report.

    The command line runs in another process. A driver that crashes does not end this process.

    Parameters
    ----------
    source : str, bytes or path-like
        Mesh to read.
    destination : str, bytes or path-like
        File for the smoothed mesh, in the format of `source`; may be `source` itself.
    **options
        Options of the command line, with underscores for hyphens: `slide=True` for `--slide`, `fix=["inlet", "outlet"]`
        for `--fix inlet --fix outlet`. `gpu-smooth --help` lists them.

    Returns
    -------
    dict
        The report of the run, as `--report` writes it; see docs/report.md.

    Raises
    ------
    FileError
        A file cannot be read or written, or its mesh cannot be smoothed.
    OptionError
        The command line has no such option, or refuses its value.
    DeviceError
        The GPU cannot be used, or has failed.
    GpuSmoothError
        The run has ended without the wanted result, such as with `strict=True`.
    """
    import json
    import pathlib
    import subprocess
    import sys
    import tempfile

    if not sys.executable:
        raise GpuSmoothError("no interpreter of Python is known to run the command line: sys.executable is empty")
    own = options.pop("report", None)
    words = [sys.executable, "-m", "gpu_smooth", "--quiet"]
    for name, value in options.items():
        # The text of the command line is not shown.
        if name == "quiet":
            continue
        option = "--" + name.replace("_", "-")
        values = value if isinstance(value, (list, tuple)) else [value]
        for one in values:
            if isinstance(one, (bool, np.bool_)):
                words += [option] if one else []
            elif one is not None:
                words.append(f"{option}={os.fsdecode(one) if isinstance(one, (bytes, os.PathLike)) else one}")
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(os.fsdecode(own) if own else pathlib.Path(folder, "report.json"))
        # A name may begin with a hyphen.
        words += [f"--report={report}", "--", os.fsdecode(source), os.fsdecode(destination)]
        earlier = _state(report)
        done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, check=False)
        if done.returncode != 0:
            text = _message(done.stderr.decode(errors="replace"))
            text = text or f"gpu-smooth ended with code {done.returncode}"
            raise ERRORS.get(done.returncode, GpuSmoothError)(text)
        # The report of an earlier run may be there.
        if _state(report) in (None, earlier):
            raise OptionError(
                "the command line has written no report, and no mesh, as with dry_run=True. Drop the option, or run the "
                "command line"
            )
        found: dict[str, Any] = json.loads(report.read_text(encoding="utf-8"))
        return found


def _state(file: pathlib.Path) -> tuple[int, ...] | None:
    """Return numbers that change when a file is replaced or written; None without the file."""
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns


def _message(text: str) -> str:
    """Return the message of an error of the command line, without messages of drivers before and usage after it."""
    text = text.rpartition("gpu-smooth: error: ")[2].strip().removeprefix("error: ")
    for end in ("\n\nUsage:", "\n\nFor more information"):
        text = text.partition(end)[0]
    return text
