"""Every figure of the five papers: how its counterpart is drawn, in the paper's panels, or why there is none."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from controller_fmu.common.slot_frame import to_world
from controller_fmu.guo2015 import chart as guo_chart
from controller_fmu.guo2015.legs import point_of_leg
from controller_fmu.guo2015.params import GuoParams
from controller_fmu.guo2015.path import FIRST_ARC, reference_at
from controller_fmu.guo2015.phases import GuoPhase
from controller_fmu.guo2015.planner import plan
from controller_fmu.hsic.characteristic_states import Characteristic
from controller_fmu.preview.control import drive_force, steering_angle
from controller_fmu.preview.params import DEFAULT_ROAD, PreviewParams
from controller_fmu.preview.preview import PreviewErrors
from controller_fmu.preview.road import road_at, road_length
from fmus.native.compilers import can_compile
from modelkit.vocabulary import Pose
from orchestrator.presentation.drawing.picture_data import path_plans
from orchestrator.presentation.drawing.run_figure import LINES, PATH, run_figure, style_context
from orchestrator.studies.papers.apa import DRIVING_STATES
from orchestrator.studies.papers.preview import sweep
from orchestrator.studies.papers.result import Driven

Draw = Callable[[list[Driven]], Figure]
TARGET: dict[str, Any] = {"color": "#555555", "linestyle": ":", "linewidth": 1.0}
PRINTED_DOT: dict[str, Any] = {"color": "#000000", "linestyle": "none", "marker": "x", "markersize": 5}
SKETCH = "a sketch that defines symbols; the page of the system has the equations"
SIMULINK = "a picture of Simulink blocks; here the FMUs are connected by the scenario's SSP (`apa export ssp`)"


class PaperFigure(NamedTuple):
    """One figure of a paper."""

    paper: str
    number: str
    title: str
    draw: Draw | None
    """From the runs of ``scenarios``; None: there is no counterpart."""
    scenarios: tuple[str, ...] = ()
    note: str = ""
    """Why there is none, or what differs from the paper's axes."""

    @property
    def name(self) -> str:
        """Name of its files."""
        return f"{self.paper}-{self.number.lower().replace('fig. ', 'fig').replace(' ', '-')}"


def grid_of(rows: int, columns: int, width: float = 6.7, height: float = 2.2) -> tuple[Figure, list[Any]]:
    """Return a figure of panels, and the panels."""
    with style_context():
        figure = Figure(figsize=(width, rows * height), layout="constrained")
        axes = [figure.add_subplot(rows, columns, place) for place in range(1, rows * columns + 1)]
    for axis in axes:
        axis.spines[["top", "right"]].set_visible(False)
    return figure, axes


def guo_case(runs: list[Driven], printed: Sequence[tuple[float, float, float, float]] = ()) -> Figure:
    """Return the four panels of Fig. 6 to 8, 12, 13, with the target's curves and the printed points."""
    figure, (speed, position, heading, path) = grid_of(2, 2)
    wheel = speed.twinx()
    target = _guo_plan()
    for driven, (colour, dashes) in zip(runs, LINES, strict=False):
        signals, t = driven.recording.signals, driven.recording.t
        label = "105 deg/s" if driven.summary.scenario.endswith("-105") else "30 deg/s"
        how = {"color": colour, "linestyle": dashes}
        speed.plot(t, signals["vehicle.speed"], label=label, **how)
        wheel.plot(t, np.degrees(signals["vehicle.steering_wheel_angle"]), label=label, linewidth=0.7, **how)
        x, y = signals["vehicle.pose.x"], signals["vehicle.pose.y"]
        position.plot(t, x, label=f"x, {label}", **how)
        position.plot(t, y, label=f"y, {label}", linewidth=0.8, **how)
        heading.plot(t, signals["vehicle.pose.heading"], label=label, **how)
        path.plot(x, y, label=label, **how)
        along = [reference_at(target.path, float(item) - target.frame.target.x, FIRST_ARC) for item in x]
        position.plot(t, [at.y + target.frame.target.y for at in along], label=f"y target, {label}", **TARGET)
        heading.plot(t, [at.heading for at in along], label=f"target, {label}", **TARGET)
    _guo_path(path, target)
    for at, x0, y0, turned in printed:
        position.plot([at, at], [x0, y0], label="printed", **PRINTED_DOT)
        heading.plot([at], [turned], label="printed", **PRINTED_DOT)
        path.plot([x0], [y0], label="printed", **PRINTED_DOT)
    speed.set(xlabel="t [s]\n(a)", ylabel="speed [m/s]")
    wheel.set(ylabel="wheel [deg], thin")
    position.set(xlabel="t [s]\n(b)", ylabel="x [m]; y [m], thin")
    heading.set(xlabel="t [s]\n(c)", ylabel="heading [rad]")
    path.set(xlabel="x [m]\n(d)", ylabel="y [m]", aspect="equal")
    lines, names = path.get_legend_handles_labels()
    unique = dict(zip(names, lines, strict=True))
    figure.legend(unique.values(), unique.keys(), loc="outside lower center", ncols=4, frameon=False)
    return figure


