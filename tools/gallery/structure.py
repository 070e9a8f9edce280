# SPDX-License-Identifier: Apache-2.0
"""Weave, knit and brick beside the random field alone and two rivals that keep the
exemplar; and what none of it can hold."""

import io
import json
import subprocess
import zipfile

from PIL import Image

from .common import contact_sheet, say, table

TITLE = "Structure"
SAYS = "weave, knit and brick in kilobytes, beside rivals that keep the exemplar; and where it fails."
SIDE = 150
PRESETS = ("plain-weave", "twill")
CLOTHS = (*PRESETS, "knit", "houndstooth")
WALLS = ("brick", "bricks", "hexagons")
FAILS = ("pebbles", "cracks")
KINDS = (
    ("original", "{} original"), ("field alone", "{} none"), ("Sateen", "{}"),
    ("random phase", "{} random phase"), ("tiling and\nblending", "{} tiling and blending"),
)  # fmt: skip


def photograph(context, preset):
    """One picture of a preset, seen and lit from above a little aside."""
    path = context.scratch / "structure" / f"{preset}.png"
    if not path.exists():
        path.parent.mkdir(exist_ok=True)
        directions = context.scratch / "structure" / "one.csv"
        directions.write_text("theta_i,phi_i,theta_v,phi_v\n30,60,0,0\n")
        archive = context.measure(
            preset, "--directions", directions, "--size", "512", "--format", "png",
            "--interreflection", "0",
        )
        with zipfile.ZipFile(archive) as pictures:
            name = next(n for n in pictures.namelist() if n.endswith(".png"))
            Image.open(io.BytesIO(pictures.read(name))).convert("RGB").save(path)
    return path


def make(context):
    bench = context.program.parent.parent / "bench" / "structure_bench"
    folder = context.scratch / "structure" / "drawn"
    names = [photograph(context, preset) for preset in PRESETS]
    patterns = [n for n in (*CLOTHS, *WALLS, *FAILS) if n not in PRESETS]
    names += [f"pattern:{name}" for name in patterns]
    say("structure_bench")
    command = [bench, "--rivals", "--seeds", "2", "--sizes", "512", "-o", folder, *names]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    found = {t["texture"]: t for t in json.loads(done.stdout)["textures"]}

    def part(name):
        path = folder / f"{name}.png"
        if not path.exists():
            return None
        with Image.open(path) as image:
            return image.convert("RGB").crop((0, 0, SIDE, SIDE))

    def sheet(names):
        rows = [[part(form.format(name)) for _, form in KINDS] for name in names]
        for name, row in zip(names, rows):
            row[1] = row[1] or row[2]  # nothing is found: they are the same
        return contact_sheet(rows, [caption for caption, _ in KINDS], names)

    def cells(name):
        t = found[name]
        auto, none = t["auto"], t.get("none", t["auto"])
        what = [w for w, key in (("pattern", "found"), ("modulation", "modulated")) if t[key]]
        return [
            name, " and ".join(what) or "neither",
            *(f"{by['score']:.2f}" for by in (none, auto, t["random phase"], t["tiling and blending"])),
            *(f"{none[key]:.2f} / {auto[key]:.2f}" for key in ("gradient_kurtosis", "blob")),
            f"{none['patches']:.3f} / {auto['patches']:.3f}",
            auto["bytes"],
        ]  # fmt: skip

    head = ["", "found", "field alone", "Sateen", "random phase", "tiling and blending",
            "gradient kurtosis", "blobs", "patches", "bytes"]  # fmt: skip

    def section(title, text, name, names):
        return (
            f"## {title}\n\n{text}\n\n"
            + context.sheet(name, sheet(names), f"{title}: 150 x 150 pixels of each")
            + "\n" + table(head, [cells(n) for n in names]) + "\n"
        )  # fmt: skip

    return (
        "Every picture is made in code: presets of `sateen measure` under one light, and patterns "
        "of `tests/support/patterns.hpp`, 512 x 512 pixels. *Field alone* is `--structure none`. "
        "The rivals keep the picture itself, about 0.8 MB. Scores are those of `sateen compare` (1 "
        "is as close as two pieces of the original), mean of two seeds; gradient kurtosis, blobs "
        "and patches (field alone / Sateen) are numbers that nothing was fitted to, 0 is equality. "
        "No constant of the analysis was set on any of these.\n\n"
        + section("Cloth", "A mean cell on a lattice that bends at random.", "cloth", CLOTHS)
        + section("Walls", "*bricks* has a shade for every brick. The cell is the mean of all, so "
                  "that drawn bricks have one shade, clouded by the residual: decision 5.",
                  "walls", WALLS)
        + section("Where it fails", "Objects: pebbles, cracks and closed cells are neither periodic "
                  "nor a matter of local contrast. What is drawn has their colours, sizes and "
                  "unevenness, and none of their shapes; modulated bands put the detail where it is dark, which is "
                  "all that they can. Closed cells of leather and fibres of wool fail alike.",
                  "fails", FAILS)
    )  # fmt: skip
