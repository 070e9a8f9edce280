# SPDX-License-Identifier: Apache-2.0
"""sateen model --surface, synthesise --maps: range maps from photographs with known lights."""

import json
import math
import unittest

from support import CliTest, png, photograph, read_png

SIDE = 48
LIGHTS = [(t, p) for t in (20, 40, 55) for p in (10, 100, 190, 280)]


def slope(row, col):
    """∂z/∂x and ∂z/∂y (up) of a torus with relief along both."""
    turn = 2 * math.pi / SIDE
    p = 0.5 * math.cos(3 * turn * col)
    q = 0.3 * math.sin(2 * turn * row)
    return p, q


def encode(value):
    value = min(1, max(0, value))
    code = 12.92 * value if value < 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055
    return round(65535 * code)


def picture(theta, phi):
    t, f = math.radians(theta), math.radians(phi)
    light = (math.sin(t) * math.cos(f), math.sin(t) * math.sin(f), math.cos(t))
    rows = []
    for row in range(SIDE):
        line = []
        for col in range(SIDE):
            p, q = slope(row, col)
            w = math.sqrt(1 + p * p + q * q)
            shading = max(0, (-p * light[0] - q * light[1] + light[2]) / w)
            line += [encode(0.6 * shading), encode(0.5 * shading), encode(0.3 * shading)]
        rows.append(line)
    return png(rows, SIDE, bits=16)


def luminances(rows):
    return [row[i] + row[i + 1] + row[i + 2] for row in rows for i in range(0, len(row), 3)]


def contrast(rows):
    values = luminances(rows)
    mean = sum(values) / len(values)
    return math.sqrt(sum((v - mean) ** 2 for v in values) / len(values)) / mean


def correlation(a, b):
    mean_a, mean_b = sum(a) / len(a), sum(b) / len(b)
    ab = sum((x - mean_a) * (y - mean_b) for x, y in zip(a, b))
    aa = sum((x - mean_a) ** 2 for x in a)
    bb = sum((y - mean_b) ** 2 for y in b)
    return ab / math.sqrt(aa * bb)