def _guo_plan() -> Any:
    return plan(Pose(), Pose(-7.608, -3.056, 0.0), GuoParams().radius, 4.0)


def _guo_path(axis: Any, target: Any) -> None:
    x = np.linspace(0.0, target.frame.target.x, 200)
    y = [
        reference_at(target.path, float(item) - target.frame.target.x, FIRST_ARC).y + target.frame.target.y
        for item in x
    ]
    axis.plot(x, y, label="target path", **TARGET)


def guo_points(_: list[Driven]) -> Figure:
    """Return Fig. 9: the path with Q1 to Q4."""
    figure, (axis,) = grid_of(1, 1, 4.0, 2.6)
    target = _guo_plan()
    _guo_path(axis, target)
    for number, leg in enumerate((GuoPhase.TO_Q1, GuoPhase.TO_Q2, GuoPhase.TO_Q3, GuoPhase.TO_Q4), start=1):
        at = to_world(point_of_leg(leg, target.path, GuoParams()), target.frame)
        axis.plot([at.x], [at.y], "o", color="#000000", markersize=4, label=f"Q{number}")
        axis.plot([at.x, at.x + 0.7 * np.cos(at.heading)], [at.y, at.y + 0.7 * np.sin(at.heading)], color="#b0401a")
        axis.annotate(f"Q{number}", (at.x, at.y), textcoords="offset points", xytext=(0, 6), ha="right")
    axis.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    return figure


ARROW_BEND = 0.12
"""Of an arrow: how far its middle is beside the straight line, as a share of its length."""


