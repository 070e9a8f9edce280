# SPDX-License-Identifier: Apache-2.0
"""Materials of a part of a measurement, drawn for directions that they have not seen."""

import sys

from PIL import Image

from .common import ROOT, contact_sheet, table

sys.path.insert(0, str(ROOT / "tools"))
from direction_results import KEPT, keep  # noqa: E402

TITLE = "Directions that were not measured"
SAYS = "materials of a tenth, a hundredth and one of the images, for views and lights left out."
PRESET = "leather"
PAIRS = [((0, 0), (30, 90)), ((30, 60), (60, 0)), ((60, 30), (30, 180)), ((60, 210), (60, 30))]
SIDE = 160


def make(context):
    source = context.measure(PRESET, "--directions", "coarse")
    materials, rows = {"all": context.model(source)}, []
    for name, share in KEPT:
        part = context.scratch / f"{source.stem}-kept-{share}.zip"
        if not part.exists():
            keep(source, part, share)
        materials[name] = context.model(part)
        found = context.run_json("compare", materials[name], source)["directions"]["restored"]
        near = found["nearest"]
        rows.append([
            name, materials[name].stat().st_size,
            f"{found['delta_e']['mean']:.2f}", f"{near['delta_e']['mean']:.2f}",
            f"{found['texture']['score']:.2f}", f"{near['texture']['score']:.2f}",
        ])  # fmt: skip
    columns = []
    for view, light in PAIRS:
        pictures = [context.measured(source, view, light)]
        for material in materials.values():
            pictures.append(context.picture(
                "synthesise", material, "--view", "{},{}".format(*view),
                "--light", "{},{}".format(*light), "--size", 128,
            ))  # fmt: skip
        columns.append([p.resize((SIDE, SIDE), Image.BICUBIC) for p in pictures])
    captions = ["view {}°, {}°\nlight {}°, {}°".format(*v, *li) for v, li in PAIRS]
    names = ["measured", *(f"of {name}" for name in materials)]
    return "\n".join([
        "[CAR2] restores missing images from the model. Materials of some of 625 images, at "
        "random, graded on all that were left out, beside the nearest image that was kept, which "
        "has pixels ([restoration](../theory/restoration.md)):", "",
        table(["kept", "bytes", "ΔE", "nearest", "texture score", "nearest"], rows),
        context.sheet(
            "restored", contact_sheet(list(zip(*columns)), columns=captions, names=names),
            f"{PRESET}, as measured and as drawn from materials of all, of some, and of one image",
        ),
    ])  # fmt: skip
