"""The command line: `python -m gpu_smooth`, and the program `gpu-smooth` of the wheel."""

from __future__ import annotations

import sys

from gpu_smooth import _native


def main() -> int:
    """Run the command line of this process, and return its exit code."""
    # A program that embeds Python may have no interpreter to start again.
    program = [sys.executable, "-m", "gpu_smooth"] if sys.executable else []
    return _native.command_line(["gpu-smooth", *sys.argv[1:]], program)


if __name__ == "__main__":
    sys.exit(main())