def _on_arrow(start: tuple[float, float], end: tuple[float, float], share: float) -> tuple[float, float]:
    """Return the point of a bent arrow (a quadratic Bezier curve) at ``share`` of it."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    bend = 2.0 * share * (1.0 - share) * ARROW_BEND
    return start[0] + share * dx + bend * dy, start[1] + share * dy - bend * dx


def state_chart(_: list[Driven], rows: Any, states: Any, guards: Any) -> Figure:
    """Return a state chart drawn from its table: states on a circle, an arrow per transition, its guard beside it."""
    figure, (axis,) = grid_of(1, 1, 6.7, 6.2)
    members = list(states)
    place = {
        int(state): (np.cos(2.0 * np.pi * k / len(members)), np.sin(2.0 * np.pi * k / len(members)))
        for k, state in enumerate(members)
    }
    always = []
    edges: dict[tuple[int, int], list[str]] = {}
    for row in rows:
        guard = guards(row[1]).name.lower().replace("_", " ")
        if row[0] in place:
            edges.setdefault((row[0], row[2]), []).append(guard)
        else:
            always.append(f"any state, {guard}: {states(row[2]).name}")
    for (begin, end), names in edges.items():
        (x0, y0), (x1, y1) = place[begin], place[end]
        arrow = {
            "arrowstyle": "->",
            "connectionstyle": f"arc3,rad={ARROW_BEND:g}",
            "color": "#777777",
            "shrinkA": 16,
            "shrinkB": 16,
        }
        axis.annotate("", (x1, y1), (x0, y0), arrowprops=arrow)
        x, y = _on_arrow((x0, y0), (x1, y1), 0.33)
        axis.text(x, y, "\n".join(names), fontsize=5, ha="center", va="center", color="#1f5fbf")
    for state in members:
        box = {"boxstyle": "round", "facecolor": "#ffffff", "edgecolor": "#000000"}
        axis.text(*place[int(state)], state.name, ha="center", va="center", fontsize=6, bbox=box)
    axis.set(xlim=(-1.3, 1.3), ylim=(-1.25, 1.15))
    axis.text(0.0, -1.24, "; ".join(always), ha="center", fontsize=5)
    axis.axis("off")
    return figure


SHOWN_AS = {"l1": "L1", "l2": "L2", "wanted_speed": "set speed"}


def over_distance(runs: list[Driven], panels: Sequence[tuple[str, str, float]], span: tuple[float, float]) -> Figure:
    """Return preview signals over the travelled distance: one panel for each (signal, label, factor)."""
    figure, axes = grid_of(len(panels), 1, 6.7, 1.6)
    for axis, (names, label, factor) in zip(axes, panels, strict=True):
        for driven in runs:
            signals = driven.recording.signals
            s = signals["controller.preview.s"]
            part = (s >= span[0]) & (s <= span[1])
            for name, (colour, dashes) in zip(names.split(), LINES, strict=False):
                shown = SHOWN_AS.get(name.rpartition(".")[2], name.rpartition(".")[2])
                what = {"color": colour, "linestyle": dashes, "label": shown, "linewidth": 0.9}
                axis.plot(s[part], factor * signals[name][part], **what)
        axis.set(ylabel=label)
        if " " in names:
            axis.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes[-1].set(xlabel="s [m]")
    return figure


def memberships(_: list[Driven]) -> Figure:
    """Return Fig. 5 with the sets chosen here: a, b inputs, c steering, d force."""
    figure, axes = grid_of(2, 2)
    p = PreviewParams()
    inputs, outputs = ("NB", "NS", "ZE", "PS", "PB"), ("NB", "NM", "NS", "ZE", "PS", "PM", "PB")
    kinds: tuple[tuple[str, tuple[float, ...], tuple[str, ...]], ...] = (
        ("(a) yL", p.lateral_peaks, inputs),
        ("(b) epsL", p.heading_peaks, inputs),
    )
    kinds += (("(c) front-wheel angle", p.steering_peaks, outputs), ("(d) force", p.force_peaks, outputs))
    for axis, (label, peaks, names) in zip(axes, kinds, strict=True):
        x = np.linspace(-1.0, 1.0, 601) * max(3.0, peaks[-1])
        for k, name in enumerate(names):
            degree = np.interp(x, peaks, [1.0 if n == k else 0.0 for n in range(len(peaks))])
            axis.plot(x, degree, color="#000000", linewidth=0.8, label=name)
            axis.annotate(name, (peaks[k], 1.02), ha="center", annotation_clip=False, fontsize=6)
        most = max(3.0, peaks[-1])
        axis.set(xlabel=label, ylabel="degree", xlim=(-most, most), ylim=(0.0, 1.1))
    return figure


def rule_surfaces(_: list[Driven]) -> Figure:
    """Return Fig. 6: both outputs over their two inputs."""
    p = PreviewParams()
    sides = np.linspace(-1.0, 1.0, 25)
    with style_context():
        figure = Figure(figsize=(6.7, 3.2), layout="constrained")
    a, b = np.meshgrid(sides, sides)
    angles = [
        steering_angle(PreviewErrors(p.lateral_range * y, p.heading_range * e), p)
        for y, e in zip(a.flat, b.flat, strict=True)
    ]
    forces = [drive_force(p.speed_range * y, p.rate_range * e, p) for y, e in zip(a.flat, b.flat, strict=True)]
    for place, (values, labels) in enumerate(
        ((np.degrees(angles), ("yL", "epsL", "angle [deg]")), (np.array(forces), ("v - v set", "rate", "force [N]"))),
        start=1,
    ):
        axis = figure.add_subplot(1, 2, place, projection="3d")
        axis.plot_wireframe(3.0 * a, 3.0 * b, np.reshape(values, a.shape), color="#1f5fbf", linewidth=0.5)
        axis.set(xlabel=labels[0], ylabel=labels[1], zlabel=labels[2])
        axis.set_box_aspect(None, zoom=0.8)
    return figure


def target_road(_: list[Driven]) -> Figure:
    """Return Fig. 7: the road, its curvatures printed beside it."""
    figure, (axis,) = grid_of(1, 1, 4.5, 4.0)
    poses = [road_at(DEFAULT_ROAD, s).pose for s in np.arange(0.0, road_length(DEFAULT_ROAD), 1.0)]
    axis.plot([pose.x for pose in poses], [pose.y for pose in poses], color="#000000", label="road")
    s = 0.0
    for piece in DEFAULT_ROAD:
        if piece.curvature:
            at = road_at(DEFAULT_ROAD, s + 0.5 * piece.length).pose
            axis.annotate(
                f"{piece.curvature:g} 1/m",
                (at.x, at.y),
                textcoords="offset points",
                xytext=(0, 8),
                ha="center",
                fontsize=6,
            )
        s += piece.length
    axis.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    return figure


def zhang_errors(runs: list[Driven], panel: str) -> Figure:
    """Return one of Fig. 5 to 8: path, heading, speed, error of the front-wheel angle."""
    if panel == PATH:
        return run_figure([("car", driven.recording) for driven in runs], (PATH,), 11.0)
    figure, (axis,) = grid_of(1, 1, 4.3, 2.6)
    signals, t = runs[0].recording.signals, runs[0].recording.t
    on = signals["controller.phase"] == GuoPhase.PATH_TRACKING
    if panel == "angle":
        off = signals["vehicle.front_wheel_angle"] - signals["controller.zhang2022.reference_angle"]
        axis.plot(t[on], np.degrees(off[on]), color="#000000", label="error")
        axis.set(ylabel="front-wheel angle error [deg]")
    else:
        ours, reference, factor = {
            "heading": ("vehicle.pose.heading", "controller.reference.heading", 180.0 / np.pi),
            "speed": ("vehicle.speed", "controller.zhang2022.set_speed", 1.0),
        }[panel]
        axis.plot(t[on], factor * signals[ours][on], color="#000000", label="car")
        axis.plot(t[on], factor * signals[reference][on], label="reference", **TARGET)
        axis.set(ylabel="heading [deg]" if panel == "heading" else "speed [m/s]")
        axis.legend(frameon=False)
    axis.set(xlabel="t [s]")
    return figure


def hsic_panels(runs: list[Driven]) -> Figure:
    """Return Fig. 13: a steering angle, b heading, c deviation from the tangent, d track with the planned path."""
    figure, (steering, heading, tangent, path) = grid_of(2, 2)
    signals, t = runs[0].recording.signals, runs[0].recording.t
    steering.plot(t, np.degrees(signals["vehicle.front_wheel_angle"]), color="#000000", label="front wheel")
    heading.plot(t, np.degrees(signals["vehicle.pose.heading"]), color="#000000", label="heading")
    on = np.where(signals["controller.hsic.stage"] == 2, 1.0, np.nan)
    tangent.plot(t, 100.0 * on * signals["controller.hsic.tangent_error"], color="#000000", label="off the tangent")
    path.plot(signals["vehicle.pose.x"], signals["vehicle.pose.y"], color="#bbbbbb", linewidth=2.5, label="rear axle")
    path.plot(*path_plans(runs[0].recording)[-1].T, label="planned path", **(TARGET | {"color": "#000000"}))
    steering.set(xlabel="t [s]\n(a)", ylabel="front wheel [deg]", xlim=(0.0, t[-1]))
    heading.set(xlabel="t [s]\n(b)", ylabel="heading [deg]", xlim=(0.0, t[-1]))
    tangent.set(xlabel="t [s]\n(c)", ylabel="off the tangent [cm]", xlim=(0.0, t[-1]))
    path.set(xlabel="x [m]\n(d)", ylabel="y [m]", aspect="equal")
    path.legend(frameon=False, loc="lower right")
    return figure


def hsic_states(runs: list[Driven]) -> Figure:
    """Return Fig. 10 as driven: which of the 12 states holds when, in all runs."""
    figure, axes = grid_of(len(runs), 1, 6.7, 1.9)
    for axis, driven in zip(axes, runs, strict=True):
        state = driven.recording.signals["controller.hsic.characteristic"]
        axis.step(driven.recording.t, np.where(state > 0, state, np.nan), where="post", color="#000000", label="state")
        axis.set_yticks(
            range(1, 13), [item.name.replace("_", " ").lower() for item in Characteristic if item], fontsize=5
        )
        axis.set(ylabel=driven.summary.scenario, ylim=(12.5, 0.5))
    axes[-1].set(xlabel="t [s]")
    return figure


def paths_of(runs: list[Driven]) -> Figure:
    """Return the paths driven among the obstacles, one panel a run."""
    return run_figure([(driven.summary.scenario, driven.recording) for driven in runs], (PATH,), 12.0)


def apa_curvature(runs: list[Driven]) -> Figure:
    """Return Fig. 4: front-wheel angle over travelled distance while the system parks."""
    figure, (axis,) = grid_of(1, 1, 5.0, 2.6)
    signals = runs[0].recording.signals
    parking = np.isin(signals["controller.apa.state"], DRIVING_STATES)
    axis.plot(
        signals["vehicle.distance"][parking],
        np.degrees(signals["vehicle.front_wheel_angle"][parking]),
        color="#000000",
        label="front wheel",
    )
    axis.set(xlabel="travelled distance [m]", ylabel="front-wheel angle [deg]")
    return figure


def camera_errors(runs: list[Driven]) -> Figure:
    """Return Fig. 12: errors at the preview point with the camera's rate and delay."""
    panels = (("controller.preview.y_l", "yL [m]", 1.0), ("controller.preview.eps_l", "epsL [deg]", 180.0 / np.pi))
    return over_distance(runs, panels, (0.0, 1e4))


