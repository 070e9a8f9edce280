# SPDX-License-Identifier: Apache-2.0
"""Pictures of a material beside pictures ray traced from the maps it was measured from.

Of the measurements given, each with its true maps in the folder NAME_truth beside it; without
one, of a preset.
"""

import json
import pathlib
import re
import subprocess
import sys

from PIL import Image

from .common import contact_sheet, table

TITLE = "Material and truth"
SAYS = "objects rendered from a material beside objects ray traced from the maps it was measured from."
PRESETS = {"leather": ["--directions", "coarse"]}
SCENES = [("plane", "30,200"), ("plane", "65,20"), ("sphere", "40,225"), ("sphere", "70,330")]


def scales(measurement):
    """Folder of the maps, lowest and highest height, exposure."""
    maps = measurement.parent / f"{measurement.stem}_truth"
    if (maps / "measurement.json").exists():
        manifest = json.loads((maps / "measurement.json").read_text())
        truth = manifest["truth"]
        return maps, truth["low"], truth["high"], manifest["radiometry"]["exposure"]
    text = (maps / "truth.txt").read_text()
    number = lambda name: float(re.search(rf"^{name}\s+(\S+)", text, re.M)[1])
    return maps, number("height_low"), number("height_high"), number("exposure")


def make(context):
    bench = context.program.parent.parent / "bench" / "truth_bench"
    if not bench.exists():
        sys.exit(f"make_gallery: error: found no {bench}, expected a build of truth_bench")
    sources = [(path.stem, path) for path in context.measurements]
    sources = sources or [(name, context.measure(name, *o)) for name, o in PRESETS.items()]
    parts = [
        "Left of each pair: the measured set's own maps - height, normals, colour - ray traced "
        "point for point with masking, shadows and parallax, as the goniometer does, without the "
        "light that parts of the surface throw on each other. Right: the material, from its file "
        "alone. Camera, light and exposure are the same; the texture of the material is a new "
        "one, drawn, so places differ and looks should not.", "",
    ]  # fmt: skip
    rows = []
    for name, source in sources:
        material = context.model(source)
        out = context.scratch / "truth"
        out.mkdir(exist_ok=True)
        maps, low, high, exposure = scales(pathlib.Path(source))
        scenes = [word for scene in SCENES for word in scene]
        command = [str(bench), maps, low, high, exposure, material, 256, out, *scenes]
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"make_gallery: error: {done.stderr.strip()}")
        figures = json.loads(done.stdout)["figures"]
        rows.append([name, material.stat().st_size, *(f"{f['value']:.1f}" for f in figures)])
        pictures = [
            Image.open(out / f"{k}_{kind}.png").convert("RGB")
            for k in range(len(SCENES)) for kind in ("traced", "material")
        ]  # fmt: skip
        pictures = [p.resize((230, 230), Image.LANCZOS) for p in pictures]
        sheet = contact_sheet(
            [pictures[:4], pictures[4:]], columns=["traced from the maps", "the material"] * 2
        )
        lights = "; ".join(f"{mesh}, light {light.replace(',', '°, ')}°" for mesh, light in SCENES)
        parts.append(context.sheet(name, sheet, f"{name}: {lights}"))
    head = ["", "bytes"] + [f"{mesh} {light}" for mesh, light in SCENES]
    parts += ["Mean colour difference (CIEDE2000) of blocks of 32 x 32 pixels:", "", table(head, rows)]
    return "\n".join(parts)
