#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the benchmarks of a build, keeps bench/results.json, writes docs/results.md.

    tools/make_results.py [--build build/dev] [--measurement ZIP...] [--side 32768]
                          [--pictures IMAGE...] [--angular MEANS.csv ANGLES.csv]
    tools/make_results.py --only-write      docs/results.md from bench/results.json
"""

import argparse
import datetime
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import direction_results as directions

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "bench" / "results.json"
PAGE = ROOT / "docs" / "results.md"


def output_of(*command):
    return subprocess.run(
        [str(c) for c in command], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout


def say(text):
    print(f"make_results: {text}", file=sys.stderr, flush=True)


# --- where ------------------------------------------------------------------------------


def machine():
    cpu = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text())
    memory = re.search(r"MemTotal:\s*(\d+)", pathlib.Path("/proc/meminfo").read_text())
    return {
        "processor": cpu.group(1) if cpu else "unknown",
        "threads": os.cpu_count(),
        "memory_gb": round(int(memory.group(1)) / 2**20) if memory else None,
        "load_before": round(os.getloadavg()[0], 1),
    }


def build_facts(build):
    cache = (build / "CMakeCache.txt").read_text()
    found = dict(re.findall(r"^(CMAKE_CXX_COMPILER|CMAKE_BUILD_TYPE):\w+=(.*)$", cache, re.M))
    version = output_of(found["CMAKE_CXX_COMPILER"], "--version").splitlines()[0]
    commit = output_of("git", "rev-parse", "--short", "HEAD").strip()
    changed = output_of("git", "status", "--porcelain", "--", "src", "include", "bench")
    return {
        "compiler": version,
        "build_type": found["CMAKE_BUILD_TYPE"],
        "commit": commit + (" with changes" if changed.strip() else ""),
        "date": datetime.date.today().isoformat(),
    }


# --- what -------------------------------------------------------------------------------


def figure(name, value, unit, limit, bound="at_most", **details):
    ok = value <= limit if bound == "at_most" else value >= limit
    ratio = round(value / limit, 3)
    return {
        "name": name, "value": value, "unit": unit, bound: limit, "ratio": ratio, "ok": ok,
        **details,
    }  # fmt: skip


def fft_figures(report):
    for entry in report["fft"]:
        if entry["size"] in (512, 1024):
            yield figure(
                f"transform of {entry['size']} x {entry['size']} to FFTW, measured plans",
                entry["ratio"], "x", entry["limit"],
                forward_ms=entry["forward_ms"], inverse_ms=entry["inverse_ms"],
            )  # fmt: skip


def noise_figures(report):
    for target, entry in report["targets"].items():
        if target == "AVX2":
            yield figure(
                "normals a second, AVX2, of a processor of 2.5 GHz",
                entry["gnormals_per_s"], "G/s", report["limit_avx2"]["gnormals_per_s"],
                "at_least", cycles_per_normal=entry["cycles_per_normal"],
            )  # fmt: skip


def recursion_figures(report):
    for taps, entry in report["taps"].items():
        yield figure(
            f"car2d recursion of {taps} neighbours, 512 x 512, to its noise",
            entry["texture_to_noise"], "x", report["limit_texture_to_noise"],
            noise_ms=entry["noise_ms"], texture_ms=entry["texture_ms"],
        )  # fmt: skip


def own_figures(report):
    return report["figures"]


def timed(command):
    """(seconds of processor time, peak megabytes, seconds on the wall) of a program."""
    start = time.monotonic()
    process = subprocess.Popen([str(c) for c in command], stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"make_results: error: {' '.join(map(str, command))} failed")
    wall = time.monotonic() - start
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, wall


def program_figures(program, side):
    """The program writes a texture larger than memory to a PNG."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        photograph, material, png = folder / "p", folder / "p.sateen", folder / "t.png"
        sys.path.insert(0, str(ROOT / "tests" / "cli"))
        from support import photograph as make_photograph

        photograph.write_bytes(make_photograph(256, 256))
        timed([program, "model", photograph, "-o", material])
        draw = [program, "synthesise", material, "-o", png, "--threads", "1", "--size"]
        small = min(timed([*draw, 2048])[0] for _ in range(3)) / 2048**2
        seconds, memory, wall = timed([*draw, side])
        size = f"{side} x {side}"
        yield figure(
            f"program to PNG, time a pixel of {size} to that of 2048 x 2048",
            round(seconds / side**2 / small, 3), "x", 1.3,
            ns_a_pixel=round(1e9 * seconds / side**2, 1), wall_s=round(wall, 1),
            file_mb=round(png.stat().st_size / 2**20),
        )  # fmt: skip
        yield figure(f"program to PNG, peak memory of {size}", round(memory), "MB", 300)


