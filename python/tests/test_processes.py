"""Threads, processes, signals and memory."""

from __future__ import annotations

import copy
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import sysconfig
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from conftest import lattice

import gpu_smooth


def smoothed(seed: int, engine: Any = "cpu") -> bytes:
    points, triangles = lattice(20, seed)
    return gpu_smooth.smooth(points, triangles, engine=engine).tobytes()


def attempted(engine: Any) -> str:
    try:
        smoothed(1, engine)
    except gpu_smooth.DeviceError as error:
        return str(error)
    return "done"


@pytest.mark.parametrize("engine", ["cpu", "gpu"])
def test_threads_smooth_at_once(engine: Any) -> None:
    expected = [smoothed(seed, engine) for seed in range(6)]
    smoother = gpu_smooth.Smoother(*lattice(20, 3))
    with ThreadPoolExecutor(6) as threads:
        for _ in range(3):
            assert list(threads.map(smoothed, range(6), [engine] * 6)) == expected
        runs = threads.map(lambda _: smoother.run(engine=engine).points.tobytes(), range(6))
        assert set(runs) == {expected[3]}


def test_other_threads_go_on_during_a_run() -> None:
    points, triangles = lattice(150)
    turns = [0]
    is_done = threading.Event()

    def count() -> None:
        while not is_done.is_set():
            turns[0] += 1
            time.sleep(0.001)

    # A thread that waits for Python's lock gets a turn or two in each call of `on_sweep`. More turns between two calls
    # are turns during the sweeps.
    seen = [turns[0]]

    def on_sweep(_: gpu_smooth.Progress) -> bool:
        seen.append(turns[0])
        return seen[-1] - seen[-2] >= 10

    thread = threading.Thread(target=count, daemon=True)
    thread.start()
    gpu_smooth.smooth(
        points, triangles, tolerance=0, time_limit=60, engine="cpu", method="relaxed", max_sweeps=10**9, on_sweep=on_sweep
    )
    is_done.set()
    thread.join()
    assert seen[-1] - seen[-2] >= 10


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes_smooth_at_once(method: str) -> None:
    expected = [smoothed(seed) for seed in range(4)]
    context = multiprocessing.get_context(method)
    with ProcessPoolExecutor(2, mp_context=context) as processes:
        assert list(processes.map(smoothed, range(4), timeout=120)) == expected


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
def test_a_gpu_is_refused_in_a_process_that_was_forked_after_its_use() -> None:
    smoothed(1, "gpu")
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("fork")) as processes:
        assert "drivers do not survive a fork" in processes.submit(attempted, "gpu").result(60)
        assert processes.submit(attempted, "auto").result(60) == "done"
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as processes:
        assert processes.submit(attempted, "gpu").result(120) == "done"


ENDLESS = """
import os, sys, threading, time, signal
sys.path.insert(0, {tests!r})
from conftest import lattice
import gpu_smooth
# A shell that starts the tests in the background lets its processes ignore the signal.
signal.signal(signal.SIGINT, signal.default_int_handler)
points, triangles = lattice(100)
gpu_smooth.smooth(points, triangles, max_sweeps=2)
if {forks}:
    child = os.fork()
    if child:
        code = os.waitpid(child, 0)[1]
        os._exit(os.waitstatus_to_exitcode(code))
threading.Thread(target=lambda: (time.sleep(0.5), os.kill(os.getpid(), signal.SIGINT)), daemon=True).start()
try:
    gpu_smooth.smooth(points, triangles, tolerance=0, max_sweeps=10**9, method="relaxed", engine={engine!r}, time_limit=60)
except KeyboardInterrupt:
    print("interrupted", flush=True)
    os._exit(7)
os._exit(1)
"""


@pytest.mark.parametrize(("engine", "forks"), [("cpu", False), ("gpu", False), ("cpu", True)])
def test_ctrl_c_ends_a_run(engine: str, forks: bool) -> None:
    code = ENDLESS.format(tests=os.path.dirname(__file__), engine=engine, forks=forks)
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, timeout=50, check=False
    )
    assert done.returncode == 7, done.stderr
    assert "interrupted" in done.stdout


def test_signals_have_their_usual_handlers_after_a_run() -> None:
    before = signal.getsignal(signal.SIGINT)
    smoothed(1)
    assert signal.getsignal(signal.SIGINT) is before


def resident() -> int:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_memory_is_flat_over_many_calls() -> None:
    points, triangles = lattice(6)
    bad = triangles.copy()
    bad[3] = 99

    def calls(count: int) -> None:
        for _ in range(count):
            gpu_smooth.smooth(points, triangles, engine="cpu", max_sweeps=2)
            gpu_smooth.quality(points, triangles)
            with pytest.raises(gpu_smooth.MeshError):
                gpu_smooth.smooth(points, bad)

    calls(1000)
    before = resident()
    calls(10_000)
    result = gpu_smooth.run(points, triangles)
    for _ in range(100):
        result = gpu_smooth.run(points, triangles)
    assert result.stop == "converged"
    # A leak of one array of this mesh per call would be 15 MB.
    assert resident() - before < 2_000_000


