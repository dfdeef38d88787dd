"""The docstring of `smooth` and the types of keywords have the options of the table that the command line shares.

`GPU_SMOOTH_OPTIONS=write` writes both, from the options of the installed package, into the sources beside the tests.
"""

from __future__ import annotations

import inspect
import os
import re
import textwrap
from pathlib import Path
from typing import Any

import pytest

import gpu_smooth
from gpu_smooth import _native, _options

SOURCES = Path(__file__).parent.parent / "gpu_smooth"
OPTIONS: list[dict[str, Any]] = _native.options()


def documented(option: dict[str, Any]) -> str:
    """Return the entry of an option in the docstring."""
    default = f"default {option['default']}" if option["default"] else "optional"
    indent = " " * 8
    description = textwrap.fill(
        option["description"], 120, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False
    )
    return f"    {option['name']} : {option['type']}, {default}\n{description}\n"


def annotated(option: dict[str, Any]) -> str:
    """Return the line of an option in the types of keywords."""
    return f"    {option['name']}: {option['annotation']} | None\n"


def replaced(text: str, pattern: str, new: str, before: str) -> str:
    """Replace the text that matches a pattern. If none matches, insert the new text before another text."""
    old = re.search(pattern, text, re.MULTILINE)
    if old is None:
        return text.replace(before, new + before, 1)
    return text.replace(old[0], new, 1)


def write_sources() -> None:
    """Write the docstring and the types. A new option stands at the end of its list."""
    smooth, options = SOURCES / "_smooth.py", SOURCES / "_options.py"
    text, types = smooth.read_text(), options.read_text()
    for option in OPTIONS:
        entry, line = documented(option), annotated(option)
        name = option["name"]
        returns = "\n    Returns\n    -------\n    numpy"
        text = replaced(text, rf"^    {name} : .*\n(?: {{8}}.*\n)+", entry, before=returns)
        end = "\n\nclass RunOptions" if option["is_of_mesh"] else "\n\nclass SmoothOptions"
        types = replaced(types, rf"^    {name}: .*\n", line, before=end)
    smooth.write_text(text)
    options.write_text(types)


if os.environ.get("GPU_SMOOTH_OPTIONS") == "write":
    write_sources()
    pytest.skip("the sources are written, and the installed package has the old ones", allow_module_level=True)


@pytest.mark.parametrize("option", OPTIONS, ids=lambda option: option["name"])
def test_the_docstring_and_the_types_have_each_option_of_the_table(option: dict[str, Any]) -> None:
    source = inspect.getsource(gpu_smooth._smooth.smooth)
    assert documented(option) in source, "write the docstring by GPU_SMOOTH_OPTIONS=write"
    keywords = _options.MeshOptions if option["is_of_mesh"] else _options.RunOptions
    assert annotated(option) in inspect.getsource(keywords)


def test_each_keyword_is_an_option() -> None:
    for keywords, names in [
        (_options.MeshOptions, _native.mesh_options()),
        (_options.RunOptions, _native.run_options()),
    ]:
        assert sorted(keywords.__annotations__) == sorted(names)
