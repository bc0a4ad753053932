"""The registered environments."""

from typing import Literal

Scenes = Literal["parallel", "perpendicular", "world", "tpcap", "parkbench"]
Body = Literal["kinematic", "double_track"]
IDS: dict[str, Scenes] = {
    "apa/Parallel-v0": "parallel",
    "apa/Perpendicular-v0": "perpendicular",
    "apa/World-v0": "world",
    "apa/TPCAP-v0": "tpcap",
    "apa/ParkBench-v0": "parkbench",
}
