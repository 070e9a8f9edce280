# SPDX-License-Identifier: Apache-2.0
"""Surfaces found in measurements beside the true ones, and fields of their tiles."""

import json
import math

from PIL import Image

from .common import contact_sheet, table
from .relighting import relit

TITLE = "Surfaces"
SAYS = "estimated normals and heights of every preset beside the truth, and fields of 4 x 4 tiles."
PRESETS = ["leather", "corduroy", "plain-weave", "twill", "knit", "stone", "plaster", "wood"]
SIDE = 128
LIGHT = (60, 54)  # of the UBO2003 grid
LAMP = (55, 135)


def normals_of(path):
    """Unit vectors of a normal map of 8 or 16 bits."""
    with Image.open(path) as image:
        triples = image.convert("RGB").getdata()
    vectors = []
    for rgb in triples:
        n = [v / 127.5 - 1 for v in rgb]
        length = math.sqrt(sum(v * v for v in n))
        vectors.append([v / length for v in n])
    return vectors


def mean_angle(a, b):
    cosines = (sum(x * y for x, y in zip(n, m)) for n, m in zip(a, b))
    return sum(math.degrees(math.acos(min(1, max(-1, c)))) for c in cosines) / len(a)


def heights_of(path):
    with Image.open(path) as image:
        return list(image.convert("I").getdata())


def correlation(a, b):
    mean_a, mean_b = sum(a) / len(a), sum(b) / len(b)
    product = sum((x - mean_a) * (y - mean_b) for x, y in zip(a, b))
    square = sum((x - mean_a) ** 2 for x in a) * sum((y - mean_b) ** 2 for y in b)
    return product / math.sqrt(square)


def grey(heights):
    """Stretched from the 1st to the 99th percentile."""
    order = sorted(heights)
    low, high = order[len(order) // 100], order[-1 - len(order) // 100]
    picture = Image.new("L", (SIDE, SIDE))
    picture.putdata([round(255 * min(1, max(0, (z - low) / (high - low)))) for z in heights])
    return picture


def of_preset(context, preset):
    source = context.measure(preset, "--size", SIDE, "--directions", "lights")
    truth = source.with_name(source.stem + "_truth")
    material = context.scratch / f"surfaces-{preset}.sateen"
    found = context.scratch / f"surfaces-{preset}"
    surface = context.run_json("model", source, "-o", material, "--surface-out", found)["surface"]
    plain = context.scratch / f"surfaces-{preset}-plain"
    context.run("model", source, "-o", context.scratch / "plain.sateen", "--paper",
                "--surface-out", plain)  # fmt: skip
    true_normals = normals_of(truth / "normal.png")
    angle = mean_angle(normals_of(found / "normal.png"), true_normals)
    plain_angle = mean_angle(normals_of(plain / "normal.png"), true_normals)
    heights, true_heights = heights_of(found / "height.png"), heights_of(truth / "height.png")
    rows, cols = surface["size"][1], surface["size"][0]
    field = context.scratch / f"surfaces-{preset}-field"
    context.run("synthesise", material, "-o", field, "--maps", "--size", f"{4 * cols}x{4 * rows}")
    with Image.open(field / "normal.png") as image:
        lit = relit(image, LAMP)
    with Image.open(truth / "normal.png") as image:
        true_lit = relit(image, LAMP)
    with Image.open(found / "normal.png") as image:
        found_lit = relit(image, LAMP)
    pictures = [
        context.measured(source, (0, 0), LIGHT), true_lit, found_lit, grey(true_heights),
        grey(heights),
    ]  # fmt: skip
    line = [
        preset, f"{plain_angle:.2f}°", f"{angle:.2f}°",
        f"{correlation(heights, true_heights):.3f}",
        "{height:.2f}, {normals:.2f}".format(**surface["seam_ratio"]),
        surface["tiles"], f"{surface['estimated_bytes'] / 1e3:.1f} KB",
    ]  # fmt: skip
    return pictures, lit.resize((384, 384 * lit.height // lit.width), Image.LANCZOS), line


def make(context):
    rows, fields, lines = [], [], []
    for preset in PRESETS:
        pictures, field, line = of_preset(context, preset)
        rows.append(pictures)
        fields.append(field)
        lines.append(line)
    estimates = contact_sheet(
        rows,
        columns=["measured", "true normals, lit", "found, lit", "true height", "found height"],
        names=PRESETS,
    )
    half = len(PRESETS) // 2
    sheets = [
        context.sheet(
            f"fields{i + 1}",
            contact_sheet([fields[first : first + 2], fields[first + 2 : first + 4]]),
            f"{', '.join(PRESETS[first : first + 4])}: fields of 4 x 4 tiles, four different "
            "ones in an order without period, lit from the upper left",
        )
        for i, first in enumerate((0, half))
    ]
    return "\n".join([
        "`sateen model --surface-out` finds normals and height of a measurement from its lights "
        "([photometric stereo](../theory/photometric_stereo.md)), and tiles that go on for ever "
        f"([Roller](../theory/roller.md)). Measurements of {SIDE} x {SIDE} pixels under 81 lights "
        "with shadow, gloss, interreflection and JPEG; error of normals on average, correlation "
        "of height over all frequencies.", "",
        table(
            ["", "normals, plain", "normals, robust", "height", "seams of height, normals", "tiles", "stored"], lines
        ),
        context.sheet("estimates", estimates,
                      "an image of the measurement; true and found normals, lit from the upper "
                      "left; true and found height, each stretched to its own range"),
        *sheets,
        "Where it fails: gaps between the yarns of knit are black and see few lights, "
        "so their depth is found too small; heights that change over a quarter of the sample and "
        "more drift by errors of the normals that add up (twill, wood). A pit of stone or a flat of "
        "plaster that is a third of the sample is recognised in several tiles.",
    ])  # fmt: skip
