"""Trial of the drivers of GPUs in another process, as a driver that crashes would end this process."""

from __future__ import annotations

import functools

# Seconds for all drivers to start. Slow drivers have needed five seconds to compile their first kernel.
PATIENCE = 60


@functools.cache
def trial() -> str | None:
    """Try all drivers once, and return the reason why they cannot be used, or None."""
    import os
    import subprocess
    import sys

    # A program that embeds Python may not be able to run a module.
    if not sys.executable:
        return None
    command = [sys.executable, "-m", "gpu_smooth", "adapters"]
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=PATIENCE,
            # Ctrl-C in a terminal would end the trial like a crash.
            start_new_session=True,
            # The command line would start a third process for its own trial.
            env=dict(os.environ, GPU_SMOOTH_IS_TRIAL="1"),
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no answer within {PATIENCE} s"
    except OSError:
        return None
    # Exit codes of the command line are 0 to 5. A negative code is the signal by which the process has ended.
    if 0 <= done.returncode <= 5:
        return None
    code = done.returncode
    return f"ended by signal {-code}" if code < 0 else f"ended with code {code}"
