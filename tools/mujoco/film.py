#!/usr/bin/env python3
"""Render the film of a drive in MuJoCo: equally spaced frames as one picture, DIR/film.png.

Without a display this needs EGL or OSMesa: MUJOCO_GL says which. Exit status 2: it cannot render here.
"""
import io
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from tools.common import ArgumentParser, ToolError, run, shown_path, write_whole
from tools.mujoco.articulation import WALL_GROUP

FRAMES, COLUMNS = 8, 2
WIDTH, HEIGHT = 640, 300
ELEVATION, ABOVE_WALLS = -18, -50  # of the camera's view, °
STATES_NAME, FILM_NAME = "film.npz", "film.png"

RENDERED, DRAWN = "rendered by MuJoCo", "drawn from the states: neither EGL nor OSMesa can render here"


def chosen(track):
    """Equally spaced samples of a drive."""
    return [track[round(i * (len(track) - 1) / (FRAMES - 1))] for i in range(FRAMES)]


def save(directory, xml, track):
    samples = chosen(track)
    np.savez(directory / STATES_NAME, xml=xml, times=[sample[0] for sample in samples],
             qpos=[sample[-1] for sample in samples])


def render(directory):
    """The frames as arrays."""
    import mujoco  # reads MUJOCO_GL

    states = np.load(directory / STATES_NAME)
    model = mujoco.MjModel.from_xml_string(str(states["xml"]))
    data = mujoco.MjData(model)
    try:
        renderer = mujoco.Renderer(model, HEIGHT, WIDTH)
    except Exception as error:  # whatever the library of this machine raises
        raise ToolError(f"MUJOCO_GL={os.environ.get('MUJOCO_GL')}: {error}") from None
    camera, seen = mujoco.MjvCamera(), mujoco.MjvOption()
    seen.geomgroup[WALL_GROUP] = 1
    robot = model.geom_bodyid > 0
    size = 2.2 * float(np.abs(model.geom_pos[robot]).max() + model.geom_rbound[robot].max())
    elevation = ABOVE_WALLS if (model.geom_group == WALL_GROUP).any() else ELEVATION
    frames = []
    for qpos in states["qpos"]:
        data.qpos[:] = qpos
        mujoco.mj_forward(model, data)
        camera.lookat[:] = data.qpos[:3]
        camera.distance, camera.azimuth, camera.elevation = 2.2 * size, 60, elevation
        renderer.update_scene(data, camera, seen)
        frames.append(renderer.render().copy())
    return frames, states["times"]


def montage(frames, times):
    """As PNG."""
    from PIL import Image, ImageDraw

    rows = -(-len(frames) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * WIDTH, rows * HEIGHT))
    draw = ImageDraw.Draw(sheet)
    for i, (frame, time) in enumerate(zip(frames, times)):
        place = (i % COLUMNS * WIDTH, i // COLUMNS * HEIGHT)
        sheet.paste(Image.fromarray(frame), place)
        draw.text((place[0] + 10, place[1] + 8), f"{time:.1f} s", fill=(20, 30, 40))
    buffer = io.BytesIO()
    sheet.save(buffer, "PNG")
    return buffer.getvalue()


def make(directory, draw):
    """The film by whichever library renders here, else by `draw`; says how it was made."""
    for library in ("egl", "osmesa"):
        result = subprocess.run([sys.executable, "-m", "tools.mujoco.film", str(directory)], capture_output=True,
                                env={**os.environ, "MUJOCO_GL": library}, check=False)
        if result.returncode == 0:
            return RENDERED
    write_whole(directory / FILM_NAME, draw())
    return DRAWN


def main():
    parser = ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("directory", metavar="DIR", type=Path, help=f"holds {STATES_NAME} of tools.mujoco.mission")
    directory = parser.parse_args().directory
    write_whole(directory / FILM_NAME, montage(*render(directory)))
    print(f"wrote {shown_path(directory / FILM_NAME)}")
    return 0


if __name__ == "__main__":
    run(main)
