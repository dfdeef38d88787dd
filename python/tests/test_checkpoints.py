"""Checkpoints, from which a run continues."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Points, Triangles, lattice

import gpu_smooth

# A run that ends by its count of sweeps alone.
OPTIONS: dict[str, Any] = {"tolerance": 0, "max_sweeps": 60, "method": "relaxed"}


@pytest.fixture
def large() -> tuple[Points, Triangles]:
    return lattice(150)


def interrupted(mesh: tuple[Points, Triangles], checkpoint: Path, **options: Any) -> gpu_smooth.Result:
    """Return the result of a run that is ended after its first sweeps."""
    points, triangles = mesh
    given: dict[str, Any] = {**OPTIONS, **options, "checkpoint": checkpoint, "on_sweep": lambda progress: progress.sweep > 0}
    return gpu_smooth.run(points, triangles, **given)


@pytest.mark.parametrize("engine", ["cpu", "gpu"])
def test_a_continued_run_has_the_bits_of_an_uninterrupted_one(
    large: tuple[Points, Triangles], engine: Any, tmp_path: Path
) -> None:
    file = tmp_path / "checkpoint"
    left = interrupted(large, file, engine=engine)
    assert left.stop == "canceled" and 0 < left.sweeps < 60 and file.exists()
    whole = gpu_smooth.run(*large, **OPTIONS, engine=engine)
    resumed = gpu_smooth.run(*large, **OPTIONS, engine=engine, resume=str(file))
    assert resumed.sweeps == whole.sweeps == 60 and np.array_equal(resumed.points, whole.points)
    assert np.array_equal(resumed.history, whole.history)
    assert not file.exists(), "a completed run removes its checkpoint"


def test_a_run_that_an_exception_ends_leaves_a_checkpoint(large: tuple[Points, Triangles], tmp_path: Path) -> None:
    file = tmp_path / "checkpoint"

    def fail(progress: gpu_smooth.Progress) -> None:
        if progress.sweep:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        gpu_smooth.smooth(*large, **OPTIONS, checkpoint=file, on_sweep=fail)
    resumed = gpu_smooth.smooth(*large, **OPTIONS, resume=file)
    assert np.array_equal(resumed, gpu_smooth.smooth(*large, **OPTIONS))


def test_other_files_and_other_runs_are_refused(large: tuple[Points, Triangles], tmp_path: Path) -> None:
    file, text = tmp_path / "checkpoint", tmp_path / "notes"
    text.write_text("notes")
    with pytest.raises(gpu_smooth.FileError, match="checkpoint: .*notes exists and is no checkpoint"):
        gpu_smooth.smooth(*large, checkpoint=text)
    with pytest.raises(gpu_smooth.FileError, match="resume: .*notes: the file is not a checkpoint"):
        gpu_smooth.smooth(*large, resume=text)
    with pytest.raises(gpu_smooth.FileError, match="resume: .*none.*A completed run removes its checkpoint"):
        gpu_smooth.smooth(*large, resume=tmp_path / "none")
    assert text.read_text() == "notes"
    interrupted(large, file)
    with pytest.raises(gpu_smooth.FileError, match="checkpoint: .* is the checkpoint of another run"):
        gpu_smooth.smooth(*large, checkpoint=file)
    with pytest.raises(gpu_smooth.OptionError, match="resume: .*max_sweeps|resume: .*60"):
        gpu_smooth.smooth(*large, resume=file, tolerance=0, max_sweeps=7, method="relaxed")
    with pytest.raises(gpu_smooth.OptionError, match="resume: mesh, .* differ from this run"):
        gpu_smooth.smooth(*lattice(149), **OPTIONS, resume=file)
    with pytest.raises(gpu_smooth.OptionError, match="checkpoint_every needs checkpoint"):
        gpu_smooth.smooth(*large, checkpoint_every=9)
    with pytest.raises(gpu_smooth.OptionError, match="checkpoint: the value is 3"):
        gpu_smooth.smooth(*large, checkpoint=3)  # type: ignore[call-overload]
    assert file.exists()


def test_a_checkpoint_that_cannot_be_saved_is_a_warning(large: tuple[Points, Triangles], tmp_path: Path) -> None:
    missing = tmp_path / "missing" / "checkpoint"
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = interrupted(large, missing)
    assert result.stop == "canceled"
    assert ["no checkpoint was saved" in str(warning.message) for warning in caught] == [True]
    with pytest.raises(gpu_smooth.MeshWarning, match="no checkpoint was saved"):
        interrupted(large, missing)
