# SPDX-License-Identifier: Apache-2.0
"""Runs the program of the environment variable SATEEN on small inputs made here."""

import json
import os
import pathlib
import random
import struct
import subprocess
import tempfile
import unittest
import zlib

PROGRAM = os.environ.get("SATEEN", "sateen")
PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def texture(rows, cols, seed=0, bands=3):
    """Rows of 8-bit samples: smoothed noise, with bands that have much in common."""
    draw = random.Random(seed)
    noise = [[draw.random() for _ in range(cols)] for _ in range(rows)]
    smooth = [
        [
            noise[r][c] + noise[r - 1][c] + noise[r][c - 1] + noise[r - 1][c - 1]
            for c in range(cols)
        ]
        for r in range(rows)
    ]
    tint = (1.0, 0.8, 0.5)
    return [
        [
            int(20 + 50 * tint[b] * smooth[r][c] + 20 * draw.random())
            for c in range(cols)
            for b in range(bands)
        ]
        for r in range(rows)
    ]


def png(samples, cols, colour_type=2, bits=8, palette=None):
    """A PNG of rows of samples. Colour types: 0 grey, 2 RGB, 3 palette, 6 RGBA."""

    def chunk(kind, data):
        crc = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", crc)

    form = "B" if bits == 8 else "H"
    raw = b"".join(
        b"\0" + struct.pack(f">{len(row)}{form}", *row) for row in samples
    )
    header = struct.pack(">IIBBBBB", cols, len(samples), bits, colour_type, 0, 0, 0)
    body = chunk(b"IHDR", header)
    if palette:
        body += chunk(b"PLTE", bytes(palette))
    body += chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")
    return PNG_SIGNATURE + body


def photograph(rows=96, cols=96, seed=0):
    return png(texture(rows, cols, seed), cols)


def _paeth(a, b, c):
    p = a + b - c
    near = min(abs(p - a), abs(p - b), abs(p - c))
    return a if near == abs(p - a) else b if near == abs(p - b) else c


def read_png(path):
    """(cols, rows, rows of 8-bit RGB samples) of what the program writes."""
    data = pathlib.Path(path).read_bytes()
    assert data[:8] == PNG_SIGNATURE
    at, packed = 8, b""
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            cols, rows, bits, colour_type = struct.unpack(">IIBB", body[:10])
            assert (bits, colour_type) == (8, 2)
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    raw, stride = zlib.decompress(packed), 3 * cols
    above, image = bytearray(stride), []
    for r in range(rows):
        start = r * (stride + 1)
        kind, line = raw[start], bytearray(raw[start + 1 : start + 1 + stride])
        if kind == 2:
            line = bytearray((x + u) & 255 for x, u in zip(line, above))
        elif kind != 0:
            for i in range(stride):
                left, up = (line[i - 3] if i >= 3 else 0), above[i]
                corner = above[i - 3] if i >= 3 else 0
                guess = (0, left, 0, (left + up) // 2, _paeth(left, up, corner))[kind]
                line[i] = (line[i] + guess) & 255
        image.append(line)
        above = line
    return cols, rows, image


def difference(a, b):
    return sum(abs(x - y) for x, y in zip(a, b)) / len(a)


def seam_ratio(image):
    """Difference across the border over that between neighbours, of rows and columns."""

    def ratio(lines):
        inside = [difference(lines[i], lines[i + 1]) for i in range(len(lines) - 1)]
        return difference(lines[-1], lines[0]) / (sum(inside) / len(inside))

    cols = len(image[0]) // 3
    columns = [[row[3 * c + b] for row in image for b in range(3)] for c in range(cols)]
    return ratio(image), ratio(columns)


class Outcome:
    def __init__(self, process):
        self.code = process.returncode
        self.out = process.stdout.decode()
        self.err = process.stderr.decode()

    def __str__(self):
        return f"exit {self.code}\nstdout: {self.out}\nstderr: {self.err}"


class CliTest(unittest.TestCase):
    made = b""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, data):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        return path

    def run_program(self, *arguments, **options):
        process = subprocess.run(
            [PROGRAM, *map(str, arguments)],
            cwd=self.folder,
            capture_output=True,
            timeout=120,
            **options,
        )
        return Outcome(process)

    def succeed(self, *arguments):
        outcome = self.run_program(*arguments)
        self.assertEqual(outcome.code, 0, outcome)
        self.assertNotIn("error", outcome.err)
        return outcome

    def succeed_with_json(self, *arguments):
        return json.loads(self.succeed(*arguments, "--json").out)

    def refuse(self, *arguments, names, code=1):
        """Fails with one line that contains every text of `names`."""
        outcome = self.run_program(*arguments)
        self.assertEqual(outcome.code, code, outcome)
        self.assertEqual(outcome.out, "", outcome)
        self.assertTrue(outcome.err.startswith("sateen: error: "), outcome)
        self.assertEqual(outcome.err.count("\n"), 1, outcome)
        for text in [names] if isinstance(names, str) else names:
            self.assertIn(text, outcome.err)
        return outcome

    def leftovers(self):
        """Files that start with a dot: those being written do."""
        return [p.name for p in self.folder.rglob(".*")]

    def measurement(self, name="ubo", rows=32, cols=32, thetas=(0, 30, 60)):
        """A folder of images under every pair of directions, darker as light falls."""
        for i, light in enumerate(thetas):
            for j, view in enumerate(thetas):
                samples = texture(rows, cols, seed=1)
                dim = 1 / (1 + 0.5 * i + 0.1 * j)
                rows_dimmed = [[int(v * dim) for v in row] for row in samples]
                self.file(
                    f"{name}/{i}{j} tl{light:03} pl045 tv{view:03} pv090.png",
                    png(rows_dimmed, cols),
                )
        return self.folder / name

    def material(self):
        """m.sateen of photo.png, made once for all tests of a program."""
        self.file("photo.png", photograph())
        path = self.folder / "m.sateen"
        if not CliTest.made:
            self.succeed("model", "photo.png", "-o", path, "--field", "car2d")
            CliTest.made = path.read_bytes()
        path.write_bytes(CliTest.made)
        return path
