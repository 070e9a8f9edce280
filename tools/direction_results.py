# SPDX-License-Identifier: Apache-2.0
"""Materials beside their measurements, by direction: parts of make_results.py."""

import json
import pathlib
import random
import re
import subprocess
import tempfile
import zipfile

KEPT = (("10 %", 0.1), ("1 %", 0.01), ("one image", 0))
IMAGE = re.compile(r"tl(\d+) pl(\d+) tv(\d+) pv(\d+)")
PRESET = ("leather", "--directions", "coarse")  # the measurement made in code


def run(*command):
    return subprocess.run(
        [str(c) for c in command], check=True, capture_output=True, text=True
    ).stdout


def keep(source, target, share):
    """A zip of some images of a zip, at random; of one at most, for 0: seen from above, lit
    from half way. Returns how many."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        angles = {n: tuple(map(int, found.groups())) for n in old.namelist()
                  if (found := IMAGE.search(n))}  # fmt: skip
        if share > 0:
            kept = random.Random(1).sample(sorted(angles), max(1, round(share * len(angles))))
        else:
            kept = [min(sorted(angles), key=lambda n: (angles[n][2], abs(angles[n][0] - 45)))]
        for name in kept:
            new.writestr(name, old.read(name))
    return len(kept)


def compared(program, source, folder, share=None):
    """Of a material of the measurement, or of a share of it: bytes, images, comparison."""
    material, part = folder / "m.sateen", pathlib.Path(source)
    if share is not None:
        part = folder / "part.zip"
        keep(source, part, share)
    made = json.loads(run(program, "model", part, "-o", material, "--json"))
    found = json.loads(run(program, "compare", material, source, "--json"))
    return {"bytes": made["bytes"], "images": made["images"], "seconds": made["seconds"],
            **found["directions"]}  # fmt: skip


def direction_results(build, measurements, say):
    program = build / "bin" / "sateen"
    results = []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        preset = folder / f"{PRESET[0]}.zip"
        run(program, "measure", *PRESET, "-o", preset)
        for source in [*measurements, preset]:
            say(f"directions of {source.stem}")
            results.append({
                "name": source.stem,
                "complete": compared(program, source, folder),
                "pca": json.loads(run(build / "bench" / "pca_bench", source))["figures"],
                "kept": {name: compared(program, source, folder, s) for name, s in KEPT},
            })  # fmt: skip
    return results


def angular_results(build, means, angles):
    report = json.loads(run(build / "bench" / "restoration_bench", means, angles))
    return {"name": means.stem, "figures": report["figures"]}


# --- the page ---------------------------------------------------------------------------


def percent(log_ratio):
    return f"{100 * (2.718281828459045**log_ratio - 1):.0f} %"


def cells(entry):
    texture = entry.get("texture")
    return [
        f"{entry['delta_e']['mean']:.2f}", f"{entry['delta_e']['p95']:.2f}",
        percent(entry["contrast"]),
        f"{texture['score']:.2f} ({texture['pairs_scored']})" if texture else "",
    ]  # fmt: skip


def elevation_lines(results):
    lines = [
        "", "## By elevation", "",
        "`sateen compare MATERIAL MEASUREMENT --json`: textures drawn as every front end draws "
        "them beside each image of the measurement. ΔE: CIEDE2000 of mean colours, mean and 95 % "
        "(must 1.0 and 3 over all). Contrast: how far off, mean. Texture score: 1 is as close as two "
        "pieces of the image; of a random sample, whose size is in brackets.",
    ]  # fmt: skip
    for entry in results:
        whole = entry["complete"]
        lines += [
            "", f"**{entry['name']}**: {whole['pairs']} images, material of {whole['bytes']} "
            "bytes (must 131072)", "",
            "| | view: ΔE | 95 % | contrast | texture | light: ΔE | 95 % | contrast | texture |",
            "|---|" + "--:|" * 8,
        ]  # fmt: skip
        views = {row["theta"]: row for row in whole["by_view"]}
        lights = {row["theta"]: row for row in whole["by_light"]}
        for theta in sorted({*views, *lights}):
            row = [c for side in (views, lights)
                   for c in (cells(side[theta]) if theta in side else 4 * [""])]  # fmt: skip
            lines.append(f"| {theta}° | " + " | ".join(row) + " |")
        for name, key in (("neither grazing", "not_grazing"), ("one at 60° or more", "grazing")):
            lines.append(f"| {name} | " + " | ".join(cells(whole[key])) + " | | | | |")
        lines.append("| **all** | " + " | ".join(cells(whole)) + " | | | | |")
    return lines


def restoration_lines(results):
    lines = [
        "", "## Directions that were not measured", "",
        "Materials of some of the images, at random, and of one (seen from above, lit from about "
        "45°), graded on all images that were left out, beside the nearest image that was kept "
        "(docs/theory/restoration.md). The nearest image has real pixels of that image's size; a "
        "material has none.", "",
        "| | kept | images | bytes | ΔE | 95 % | nearest | 95 % | contrast | nearest | texture "
        "| nearest |", "|---|---|" + "--:|" * 10,
    ]  # fmt: skip
    for entry in results:
        for kept, found in entry["kept"].items():
            ours, near = (cells(found["restored"]), cells(found["restored"]["nearest"]))
            lines.append(
                f"| {entry['name']} | {kept} | {found['images']} | {found['bytes']} | {ours[0]} | "
                f"{ours[1]} | {near[0]} | {near[1]} | {ours[2]} | {near[2]} | {ours[3]} | "
                f"{near[3]} |"
            )
    return lines


def angular_lines(name, figures):
    lines = [
        "", f"## Real mean colours: {name}", "",
        "`restoration_bench`: mean colours of a real measurement, of which a share is known; mean "
        "ΔE of the rest as the material gives it, beside the nearest known pair and barycentric "
        "interpolation over the known lights of the same view.", "",
        "| known | pairs | rank | ΔE | 95 % | nearest | 95 % | barycentric | 95 % |",
        "|---|" + "--:|" * 8,
    ]  # fmt: skip
    for f in figures:
        known = re.search(r"(\d+) %", f["name"]).group(1)

        def cell(key):
            return f"{f[key]:.2f}" if key in f else ""

        lines.append(
            f"| {known} % | {f['pairs known']:.0f} | {f['rank']:.0f} | {f['value']:.2f} | "
            + " | ".join(
                cell(k)
                for k in ("p95", "nearest", "nearest p95", "barycentric", "barycentric p95")
            )
            + " |"
        )
    return lines


def pca_lines(results):
    lines = [
        "", "## Beside principal components", "",
        "`pca_bench`: the factorisations that [CAR2] names as its rivals. They keep the sample and "
        "no more, factors of 2 bytes; errors and times are those of a crop in the middle. Rms: of "
        "sRGB code values, pixel by pixel, which a random field does not have. Texture score: of a "
        "sample of whole images, where the crop is one.",
    ]  # fmt: skip
    for entry in results:
        whole, first = entry["complete"], entry["pca"][0]
        lines += [
            "", f"**{entry['name']}**, crop of {first['crop']:.0f} x {first['crop']:.0f}", "",
            "| | MB | to the material | ΔE of means | texture | rms | seconds |",
            "|---|" + "--:|" * 6,
            f"| sateen | {whole['bytes'] / 1e6:.3f} | 1 | {whole['delta_e']['mean']:.2f} | "
            f"{whole['texture']['score']:.2f} | | {whole['seconds']:.1f} (all) |",
        ]  # fmt: skip
        for f in entry["pca"]:
            times = 1e6 * f["value"] / whole["bytes"]
            texture = f"{f['texture']:.2f}" if "texture" in f else ""
            lines.append(
                f"| {f['name']} | {f['value']:.3g} | {times:.0f} | "
                f"{f['delta_e of mean colours']:.2f} | {texture} | {f['rms of code values']:.1f} "
                f"| {f['seconds for the crop']:.1f} |"
            )
    return lines
