# SPDX-License-Identifier: Apache-2.0
"""Patterns that repeat: found or left out, drawn closed, without seams."""

import math
import random
import unittest

from support import CliTest, png, read_png, seam_ratio

SIDE = 160
PERIOD = 13.5


def weave(seed=0):
    draw = random.Random(seed)
    wave = [math.sin(2 * math.pi * i / PERIOD) for i in range(SIDE)]
    rows = []
    for r in range(SIDE):
        row = []
        for c in range(SIDE):
            over = max(wave[r], wave[c]) + 0.3 * wave[r] * wave[c]
            for tint in (60, 50, 35):
                row.append(int(110 + tint * over + 12 * draw.random()))
        rows.append(row)
    return rows


class Structure(CliTest):
    made = {}

    def model(self, name, *arguments):
        if name not in Structure.made:
            self.file("weave.png", png(weave(), SIDE))
            self.succeed("model", "weave.png", "-o", name, *arguments)
            Structure.made[name] = (self.folder / name).read_bytes()
        self.file(name, Structure.made[name])

    def parts(self, name):
        return self.succeed_with_json("info", name)["payload_bytes"]

    def test_is_part_of_the_material_unless_unwanted(self):
        self.model("auto.sateen")
        self.assertGreater(self.parts("auto.sateen")["structure"], 100)
        self.assertLess(len(Structure.made["auto.sateen"]), 8192)
        for name, option in (("none", ["--structure", "none"]), ("paper", ["--paper"])):
            self.model(f"{name}.sateen", *option)
            self.assertNotIn("structure", self.parts(f"{name}.sateen"))

    def test_no_structure_in_noise(self):
        self.material()
        self.assertNotIn("structure", self.parts("m.sateen"))

    def test_windows_agree(self):
        self.model("auto.sateen")
        for name, size, offset in (("a", "90x70", "0,0"), ("b", "64x48", "-40,-24")):
            self.succeed(
                "synthesise", "auto.sateen", "-o", f"{name}.png", "--size", size, "--offset", offset
            )
        _, _, a = read_png(self.folder / "a.png")
        _, _, b = read_png(self.folder / "b.png")
        for r in range(48 - 24):
            self.assertEqual(a[r][: 3 * 24], b[r + 24][3 * 40 :])

    def test_tiles_close_and_say_how_much_they_are_strained(self):
        self.model("auto.sateen")
        draw = ["synthesise", "auto.sateen", "-o", "t.png", "--tileable", "--size"]
        asked = self.succeed_with_json(*draw, "128")
        best = self.succeed_with_json(*draw, "best:128")
        # 128 = 9.48 periods; 135 = 10 of them.
        self.assertAlmostEqual(asked["strain"], 128 / (9 * PERIOD) - 1, delta=0.01)
        self.assertLess(best["strain"], 0.005)
        cols, rows, samples = read_png(self.folder / "t.png")
        self.assertEqual([cols, rows], best["size"])
        for ratio in seam_ratio(samples):
            self.assertLess(ratio, 1.4)

    def test_the_pattern_is_drawn(self):
        self.model("auto.sateen")
        self.succeed("synthesise", "auto.sateen", "-o", "t.png", "--size", "270x135", "--tileable")
        _, _, samples = read_png(self.folder / "t.png")
        # Correlation with itself one period of the lattice away, by rows of the red band.
        values = [[row[3 * c] for c in range(270)] for row in samples]
        mean = sum(map(sum, values)) / (270 * 135)
        power = sum((v - mean) ** 2 for row in values for v in row)
        moved = sum(
            (row[c] - mean) * (row[(c + 27) % 270] - mean) for row in values for c in range(270)
        )
        self.assertGreater(moved / power, 0.6)

    def test_the_same_bytes_for_any_number_of_threads(self):
        self.file("weave.png", png(weave(), SIDE))
        files = []
        for threads in (1, 2):
            self.succeed("model", "weave.png", "-o", "m.sateen", "--threads", threads)
            files.append((self.folder / "m.sateen").read_bytes())
        self.assertEqual(files[0], files[1])

    def test_a_size_that_is_none_is_refused(self):
        self.model("auto.sateen")
        outcome = self.run_program("synthesise", "auto.sateen", "-o", "t.png", "--size", "best:0")
        self.assertEqual(outcome.code, 2, outcome)


if __name__ == "__main__":
    unittest.main()