def set_speed_sweep(_: list[Driven]) -> Figure:
    """Return Fig. 11: largest deviation of the drive, and largest heading error in curve 4, over the set speed."""
    speeds, errors = sweep()
    figure, (axis,) = grid_of(1, 1, 4.5, 2.6)
    heading = axis.twinx()
    printed = TARGET | {"label": "as printed"}
    axis.plot(speeds, 100.0 * errors[:, 0], color="#000000", label="yL")
    axis.axhline(2.0, **printed)
    heading.plot(speeds, np.degrees(errors[:, 1]), color="#b0401a", linestyle="--", label="epsL in curve 4")
    heading.axhline(5.0, **printed)
    axis.set(xlabel="set speed [m/s]", ylabel="largest |yL| [cm]", ylim=(0.0, 4.0))
    heading.set(ylabel="|epsL| in curve 4 [deg]", ylim=(0.0, 16.0))
    return figure


Printed = tuple[float, float, float, float]
"""A point that a paper prints: time [s], x, y [m], heading [rad]; NaN where it prints none."""
FigureRow = tuple[str, str, Draw | None, tuple[str, ...], str]
"""Number, title, what draws it, its scenarios, and why there is none or what differs."""
NAN = float("nan")
DISTANCES = (
    ("controller.preview.l1 controller.preview.l2", "preview distance [m]", 1.0),
    ("vehicle.speed controller.preview.wanted_speed", "speed [m/s]", 1.0),
)
STEERED = (*DISTANCES, ("vehicle.front_wheel_angle", "front wheel [deg]", 180.0 / np.pi))
CASE_4 = (
    (3.59, -3.8, NAN, NAN),
    (4.58, -4.803, -2.441, 0.588),
    (9.38, -3.078, -0.858, 0.771),
    (11.6, -3.801, -1.539, 0.761),
)
CHART = partial(state_chart, rows=guo_chart.TRANSITIONS, states=GuoPhase, guards=guo_chart.Guard)
ALL_STATES = ("hsic", "hsic-straight", "hsic-shuffle")
NEAR_CURVE_1 = partial(over_distance, panels=DISTANCES, span=(60.0, 290.0))
NEAR_CURVE_2 = partial(over_distance, panels=DISTANCES, span=(310.0, 530.0))
WHOLE_ROAD = partial(over_distance, panels=STEERED, span=(0.0, 1e4))
FLOW = "search and planning around the chart of Fig. 11, which is drawn"
BESIDE = "The neighbours that l_c and l_k stand for, and the path between them."
ON_CURVE_1 = "As driven on curve 1; the paper's is a sketch."
CAMERA = "1.4 m where 0.2 m is printed: counted as differs."
BLOCKS = "boxes and names; the page of the system lists the same parts"
FROM_STUDY = "From the study `preview-speed`, which needs a C compiler; dotted: as printed."
SMOOTH = "The wheel turns while the vehicle rolls; the source has a B-spline."


