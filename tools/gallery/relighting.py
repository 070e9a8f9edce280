# SPDX-License-Identifier: Apache-2.0
"""De-lit textures times relit range maps beside the measurement; a relit photograph."""

import math

from PIL import Image

from .common import contact_sheet, table

TITLE = "Relighting"
SAYS = "smooth textures without shading, relit range maps, and their product beside measurements."
PRESETS = ["corduroy", "stone"]
ABOVE = (0, 0)
LIGHTS = [(30, 60), (60, 54), (60, 324)]  # of the UBO2003 grid
PHOTOGRAPH = ("stone", (45, 120))
AZIMUTHS = [120, 220, 300, 40]
SIDE = 128


def degrees(direction):
    return f"{direction[0]},{direction[1]}"


def relit(normals, light):
    """max(0, n·l) of a 16-bit or 8-bit normal map, of mean 0.4, as sRGB grey."""
    theta, phi = (math.radians(a) for a in light)
    x, y, z = math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)
    values = [
        max(0.0, x * (r / 127.5 - 1) + y * (g / 127.5 - 1) + z * (b / 127.5 - 1))
        for r, g, b in normals.convert("RGB").getdata()
    ]
    scale = 0.4 * len(values) / max(1e-9, sum(values))

    def code(v):
        v = min(1, v * scale)
        return round(255 * (12.92 * v if v < 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055))

    picture = Image.new("L", normals.size)
    picture.putdata([code(v) for v in values])
    return picture


def of_measurement(context, preset):
    """Rows of pictures and what was explained."""
    source = context.measure(preset, "--size", SIDE, "--directions", "lights")
    material = context.scratch / f"relighting-{preset}.sateen"
    report = context.run_json("model", source, "-o", material)
    maps = context.scratch / f"relighting-{preset}"
    size = ["--size", f"{SIDE}x{SIDE}"]
    context.run("synthesise", material, "-o", maps, "--maps", *size)
    with Image.open(maps / "normal.png") as image:
        normals = image.convert("RGB")
    rows = []
    for light in LIGHTS:
        directions = ["--view", degrees(ABOVE), "--light", degrees(light)]
        drawn = context.scratch / "drawn.png"
        subspace = context.run_json(
            "synthesise", material, "-o", drawn, *directions, "--tileable", *size
        )["subspace"]
        rows.append([
            context.measured(source, ABOVE, light),
            context.picture("synthesise", material, "--subspace", subspace, "--tileable", *size),
            relit(normals, light),
            Image.open(drawn).convert("RGB"),
        ])  # fmt: skip
    surface = report["surface"]
    return rows, [
        preset, f"{100 * surface['shading_share']:.0f} %", "yes" if surface["delit"] else "no",
        f"{report['bytes'] / 1e3:.0f} KB",
    ]  # fmt: skip


def of_photograph(context):
    preset, light = PHOTOGRAPH
    source = context.measure(preset, "--size", SIDE, "--directions", "lights")
    lights = [(45, azimuth) for azimuth in AZIMUTHS]
    photograph = context.scratch / "photograph.png"
    context.measured(source, ABOVE, light).save(photograph)
    rows = [[context.measured(source, ABOVE, l) for l in lights]]
    reports = []
    for known in (["--surface-light", degrees(light)], []):
        material = context.scratch / "photograph.sateen"
        reports.append(
            context.run_json("model", photograph, "-o", material, "--surface", "shading", *known)
        )
        rows.append([
            context.picture(
                "synthesise", material, "--light", degrees(l), "--tileable", "--size", SIDE
            )
            for l in lights
        ])  # fmt: skip
    return rows, reports


def make(context):
    parts, figures = [], []
    for preset in PRESETS:
        rows, line = of_measurement(context, preset)
        figures.append(line)
        sheet = contact_sheet(
            rows,
            columns=["measured", "smooth texture", "relit range map", "drawn"],
            names=[f"{t}°, {p}°" for t, p in LIGHTS],
        )
        parts.append(context.sheet(
            preset, sheet,
            f"{preset}, seen from above, light by row: an image of the measurement, the de-lit "
            "texture, the relit range map, what `synthesise --view --light --tileable` draws",
        ))  # fmt: skip
    rows, reports = of_photograph(context)
    estimated = reports[1]["surface"]["light"]
    sheet = contact_sheet(
        rows,
        columns=[f"light at {a}°" for a in AZIMUTHS],
        names=["measured", "from one,\nlight known", "from one,\nlight found"],
    )
    parts.append("## One photograph\n")
    parts.append(context.sheet(
        "photograph", sheet,
        f"{PHOTOGRAPH[0]}: four images of a measurement, and what a material of the first one "
        "alone (`--surface shading`) shows under the four lights, with the light known and "
        f"estimated at {estimated[0]:.0f}°, {estimated[1]:.0f}° (true {PHOTOGRAPH[1][0]}°, "
        f"{PHOTOGRAPH[1][1]}°)",
    ))  # fmt: skip
    return "\n".join([
        "Smooth textures of materials without a pattern are fitted to images divided by the shading of the range map, and drawn "
        "textures are multiplied by it: [delighting](../theory/delighting.md).", "",
        table(["", "of the contrast explained by shading", "divided by it", "material"], figures),
        *parts,
    ])  # fmt: skip