class Surfaces(CliTest):
    def drawn(self, *arguments):
        """Rows of what the arguments write to t.png."""
        self.succeed(*arguments)
        return read_png(self.folder / "t.png")[2]

    def icon(self):
        lines = [str(len(LIGHTS))]
        for i, (theta, phi) in enumerate(LIGHTS):
            self.file(f"icon/light {i:02}.png", picture(theta, phi))
            t, f = math.radians(theta), math.radians(phi)
            x, y = math.sin(t) * math.cos(f), math.sin(t) * math.sin(f)
            lines.append(f"light {i:02}.png {x:.9f} {y:.9f} {math.cos(t):.9f}")
        return self.file("icon/dirs.lp", "\n".join(lines).encode())

    def test_a_light_position_file_gives_a_range_map(self):
        path = self.icon()
        report = self.succeed_with_json(
            "model", path, "-o", "m.sateen", "--surface-out", "maps"
        )
        self.assertEqual(report["surface"]["size"], [SIDE, SIDE])
        self.assertEqual(report["surface"]["tiles"], 4)
        info = self.succeed_with_json("info", "m.sateen")
        self.assertEqual(info["name"], "icon")
        self.assertGreater(info["payload_bytes"]["surface"], 0)
        # Amplitudes slope / frequency of both waves.
        turn = 2 * math.pi / SIDE
        height = 2 * (0.5 / (3 * turn) + 0.3 / (2 * turn))
        found = info["surface"]["highest_px"] - info["surface"]["lowest_px"]
        # Joining tiles may lift them a little.
        self.assertAlmostEqual(found, height, delta=0.2 * height)
        maps = json.loads((self.folder / "maps/maps.json").read_text())
        found = maps["height"]["highest_px"] - maps["height"]["lowest_px"]
        self.assertAlmostEqual(found, height, delta=0.05 * height)
        names = sorted(p.name for p in (self.folder / "maps").iterdir())
        self.assertEqual(names, ["albedo.png", "height.png", "maps.json", "normal.png"])
        self.assertEqual(self.leftovers(), [])

    def light_lines(self, scale=1.0):
        """Lines of the icon's light position file without their count."""
        lines = self.icon().read_text().splitlines()[1:]
        out = []
        for line in lines:
            words = line.split()
            xyz = (f"{scale * float(v):.7f}" for v in words[2:])
            out.append([" ".join(words[:2]), *xyz])
        return out

    def test_light_position_files_as_they_are_found(self):
        right = self.succeed_with_json("model", self.icon(), "-o", "m.sateen")["surface"]
        lines = self.light_lines(scale=3.5)
        folder = self.folder / "icon"
        for what, head, ends, name in (
            ("CRLF and positions for vectors", "12", "\r\n", "{}"),
            ("tabs, blank lines and no count", "", "\n\n", "{}"),
            ("paths of a Windows machine", "12", "\n", "C:\\scans\\my icon\\{}"),
            ("paths of another machine", "12", "\n", "/home/them/icon/{}"),
            ("paths from elsewhere", "12", "\n", "./{}"),
            ("names of another case", "12", "\n", "{}"),
        ):
            with self.subTest(what):
                rows = [head] if head else []
                for image, *xyz in lines:
                    image = image.upper() if "case" in what else image
                    gap = "\t" if "tabs" in what else " "
                    rows.append(gap.join([name.format(image), *xyz]))
                (folder / "dirs.lp").write_bytes(ends.join(rows).encode())
                found = self.succeed_with_json(
                    "model", folder / "dirs.lp", "-o", "m.sateen"
                )["surface"]
                self.assertEqual(found["size"], right["size"])
                self.assertAlmostEqual(found["shading_share"], right["shading_share"], delta=0.01)

    def test_light_position_files_that_are_wrong(self):
        lines = [" ".join(line) for line in self.light_lines()]
        for what, text, names in (
            ("an image that is not there", ["12", *lines[:-1], "gone.png 0 0 1"],
             ["dirs.lp", "gone.png"]),
            ("no vector", ["12", *lines[:-1], "light 11.png 0 0 0"], ["dirs.lp", "line 13"]),
            ("no number", ["12", *lines[:-1], "light 11.png 0 x 1"], ["dirs.lp", "line 13"]),
            ("nothing", [], ["dirs.lp"]),
        ):
            with self.subTest(what):
                path = self.file("icon/dirs.lp", "\n".join(text).encode())
                self.refuse("model", path, "-o", "n.sateen", names=names)
                self.assertFalse((self.folder / "n.sateen").exists())
        path = self.file("icon/dirs.lp", "\n".join(["20", *lines]).encode())
        self.assertIn("states 20 images and lists 12",
                      self.succeed("model", path, "-o", "n.sateen").err)  # fmt: skip

    def test_maps_of_any_size(self):
        self.succeed("model", self.icon(), "-o", "m.sateen")
        for size in ("96x48", "70x50"):
            report = self.succeed_with_json(
                "synthesise", "m.sateen", "-o", "out", "--maps", "--size", size
            )
            self.assertEqual(len(report["written"]), 4)
            header = (self.folder / "out/height.png").read_bytes()[16:25]
            cols, rows = size.split("x")
            self.assertEqual(int.from_bytes(header[:4], "big"), int(cols))
            self.assertEqual(int.from_bytes(header[4:8], "big"), int(rows))
            self.assertEqual(header[8], 16)

    def test_shading_is_divided_out_and_put_back(self):
        report = self.succeed_with_json("model", self.icon(), "-o", "m.sateen")
        self.assertTrue(report["surface"]["delit"])
        # The albedo of the icon is uniform: all contrast is shading.
        self.assertGreater(report["surface"]["shading_share"], 0.95)
        size = ["--size", "96x48"]
        draw = ["synthesise", "m.sateen", "-o"]
        smooth, lit = (
            contrast(self.drawn(*draw, "t.png", *size, "--tileable", *how))
            for how in (["--subspace", "0"], ["--light", "55,10"])
        )
        self.assertGreater(lit, 5 * smooth)
        report = self.succeed_with_json(*draw, "out", "--maps", "--light", "55,10", *size)
        names = sorted(p.name for p in (self.folder / "out").iterdir())
        self.assertEqual(
            names, ["base_colour.png", "height.png", "maps.json", "normal.png", "relit.png"]
        )
        self.assertEqual(sorted(report["written"]), [f"out/{name}" for name in names])
        alone = (self.folder / "t.png").read_bytes()
        self.assertEqual((self.folder / "out/relit.png").read_bytes(), alone)
        self.assertLess(contrast(read_png(self.folder / "out/base_colour.png")[2]), 0.1)
        maps = json.loads((self.folder / "out/maps.json").read_text())
        self.assertTrue(maps["colour"]["delit"])
        self.assertEqual(maps["height"]["unit"], "pixels of these maps")
        for angle, expected in zip(maps["relit"]["light"], (55, 10)):
            self.assertAlmostEqual(angle, expected, delta=0.01)

    def test_light_from_the_other_side_shows_the_other_slopes(self):
        self.succeed("model", self.icon(), "-o", "m.sateen")
        east, west = (
            luminances(
                self.drawn("synthesise", "m.sateen", "-o", "t.png", "--size", "96",
                           "--tileable", "--light", light)
            )
            for light in ("50,0", "50,180")
        )
        self.assertLess(correlation(east, west), -0.3)

    def test_maps_appear_together_and_spare_other_files(self):
        self.file("maps/mine.txt", b"mine")
        self.succeed("model", self.icon(), "-o", "m.sateen", "--surface-out", "maps")
        names = sorted(p.name for p in (self.folder / "maps").iterdir())
        self.assertIn("mine.txt", names)
        self.assertEqual(len(names), 5)
        self.assertEqual(self.leftovers(), [])
        self.file("flat", b"a file")
        self.refuse(
            "model", self.folder / "icon/dirs.lp", "-o", "n.sateen", "--surface-out", "flat",
            names=["flat", "expected a folder"],
        )
        self.assertFalse((self.folder / "n.sateen").exists())
        self.assertEqual(self.leftovers(), [])

    def test_a_photograph_has_a_surface_if_asked(self):
        self.file("stone.png", photograph(64, 64))
        report = self.succeed_with_json("model", "stone.png", "-o", "m.sateen")
        self.assertNotIn("surface", report)
        options = ["--surface", "shading"]
        report = self.succeed_with_json("model", "stone.png", "-o", "m.sateen", *options)
        self.assertIn("surface", report)
        self.assertTrue(any("light estimated" in note for note in report["notes"]))
        options += ["--surface-light", "45,120"]
        report = self.succeed_with_json("model", "stone.png", "-o", "m.sateen", *options)
        self.assertEqual(report["notes"], [])
        self.assertTrue(report["surface"]["delit"])
        for angle, expected in zip(report["surface"]["light"], (45, 120)):
            self.assertAlmostEqual(angle, expected, delta=0.01)
        # Without a light it is lit from the upper left.
        own, same, other = (
            self.drawn("synthesise", "m.sateen", "-o", "t.png", "--size", "64", *light)
            for light in ([], ["--light", "45,135"], ["--light", "45,300"])
        )
        self.assertEqual(own, same)
        self.assertNotEqual(own, other)

    def test_says_what_is_missing(self):
        self.file("stone.png", photograph(64, 64))
        self.refuse(
            "model", "stone.png", "-o", "m.sateen", "--surface", "stereo",
            names=["stone", "without directions"],
        )
        self.refuse(
            "model", "stone.png", "-o", "m.sateen", "--surface-out", "maps",
            names=["--surface-out", "--surface shading"],
        )
        self.assertFalse((self.folder / "m.sateen").exists())


if __name__ == "__main__":
    unittest.main()
