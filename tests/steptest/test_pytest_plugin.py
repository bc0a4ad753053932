"""The pytest plugin, used by a third-party test file."""

from importlib.metadata import entry_points
from typing import Any

import pytest

from orchestrator.simulation.cosim.kinds import default_kind

pytest_plugins = ["pytester"]
INSTALLED = "apa_cosim" in entry_points(group="pytest11").names
"""Whether pytest finds the plugin by itself; it does where the package is installed."""
PLUGIN = (
    *(() if INSTALLED else ("-p", "apa_cosim.pytest_plugin")),
    "-p",
    "no:cacheprovider",
    "--apa-fmus",
    default_kind(),
)


@pytest.fixture
def run(pytester: pytest.Pytester) -> Any:
    return lambda *words: pytester.runpytest_inprocess(*PLUGIN, *words)


def test_fixtures_drive_the_system_and_each_part_alone(pytester: pytest.Pytester, run: Any) -> None:
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.parametrize("body", ["kinematic", "single_track"])
        def test_parks(closed_loop, body):
            run = closed_loop("guo2015-case4", {"vehicle.body": body})
            run.assert_outcome("parked").assert_requirements("gbt41630")

        def test_steering(vehicle):
            wanted = {"step": {"at": 1.0, "to": 3.14}}
            run = vehicle({"steering_active": True, "steering_wheel_request": wanted}, stop_time=2.0)
            rises = {"rise_time": {"max": 0.3}, "to": 3.14, "at": 1.0}
            run.assert_requirements({"id": "rises", "signal": "steering_wheel_angle", "response": rises})
            assert run["steering_wheel_angle"][-1] == pytest.approx(3.14)

        def test_takeover(controller):
            run = controller({"driver_takeover": {"step": {"at": 0.2, "to": True}}}, stop_time=1.0)
            run.assert_requirements({"id": "ends", "signal": "phase", "eventually": {"equals": "TAKEOVER"}})
        """
    )
    run().assert_outcomes(passed=4)


def test_a_miss_says_signal_time_value_and_limit(pytester: pytest.Pytester, run: Any) -> None:
    pytester.makepyfile(
        """
        def test_too_slow(closed_loop):
            closed_loop("guo2015-case4").assert_requirements("own.yaml")

        def test_outcome(closed_loop):
            closed_loop("guo2015-case2").assert_outcome("parked")
        """
    )
    pytester.makefile(".yaml", own="- {id: slow, signal: vehicle.speed, max_abs: 1 m/s, source: me}")
    found = run()
    found.assert_outcomes(failed=2)
    found.stdout.fnmatch_lines(
        ["*slow: vehicle.speed: -1.5* at * s, required *1.000 m/s, margin*", "*guo2015-case2: *expected parked*"]
    )


def test_step_tests_are_collected(pytester: pytest.Pytester, run: Any) -> None:
    text = (
        "model: vehicle\nstop_time: 2 s\n"
        "inputs: {steering_active: true, steering_wheel_request: {step: {at: 1 s, to: 1}}}\n"
        "expect:\n  - {id: good, signal: steering_wheel_angle, eventually: {min: 0.99}}\n"
        "  - {id: bad, signal: steering_wheel_angle, always: {max: 0.5}}\n"
    )
    pytester.makefile(".yaml", test_steering=text, test_other="a: 1\n", helper=text)
    found = run("-v")
    found.assert_outcomes(passed=1, failed=1)
    found.stdout.fnmatch_lines(["*good PASSED*", "*bad: vehicle.steering_wheel_angle:*required*"])


def test_an_fmu_of_somebody_elses_takes_the_place_of_ours(pytester: pytest.Pytester, run: Any) -> None:
    pytester.makepyfile("def test_it(closed_loop):\n    closed_loop('guo2015-case4')\n")
    found = run("--apa-controller", "no.fmu")
    found.assert_outcomes(failed=1)
    found.stdout.fnmatch_lines(["*no.fmu*"])


def test_yaml_files_of_other_projects_are_not_collected(pytester: pytest.Pytester, run: Any) -> None:
    """A machine-learning configuration, and a text with another meaning of ``model`` and ``inputs``."""
    pytester.makepyfile(test_theirs="def test_passes(): pass")
    pytester.makefile(
        ".yaml", test_model="model: resnet50\nepochs: 3", test_prompt="model: gpt\ninputs: [a]\nexpect: b"
    )
    run().assert_outcomes(passed=1)


def test_a_step_test_with_a_mistake_is_collected_and_reported(pytester: pytest.Pytester, run: Any) -> None:
    pytester.makefile(".yaml", test_mistake="model: vehicle\nexpect: []")
    found = run()
    found.assert_outcomes(errors=1)
    found.stdout.fnmatch_lines(["*stop_time*"])
