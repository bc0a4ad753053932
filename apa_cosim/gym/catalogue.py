"""The environments: their scenes, and what their arguments mean."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple, get_args

from apa_cosim.gym.file_scenes import FileScenes
from apa_cosim.gym.ids import IDS, Body, Scenes
from apa_cosim.gym.options import EnvironmentOptions
from apa_cosim.gym.parking_scenes import PARALLEL, PERPENDICULAR, slot_scenes, world_scenes
from apa_cosim.gym.scene_source import SceneSource
from orchestrator.inputs.text.errors import BadInput

DEFAULT_BODY: Body = "double_track"
MAX_STOP_TIME = 3600.0
"""[s]"""


class Environment(NamedTuple):
    """What one environment is."""

    stop_time: float
    """When an episode is truncated [s]."""
    source: Callable[[EnvironmentOptions, float], SceneSource]
    """(arguments, stop time) -> its scenes."""
    takes_files: bool = False
    """Whether its scenes are those of files."""


def _slot(kind: int, given: EnvironmentOptions, stop_time: float) -> SceneSource:
    return slot_scenes(kind, given.body or DEFAULT_BODY, stop_time, given.pedals)


def _world(given: EnvironmentOptions, stop_time: float) -> SceneSource:
    return world_scenes(given.body, stop_time, given.pedals)


def _files(given: EnvironmentOptions, stop_time: float) -> SceneSource:
    return FileScenes(given.files, given.body or DEFAULT_BODY, stop_time, given.pedals)


ENVIRONMENTS: dict[Scenes, Environment] = {
    "parallel": Environment(60.0, partial(_slot, PARALLEL)),
    "perpendicular": Environment(60.0, partial(_slot, PERPENDICULAR)),
    "world": Environment(120.0, _world),
    "tpcap": Environment(200.0, _files, takes_files=True),
    "parkbench": Environment(200.0, _files, takes_files=True),
}
FILE_IDS = tuple(name for name, scenes in IDS.items() if ENVIRONMENTS[scenes].takes_files)
"""Registered environments whose scenes are those of files."""


def scene_source(scenes: Scenes, options: EnvironmentOptions) -> SceneSource:
    """Return the scenes of an environment. Raises ``BadInput`` for an argument that means nothing."""
    if scenes not in ENVIRONMENTS:
        raise BadInput(f"{scenes!r}: expected one of {', '.join(ENVIRONMENTS)}", key="scenes")
    environment = ENVIRONMENTS[scenes]
    stop = environment.stop_time if options.stop_time is None else options.stop_time
    if options.body not in (None, *get_args(Body)):
        raise BadInput(f"{options.body!r}: expected one of {', '.join(get_args(Body))}", key="body")
    if options.files and not environment.takes_files:
        raise BadInput(f"is for {', '.join(FILE_IDS)}", key="files")
    if not 1.0 <= stop <= MAX_STOP_TIME:
        raise BadInput(f"{stop!r} s: expected 1 to {MAX_STOP_TIME:g} s", key="stop_time")
    return environment.source(options, stop)
