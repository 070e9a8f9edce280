# SPDX-License-Identifier: Apache-2.0
"""What the pages of the gallery are made with: runs sateen, lays out pictures, writes JPEGs.

A page is a module tools/gallery/<topic>.py with

    TITLE = "..."                  its heading
    SAYS = "..."                   one sentence for the list of pages
    def make(context): -> str      the Markdown below the heading; pictures by context.sheet()

Pictures go to docs/gallery/<topic>/, the page to docs/gallery/<topic>.md.
"""

import hashlib
import io
import json
import os
import pathlib
import re
import subprocess
import sys
import zipfile

try:
    from PIL import Image, ImageDraw, ImageFont
except ImportError:
    sys.exit("make_gallery: error: found no Pillow, expected the package python3-pil")

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
GALLERY = ROOT / "docs" / "gallery"
MOST_BYTES = 250_000  # of a picture
FONTS = pathlib.Path("/usr/share/fonts/truetype/dejavu")
INK, PAPER = (40, 40, 40), (255, 255, 255)


def say(text):
    print(f"make_gallery: {text}", file=sys.stderr, flush=True)


def font(size, bold=False):
    path = FONTS / ("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf")
    return ImageFont.truetype(str(path), size) if path.exists() else ImageFont.load_default()


def enlarged(picture, factor):
    """Every pixel a square."""
    return picture.resize((picture.width * factor, picture.height * factor), Image.NEAREST)


def scaled(picture, width):
    """To a width, by area or bicubic."""
    height = max(1, round(picture.height * width / picture.width))
    small = width < picture.width
    return picture.resize((width, height), Image.LANCZOS if small else Image.BICUBIC)


def centre(picture, side):
    """The square in the middle."""
    left, top = (picture.width - side) // 2, (picture.height - side) // 2
    return picture.crop((left, top, left + side, top + side))


