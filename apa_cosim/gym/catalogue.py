"""What the arguments of the environments mean."""

from apa_cosim.gym.ids import Scenes
from apa_cosim.gym.options import EnvironmentOptions
from apa_cosim.gym.scene_source import SceneSource
from orchestrator.inputs.text.errors import BadInput

STOP_TIMES: dict[Scenes, float] = {"parallel": 60.0, "perpendicular": 60.0, "world": 120.0, "tpcap": 200.0}
"""When an episode is truncated [s]."""
MAX_STOP_TIME = 3600.0
"""[s]"""


def scene_source(scenes: Scenes, options: EnvironmentOptions) -> SceneSource:
    """Return the scenes of an environment. Raises ``BadInput`` for an argument that means nothing."""
    from apa_cosim.gym.parking_scenes import BODIES, PARALLEL, PERPENDICULAR, slot_scenes, world_scenes

    if scenes not in STOP_TIMES:
        raise BadInput(f"{scenes!r}: expected one of {', '.join(STOP_TIMES)}", key="scenes")
    body, stop = options.body, STOP_TIMES[scenes] if options.stop_time is None else options.stop_time
    if body is not None and body not in BODIES:
        raise BadInput(f"{body!r}: expected one of {', '.join(BODIES)}", key="body")
    if options.files and scenes != "tpcap":
        raise BadInput("is for apa/TPCAP-v0", key="files")
    if not 1.0 <= stop <= MAX_STOP_TIME:
        raise BadInput(f"{stop!r} s: expected 1 to {MAX_STOP_TIME:g} s", key="stop_time")
    if scenes == "world":
        return world_scenes(body, stop, options.pedals)
    if scenes == "tpcap":
        from apa_cosim.gym.file_scenes import FileScenes

        return FileScenes(options.files, body or "double_track", stop, options.pedals)
    kind = PARALLEL if scenes == "parallel" else PERPENDICULAR
    return slot_scenes(kind, body or "double_track", stop, options.pedals)