def run_all(build, measurement, side, only=()):
    """All sections, or those of these titles."""
    figures = []

    def add(title, command, read):
        if only and title not in only:
            return
        program = build / "bench" / command[0]
        if not program.exists():
            say(f"{command[0]} is not built, left out")
            return
        say(command[0])
        report = json.loads(output_of(program, *command[1:]))
        figures.append({"title": title, "figures": list(read(report))})

    add("Kernels: Fourier transform", ["fft_bench"], fft_figures)
    add("Kernels: noise", ["noise_bench"], noise_figures)
    add("Kernels: recursion", ["causal_recursion_bench"], recursion_figures)
    add("Drawing", ["synthesis_bench", side], own_figures)
    add("Modelling", ["analysis_bench", *measurement], own_figures)
    if not only or "The program" in only:
        say("sateen")
        program = list(program_figures(build / "bin" / "sateen", side))
        figures.append({"title": "The program", "figures": program})
    return figures


def run_again(results, build, measurement, side, titles):
    """Puts sections measured now in the place of those of the same titles, with what they are of."""
    known = {section["title"]: section for section in results["sections"]}
    for section in run_all(build, measurement, side, titles):
        facts = build_facts(build)
        known[section["title"]].update(
            figures=section["figures"],
            measured_again=f"Commit {facts['commit']}, {facts['date']}, load "
            f"{round(os.getloadavg()[0], 1)}.",
        )


# --- pictures ---------------------------------------------------------------------------

MODELS = ["car2d", "gmrf2d", "car3d", "sar3d"]
ORDERS = [2, 4, 6]
LEVELS = [1, 3, 5]
SWEPT = 2  # pictures, the first of those given, of which everything is tried


def score(program, picture, options):
    """Similarity to the picture of a texture of 512 x 512 of its model."""
    with tempfile.TemporaryDirectory() as folder:
        material, texture = f"{folder}/m.sateen", f"{folder}/t.png"
        output_of(program, "model", picture, "-o", material, *options)
        output_of(program, "synthesise", material, "-o", texture, "--tileable")
        return json.loads(output_of(program, "compare", picture, texture, "--json"))["total"]


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def model_scores(program, pictures):
    """Mean scores without periodic layer: by model and order, and by model and levels."""

    def mean(model, order, levels):
        options = ["--field", model, "--neighbourhood", f"order:{order}"]
        options += ["--levels", str(levels), "--structure", "none"]
        return geometric_mean([score(program, p, options) for p in pictures])

    rows = []
    for model in MODELS:
        say(f"scores of {model}")
        rows.append({
            "model": model,
            "by_order": {o: mean(model, o, 5) for o in ORDERS},
            "by_levels": {levels: mean(model, 6, levels) for levels in LEVELS},
        })  # fmt: skip
    return rows


PATTERNS = ("brick", "bricks", "knit", "twill", "houndstooth", "tiles", "corrugation", "hexagons")


def structure_results(build, pictures):
    say("structure_bench")
    names = [*pictures, *(f"pattern:{name}" for name in PATTERNS)]
    bench = [build / "bench" / "structure_bench", "--rivals"]
    return json.loads(output_of(*bench, *names))["textures"]


def picture_results(build, pictures):
    say("rivals_bench")
    rivals = json.loads(output_of(build / "bench" / "rivals_bench", *pictures))
    say("validity_bench")
    validity = output_of(build / "bench" / "validity_bench", *pictures[:SWEPT]).splitlines()
    return {
        "rivals": rivals,
        "validity": [json.loads(line) for line in validity],
        "swept": [p.stem for p in pictures[:SWEPT]],
        "models": model_scores(build / "bin" / "sateen", pictures[:SWEPT]),
        "structure": structure_results(build, pictures),
    }


