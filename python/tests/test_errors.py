"""Wrong arguments raise exceptions that name the argument, and nothing crashes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from conftest import Points, Triangles, lattice

import gpu_smooth
from gpu_smooth import DeviceError, FileError, GpuSmoothError, MeshError, OptionError

Mesh = tuple[Points, Triangles]
POINTS, TRIANGLES = lattice(3)
INVERTED = POINTS.copy()
INVERTED[5] += [3.0, 0.0]


def with_value(array: Any, index: Any, value: Any) -> Any:
    changed = array.copy()
    changed[index] = value
    return changed


def test_exceptions_are_of_the_kinds_that_python_has_for_them() -> None:
    for kind, base in (
        (MeshError, ValueError), (OptionError, ValueError), (DeviceError, RuntimeError), (FileError, OSError),
    ):
        assert issubclass(kind, base) and issubclass(kind, GpuSmoothError)


@pytest.mark.parametrize(
    ("points", "triangles", "message"),
    [
        (POINTS[:, :1], TRIANGLES, r"points: .* the shape is \(16, 1\)"),
        (np.zeros((16, 4)), TRIANGLES, r"points: .* \(16, 4\)"),
        (POINTS.ravel(), TRIANGLES, r"points: .* \(32,\)"),
        (POINTS[None], TRIANGLES, r"points: .* \(1, 16, 2\)"),
        (np.float64(1), TRIANGLES, "points: "),
        (POINTS.astype(complex), TRIANGLES, r"points: .* \.astype\(float\)"),
        (POINTS.astype(str), TRIANGLES, "points: "),
        (POINTS.astype(object), TRIANGLES, "points: "),
        ([[0, 1], [2]], TRIANGLES, "points: "),
        (None, TRIANGLES, "points: "),
        ({}, TRIANGLES, "points: "),
        (np.ma.masked_array(POINTS, POINTS > 1), TRIANGLES, "points: masked"),
        (POINTS, TRIANGLES[:, :2], r"triangles: .* \(18, 2\)"),
        (POINTS, TRIANGLES.ravel(), r"triangles: .* \(54,\)"),
        (POINTS, TRIANGLES.astype(float), r"triangles: .* \.astype\(int\)"),
        (POINTS, TRIANGLES > 3, "triangles: "),
        (POINTS, "abc", "triangles: .* not text. Pass numbers"),
        (object(), TRIANGLES, "points: .* or a mesh alone"),
        (POINTS, TRIANGLES[:0], "triangles: the mesh has no triangles"),
        (POINTS, [], "triangles: "),
        (POINTS[:0], TRIANGLES[:0], "triangles: the mesh has no triangles"),
        (POINTS[:0], TRIANGLES, r"triangles\[0, 0\] is 0, but points has no rows"),
        (POINTS[:9], TRIANGLES, r"triangles\[\d+, \d\] is 9, but points has 9 rows"),
        (POINTS, with_value(TRIANGLES, (4, 1), -1), r"triangles\[4, 1\] is -1"),
        (POINTS, with_value(TRIANGLES, (4, 1), 2**40), r"triangles\[4, 1\] is 1099511627776"),
        (POINTS, with_value(TRIANGLES.astype("u8"), (4, 1), 2**64 - 1), r"triangles\[4, 1\] is 184467"),
        (POINTS, with_value(TRIANGLES.astype("i1"), (4, 1), -128), r"triangles\[4, 1\] is -128"),
        (POINTS, with_value(TRIANGLES, (4, 1), TRIANGLES[4, 0]), r"triangles\[4\]: .* twice"),
        (POINTS, np.concatenate([TRIANGLES, TRIANGLES[:2]]), "triangles: the edge between vertices"),
        (with_value(POINTS, 6, np.nan), TRIANGLES, r"points\[6\]: "),
        (with_value(POINTS, 6, -np.inf), TRIANGLES, r"points\[6\]: "),
        (POINTS * 1e200, TRIANGLES, "points: .* unit of length"),
        (POINTS * 1e-200, TRIANGLES, "points: .* unit of length"),
        (INVERTED, TRIANGLES, "triangles: .*inverted or flat"),
        (POINTS * [1, 0], TRIANGLES, "triangles: "),
        (POINTS[:3], [[0, 1, 2]], "triangles: |none of the 3 vertices is free"),
        (POINTS[[0, 1, 4]], [[0, 1, 2]], "none of the 3 vertices is free.*slide=True"),
    ],
)
def test_wrong_meshes_are_refused(points: Any, triangles: Any, message: str) -> None:
    for function in (gpu_smooth.smooth, gpu_smooth.run):
        with pytest.raises(MeshError, match=message):
            function(points, triangles)


def test_an_error_of_a_mesh_has_the_indices() -> None:
    with pytest.raises(MeshError) as raised:
        gpu_smooth.smooth(with_value(POINTS, 6, np.nan), TRIANGLES)
    assert raised.value.vertex == 6
    with pytest.raises(MeshError) as raised:
        gpu_smooth.smooth(INVERTED, TRIANGLES)
    flat = gpu_smooth.quality(INVERTED, TRIANGLES, "scaled-jacobian") <= 0
    assert list(raised.value.triangles) == np.flatnonzero(flat).tolist()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scheme": "round"}, "scheme: no metric is called 'round'"),
        ({"scheme": 3}, "scheme: the value is 3"),
        ({"scheme": "imr+" * 60 + "imr"}, "scheme: "),
        ({"engine": "tpu"}, 'engine: the value is .tpu., and must be "auto" or'),
        ({"engine": "cpu", "adapter": "x"}, "adapter does not go with"),
        ({"tolerance": -1}, "tolerance: the value is -1"),
        ({"tolerance": "small"}, "tolerance: the value is 'small'"),
        ({"tolerance": np.nan}, "tolerance: the value is nan"),
        ({"tolerance": True}, "tolerance: the value is True"),
        ({"max_sweeps": -1}, "max_sweeps: the value is -1"),
        ({"max_sweeps": 1.5}, "max_sweeps: the value is 1.5"),
        ({"max_sweeps": 2**40}, "max_sweeps: "),
        ({"fraction": 0}, "fraction: "),
        ({"fraction": 0.5, "tolerance": 1e-3}, "tolerance does not go with"),
        ({"desired": np.inf}, "desired: "),
        ({"time_limit": -1}, "time_limit: "),
        ({"method": "magic"}, "method: "),
        ({"omega": 2}, "omega: "),
        ({"omega": 1.5, "method": "paper"}, 'omega does not go with method="paper"'),
        ({"inner": 0}, "inner: "),
        ({"inner": 2, "method": "relaxed"}, 'inner does not go with method="relaxed"'),
        ({"guard": "dog"}, "guard: "),
        ({"improve_worst": "all"}, "improve_worst: "),
        ({"max_move": 0}, "max_move: "),
        ({"max_move": 1, "untangle": True}, "max_move does not go with untangle"),
        ({"method": "multilevel", "scheme": "area"}, 'method="multilevel" does not go with scheme'),
        ({"keep_altitude": 1}, "keep_altitude: the value is 1, and must be True or False"),
        ({"slide": "yes"}, "slide: "),
        ({"corner_angle": 20}, "corner_angle has no effect without slide"),
        ({"slide": True, "corner_angle": 190}, "corner_angle: "),
        ({"slide": True, "hausdorff": 0}, "hausdorff: "),
        ({"rings": 2}, "rings has no effect without only_bad"),
        ({"only_bad": 0.5}, "only_bad: "),
        ({"target": "round"}, "target: "),
        ({"target_rings": 2}, "target_rings has no effect without target"),
        ({"keep_layers": "rows=0"}, "keep_layers: "),
        ({"target_of": "place"}, "target_of has no effect without another target"),
        ({"target": (1, 2)}, "target: "),
        ({"surface": "torus"}, "surface: "),
        ({"history": "none"}, "history: "),
    ],
)
def test_wrong_options_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        gpu_smooth.smooth(POINTS, TRIANGLES, **options)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"fixed": [16]}, r"fixed\[0\] is 16"),
        ({"fixed": [-1]}, r"fixed\[0\] is -1"),
        ({"fixed": [0.5]}, "fixed: "),
        ({"fixed": [True]}, r"fixed: booleans of shape \(16,\)"),
        ({"fixed": [[1]]}, "fixed: "),
        ({"fixed": 1}, "fixed: "),
        ({"lines": [[0, 99]]}, r"lines\[0, 1\] is 99"),
        ({"lines": [0, 1]}, "lines: "),
        ({"regions": [1, 2]}, r"regions: integers of shape \(18,\)"),
        ({"regions": []}, r"regions: integers of shape \(18,\)"),
        ({"target": []}, r"target: numbers of shape \(16,\)"),
        ({"periodic": [[0, 99]], "slide": True}, r"periodic\[0, 1\] is 99"),
        ({"target": [1.0] * 15}, "target: "),
        ({"target": [0.0] * 16}, "vertex 0 has no target"),
        ({"target": [np.nan] * 16}, "vertex 0 has no target"),
        ({"target": np.ones((16, 2))}, "target: the vertices have 2 numbers"),
        ({"target": np.ones((16, 3))}, "positive definite"),
        ({"target": (POINTS, TRIANGLES, [1.0])}, r"target\[2\]"),
        ({"target": (INVERTED, TRIANGLES, np.ones(16))}, "inverted"),
        ({"surface": "sphere", "fixed": [3]}, None),
    ],
)
def test_arrays_of_options_must_fit_the_mesh(options: dict[str, Any], message: str | None) -> None:
    if message is None:
        gpu_smooth.smooth(POINTS, TRIANGLES, **options)
        return
    with pytest.raises(MeshError, match=message):
        gpu_smooth.smooth(POINTS, TRIANGLES, **options)


def test_unknown_options_are_refused_with_the_most_similar_name() -> None:
    with pytest.raises(TypeError, match="tolerence: smoothing has no option.*Did you mean tolerance"):
        gpu_smooth.smooth(POINTS, TRIANGLES, tolerence=1)  # type: ignore[call-overload]
    # No option is called so, and none differs by a slip.
    for name in "iterations", "device", "sizes", "angle":
        with pytest.raises(TypeError, match=f"{name}: smoothing has no option of this name. There are quadrilaterals, ") as raised:
            gpu_smooth.smooth(POINTS, TRIANGLES, **{name: 1})  # type: ignore[call-overload]
        assert "Did you mean" not in str(raised.value)
    with pytest.raises(TypeError, match="MeshFile reads a file"):
        gpu_smooth.smooth("part.msh")
    with pytest.raises(TypeError, match="points and triangles are needed"):
        gpu_smooth.smooth(3)


def test_the_measure_of_a_mesh_is_not_taken_for_triangles() -> None:
    with pytest.raises(MeshError, match="quality\\(mesh, measure='min-angle'\\)"):
        gpu_smooth.quality(object(), "min-angle")


def test_an_adapter_that_does_not_exist_is_a_device_error() -> None:
    with pytest.raises(DeviceError, match="adapter: no GPU adapter has 'none such' .*Pass a part of one of these names"):
        gpu_smooth.smooth(POINTS, TRIANGLES, adapter="none such")


def test_options_of_none_are_defaults() -> None:
    from gpu_smooth import _native

    options: dict[str, Any] = dict.fromkeys([*_native.mesh_options(), *_native.run_options()])
    smoothed = gpu_smooth.smooth(POINTS, TRIANGLES, **options)
    assert np.array_equal(smoothed, gpu_smooth.smooth(POINTS, TRIANGLES))


@pytest.mark.filterwarnings("ignore::gpu_smooth.MeshWarning")
def test_random_arguments_raise_exceptions_of_python() -> None:
    """Arrays of random types, shapes and values never end the process, nor raise anything else than these exceptions."""
    random = np.random.default_rng(7)
    dtypes = ["f8", "f4", "f2", ">f8", "i8", "i4", "u2", "u8", "?", "c16", "O", "U3", "M8[s]", "S2"]
    accepted = 0
    for _ in range(3000):
        shape = tuple(random.integers(0, 5, random.integers(0, 4)))
        points = random.uniform(-5, 5, shape).astype(random.choice(dtypes[:4]))
        if random.random() < 0.5:
            points = random.uniform(-2, 2, (random.integers(0, 9), random.integers(2, 4)))
        if random.random() < 0.3:
            points = points.astype("i8").astype(random.choice(dtypes))
        triangles = random.integers(-1, 8, (random.integers(0, 6), 3)).astype("i8")
        if random.random() < 0.8 and len(points.shape) and len(points) >= 3:
            rows = [random.permutation(len(points))[:3] for _ in range(random.integers(1, 5))]
            triangles = np.array(rows)
        if random.random() < 0.2:
            triangles = triangles.astype(random.choice(dtypes))
        if random.random() < 0.3 and points.dtype.kind == "f" and points.size:
            with np.errstate(all="ignore"):
                value = np.array([np.nan, np.inf, 1e300, 1e-320, 0.0]).astype(points.dtype)
            points.flat[random.integers(points.size)] = random.choice(value)
        slide, untangle = random.random() < 0.5, random.random() < 0.3
        try:
            gpu_smooth.smooth(
                points, triangles, slide=bool(slide), untangle=bool(untangle), max_sweeps=5, z="data" if slide else None
            )
            accepted += 1
        except MeshError:
            pass
    assert accepted > 20


def test_random_options_raise_exceptions_of_python() -> None:
    """Options of random values never end the process, nor raise anything else than these exceptions."""
    from gpu_smooth import _native

    random = np.random.default_rng(11)
    values: list[Any] = [
        None, True, False, 0, 1, -1, 3, 2**70, 0.5, -2.5, 1e-300, 1e300, np.nan, np.inf, "", "auto", "cpu", "imr", "edge+rms",
        "keep-size", "place", "\0", "é" * 300, b"x", [], [0], [[0, 1]], [0, 99], [[0, 5], [5, 0]], (), (1, 2, 3), {}, set(),
        np.zeros(16), np.ones(16), np.ones((16, 3)), np.eye(3), np.full(16, np.nan), np.ones(16, bool), np.zeros(0),
        np.arange(16), np.arange(18), np.zeros((2, 2, 2)), np.array("x"), np.float32(2), np.int8(-3), object(), int, len,
        (POINTS, TRIANGLES, np.ones(16)), (POINTS, TRIANGLES, np.ones((16, 3))), (POINTS, None, 1), (INVERTED, TRIANGLES, 1),
    ]
    # Files would be written by these, and a GPU would be searched for in each call by these.
    left_out = {"checkpoint", "resume", "adapter", "engine"}
    names = sorted({*_native.mesh_options(), *_native.run_options()} - left_out)
    accepted = 0
    for _ in range(4000):
        chosen = random.choice(names, size=random.integers(1, 4), replace=False)
        options = {name: values[random.integers(len(values))] for name in chosen.tolist()}
        options.setdefault("max_sweeps", 3)
        try:
            smoothed = gpu_smooth.smooth(POINTS, TRIANGLES, engine="cpu", **options)
            assert np.isfinite(smoothed).all()
            accepted += 1
        except GpuSmoothError as error:
            assert str(error)
        except TypeError as error:
            # A class or a function of Python as `on_sweep` may refuse its argument.
            assert "on_sweep" in options, error
    assert accepted > 50


def test_random_arguments_of_functions_raise_exceptions_of_python() -> None:
    """Functions on arrays never end the process, nor raise anything else than these exceptions."""
    random = np.random.default_rng(5)
    fine: list[Any] = [POINTS, POINTS.astype("f4"), np.column_stack([POINTS, POINTS[:, 0]]), TRIANGLES, np.arange(16.0)]
    wrong: list[Any] = [
        None, 3, "x", [], [[]], [[1, 2], [3]], np.zeros((0, 3)), np.zeros((3, 0)), np.zeros((16, 2)), np.full((16, 2), np.nan),
        np.full((16, 2), 1e308), TRIANGLES * -1, TRIANGLES + 14, TRIANGLES.astype("u1"), TRIANGLES[::-2], POINTS[::2],
        POINTS.T, POINTS[:, ::-1], np.ma.masked_array(POINTS, POINTS > 1), np.asfortranarray(TRIANGLES), np.zeros((2, 2, 2)), INVERTED, 1j,
    ]
    functions: list[Any] = [gpu_smooth.quality, gpu_smooth.untangle, gpu_smooth.interpolate, gpu_smooth.compare]
    counts = [2, 2, 4, 3]
    accepted = 0
    for _ in range(4000):
        which = random.integers(len(functions))
        of_function = {2: [POINTS, TRIANGLES], 3: [POINTS, POINTS, TRIANGLES], 4: [POINTS, TRIANGLES, POINTS, np.arange(16.0)]}
        arguments: list[Any] = list(of_function[counts[which]])
        for _ in range(random.integers(0, 3)):
            pool = wrong if random.random() < 0.7 else fine
            arguments[random.integers(len(arguments))] = pool[random.integers(len(pool))]
        try:
            functions[which](*arguments)
            accepted += 1
        except MeshError as error:
            assert str(error)
        except TypeError as error:
            # A call without triangles takes a mesh.
            assert functions[which] is gpu_smooth.quality and arguments[1] is None and "or a mesh of meshio" in str(error)
    assert accepted > 100


def test_empty_lists_list_nothing() -> None:
    smoothed = gpu_smooth.smooth(POINTS, TRIANGLES)
    nothing: list[Any] = [[], (), np.array([]), np.empty((0,), int)]
    for empty in nothing:
        assert np.array_equal(gpu_smooth.smooth(POINTS, TRIANGLES, fixed=empty, lines=empty), smoothed)
        slid = gpu_smooth.smooth(POINTS, TRIANGLES, slide=True, periodic=empty)
        assert np.array_equal(slid, gpu_smooth.smooth(POINTS, TRIANGLES, slide=True))
        assert np.array_equal(gpu_smooth.untangle(POINTS, TRIANGLES, fixed=empty), POINTS)
    assert np.array_equal(gpu_smooth.smooth(POINTS, TRIANGLES, lines=np.empty((0, 2))), smoothed)
    with pytest.raises(MeshError, match="fixed: booleans"):
        gpu_smooth.smooth(POINTS, TRIANGLES, fixed=np.empty(0, bool))


def test_messages_name_the_argument_of_functions() -> None:
    wrong: Any = np.full_like(POINTS, np.nan)
    calls: list[tuple[str, Any]] = [
        (r"moved\[0\]: vertex 0", lambda: gpu_smooth.interpolate(POINTS, TRIANGLES, wrong, POINTS)),
        (r"points\[0\]: vertex 0", lambda: gpu_smooth.interpolate(wrong, TRIANGLES, POINTS, POINTS)),
        (r"before\[0\]: vertex 0", lambda: gpu_smooth.compare(wrong, POINTS, TRIANGLES)),
        (r"after\[0\]: vertex 0", lambda: gpu_smooth.compare(POINTS, wrong, TRIANGLES)),
        ("target: vertex 0", lambda: gpu_smooth.smooth(POINTS, TRIANGLES, target=0 * POINTS[:, 0])),
        ("points has no rows", lambda: gpu_smooth.smooth(np.empty((0, 2)), TRIANGLES)),
        ("not an object of type NoneType. Pass an array", lambda: gpu_smooth.smooth(None, TRIANGLES)),  # type: ignore[call-overload]
        ("not an object of type set. Pass an array", lambda: gpu_smooth.smooth(POINTS, TRIANGLES, fixed={1, 2})),  # type: ignore[call-overload]
        ("measure: the value is 3", lambda: gpu_smooth.quality(POINTS, TRIANGLES, 3)),  # type: ignore[arg-type]
        ("keep_going: ", lambda: gpu_smooth.untangle(POINTS, TRIANGLES, keep_going="x")),  # type: ignore[arg-type]
        ("metric: ", lambda: gpu_smooth.run(POINTS, TRIANGLES).quality_after.f(3)),  # type: ignore[arg-type]
        ("weld: ", lambda: gpu_smooth.MeshFile("a.vtk", weld="x")),  # type: ignore[arg-type]
        ("regions: ", lambda: gpu_smooth.MeshFile("a.vtk", regions=3)),  # type: ignore[arg-type]
    ]
    for text, call in calls:
        with pytest.raises(GpuSmoothError, match=text):
            call()
    with pytest.raises(TypeError, match="Did you mean target?"):
        gpu_smooth.run(POINTS, TRIANGLES, targt="keep-size")  # type: ignore[call-arg]
