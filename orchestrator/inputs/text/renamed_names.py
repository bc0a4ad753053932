"""Names that scenarios, studies, tests and commands had before, and what they are called now: one table for all.

An old name is rejected, and the message gives the new one; ``apa migrate`` rewrites files by the same table.
"""

SCENARIO_KEYS = {
    "base": "extends",
    "car.base": "car.extends",
    "ending": "stop_condition",
    "ending.done": "stop_condition.succeeded",
    "ending.over": "stop_condition.ended",
    "every": "decimation",
    "expect": "expected_outcome",
    "limits": "requirements",
    "polygons": "obstacles",
    "system.slaves": "system.components",
    "target.of": "target.reference_point",
}
"""Keys of a scenario, nested ones with dots."""
VARIABLES = {
    "controller.apa.mode": "controller.apa.state",
    "controller.apa.slot.kind": "controller.apa.slot.type",
    "controller.apa.target": "controller.apa.goal",
    "controller.choice": "controller.driver_selection",
    "controller.drive.brake": "controller.drive.brake_deceleration",
    "controller.drive.creep": "controller.drive.creep_speed",
    "controller.drive.delay": "controller.drive.brake_delay",
    "controller.drive.rolling": "controller.drive.rolling_offset",
    "controller.drive.wheel_delay": "controller.drive.steering_delay",
    "controller.end.heading": "controller.final.heading",
    "controller.end.position": "controller.final.position",
    "controller.guard.corridor": "controller.monitor.corridor",
    "controller.guard.corridor_heading": "controller.monitor.corridor_heading",
    "controller.guard.surprise": "controller.monitor.unexplained",
    "controller.guard.wait": "controller.monitor.wait",
    "controller.hsic.gain.creep": "controller.hsic.gain.min_speed",
    "controller.hsic.gain.fast": "controller.hsic.gain.max_speed",
    "controller.hsic.gain.slow": "controller.hsic.gain.corrective_speed",
    "controller.hsic.gain.steepest": "controller.hsic.gain.max_approach_heading",
    "controller.hsic.gain.strengthened": "controller.hsic.gain.gain_boost",
    "controller.hsic.threshold.retreat": "controller.hsic.threshold.retry_distance",
    "controller.hsic.threshold.wheel": "controller.hsic.threshold.steering_angle_reached",
    "controller.limit.patience": "controller.limit.driver_response_timeout",
    "controller.limit.shifts": "controller.limit.manoeuvres",
    "controller.limit.wheel_fault": "controller.limit.steering_fault_debounce",
    "controller.limit.wheel_off": "controller.limit.steering_tracking_error",
    "controller.plan.at_once": "controller.plan.steps_per_sample",
    "controller.plan.curvature_share": "controller.plan.curvature_fraction",
    "controller.plan.plans": "controller.plan.max_plans",
    "controller.plan.steps": "controller.plan.max_steps",
    "controller.search.open_ended": "controller.slot.open_ended",
    "controller.search.way": "controller.slot.distance",
    "controller.search.wish": "controller.slot.wanted",
    "controller.shifts": "controller.manoeuvres",
    "controller.threshold.lost_lateral": "controller.threshold.abort_lateral_error",
    "controller.threshold.miss_heading": "controller.threshold.final_heading_error",
    "controller.threshold.miss_lateral": "controller.threshold.final_lateral_error",
    "controller.threshold.wheel": "controller.threshold.steering_angle_reached",
    "controller.told": "controller.external_slot",
    "controller.zhang2022.mpc.cap": "controller.zhang2022.mpc.max_iterations",
    "controller.zhang2022.mpc.softness": "controller.zhang2022.mpc.slack_weight",
    "vehicle.driver.grab_angle": "vehicle.driver.steering_override_angle",
    "vehicle.driver.grab_time": "vehicle.driver.steering_override_time",
    "vehicle.driver.obeys_direction": "vehicle.driver.complies_with_direction",
    "vehicle.driver.obeys_slow_down": "vehicle.driver.complies_with_slow_down",
    "vehicle.driver.obeys_stop": "vehicle.driver.complies_with_stop",
    "vehicle.driver.wobble": "vehicle.driver.speed_oscillation_amplitude",
    "vehicle.driver.wobble_period": "vehicle.driver.speed_oscillation_period",
    "vehicle.odometry.perfect": "vehicle.odometry.ideal",
    "vehicle.person": "vehicle.manual",
    "vehicle.person.drives": "vehicle.manual.active",
    "vehicle.road.bank": "vehicle.road.cross_slope",
    "vehicle.road.slope": "vehicle.road.grade",
    "vehicle.steering.stuck_time": "vehicle.steering.fault_time",
}
"""Parameters and signals; a group stands for all that is in it."""
MOVED_VARIABLES = {
    "controller.apa.drive": "controller.drive",
    "controller.apa.drive.brake": "controller.drive.brake_deceleration",
    "controller.apa.drive.creep": "controller.drive.creep_speed",
    "controller.apa.drive.delay": "controller.drive.brake_delay",
    "controller.apa.drive.reaction": "controller.drive.driver_reaction",
    "controller.apa.end.final_heading_error": "controller.final.accepted_heading",
    "controller.apa.end.final_lateral_error": "controller.final.accepted",
    "controller.apa.end.heading": "controller.final.heading",
    "controller.apa.end.lateral": "controller.final.position",
    "controller.apa.end.miss_heading": "controller.final.accepted_heading",
    "controller.apa.end.miss_lateral": "controller.final.accepted",
    "controller.apa.end.out": "controller.slot.stand_out",
    "controller.apa.guard.blocked": "controller.monitor.wait",
    "controller.apa.guard.brake_delay": "controller.monitor.brake_delay",
    "controller.apa.guard.confirm": "controller.slot.confirm_time",
    "controller.apa.guard.driver_response_timeout": "controller.limit.driver_response_timeout",
    "controller.apa.guard.duration": "controller.limit.duration",
    "controller.apa.guard.gap": "controller.monitor.map_distance",
    "controller.apa.guard.over_speed": "controller.monitor.over_speed",
    "controller.apa.guard.over_speed_time": "controller.monitor.over_speed_time",
    "controller.apa.guard.patience": "controller.limit.driver_response_timeout",
    "controller.apa.guard.surprise": "controller.monitor.unexplained",
    "controller.apa.guard.surprise_gap": "controller.monitor.echo_distance",
    "controller.apa.map.noise": "controller.mapping.range_noise",
    "controller.apa.plan.curvature_share": "controller.plan.curvature_fraction",
    "controller.apa.plan.manoeuvres": "controller.limit.manoeuvres",
    "controller.apa.plan.margin": "controller.plan.margin",
    "controller.apa.plan.shifts": "controller.limit.manoeuvres",
    "controller.apa.plan.stand_out": "controller.slot.stand_out",
    "controller.apa.search.speed": "controller.slot.speed",
    "controller.apa.search.way": "controller.slot.distance",
    "controller.apa.search.wish": "controller.slot.wanted",
    "controller.apa.slot.a.x": "controller.apa.slot.ax",
    "controller.apa.slot.a.y": "controller.apa.slot.ay",
    "controller.apa.corner_b.x": "controller.apa.slot.bx",
    "controller.apa.corner_b.y": "controller.apa.slot.by",
}
"""Variables in another group: messages give the new name, files are not rewritten."""
REMOVED_VARIABLES = (
    *(f"controller.apa.{group}" for group in ("end", "guard", "map", "plan", "search", "sensors")),
    *(f"controller.apa.{name}" for name in ("confirm", "corner_b", "family", "iso_spare", "moves", "slots")),
    *(f"controller.apa.slot.{name}" for name in ("a", "b_out", "empty_a", "empty_b", "length", "line", "opposite")),
    *(f"controller.apa.slot.{name}" for name in ("skew_a", "skew_b", "unsure")),
)
"""Variables, and groups of them, without a counterpart."""
METRICS = {
    "final.slot_margin": "final.outline_margin",
    "shifts": "manoeuvres",
    "standstill_steering": "dry_steering_count",
    "steering_effort": "steering_travel",
}
"""Metrics of a run, as requirements name them."""
SHIPPED_NAMES = {
    "requirements": {"driver-told": "driver-information", "house": "project"},
    "scenarios": {
        "apa-told": "apa-external-slot",
        "apa-told-nose-in": "apa-external-slot-nose-in",
        "apa-told-wrong": "apa-external-slot-occupied",
        "cicap-thing-in-slot": "cicap-object-in-slot",
        "valet-no-way": "valet-no-path",
        "valet-thing-in-the-way": "valet-obstacle-on-path",
        "valet-told": "valet-external-slot",
        "valet-told-wrong": "valet-external-slot-occupied",
    },
}
"""Folder of the library -> names of its files."""
VALUES = {
    "extends": SHIPPED_NAMES["scenarios"],
    "requirements": SHIPPED_NAMES["requirements"],
    "scenario": SHIPPED_NAMES["scenarios"],
    "kind": {"drop": "dropout", "freeze": "stuck_at_last"},
    "system": {"parking": "apa", "parking_large": "apa_large", "valet": "apa", "valet_large": "apa_large"},
    "task": {"run": "open_loop"},
    "where": {"polygons": "obstacles"},
}
"""Key -> its values, or those of its list; ``kind`` is that of a fault."""
OPTIONS = {
    "--corpus": "--regression",
    "--every": "--stride",
    "--first": "--offset",
    "--picture": "--figure",
    "--workers": "--jobs",
}
"""Options of commands."""
API = {"must_be": "assert_outcome", "must_meet": "assert_requirements"}
"""Methods of the runs that the fixtures of the pytest plugin return."""
DOTTED_NAMES = SCENARIO_KEYS | VARIABLES | METRICS


