#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the pages of docs/gallery: pictures of what the program does, from its own presets.

    tools/make_gallery.py [TOPIC...] [--program build/dev/bin/sateen] [--measurement ZIP...]

Without a topic all pages are made; a page is a module tools/gallery/TOPIC.py, described in
tools/gallery/common.py. Needs the packages python3-pil and fonts-dejavu-core.
"""

import argparse
import importlib
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from gallery import common  # noqa: E402

MOST_BYTES = 6_000_000  # of all pictures


def topics():
    folder = pathlib.Path(__file__).resolve().parent / "gallery"
    return sorted(p.stem for p in folder.glob("*.py") if "def make(" in p.read_text())


def write_list():
    """docs/gallery/README.md: the pages that there are."""
    lines = [
        "# Gallery", "",
        "Pictures of what the program does. `tools/make_gallery.py` makes them all from the "
        "virtual goniometer's presets; `tools/make_gallery.py TOPIC` makes one page.", "",
    ]  # fmt: skip
    for topic in topics():
        if (common.GALLERY / f"{topic}.md").exists():
            page = importlib.import_module(f"gallery.{topic}")
            lines.append(f"- [{page.TITLE}]({topic}.md): {page.SAYS}")
    (common.GALLERY / "README.md").write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("topics", nargs="*", metavar="TOPIC")
    build = common.ROOT / "build"
    parser.add_argument("--program", default=build / "dev" / "bin" / "sateen")
    parser.add_argument("--scratch", default=build / "gallery", help="what is made once")
    parser.add_argument("--measurement", nargs="+", default=[], help="shown besides")
    arguments = parser.parse_args()
    unknown = set(arguments.topics) - set(topics())
    if unknown:
        parser.error(f"no page {', '.join(sorted(unknown))}; there are {', '.join(topics())}")
    context = common.Context(arguments.program, arguments.scratch, arguments.measurement)
    common.GALLERY.mkdir(exist_ok=True)
    for topic in arguments.topics or topics():
        common.say(topic)
        page = importlib.import_module(f"gallery.{topic}")
        context.topic = topic
        body = page.make(context)
        (common.GALLERY / f"{topic}.md").write_text(
            f"# {page.TITLE}\n\n{body.strip()}\n\n"
            f"*Made by `tools/make_gallery.py {topic}`. [All pages](README.md)*\n"
        )
    write_list()
    size = sum(p.stat().st_size for p in common.GALLERY.rglob("*.jpg"))
    common.say(f"{size / 1e6:.1f} MB of pictures")
    if size > MOST_BYTES:
        sys.exit(f"make_gallery: error: more than {MOST_BYTES / 1e6:.0f} MB of pictures")


if __name__ == "__main__":
    main()
