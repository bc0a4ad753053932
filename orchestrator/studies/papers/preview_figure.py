"""Pictures of the preview paper: Fig. 8 to 11, and the single preview point beside."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from controller_fmu.preview.control import drive_force, steering_angle
from controller_fmu.preview.params import PreviewParams
from controller_fmu.preview.phases import PreviewPhase
from controller_fmu.preview.preview import PreviewErrors
from orchestrator.presentation.drawing.save import save
from orchestrator.simulation.cosim.fmu_instance import Array
from orchestrator.studies.papers.result import Driven

BLUE, ORANGE, GREEN, GREY = "#1f5fbf", "#d1602a", "#2b8a5a", "#888888"
POINTS = {"A": 331.5, "B": 350.6, "C": 353.6, "D": 508.6, "E": 510.7}


def draw_preview(main: Driven, eight: Driven, single: Driven, out: Path) -> list[Path]:
    """Write the pictures of the drives and return their paths."""
    return [_distances(eight, out / "preview-distances.png"), _drive(main, single, out / "preview-drive.png")]


def draw_sweep(speeds: Array, table: Array, file: Path) -> Path:
    """Write Fig. 11: largest |yL| and |epsL| of curve 4 over the set speed."""
    figure, axis = plt.subplots(figsize=(7.0, 4.2), layout="constrained")
    axis.plot(speeds, 100.0 * table[:, 0], "o-", color=BLUE, label="largest |yL| [cm]")
    axis.axhline(2.0, color=BLUE, linewidth=0.8, linestyle=":", label="2 cm, as printed")
    other = axis.twinx()
    other.plot(speeds, np.degrees(table[:, 1]), "s--", color=ORANGE, label="epsL in curve 4 by (2) [deg]")
    other.axhline(5.0, color=ORANGE, linewidth=0.8, linestyle=":", label="5 deg, as printed")
    axis.set(
        xlabel="set speed [m/s]", ylabel="cm", ylim=(0.0, 4.0), title="Preview paper, Fig. 11: sweep of the set speed"
    )
    other.set(ylabel="deg", ylim=(0.0, 16.0))
    figure.legend(loc="outside lower center", ncols=2, frameon=False)
    return _save(figure, file)


def draw_surfaces(file: Path) -> Path:
    """Write the rule surfaces of both fuzzy controllers (Fig. 6): angle over yL, epsL; force over speed error, rate."""
    params = PreviewParams()
    sides = np.linspace(-1.0, 1.0, 41)
    y, eps = np.meshgrid(params.lateral_range * sides, params.heading_range * sides)
    error, rate = np.meshgrid(0.2 * params.speed_range * sides, params.rate_range * sides)
    angles = np.array([steering_angle(PreviewErrors(*pair), params) for pair in zip(y.flat, eps.flat, strict=True)])
    forces = np.array([drive_force(*pair, params) for pair in zip(error.flat, rate.flat, strict=True)])
    figure = plt.figure(figsize=(10.0, 4.6), layout="constrained")
    surfaces = (
        (100.0 * y, np.degrees(eps), np.degrees(angles), ("yL [cm]", "epsL [deg]", "front wheel [deg]")),
        (error, rate, forces, ("v - v set [m/s]", "its rate [m/s2]", "force [N]")),
    )
    for place, (across, along, up, labels) in enumerate(surfaces, start=1):
        axis = figure.add_subplot(1, 2, place, projection="3d")
        axis.plot_surface(across, along, np.reshape(up, across.shape), cmap="viridis", linewidth=0)
        axis.set(xlabel=labels[0], ylabel=labels[1], zlabel=labels[2])
    figure.suptitle("Preview paper, Fig. 6: what the rules make of their inputs")
    save(figure, file, dpi=110)
    plt.close(figure)
    return file


def _distances(eight: Driven, file: Path) -> Path:
    signals = eight.recording.signals
    s = signals["controller.preview.s"]
    part = (s > 310.0) & (s < 530.0)
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(10.0, 6.4), sharex=True, layout="constrained")
    top.plot(s[part], signals["controller.preview.l2"][part], color=GREY, linewidth=1.0, label="L2")
    top.plot(s[part], signals["controller.preview.l1"][part], color=BLUE, linewidth=1.6, label="L1")
    for letter, at in POINTS.items():
        top.axvline(at, color=ORANGE, linewidth=0.7, linestyle=":")
        top.text(at, 26.5, letter, color=ORANGE, ha="center")
    top.set(ylabel="preview distance [m]", ylim=(0.0, 28.5))
    top.legend(frameon=False, loc="upper right")
    bottom.plot(s[part], signals["vehicle.speed"][part], color=BLUE, label="speed [m/s]")
    bottom.plot(
        s[part], signals["controller.preview.wanted_speed"][part], color=GREY, linestyle="--", label="set speed [m/s]"
    )
    bottom.plot(s[part], np.degrees(signals["vehicle.front_wheel_angle"][part]), color=GREEN, label="front wheel [deg]")
    bottom.set(xlabel="s [m]", ylim=(-3.0, 9.5))
    bottom.legend(frameon=False, loc="center right")
    figure.suptitle("Preview paper, Fig. 8: curve 2 at 8 m/s; dotted: A to E as printed")
    return _save(figure, file)


def _drive(main: Driven, single: Driven, file: Path) -> Path:
    figure, axes = plt.subplots(4, 1, figsize=(11.0, 9.6), sharex=True, layout="constrained")
    for driven, colour, label in ((main, BLUE, "dual"), (single, ORANGE, "single point, no slowing")):
        signals = driven.recording.signals
        s = signals["controller.preview.s"]
        driving = signals["controller.phase"] == PreviewPhase.PATH_TRACKING
        axes[0].plot(
            s[driving], 100.0 * signals["controller.preview.y_l"][driving], color=colour, label=label, linewidth=1.0
        )
        axes[1].plot(s[driving], np.degrees(signals["controller.preview.eps_l"][driving]), color=colour, linewidth=1.2)
        axes[2].plot(s[driving], signals["vehicle.speed"][driving], color=colour, linewidth=1.4)
        axes[3].plot(s[driving], np.degrees(signals["vehicle.front_wheel_angle"][driving]), color=colour, linewidth=1.0)
    signals = main.recording.signals
    s = signals["controller.preview.s"]
    chord = np.degrees(0.5 * signals["controller.preview.kappa1"] * signals["controller.preview.l1"])
    axes[1].plot(s, chord, color=GREEN, linewidth=0.9, linestyle="--", label="dual, as the chord")
    axes[1].legend(frameon=False, loc="upper left")
    axes[2].plot(s, signals["controller.preview.wanted_speed"], color=GREY, linewidth=0.9, linestyle="--", label="set")
    axes[2].legend(frameon=False, loc="lower left")
    axes[0].axhspan(-2.0, 2.0, color=BLUE, alpha=0.08)
    axes[0].set(ylabel="yL [cm]", ylim=(-6.0, 6.0))
    axes[1].set(ylabel="epsL [deg]", ylim=(-15.0, 15.0))
    axes[2].set(ylabel="speed [m/s]", ylim=(0.0, 9.5))
    axes[3].set(ylabel="front wheel [deg]", xlabel="s [m]", ylim=(-12.0, 12.0))
    axes[0].legend(frameon=False, loc="upper left", ncols=2)
    figure.suptitle("Preview paper, Fig. 9 and 10, and the conventional single point beside it")
    return _save(figure, file)


def _save(figure: Figure, file: Path) -> Path:
    for axis in figure.axes:
        axis.grid(alpha=0.25, linewidth=0.6)
        axis.spines[["top"]].set_visible(False)
    save(figure, file, dpi=110)
    plt.close(figure)
    return file