def rival_lines(rivals):
    methods = [entry["method"] for entry in rivals["mean"]]
    lines = [
        "", "## Beside its rivals", "",
        "`rivals_bench`: texture similarity (1 is as close as two pieces of the photograph; "
        "smaller is better), results of 512 x 512, one seed. Bytes: what must be kept to draw "
        "again.", "",
        "| | " + " | ".join(methods) + " |", "|---|" + "--:|" * len(methods),
    ]  # fmt: skip
    textures = {}
    for entry in rivals["textures"]:
        textures.setdefault(entry["texture"], {})[entry["method"]] = entry["score"]
    for texture, scores in textures.items():
        cells = [f"{scores[m]:.2f}" if m in scores else "" for m in methods]
        lines.append(f"| {texture} | " + " | ".join(cells) + " |")
    for key, name, form in (
        ("score", "**geometric mean**", "{:.2f}"), ("seam", "seam ratio", "{:.2f}"),
        ("seconds", "seconds", "{:.2f}"), ("bytes", "bytes", "{:.0f}"),
    ):  # fmt: skip
        cells = [form.format(entry[key]) for entry in rivals["mean"]]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    mean = {entry["method"]: entry["score"] for entry in rivals["mean"]}
    lines += [
        "",
        f"To random phase: {mean['sateen'] / mean['random phase']:.2f} (must be at most 1.05); "
        f"to paper mode: {mean['sateen'] / mean['sateen --paper']:.2f} (at most 0.70).",
    ]
    return lines


# Of the numpy prototype, column E, mean of four seeds.
PROTOTYPE = {"fabric": 1.77, "wool_albedo": 1.26, "stone": 1.20, "grass": 1.09, "wood": 1.07}


def structure_lines(textures):
    """The periodic layer and the modulation of bands; a pair is without / with."""
    lines = [
        "", "## Structure", "",
        "`structure_bench --rivals`: the 512 x 512 pixels at the top left, of patterns made in code "
        "too where they are listed. Geometric mean of four seeds, and for patterns of "
        "three tori near 512, 448 and 576. Gaussian: `--structure none`; Sateen: default; random phase "
        "and tiling and blending keep the exemplar; prototype: column E of the numpy prototype, whose "
        "score divides otherwise (decision 7), so that it can only be compared roughly. Targets are its column and "
        "never more than the Gaussian.", "",
        "| | found | Gaussian | Sateen | random phase | tiling and blending | prototype |",
        "|---|---|--:|--:|--:|--:|--:|",
    ]  # fmt: skip

    def score(texture, key):
        return f"{texture[key]['score']:.2f}" if key in texture else ""

    for t in textures:
        what = ", ".join(
            w for w, key in (("pattern", "found"), ("modulation", "modulated")) if t[key]
        )
        none = score(t, "none") or score(t, "auto")
        cells = [
            what or "neither", none, f"**{score(t, 'auto')}**", score(t, "random phase"),
            score(t, "tiling and blending"), f"{PROTOTYPE[t['texture']]:.2f}" if t["texture"] in PROTOTYPE else "",
        ]  # fmt: skip
        lines.append(f"| {t['texture']} | " + " | ".join(cells) + " |")
    lines += [
        "", "What it costs, and numbers that nothing was fitted to (0 is equality; smaller is "
        "better), Gaussian / Sateen. Bytes of the file, and of the parts before compression; "
        "seconds of analysis and milliseconds of drawing exactly 512 x 512, of processor time on one "
        "thread, which other work of the machine lengthens.", "",
        "| | gradient kurtosis | blobs | patches | bytes | pattern | modulation | analysis, s | drawing, ms | strain |",
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]  # fmt: skip
    for t in textures:
        if "none" not in t:
            continue
        none, auto = t["none"], t["auto"]

        def pair(key, form, none=none, auto=auto):
            return f"{none[key]:{form}} / {auto[key]:{form}}"

        cells = [
            pair("gradient_kurtosis", ".2f"), pair("blob", ".2f"), pair("patches", ".3f"),
            pair("bytes", "d"), str(auto["structure_bytes"]), str(auto["modulation_bytes"]),
            pair("analysis_s", ".1f"), pair("drawing_ms", ".0f"), f"{auto['strain']:.3f}",
        ]  # fmt: skip
        lines.append(f"| {t['texture']} | " + " | ".join(cells) + " |")
    return lines


def model_lines(models, swept):
    head = [f"order {o}" for o in ORDERS] + [f"{n} levels" for n in LEVELS]
    lines = [
        "", "## By model, order and levels", "",
        f"Geometric mean of the scores of {' and '.join(swept)}, without periodic layer; orders "
        "at 5 levels, levels at order 6.", "",
        "| | " + " | ".join(head) + " |", "|---|" + "--:|" * len(head),
    ]  # fmt: skip
    for row in models:
        cells = [*row["by_order"].values(), *row["by_levels"].values()]
        lines.append(f"| {row['model']} | " + " | ".join(f"{c:.2f}" for c in cells) + " |")
    return lines


