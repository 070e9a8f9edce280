# SPDX-License-Identifier: Apache-2.0
"""The rows of figure 8 of [CAR2]: measured, smooth synthesis, relit range map, combination."""

import math

from PIL import Image

from .common import contact_sheet

TITLE = "Smooth texture, range map and both"
SAYS = "the four rows of figure 8 of [CAR2]: measured, smooth, relit range map, combination."
PRESETS = {"corduroy": (60, 0), "leather": (60, 90), "plain-weave": (60, 30)}
VIEW = (0, 0)
SIDE = 128
SHOWN = 220


def relit(normals, light):
    """max(0, n·l) over its mean, at half of white."""
    theta, phi = (math.radians(a) for a in light)
    to_light = (math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta))
    shading = [
        max(0.0, sum((2 * v / 255 - 1) * x for v, x in zip(pixel, to_light)))
        for pixel in normals.getdata()
    ]
    scale = 0.22 * len(shading) / sum(shading)
    picture = Image.new("L", normals.size)
    picture.putdata([min(255, round(255 * (scale * s) ** (1 / 2.2))) for s in shading])
    return picture.convert("RGB")


def make(context):
    columns = []
    for name, light in PRESETS.items():
        source = context.measure(name, "--directions", "coarse")
        whole, smooth = context.model(source), context.model(source, "--surface", "none")
        maps = context.scratch / "maps"
        # Tiles are stretched to close a torus: little in a large one.
        context.run("synthesise", whole, "-o", maps, "--maps", "--size", 4 * SIDE)
        with Image.open(maps / "normal.png") as image:
            normals = image.convert("RGB").crop((0, 0, SIDE, SIDE))
        options = ["--size", SIDE, "--view", "{},{}".format(*VIEW), "--light"]
        options.append("{},{}".format(*light))
        columns.append([
            context.measured(source, VIEW, light), context.picture("synthesise", smooth, *options),
            relit(normals, light), context.picture("synthesise", whole, *options),
        ])  # fmt: skip
    rows = [[p.resize((SHOWN, SHOWN), Image.BICUBIC) for p in row] for row in zip(*columns)]
    names = ["measured", "smooth\nsynthesis", "relit\nrange map", "combination"]
    captions = [f"{name}, light {light[0]}°, {light[1]}°" for name, light in PRESETS.items()]
    return "\n".join([
        "[CAR2, figure 8] shows what each part of its model gives. Smooth synthesis here is a "
        "material without range map, whose fields hold the shading as grain; in the combination "
        "the texture, free of shading, is multiplied by the shading of the range map, normalised so "
        "that brightness is counted once ([evaluation](../theory/evaluation.md)). Corduroy and weave have a "
        "pattern, which holds its shading ([de-lighting](../theory/delighting.md)): their smooth "
        "synthesis is drawn as it is.", "",
        context.sheet(
            "rows", contact_sheet(rows, columns=captions, names=names),
            "Seen from above, 128 x 128 pixels, materials of 25 views x 25 lights",
        ),
    ])  # fmt: skip
