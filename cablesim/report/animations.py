"""The line through the last period as a moving picture, beside a still one that can be printed."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image
from scipy.interpolate import CubicSpline

from cablesim.config.figure_file import Figure
from cablesim.files import written_whole
from cablesim.quantities import quantity
from cablesim.report.drawing import LEGEND
from cablesim.report.snapshots import COLOURS, Motion, colour_values, coloured, elements, motions_of

# Of a period, which runs again and again; how long each is shown, and how large it is.
FRAMES, MILLISECONDS, DOTS_PER_INCH = 48, 80, 100
# All phases together, behind the line that moves.
TRACE, TRACE_WIDTH, WIDTH = "#DDDDDD", 0.6, 2.2
GREYS, SHADES, PALE_STEP = 32, 160, 4
PHASE = f"${quantity('history_time').symbol}/{quantity('wave_period').symbol}$"


def save_animation(still: Any, dataset: xr.Dataset, figure: Figure, path: Path) -> None:
    """Write a GIF of the lines of a figure of snapshots that is drawn already: that stays, but for its colours."""
    frames = [Image.fromarray(frame) for frame in _frames(still, motions_of(dataset, figure))]
    palette = _palette()
    first, *rest = (frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames)
    with written_whole(path) as temporary:
        first.save(temporary, "GIF", save_all=True, append_images=rest, duration=MILLISECONDS, loop=0)


def _palette() -> Image.Image:
    """The colours of tension and greys, the same for all frames: what does not move stays as it is."""
    greys = np.linspace(0.0, 1.0, GREYS)[:, None] * np.ones(3)
    tension = COLOURS(np.linspace(0.0, 1.0, SHADES))[:, :3]
    slack = np.array(COLOURS(-1.0))[None, :3]
    # A line of a colour has paler edges.
    pale = 0.5 + 0.5 * np.concatenate([tension[::PALE_STEP], slack])
    colours = np.concatenate([greys, tension, slack, pale])
    image = Image.new("P", (1, 1))
    image.putpalette(np.round(255.0 * colours).astype(np.uint8).ravel().tolist())
    return image


def between(motion: Motion, frames: int) -> Motion:
    """A line at more phases of its period, which has no end: places along splines, tensions along straight lines."""
    phases = len(motion.places)
    times = np.arange(frames) * phases / frames
    places, tension = (np.concatenate([values, values[:1]]) for values in (motion.places, motion.tension))
    if not np.isfinite(places).all():
        return Motion(motion.rest, np.full((frames, *places.shape[1:]), np.nan), np.zeros((frames, tension.shape[1])))
    before, after = tension[times.astype(int)], tension[times.astype(int) + 1]
    part = (times % 1.0)[:, None]
    spline = CubicSpline(np.arange(phases + 1), places, bc_type="periodic")
    return Motion(motion.rest, spline(times), (1.0 - part) * before + part * after)


def _frames(still: Any, motions: list[Motion]) -> list[np.ndarray]:
    """Pictures of (row, column, colour). Only what moves is drawn anew."""
    panels = still.axes[: len(motions)]
    norm = panels[0].collections[0].norm
    moving = [between(motion, FRAMES) for motion in motions]
    lines = [_add_line(axes, motion, norm) for axes, motion in zip(panels, moving, strict=True)]
    text = panels[0].text(0.03, 0.97, "", transform=panels[0].transAxes, va="top", fontsize=LEGEND, animated=True)
    still.set_dpi(DOTS_PER_INCH)
    canvas = FigureCanvasAgg(still)
    canvas.draw()
    background = canvas.copy_from_bbox(still.bbox)
    found = []
    for number in range(FRAMES):
        canvas.restore_region(background)
        for axes, line, motion in zip(panels, lines, moving, strict=True):
            line.set_segments(elements(motion.places[number : number + 1]))
            line.set_array(colour_values(motion.tension[number : number + 1], norm))
            axes.draw_artist(line)
        text.set_text(f"{PHASE} = {number / FRAMES:.2f}")
        panels[0].draw_artist(text)
        found.append(np.asarray(canvas.buffer_rgba())[..., :3].copy())
    return found


def _add_line(axes: Any, motion: Motion, norm: Any) -> Any:
    """The line that moves, before what was there, which fades."""
    trace = axes.collections[0]
    trace.set(array=None, color=TRACE, linewidths=TRACE_WIDTH)
    line = coloured(motion.places[:1], motion.tension[:1], norm, linewidths=WIDTH, animated=True, zorder=4)
    axes.add_collection(line, autolim=False)
    return line
