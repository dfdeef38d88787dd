"""Modules of the package do not import each other in a circle."""

from __future__ import annotations

import ast
import graphlib
from pathlib import Path

import gpu_smooth

PACKAGE = Path(gpu_smooth.__file__).parent


def imported(text: str, names: set[str]) -> set[str]:
    """Return the modules of the package that a module imports, also in functions and for type checkers alone."""
    found = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            paths = [alias.name.split(".") for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            paths = [[*node.module.split("."), alias.name] for alias in node.names]
        else:
            continue
        own = [path for path in paths if path[0] == "gpu_smooth"]
        found |= {path[1] if len(path) > 1 and path[1] in names else "__init__" for path in own}
    return found


def test_modules_do_not_import_each_other_in_a_circle() -> None:
    files = [*PACKAGE.glob("*.py"), *PACKAGE.glob("*.pyi")]
    names = {file.stem for file in files}
    imports = {file.stem: imported(file.read_text(encoding="utf-8"), names) for file in files}
    assert {"_picture", "_native"} <= imports["_result"] and "_result" in imports["_smooth"]
    # Raises a CycleError, which lists the modules of a circle.
    graphlib.TopologicalSorter(imports).prepare()


def test_every_kind_of_import_is_found() -> None:
    text = "import gpu_smooth._a\nfrom gpu_smooth import _b, run\ndef f():\n    from gpu_smooth._c import x\nimport numpy"
    assert imported(text, {"_a", "_b", "_c"}) == {"_a", "_b", "_c", "__init__"}
