"""A vehicle parameter file of CommonRoad vehicle models as a car: ``parameters_vehicle1.yaml``.

Althoff and Wuersching, CommonRoad: Vehicle Models, 3.0.2. Its overhangs are not in it: each is half of the length less
the wheelbase. Steering ratio and sensors are chosen. Roll stiffness: springs and torsion in series with the tyres.
Longitudinal limits, damping, pitch and the compliance of the pin joints have no counterpart here.
"""

from collections.abc import Mapping
from typing import Any

from modelkit.car import mounts_on
from orchestrator.inputs.text.errors import BadInput
from orchestrator.inputs.text.quantities import number

STEERING_RATIO = 16.0
GRAVITY_ACCELERATION = 9.81
TYRE = {"p_ky1": -21.92, "p_dy1": 1.0489}
"""Of the tyre that all its cars have, if the file has none of its own: slip stiffness over load, friction."""
GROUPS = ("steering", "longitudinal", "tire")
KEYS = (
    *("l", "w", "a", "b", "m", "m_s", "m_uf", "m_ur", "I_Phi_s", "I_y_s", "I_z", "I_xz_s"),
    *("K_sf", "K_sdf", "K_sr", "K_sdr", "T_f", "T_r", "K_ras", "K_tsf", "K_tsr", "K_rad"),
    *("K_zt", "h_cg", "h_raf", "h_rar", "h_s", "I_uf", "I_ur", "I_y_w"),
    *("K_lt", "R_w", "T_sb", "T_se", "D_f", "D_r", "E_f", "E_r"),
)
MARKS = frozenset(("l", "w", "a", "b", "steering"))
"""Keys that no car file of ours has."""


def is_commonroad(content: Mapping[str, Any]) -> bool:
    """Return whether a car file is one of CommonRoad's."""
    return content.keys() >= MARKS


def commonroad_car(content: Mapping[str, Any], file: object) -> dict[str, Any]:
    """Return the sections ``car`` and ``vehicle`` of a CommonRoad file, in SI. Raises ``BadInput``."""
    known = (*KEYS, *GROUPS)
    for key in content:
        if key not in known:
            raise BadInput("unknown in a vehicle of CommonRoad that drives here", file=file, key=key)
    p = {key: number(content[key], "1", file=file, key=key) for key in KEYS if key in content}
    missing = [key for key in KEYS if key not in p and key not in ("E_f", "E_r", "I_xz_s", "h_raf", "h_rar")]
    if missing:
        raise BadInput(
            f"is missing; a vehicle of CommonRoad's multi-body model has {', '.join(KEYS)}", key=missing[0], file=file
        )
    steering = _group(content, "steering", ("min", "max", "v_min", "v_max"), file)
    tyre = {**TYRE, **_group(content, "tire", (), file)}
    for low, high in (("min", "max"), ("v_min", "v_max")):
        if not 0.0 < steering[high] == -steering[low]:
            raise BadInput(f"expected {high} above 0 and {low} its opposite", file=file, key="steering")
    return {"car": _car(p, steering), "vehicle": _vehicle(p, tyre)}


def _group(content: Mapping[str, Any], key: str, needed: tuple[str, ...], file: object) -> dict[str, float]:
    group = content.get(key, {})
    if not isinstance(group, Mapping):
        raise BadInput(f"expected a mapping with {', '.join(needed)}", file=file, key=key)
    found = {str(name): number(value, "1", file=file, key=f"{key}.{name}") for name, value in group.items()}
    for name in needed:
        if name not in found:
            raise BadInput("is missing", file=file, key=f"{key}.{name}")
    return found


def _car(p: Mapping[str, float], steering: Mapping[str, float]) -> dict[str, Any]:
    wheelbase = p["a"] + p["b"]
    overhang = 0.5 * (p["l"] - wheelbase)
    mounts = mounts_on(wheelbase + overhang, overhang, 0.5 * p["w"])
    return {
        "wheelbase": wheelbase,
        "front_overhang": overhang,
        "rear_overhang": overhang,
        "width": p["w"],
        "cg_to_rear": p["b"],
        "steering": {
            "ratio": STEERING_RATIO,
            "angle_limit": STEERING_RATIO * steering["max"],
            "rate_limit": STEERING_RATIO * steering["v_max"],
        },
        "ultrasonic": {"mounts": [mount._asdict() for mount in mounts]},
    }


def _vehicle(p: Mapping[str, float], tyre: Mapping[str, float]) -> dict[str, Any]:
    load = p["m"] * GRAVITY_ACCELERATION / (p["a"] + p["b"])
    front, share_front = _roll_stiffness(p["K_sf"], p["K_tsf"], p["K_zt"], p["T_f"])
    rear, share_rear = _roll_stiffness(p["K_sr"], p["K_tsr"], p["K_zt"], p["T_r"])
    return {
        "chassis": {
            "mass": p["m"],
            "yaw_inertia": p["I_z"],
            "cg_height": p["h_cg"],
            "front_drive_share": p["T_se"],
            "front_brake_share": p["T_sb"],
        },
        "single_track": {
            "stiffness_front": -tyre["p_ky1"] * load * p["b"],
            "stiffness_rear": -tyre["p_ky1"] * load * p["a"],
            "load_height": p["h_s"],
            "friction": tyre["p_dy1"],
        },
        "double_track": {
            "track_front": p["T_f"],
            "track_rear": p["T_r"],
            "hub": {"radius": p["R_w"], "inertia": p["I_y_w"]},
            "roll": {
                "arm": p["h_s"] * p["m_s"] / p["m"],
                "stiffness_front": front,
                "stiffness_rear": rear,
                "camber_front": 1.0 + 0.5 * p["D_f"] * p["T_f"] * share_front,
                "camber_rear": 1.0 + 0.5 * p["D_r"] * p["T_r"] * share_rear,
                "unsprung_front": p["m_uf"],
                "unsprung_rear": p["m_ur"],
            },
        },
        "scene": {"tyre_reach": p["R_w"]},
    }


def _roll_stiffness(spring: float, torsion: float, tyre: float, track: float) -> tuple[float, float]:
    """Return an axle's roll stiffness [N.m/rad], and the share of the roll that its springs take."""
    springs, tyres = 0.5 * spring * track * track - torsion, 0.5 * tyre * track * track
    whole = springs * tyres / (springs + tyres)
    return whole, whole / springs
