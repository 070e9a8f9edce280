# SPDX-License-Identifier: Apache-2.0
"""Originals beside what each random field model draws of them, as published and by default."""

import math
import re

from PIL import Image

from .common import centre, contact_sheet, scaled, table

TITLE = "Random fields"
SAYS = "every field model as the papers print it and as it is fitted by default, beside the original."
PRESETS = ["leather", "stone", "plaster", "wood"]
LIGHT = (45, 90)
FIELDS = ["car2d", "gmrf2d", "car3d", "sar3d"]
# The fields alone: no pattern that repeats, no modulation of bands.
METHODS = {
    f"{field}{' --paper' if paper else ''}": ["--field", field, *(paper or ["--structure", "none"])]
    for field in FIELDS
    for paper in (["--paper"], [])
}
SIDE = 200  # shown of each picture
SHOWN = 145  # pixels of a cell


def cell(picture):
    return scaled(centre(picture, min(SIDE, picture.width, picture.height)), SHOWN)


def from_above(context, name):
    """A preset as one photograph."""
    directions = context.scratch / "from_above.csv"
    directions.write_text(f"theta_i,phi_i,theta_v,phi_v\n{LIGHT[0]},{LIGHT[1]},0,0\n")
    image = context.scratch / f"{name}.png"
    measurement = context.measure(name, "--directions", directions, "--size", 512)
    context.measured(measurement, (0, 0), LIGHT).save(image)
    return image


def failure(notes):
    """What the report says of a paper's estimator, at its worst."""
    worst = {}
    for note in notes:
        number = re.search(r"(spectral radius|1 - A =) (-?[\d.]+)", note)
        if not number:
            continue
        kind, value = number.group(1), float(number.group(2))
        radius = kind == "spectral radius"
        if kind not in worst or (value > worst[kind][1] if radius else value < worst[kind][1]):
            worst[kind] = (worst.get(kind, (0, 0))[0], value)
        worst[kind] = (worst[kind][0] + 1, worst[kind][1])
    text = {"spectral radius": "unstable: {} fields, spectral radius up to {:.2f}",
            "1 - A =": "spectrum not positive: {} fields, 1 - A down to {:.2f}"}  # fmt: skip
    return "; ".join(text[kind].format(*found) for kind, found in worst.items()) or "-"


def make(context):
    rows, scores, failures = [], {}, {}
    for name in PRESETS:
        image = from_above(context, name)
        with Image.open(image) as picture:
            pictures = [cell(picture.convert("RGB"))]
        drawn = context.scratch / "drawn.png"
        for method, options in METHODS.items():
            material = context.scratch / "fields.sateen"
            report = context.run_json("model", image, "-o", material, *options)
            if "--paper" in options:
                failures[name, method] = failure(report["notes"])
            # The infinite plane: what is drawn by recursion as published is so here as well.
            texture = context.picture("synthesise", material, "--size", 512)
            texture.save(drawn)
            pictures.append(cell(texture))
            scores[name, method] = float(context.run("compare", image, drawn).split()[-1])
        rows.append(pictures)
    mean = [math.exp(sum(math.log(scores[n, m]) for n in PRESETS) / len(PRESETS)) for m in METHODS]
    lines = [[name, *(f"{scores[name, m]:.2f}" for m in METHODS)] for name in PRESETS]
    lines.append(["**geometric mean**", *(f"{value:.2f}" for value in mean)])
    as_published = [m for m in METHODS if "--paper" in m]
    return "\n".join([
        "Four surfaces of the virtual goniometer, seen from above, each one photograph, and what each "
        "model draws of it: as published (`--paper`: 3 neighbours, 3 levels, the papers' estimators), and "
        "by default (`--structure none`: the field and its marginal curve alone).", "",
        context.sheet(
            "models", contact_sheet(rows, ["original", *(m.replace("--", "") for m in METHODS)], PRESETS),
            f"{SIDE} x {SIDE} pixels of each",
        ),
        "Texture similarity (1 is as close as two pieces of the original; smaller is better):", "",
        table(["", *METHODS], lines),
        "What the published estimators run into, as the notes of `sateen model --paper` name it:", "",
        table(["", *as_published], [[n, *(failures[n, m] for m in as_published)] for n in PRESETS]),
        "By default the four models are nearly alike: they are fitted to the same covariances, and car3d "
        "and sar3d keep the colours of details. All turn pebbles and grains into clouds of the right "
        "size and contrast, for shapes are in the phases, which no Gaussian field holds.", "",
        "As published, three neighbours reach no further than a few pixels a level, and levels that are "
        "drawn independently add up to less contrast. The pseudo-likelihood of gmrf2d finds spectra that are "
        "not positive; shrunk until they are, their peak is left as a diagonal weave. The least squares of sar3d take "
        "neighbours for independent of the noise, which they are not where a model looks both ways: details are smeared, "
        "and with a diagonal Σ the colours of the planes come apart.",
    ])  # fmt: skip
