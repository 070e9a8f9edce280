# SPDX-License-Identifier: Apache-2.0
"""The kettle and the conch of [SAR], dressed in materials."""

from . import shapes
from .common import contact_sheet

TITLE = "Kettle and conch"
SAYS = "the objects of [SAR] dressed in materials, smooth and with their relief."
PRESETS = ["leather", "plain-weave", "corduroy"]
SIDE = 256


def make(context):
    files = {}
    for name in ("kettle", "conch"):
        files[name] = context.scratch / f"{name}.obj"
        files[name].write_text(getattr(shapes, name)())
    materials = {
        name: context.model(context.measure(name, "--directions", "coarse")) for name in PRESETS
    }
    views = {"kettle": "66,300", "conch": "70,250"}
    rows = []
    for name, path in files.items():
        common = ["--mesh", path, "--size", SIDE, "--texture", 256, "--scale", 1]
        common += ["--view", views[name], "--light", "45,240", "--light", "70,20"]
        pictures = [context.picture("render", m, *common) for m in materials.values()]
        pictures.append(
            context.picture("render", materials["leather"], *common, "--displacement")
        )
        rows.append([p.resize((SIDE, SIDE)) for p in pictures])
    sheet = contact_sheet(rows, columns=[*PRESETS, "leather, --displacement"])
    sizes = ", ".join(f"{n} {m.stat().st_size / 1000:.0f} KB" for n, m in materials.items())
    return "\n".join([
        "[SAR] shows its materials on a kettle and on a conch. These two are made by a script "
        "(`tools/gallery/shapes.py`) and drawn by `sateen render --mesh FILE.obj` under two distant "
        "lights.", "",
        context.sheet(
            "objects", sheet, f"Materials of 25 views x 25 lights: {sizes}", quality=88
        ),
    ])  # fmt: skip