def validity_lines(validity, pictures):
    swept = [pathlib.Path(name).stem for name in dict.fromkeys(pictures)]
    lines = [
        "", "## No field is invalid", "",
        "`validity_bench`: orders 1 to 8, levels 1 to 5, each on the torus at 64, 81, 250 or 1000 x "
        "640, and at 97, 333, 999 x 639 or in a window of 1000 x 640 of the infinite plane; crops of 256 x "
        f"256 of {' and '.join(swept)}, no periodic layer. A window's variance scatters about the "
        "field's 1, the more the larger its clouds: invalid is one beyond 5 % and beyond 4 standard errors "
        "of its estimate. A seam is a wrap that stands out for 3 of 5 seeds.", "",
        "| model | textures | not finite | seams | invalid variances | beyond 5 %: torus | plane "
        "| worst: torus | plane |", "|---|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]  # fmt: skip
    for model in MODELS:
        rows = [row for row in validity if row["model"] == model]
        off = [row["variance_beyond_5_percent"] for row in rows]
        worst = {
            where: max(
                (row["worst_variance"][where] for row in rows), key=lambda v: abs(math.log(v))
            )
            for where in ("torus", "plane")
        }
        counts = ("textures", "not_finite", "seams", "beyond_4_standard_errors")
        cells = [
            *(sum(row[key] for row in rows) if key in rows[0] else "not judged" for key in counts),
            *(sum(o[where] for o in off) for where in ("torus", "plane")),
            f"{worst['torus']:.3f}", f"{worst['plane']:.3f}",
        ]  # fmt: skip
        lines.append(f"| {model} | " + " | ".join(map(str, cells)) + " |")
    return lines


# --- the page ---------------------------------------------------------------------------


def number(value):
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def table(figures):
    lines = ["| what | measured | must | met | |", "|---|--:|--:|:-:|---|"]
    known = {"name", "value", "unit", "at_most", "at_least", "ratio", "ok"}
    for f in figures:
        bound = "≤" if "at_most" in f else "≥"
        limit = f.get("at_most", f.get("at_least"))
        unit = "" if f["unit"] == "x" else " " + f["unit"]
        times = " x" if f["unit"] == "x" else ""
        rest = ", ".join(
            f"{k.replace('_', ' ')} {number(v)}" for k, v in f.items() if k not in known
        )
        lines.append(
            f"| {f['name']} | {number(f['value'])}{times}{unit} | {bound} {number(limit)}"
            f"{times}{unit} | {'yes' if f['ok'] else '**no**'} | {rest} |"
        )
    return lines


# What [SAR, table 1] and [CAR2] print for the model nearest to each of ours: analysis of
# 800 x 800 and synthesis of 512 x 512 in seconds, 3 neighbours.
PRINTED = {
    "car2d": (None, None), "gmrf2d": (3.9, 2.5), "car3d": (0.55, 0.15), "sar3d": (0.25, 1.35),
}  # fmt: skip
SUBSPACES_PRINTED = {"car2d": 3, "car3d": 6, "gmrf2d": 16}


def beside_the_papers(sections):
    """Rows of (what, ours, theirs)."""
    found = {f["name"]: f for s in sections for f in s["figures"]}

    def time(name, key, scale):
        value = found.get(name, {}).get(key)
        return "not measured" if value is None else number(scale * value)

    def printed(seconds):
        return "-" if seconds is None else number(1e3 * seconds)

    lines = [
        "Milliseconds, one thread of the processor above. Printed: [SAR, table 1], 3 neighbours, "
        "two dual-core Pentiums of 2.8 GHz; their GMRF is three-dimensional. As published: `--paper`, "
        "3 neighbours, 3 levels. Default: evidence to order 6, 5 levels, marginal curves, search for a "
        "pattern; must be 1000 at most.", "",
        "| | analysis of 800 x 800, default | as published | printed | colour texture of 512 x 512, "
        "default | to noise and transforms | printed |", "|---|--:|--:|--:|--:|--:|--:|",
    ]  # fmt: skip
    for model in MODELS:
        analysis = f"photograph of 800 x 800, {model}"
        texture = f"{model} texture of 512 x 512, spectral, to noise and transforms"
        ratio = time(texture, "value", 1)
        lines.append(
            f"| {model} | {time(analysis, 'value', 1e3)} | {time(analysis, 'as_published_s', 1e3)} "
            f"| {printed(PRINTED[model][0])} | {time(texture, 'texture_ms', 1)} "
            f"| {ratio + ' x' if ratio != 'not measured' else ratio} | {printed(PRINTED[model][1])} |"
        )
    fifteen = time("15 subspaces of 512 x 512, two threads", "one_thread_ms", 1)
    recursion = time("car2d recursion of 3 neighbours, 512 x 512, to its noise", "texture_ms", 1)
    lines += [
        "", f"By causal recursion a car2d texture of 512 x 512 and 3 levels takes {recursion} ms. "
        f"15 subspaces of 512 x 512 take {fifteen} ms on one thread; [CAR2] prints "
        + ", ".join(f"{s} s for {m}" for m, s in SUBSPACES_PRINTED.items())
        + " on an Athlon of 1.9 GHz.",
    ]  # fmt: skip
    return lines


def page(results):
    m, b = results["machine"], results["build"]
    lines = [
        "# Measured",
        "",
        "Made by one command, after `./test` has built the preset `dev`:",
        "",
        "    tools/make_results.py --measurement MEASUREMENT.zip... --pictures PICTURE... "
        "--angular MEANS.csv ANGLES.csv",
        "",
        "It runs the programs of `bench/`, keeps what they print in `bench/results.json`, and "
        "writes this page from it.",
        "Without `--measurement` the figures of a whole measurement are left out, without "
        "`--pictures` the scores, without `--angular` real mean colours.",
        "",
        "Figures marked x are ratios of two times measured in one run, each the shortest of "
        "several, in processor time of one thread unless said. What must be reached is beside "
        "them.",
        "",
        f"{m['processor']}, {m['threads']} threads, {m['memory_gb']} GB, load "
        f"{m['load_before']} before; {b['compiler']}, {b['build_type']}; commit {b['commit']}; "
        f"{b['date']}.",
    ]
    for section in results["sections"]:
        lines += ["", f"## {section['title']}", ""]
        if again := section.get("measured_again"):
            lines += [again, ""]
        lines += table(section["figures"])
    lines += ["", "## Beside the papers", "", *beside_the_papers(results["sections"])]
    if pictures := results.get("pictures"):
        lines += rival_lines(pictures["rivals"])
        if structure := pictures.get("structure"):
            lines += structure_lines(structure)
        if models := pictures.get("models"):
            lines += model_lines(models, pictures["swept"])
        if validity := pictures.get("validity"):
            lines += validity_lines(validity, [row["picture"] for row in validity])
    if found := results.get("directions"):
        lines += directions.elevation_lines(found) + directions.restoration_lines(found)
        lines += directions.pca_lines(found)
    if angular := results.get("angular"):
        lines += directions.angular_lines(angular["name"], angular["figures"])
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "dev")
    parser.add_argument("--measurement", type=pathlib.Path, nargs="+", default=[])
    parser.add_argument("--angular", type=pathlib.Path, nargs=2, default=[])
    parser.add_argument("--only", nargs="+", default=[], metavar="TITLE", help="sections of timings")
    parser.add_argument("--only-directions", action="store_true", help="keep all other results")
    parser.add_argument("--pictures", type=pathlib.Path, nargs="+", default=[])
    parser.add_argument("--side", type=int, default=32768)
    parser.add_argument("--only-write", action="store_true")
    arguments = parser.parse_args()
    if not arguments.only_write:
        build = arguments.build.resolve()
        measurements = [m.resolve() for m in arguments.measurement]
        if arguments.only_directions or arguments.only:
            results = json.loads(RESULTS.read_text())
            if arguments.only:
                run_again(results, build, measurements[:1], arguments.side, arguments.only)
        else:
            results = {
                "machine": machine(),
                "build": build_facts(build),
                "sections": run_all(build, measurements[:1], arguments.side),
            }
        if arguments.pictures and not arguments.only_directions and not arguments.only:
            pictures = [p.resolve() for p in arguments.pictures]
            results["pictures"] = picture_results(build, pictures)
        if not arguments.only:
            results["directions"] = directions.direction_results(build, measurements, say)
        if arguments.angular:
            files = [p.resolve() for p in arguments.angular]
            results["angular"] = directions.angular_results(build, *files)
        RESULTS.write_text(json.dumps(results, indent=1) + "\n")
    PAGE.write_text(page(json.loads(RESULTS.read_text())))
    say(f"wrote {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