def moved_name(path: str) -> str:
    """Return a dotted name in the group that it is in now; empty if it has not moved."""
    owner = next((old for old in sorted(MOVED_VARIABLES, key=len, reverse=True) if _is_part(path, old)), "")
    return MOVED_VARIABLES[owner] + path[len(owner) :] if owner else ""


def is_removed(path: str) -> bool:
    """Return whether a dotted name was that of a variable that has no counterpart."""
    return any(_is_part(path, old) for old in REMOVED_VARIABLES)


def _is_part(path: str, group: str) -> bool:
    return path == group or path.startswith(f"{group}.")


def current_name(path: str) -> str:
    """Return a dotted name as it is called now; itself where it, and all that it is in, was never called otherwise.

    Old and new names have equally many parts.
    """
    parts = path.split(".")
    for count in range(len(parts), 0, -1):
        new = DOTTED_NAMES.get(".".join(parts[:count]))
        if new is not None:
            return ".".join([new, *parts[count:]])
    return path


def new_name(word: str, prefix: str = "") -> str:
    """Return what the unknown ``word``, which may lack its owner ``prefix``, is called now; empty if nothing is known.

    A name without its owner is found if one old name ends with it.
    """
    for full in (prefix + word, word):
        if current_name(full) != full:
            return current_name(full)
    if word in OPTIONS:
        return OPTIONS[word]
    ends = {new for old, new in DOTTED_NAMES.items() if old.endswith(f".{word}")}
    return ends.pop() if len(ends) == 1 else ""
