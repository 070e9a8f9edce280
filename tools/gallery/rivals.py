# SPDX-License-Identifier: Apache-2.0
"""One set of images as measured, of a material, and of principal components."""

import json
import re
import shutil
import subprocess

from PIL import Image

from .common import contact_sheet, table

TITLE = "Beside principal components"
SAYS = "the same images from a material of kilobytes and from factorisations of megabytes."
PRESET = "leather"
SHOWN = 4  # of the images that pca_bench writes
SIDE = 160


def make(context):
    source = context.measure(PRESET, "--directions", "coarse")
    material = context.model(source)
    folder = context.scratch / "pca"
    shutil.rmtree(folder, ignore_errors=True)
    bench = context.program.parent.parent / "bench" / "pca_bench"
    report = json.loads(
        subprocess.run([bench, source, folder], check=True, capture_output=True, text=True).stdout
    )
    files = sorted((folder / "measured").glob("*.png"))
    files = files[:: max(1, len(files) // SHOWN)][:SHOWN]
    methods = [f["name"] for f in report["figures"]]
    found = context.run_json("compare", material, source)["directions"]
    columns, captions = [], []
    for file in files:
        angles = tuple(map(int, re.search(r"tl(\d+) pl(\d+) tv(\d+) pv(\d+)", file.stem).groups()))
        light, view = ["{},{}".format(*pair) for pair in (angles[:2], angles[2:])]
        drawn = context.picture("synthesise", material, "--view", view, "--light", light, "--size", 128)
        pictures = [Image.open(folder / m / file.name).convert("RGB") for m in methods]
        measured = Image.open(file).convert("RGB")
        columns.append([p.resize((SIDE, SIDE)) for p in (measured, drawn, *pictures)])
        captions.append("light {}°, {}°\nview {}°, {}°".format(*angles))
    size = material.stat().st_size
    rows = [["sateen", f"{size / 1e6:.3f}", f"{found['delta_e']['mean']:.2f}",
             f"{found['texture']['score']:.2f}"]]  # fmt: skip
    for f in report["figures"]:
        rows.append([f["name"], f"{f['value']:.1f}", f"{f['delta_e of mean colours']:.2f}",
                     f"{f['texture']:.2f}"])  # fmt: skip
    names = ["measured", "sateen", *[m.replace("PCA of ", "PCA of\n").replace(", ", ",\n") for m in methods]]
    return "\n".join([
        "[CAR2] names factorisations of all images together, and of the images of each view, as "
        "its rivals. They keep the sample, pixel by pixel, and enlarge nothing; a material has no "
        "pixels, and any size. Texture score: 1 is as close as two pieces of the image "
        "([quality](../theory/quality.md)).", "",
        table(["", "MB", "ΔE of mean colours", "texture score"], rows),
        context.sheet(
            "images", contact_sheet(list(zip(*columns)), columns=captions, names=names),
            f"{PRESET}, 625 images of 128 x 128", quality=85,
        ),
    ])  # fmt: skip
