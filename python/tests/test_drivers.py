"""Drivers of GPUs that fail, and devices that are kept for later calls."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux") or shutil.which("cc") is None, reason="compiles a driver of Vulkan for Linux"
)
TESTS = Path(__file__).parent
SOURCE = TESTS.parents[1] / "cli" / "tests" / "cli" / "faulty_driver.c"
NEVER = "1000000000"

# A mesh for which one core considers a GPU: a run by edge takes many sweeps. No sweep is needed to reach the goal.
HEAD = f"""
import os, sys
sys.path.insert(0, {str(TESTS)!r})
from conftest import lattice
import gpu_smooth
points, triangles = lattice(200)
def run(**options):
    return gpu_smooth.run(points, triangles, **options)
def chosen():
    return run(scheme="edge", desired=1e6).engine
"""


def real_driver() -> str:
    """Return the library of Mesa's software driver, as this machine has registered it."""
    for folder in ("/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"):
        for file in sorted(Path(folder).glob("lvp*.json")):
            return str(json.loads(file.read_text())["ICD"]["library_path"])
    pytest.skip("needs Mesa's lavapipe")


@pytest.fixture(scope="module")
def faulty(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Compile the faulty driver, and return the file that registers it."""
    folder = tmp_path_factory.mktemp("driver")
    library, icd = folder / "libfaulty.so", folder / "icd.json"
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, SOURCE, "-ldl"], check=True)
    icd.write_text(json.dumps(
        {"file_format_version": "1.0.0", "ICD": {"library_path": str(library), "api_version": "1.1.0"}}
    ))
    return icd


def python(code: str, icd: Path, **fault: str) -> subprocess.CompletedProcess[str]:
    """Run code in a process that finds only the driver that `icd` registers."""
    variables = {"VK_DRIVER_FILES": str(icd), "VK_ICD_FILENAMES": str(icd), "RAYON_NUM_THREADS": "1"}
    environment = {**os.environ, **variables, "REAL_DRIVER": real_driver(), "FAULT_FROM": "1", **fault}
    environment.pop("VK_ADD_DRIVER_FILES", None)
    return subprocess.run(
        [sys.executable, "-c", HEAD + code], capture_output=True, text=True, timeout=240, check=False, env=environment
    )


def output(code: str, icd: Path, **fault: str) -> list[str]:
    """Return the lines that the code prints. The process must not fail."""
    done = python(code, icd, **fault)
    assert done.returncode == 0, done.stderr
    return done.stdout.split("\n")[:-1]


@pytest.mark.parametrize("function", ["vkCreateInstance", "vkCreateDevice", "vkQueueSubmit"])
def test_a_driver_that_crashes_does_not_end_a_process_that_lets_the_engine_be_chosen(
    faulty: Path, function: str
) -> None:
    code = "from gpu_smooth import _drivers; print(chosen(), _drivers.trial())"
    assert output(code, faulty, FAULT_FUNCTION=function, FAULT_RESULT="crash") == ["cpu ended by signal 6"]


def test_a_driver_that_hangs_is_given_up(faulty: Path) -> None:
    code = "from gpu_smooth import _drivers; _drivers.PATIENCE = 2; print(chosen(), _drivers.trial())"
    found = output(code, faulty, FAULT_FUNCTION="vkCreateDevice", FAULT_RESULT="hang")
    assert found == ["cpu no answer within 2 s"]


@pytest.mark.parametrize("library", ["/nonexistent/driver.so", "damaged.so"])
def test_a_driver_that_cannot_be_loaded_is_no_driver(tmp_path: Path, library: str) -> None:
    (tmp_path / "damaged.so").write_bytes(b"no library")
    icd = tmp_path / "icd.json"
    icd.write_text(json.dumps(
        {"file_format_version": "1.0.0", "ICD": {"library_path": str(tmp_path / library), "api_version": "1.1.0"}}
    ))
    code = """
print(chosen(), [a.backend for a in gpu_smooth.adapters() if a.backend == "vulkan"])
"""
    assert output(code, icd) == ["cpu []"]


def test_a_chosen_device_is_opened_once_for_all_calls_and_threads(faulty: Path, tmp_path: Path) -> None:
    count = tmp_path / "count"
    count.touch()
    code = """
from concurrent.futures import ThreadPoolExecutor
with ThreadPoolExecutor(3) as threads:
    print({word.split(" ")[0] for word in threads.map(lambda _: chosen(), range(6))})
"""
    found = output(
        code, faulty, FAULT_KIND="2", FAULT_FUNCTION="vkCreateDevice", FAULT_FROM=NEVER, FAULT_COUNT=str(count)
    )
    assert found == ["{'llvmpipe'}"] and count.read_bytes() == b"x"


@pytest.mark.parametrize("options", ["", 'engine="gpu"'])
def test_a_device_that_was_lost_is_replaced(faulty: Path, tmp_path: Path, options: str) -> None:
    count = tmp_path / "count"
    count.touch()
    code = f"""
options = dict({options}) or dict(scheme="edge", desired=2.5)
print(run(**options).engine.split(" ")[0])
os.environ["FAULT_FROM"] = "1"
try:
    failed = run(**options)
    print(failed.engine.split(" ")[0], "fault", "lost" in failed.fault, failed.sweeps > 0)
except gpu_smooth.DeviceError as error:
    print("error", "lost" in str(error))
os.environ["FAULT_FROM"] = "{NEVER}"
print(run(**options).engine.split(" ")[0])
"""
    found = output(
        code, faulty, FAULT_KIND="2", FAULT_FUNCTION="vkQueueSubmit", FAULT_FROM=NEVER, FAULT_RESULT="-4"
    )
    failed = "error True" if options else "llvmpipe fault True True"
    assert found == ["llvmpipe", failed, "llvmpipe"]
