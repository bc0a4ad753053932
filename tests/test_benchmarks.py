"""The C of the benchmarks compiles with the models' C as it is now, and does what CPython does."""

import importlib
from typing import Any

import numpy as np
import pytest

from modelkit.variables import flatten


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Import a benchmark; what it compares with need not be installed."""

    def load(name: Any, *needs: Any) -> Any:
        for package in needs:
            pytest.importorskip(package)
        return importlib.import_module(f"benchmarks.{name}")

    return load


@pytest.mark.filterwarnings("ignore")
def test_bodies(bench: Any) -> None:
    module = bench("bench_vehicle", "vehiclemodels")
    library = module.compiled()
    for name, (_, run) in module.bodies(0).items():
        end = run(40)
        pose = end if name == "kinematic" else end.motion.pose
        assert module.compiled_bodies(library, 40)[name][1](40) == pose.x != 0.0
    assert len({run(100) for _, run in module.vehicles(library, 0).values()}) == 3


@pytest.mark.filterwarnings("ignore")
def test_controllers(bench: Any) -> None:
    module = bench("bench_controllers", "cvxpy", "daqp", "osqp", "skfuzzy")
    library, source = module.compiled(), np.random.default_rng(1)
    points = source.uniform(-3.0, 3.0, (50, 2))
    ours = [module.infer(a, b, *module.FUZZY) for a, b in points.tolist()]
    assert library.bench_infer(points.ctypes.data, len(points)) == sum(ours) != 0.0
    now, stages, weights = module.random_problem(source)
    flat = [np.array(flatten(item)) for item in (stages, weights)]
    found = library.bench_solve(1, *now, *(item.ctypes.data for item in flat))
    assert found == module.solve(now, stages, weights, 1e-10, 40).nodes[0].u
