# SPDX-License-Identifier: Apache-2.0
"""Pictures of the viewer page in headless Chromium. Needs tools/build_viewer.sh, Node and Chromium."""

import json
import subprocess
import sys

from PIL import Image

from .common import ROOT, contact_sheet, write_jpeg

TITLE = "In the browser"
SAYS = "the viewer page: shapes, views, two materials side by side, on a desk and on a phone."
SOURCES = ("corduroy", "leather", "stone")
MODES = ("combined", "smooth", "relief", "index")
DESK = {"width": 960, "height": 600}
PHONE = {"width": 360, "height": 680, "phone": True}


def wanted(materials):
    """What tools/pictures.mjs shall take, by name."""
    corduroy, leather, stone = materials
    pictures = {
        "desk": {**DESK, "materials": [corduroy], "shape": "cloth"},
        "split": {**DESK, "materials": [leather, stone], "shape": "knot", "dark": True},
        "phone": {**PHONE, "materials": [stone]},
        "controls": {**PHONE, "materials": [leather], "dark": True, "press": ["#toggle"],
                     "shape": "cloth"},
    }  # fmt: skip
    for mode in MODES:
        pictures[mode] = {
            "width": 300, "height": 300, "materials": [corduroy], "mode": mode, "bare": True,
            "set": {"scale": 0.5},
        }  # fmt: skip
    return pictures


def take(context, pictures):
    """PIL images by name, as a browser shows the page."""
    files = {name: context.scratch / f"viewer-{name}.png" for name in pictures}
    takes = [{**options, "file": str(files[name])} for name, options in pictures.items()]
    command = ["node", str(ROOT / "viewer" / "tools" / "pictures.mjs")]
    done = subprocess.run(command, input=json.dumps(takes), capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"make_gallery: error: {' '.join(command)}: {done.stderr.strip()}")
    return {name: Image.open(path).convert("RGB") for name, path in files.items()}


def named_model(context, preset):
    """The page shows a material by the name of what it was made from."""
    measured = context.scratch / "viewer" / f"{preset}.zip"
    measured.parent.mkdir(exist_ok=True)
    if not measured.exists():
        measured.symlink_to(context.measure(preset, "--directions", "coarse"))
    return context.model(measured)


def make(context):
    materials = [named_model(context, name) for name in SOURCES]
    shown = take(context, wanted(list(map(str, materials))))
    write_jpeg(shown["desk"], ROOT / "docs" / "images" / "viewer.jpg")
    sizes = ", ".join(
        f"{name} {material.stat().st_size / 1000:.0f} KB"
        for name, material in zip(SOURCES, materials)
    )
    return "\n".join([
        "`sateen view M.sateen` shows a material in a browser, `sateen export M.sateen -o M.html` writes the same page "
        f"as one file. Presets of the virtual goniometer, 25 views x 25 lights, as materials: {sizes}. "
        "Drawn in software by headless Chromium; how: [the shader](../theory/viewer_shader.md).", "",
        "![Corduroy on a cloth](../images/viewer.jpg)", "",
        "*Corduroy on a cloth that lies over a ball*", "",
        context.sheet("split", shown["split"], "Two materials on one object, leather and stone, in the dark; the line between them is dragged"),
        "## Views", "",
        context.sheet("views", contact_sheet([[shown[m] for m in MODES]], MODES),
                      "Corduroy: texture over relief; texture without relief; relief alone; which subspace each pixel takes"),
        "## On a phone", "",
        context.sheet("phone", contact_sheet([[shown["phone"], shown["controls"]]], ("stone", "leather, controls open")),
                      "A finger turns the object, two move the lamp"),
    ])  # fmt: skip