def test_an_interpreter_without_a_global_lock_stays_so() -> None:
    is_free = bool(sysconfig.get_config_var("Py_GIL_DISABLED"))
    code = "import sys, gpu_smooth; print(getattr(sys, '_is_gil_enabled', lambda: True)())"
    # Python issues a warning if a module needs the lock.
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=False)
    assert done.stdout.strip() == str(not is_free), done.stderr


def test_threads_use_the_same_objects_at_once() -> None:
    points, triangles = lattice(12)
    smoother = gpu_smooth.Smoother(points, triangles)
    result = smoother.run(engine="cpu")
    bad = triangles.copy()
    bad[7] = 999
    start = threading.Barrier(8)

    def use(_: int) -> bytes:
        start.wait()
        for _ in range(20):
            assert smoother.free.sum() == 121 and len(smoother.triangles) == len(triangles)
            assert result.quality_after.inverted == 0 and len(result.history) == result.sweeps + 1
            assert np.array_equal(result.points_before, points)
            with pytest.raises(gpu_smooth.MeshError, match="999"):
                gpu_smooth.quality(points, bad)
            seen: list[gpu_smooth.Progress] = []
            again = smoother.run(engine="cpu", on_sweep=seen.append)
        assert seen
        return again.points.tobytes()

    with ThreadPoolExecutor(8) as threads:
        assert set(threads.map(use, range(8))) == {result.points.tobytes()}


def test_arrays_that_other_threads_change_do_no_harm() -> None:
    points, triangles = lattice(40)
    is_done = threading.Event()

    def change() -> None:
        random = np.random.default_rng(3)
        own, wrong = triangles.copy(), triangles.copy()
        wrong[random.integers(len(wrong), size=50)] = 10**6
        while not is_done.is_set():
            triangles[:] = wrong
            triangles[:] = own

    thread = threading.Thread(target=change, daemon=True)
    thread.start()
    ended = set()
    for _ in range(200):
        try:
            smoothed = gpu_smooth.smooth(points, triangles, engine="cpu", max_sweeps=2)
            ended.add(bool(np.isfinite(smoothed).all()))
        except gpu_smooth.MeshError:
            ended.add(True)
    is_done.set()
    thread.join()
    assert ended == {True}


def test_results_go_to_other_processes() -> None:
    points, triangles = lattice(12)
    result = gpu_smooth.run(points, triangles, scheme="rms", history="all")
    result.points[0] += 1.0
    for other in (pickle.loads(pickle.dumps(result)), copy.deepcopy(result), copy.copy(result)):
        assert repr(other) == repr(result) and other._repr_html_() == result._repr_html_()
        assert np.array_equal(other.points, result.points) and np.array_equal(other.history, result.history)
        assert np.array_equal(other.points_before, points) and np.array_equal(other.displacement, result.displacement)
        assert set(other.histories) == set(result.histories) and other.axes == ("x", "y")
        for metric in gpu_smooth.metrics():
            assert other.quality_after.f(metric.name) == result.quality_after.f(metric.name)
        assert other.quality_after.worst_element == result.quality_after.worst_element
    # Values have the names of their metrics, as another version may have other metrics in another order.
    reduced: Any = result.quality_after.__reduce__()
    restore, (state,) = reduced
    assert dict(state["f"])["rms"] == result.quality_after.f("rms")
    one_less = restore({**state, "f": [pair for pair in reversed(state["f"]) if pair[0] != "imr"]})
    assert one_less.f("rms") == result.quality_after.f("rms") and np.isnan(one_less.f("imr"))
    compared = gpu_smooth.compare(points, result.points, triangles)
    assert repr(pickle.loads(pickle.dumps(compared))) == repr(compared)
    smoother = gpu_smooth.Smoother(points, triangles)
    assert copy.deepcopy(smoother).run().stop == "converged" and repr(smoother).startswith("Smoother(169 vertices")
    with pytest.raises(TypeError, match="a Smoother cannot be pickled: make one in each process"):
        pickle.dumps(smoother)


TRIAL = """
import subprocess, sys
sys.path.insert(0, sys.argv[1])
from conftest import lattice
import gpu_smooth
from gpu_smooth import _drivers

calls = []
def interrupted(*words, **options):
    calls.append(words)
    raise KeyboardInterrupt
points, triangles = lattice(200)
usual, subprocess.run = subprocess.run, interrupted
for _ in range(2):
    try:
        gpu_smooth.run(points, triangles, scheme="edge", desired=1e6)
    except KeyboardInterrupt:
        print("interrupted")
subprocess.run = lambda *words, **options: calls.append(words) or usual(*words, **options)
print(gpu_smooth.run(points, triangles, scheme="edge", desired=1e6).stop, len(calls))
"""


def test_an_interrupt_during_the_trial_of_drivers_ends_the_run_and_is_not_kept() -> None:
    environment = {**os.environ, "RAYON_NUM_THREADS": "1"}
    command = [sys.executable, "-c", TRIAL, os.path.dirname(__file__)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, env=environment)
    assert done.stdout.split("\n")[:-1] == ["interrupted", "interrupted", "reached 3"], done.stderr