def contact_sheet(rows, columns=(), names=(), gap=6):
    """A picture of labelled pictures.

    rows     lists of PIL images or None; all cells get the size of the largest
    columns  a caption over each column
    names    a caption left of each row
    """
    cells = [p for row in rows for p in row if p is not None]
    width, height = max(p.width for p in cells), max(p.height for p in cells)
    text = font(max(12, min(15, width // 10)))
    count = max(len(row) for row in rows)

    def measure(caption):
        box = text.getbbox(caption)
        return box[2] - box[0], box[3]

    left = max((measure(line)[0] for n in names for line in n.split("\n")), default=-gap) + gap
    line_height = measure("Åg")[1] + 2
    top = max((c.count("\n") + 1 for c in columns), default=0) * line_height
    sheet = Image.new(
        "RGB",
        (left + count * (width + gap) + gap, top + len(rows) * (height + gap) + gap),
        PAPER,
    )
    draw = ImageDraw.Draw(sheet)
    for c, caption in enumerate(columns):
        x = left + gap + c * (width + gap)
        draw.multiline_text((x, 2), caption, INK, text, spacing=2)
    for r, row in enumerate(rows):
        y = top + gap + r * (height + gap)
        if r < len(names):
            draw.multiline_text((gap, y), names[r], INK, text, spacing=2)
        for c, picture in enumerate(row):
            if picture is not None:
                sheet.paste(picture.convert("RGB"), (left + gap + c * (width + gap), y))
    return sheet


def write_jpeg(picture, path, quality=90):
    """As good as fits MOST_BYTES."""
    path.parent.mkdir(parents=True, exist_ok=True)
    for q in range(quality, 30, -5):
        data = io.BytesIO()
        picture.convert("RGB").save(data, "JPEG", quality=q, optimize=True)
        if data.tell() <= MOST_BYTES:
            path.write_bytes(data.getvalue())
            return
    sys.exit(f"make_gallery: error: {path.name} exceeds {MOST_BYTES} bytes: make it smaller")


def table(head, rows):
    """Markdown, the first column left, the others right."""
    lines = ["| " + " | ".join(head) + " |", "|---|" + "--:|" * (len(head) - 1)]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows]) + "\n"


class Plot:
    """Curves in a frame: add() them, then picture()."""

    COLOURS = [(42, 111, 187), (217, 98, 43), (60, 150, 80), (150, 70, 160), (120, 120, 120)]

    def __init__(self, x_label, y_label, x_range, y_range, size=(560, 340)):
        self.labels, self.x, self.y, self.size = (x_label, y_label), x_range, y_range, size
        self.curves = []

    def add(self, name, xs, ys):
        self.curves.append((name, list(xs), list(ys)))

    def picture(self):
        width, height = self.size
        box = (56, 26, width - 12, height - 40)
        image = Image.new("RGB", self.size, PAPER)
        draw, text = ImageDraw.Draw(image), font(12)

        def at(x, y):
            u = (x - self.x[0]) / (self.x[1] - self.x[0])
            v = (y - self.y[0]) / (self.y[1] - self.y[0])
            return box[0] + u * (box[2] - box[0]), box[3] - v * (box[3] - box[1])

        for k in range(6):
            x = self.x[0] + k * (self.x[1] - self.x[0]) / 5
            y = self.y[0] + k * (self.y[1] - self.y[0]) / 5
            draw.line([at(x, self.y[0]), at(x, self.y[1])], (225, 225, 225))
            draw.line([at(self.x[0], y), at(self.x[1], y)], (225, 225, 225))
            draw.text((at(x, 0)[0], box[3] + 4), f"{x:.3g}", INK, text, anchor="ma")
            draw.text((box[0] - 4, at(self.x[0], y)[1]), f"{y:.3g}", INK, text, anchor="rm")
        draw.rectangle(box, outline=(150, 150, 150))
        draw.text(((box[0] + box[2]) / 2, height - 4), self.labels[0], INK, text, anchor="md")
        draw.text((4, 4), self.labels[1], INK, text)
        for k, (name, xs, ys) in enumerate(self.curves):
            colour = self.COLOURS[k % len(self.COLOURS)]
            draw.line([at(x, y) for x, y in zip(xs, ys)], colour, 2)
            draw.text((box[2] - 6, box[1] + 4 + 15 * k), name, colour, text, anchor="ra")
        return image


class Context:
    """What a page is made with. Measurements and materials are made once and kept in the
    scratch folder, by what they are made of."""

    def __init__(self, program, scratch, measurements):
        self.program = pathlib.Path(program).resolve()
        self.scratch = pathlib.Path(scratch).resolve()
        self.measurements = [pathlib.Path(m).resolve() for m in measurements]
        self.topic = ""
        self.scratch.mkdir(parents=True, exist_ok=True)

    def run(self, *arguments):
        """What the program prints."""
        command = [str(self.program), *map(str, arguments)]
        done = subprocess.run(command, cwd=self.scratch, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"make_gallery: error: {' '.join(command)}: {done.stderr.strip()}")
        return done.stdout

    def run_json(self, *arguments):
        return json.loads(self.run(*arguments, "--json"))

    def measure(self, surface, *options):
        """A measurement of a preset, e.g. measure("twill", "--directions", "coarse")."""
        path = self.scratch / f"{surface}-{_key(options)}.zip"
        if not path.exists():
            say(f"measuring {surface} {' '.join(map(str, options))}")
            self.run("measure", surface, "-o", path, *options)
        return path

    def model(self, source, *options):
        """The material of a measurement or a photograph."""
        source = pathlib.Path(source)
        path = self.scratch / f"{source.stem}-{_key((source, *options))}.sateen"
        newest = max(source.stat().st_mtime, pathlib.Path(self.program).stat().st_mtime)
        if not path.exists() or path.stat().st_mtime < newest:
            say(f"modelling {source.name} {' '.join(map(str, options))}")
            self.run("model", source, "-o", path, *options)
        return path

    def picture(self, verb, material, *options):
        """A PIL image of `sateen synthesise` or `sateen render`."""
        path = self.scratch / f"picture-{os.getpid()}.png"
        self.run(verb, material, "-o", path, *options)
        with Image.open(path) as image:
            picture = image.convert("RGB")
        path.unlink()
        return picture

    def measured(self, measurement, view, light):
        """A PIL image of a measurement named as UBO2003 names its files; view and light are
        (theta, phi) in whole degrees."""
        wanted = tuple(map(int, (*light, *view)))
        with zipfile.ZipFile(measurement) as archive:
            for name in archive.namelist():
                angles = re.search(r"tl(\d+) pl(\d+) tv(\d+) pv(\d+)", name)
                if angles and tuple(map(int, angles.groups())) == wanted:
                    return Image.open(io.BytesIO(archive.read(name))).convert("RGB")
        sys.exit(f"make_gallery: error: {measurement}: no image of tl, pl, tv, pv {wanted}")

    def sheet(self, name, picture, caption, quality=90):
        """Writes a picture of the page; returns its Markdown."""
        write_jpeg(picture, GALLERY / self.topic / f"{name}.jpg", quality)
        return f"![{caption}]({self.topic}/{name}.jpg)\n\n*{caption}*\n"


def _key(parts):
    return hashlib.sha256(" ".join(map(str, parts)).encode()).hexdigest()[:10]