def _case(number: str, case: int, printed: tuple[Printed, ...] = ()) -> FigureRow:
    names = (f"guo2015-case{case}", f"guo2015-case{case}-105")
    note = "Panels a to d as printed; dotted: the target at the car's x. Both steering rates."
    return number, f"case {case}", partial(guo_case, printed=printed), names, note


ROWS: dict[str, tuple[FigureRow, ...]] = {
    "guo2015": (
        ("Fig. 1", "flow chart of the system", None, (), FLOW),
        ("Fig. 2", "Ackermann geometry", None, (), SKETCH),
        ("Fig. 3", "path tracking", None, (), SKETCH),
        ("Fig. 4", "deviation from the path", None, (), SKETCH),
        ("Fig. 5", "simulation model", None, (), SIMULINK),
        _case("Fig. 6", 1, ((9.5, -3.8, NAN, NAN),)),
        _case("Fig. 7", 2, ((3.5, -3.8, NAN, NAN),)),
        _case("Fig. 8", 3),
        ("Fig. 9", "path and points Q1 to Q4", guo_points, (), ""),
        ("Fig. 10", "deviation from a point", None, (), SKETCH),
        ("Fig. 11", "chart of NTBPTcwPT", CHART, (), "Drawn from the table of transitions."),
        _case("Fig. 12", 4, CASE_4),
        _case("Fig. 13", 5, ((22.0, NAN, -3.058, 0.002),)),
    ),
    "preview": (
        ("Fig. 1", "block diagram", None, (), BLOCKS),
        ("Fig. 2", "vehicle model", None, (), SKETCH),
        ("Fig. 3", "car and target path", None, (), SKETCH),
        ("Fig. 4", "regulation of the two distances", NEAR_CURVE_1, ("preview-8",), ON_CURVE_1),
        ("Fig. 5", "membership functions", memberships, (), "The paper's are lost; these are the sets chosen here."),
        ("Fig. 6", "rule surfaces", rule_surfaces, (), "Inputs on the universe [-3, 3]."),
        ("Fig. 7", "target road", target_road, (), "Lengths of the straights are chosen."),
        ("Fig. 8", "L1 and L2 over 310 to 530 m", NEAR_CURVE_2, ("preview-8",), ""),
        ("Fig. 9", "tracking errors", camera_errors, ("preview",), ""),
        ("Fig. 10", "speed and front-wheel angle", WHOLE_ROAD, ("preview",), ""),
        ("Fig. 11", "errors over the set speed", set_speed_sweep if can_compile() else None, (), FROM_STUDY),
        ("Fig. 12", "errors with a camera", camera_errors, ("preview-camera",), CAMERA),
    ),
    "zhang2022": (
        ("Fig. 1", "kinematic model", None, (), SKETCH),
        ("Fig. 2", "slot", paths_of, ("zhang2022",), BESIDE),
        ("Fig. 3", "arc, line, arc", None, (), SKETCH),
        ("Fig. 4", "co-simulation", None, (), SIMULINK),
        ("Fig. 5", "path", partial(zhang_errors, panel=PATH), ("zhang2022",), ""),
        ("Fig. 6", "heading", partial(zhang_errors, panel="heading"), ("zhang2022",), ""),
        ("Fig. 7", "speed", partial(zhang_errors, panel="speed"), ("zhang2022",), ""),
        ("Fig. 8", "front-wheel angle error", partial(zhang_errors, panel="angle"), ("zhang2022",), ""),
    ),
    "hsic": (
        ("Fig. 1", "ranging by ultrasound", None, (), SKETCH),
        ("Fig. 2", "where a reversing aid is mounted", None, (), "a photograph"),
        ("Fig. 3", "where sensors are", None, (), "a sketch of a car; the sensors' places are in the car files"),
        ("Fig. 5", "method by experience", None, (), SKETCH),
        ("Fig. 6", "kinematic model", None, (), SKETCH),
        ("Fig. 7", "Simulink block", None, (), SIMULINK),
        ("Fig. 8", "flow of the control", None, (), "four steps in words; the states as driven are Fig. 10"),
        ("Fig. 4", "arcs and common tangent", paths_of, ("hsic",), "Dotted: the planned path."),
        ("Fig. 9", "key points", paths_of, ("hsic-straight",), "P1 to P4 are the ends of the dotted pieces."),
        ("Fig. 10", "the 12 states", hsic_states, ALL_STATES, "When each holds; the paper sketches them."),
        ("Fig. 11", "simulation model", None, (), SIMULINK),
        ("Fig. 12", "kinematic block", None, (), SIMULINK),
        ("Fig. 13", "result", hsic_panels, ("hsic",), ""),
    ),
    "apa": (
        ("Fig. 1", "parallel parking", paths_of, ("apa-parallel",), ""),
        ("Fig. 2", "range of starts", None, (), "a sketch; this system plans from where the vehicle stands"),
        ("Fig. 3", "tangent arcs", None, (), "a sketch; the path driven is Fig. 1"),
        ("Fig. 4", "smooth curvature", apa_curvature, ("apa-parallel",), SMOOTH),
        ("Fig. 5", "perpendicular parking", paths_of, ("apa-perpendicular",), ""),
        ("States", "state machine", None, (), "this system's chart has states of its own: docs/parking.md"),
    ),
}
FIGURES = tuple(PaperFigure(paper, *row) for paper, rows in ROWS.items() for row in rows)
