# SPDX-License-Identifier: Apache-2.0
"""Views and lights: textures between measured directions, and all of them compared."""

import unittest

from support import CliTest, read_png


class Directions(CliTest):
    def setUp(self):
        super().setUp()
        self.measurement("ubo")
        self.succeed("model", "ubo", "-o", "m.sateen", "--subspaces", 2)

    def brightness(self, *directions):
        self.succeed("synthesise", "m.sateen", "-o", "t.png", "--size", 64, *directions)
        values = [v for row in read_png(self.folder / "t.png")[2] for v in row]
        return sum(values) / len(values)

    def test_brightness_follows_the_light_between_measured_ones(self):
        levels = [
            self.brightness("--view", "0,0", "--light", f"{theta},45")
            for theta in (0, 15, 30, 45, 60)
        ]
        for bright, dark in zip(levels, levels[1:]):
            self.assertGreater(bright, dark)

    def test_windows_of_a_blend_agree(self):
        between = ["--view", "15,90", "--light", "45,45"]
        self.succeed("synthesise", "m.sateen", "-o", "a.png", "--size", "64x64", *between)
        self.succeed(
            *["synthesise", "m.sateen", "-o", "b.png", "--size", "32x32"],
            *["--offset", "32,32", *between],
        )
        whole = read_png(self.folder / "a.png")[2]
        part = read_png(self.folder / "b.png")[2]
        self.assertEqual([bytes(row[96:]) for row in whole[32:]], [bytes(row) for row in part])

    def test_three_nearest_is_the_papers_interpolation(self):
        self.assertGreater(self.brightness("--three-nearest", "--light", "20,45"), 0)

    def test_compare_tells_the_errors_of_all_directions(self):
        found = self.succeed_with_json("compare", "m.sateen", "ubo")["directions"]
        self.assertEqual(found["pairs"], 9)
        self.assertLess(found["delta_e"]["mean"], 1)
        self.assertLess(found["delta_e"]["p95"], 3)
        self.assertEqual([entry["theta"] for entry in found["by_light"]], [0, 30, 60])
        self.assertEqual(found["grazing"]["pairs"] + found["not_grazing"]["pairs"], 9)

    def test_compare_scores_textures_by_elevation(self):
        found = self.succeed_with_json("compare", "m.sateen", "ubo")
        found = found["directions"]
        self.assertEqual(found["texture"]["pairs_scored"], 9)
        scored = [entry["texture"]["pairs_scored"] for entry in found["by_light"]]
        self.assertEqual(scored, [3, 3, 3])
        self.assertGreaterEqual(found["texture"]["score"], 1)
        self.assertNotIn("restored", found)
        few = self.succeed_with_json("compare", "m.sateen", "ubo", "--textures", 5)
        self.assertEqual(few["directions"]["texture"]["pairs_scored"], 5)
        none = self.succeed_with_json("compare", "m.sateen", "ubo", "--textures", 0)
        self.assertNotIn("texture", none["directions"])

    def test_compare_grades_what_was_not_measured_beside_the_nearest(self):
        for name in ("00", "02", "12", "20"):
            next((self.folder / "ubo").glob(f"{name} *")).rename(self.folder / f"{name}.png")
        self.succeed("model", "ubo", "-o", "few.sateen")
        for left in self.folder.glob("*.png"):
            light, view = (30 * int(c) for c in left.stem)
            left.rename(
                self.folder / f"ubo/{left.stem} tl{light:03} pl045 tv{view:03} pv090.png"
            )
        found = self.succeed_with_json("compare", "few.sateen", "ubo")["directions"]
        self.assertEqual((found["pairs"], found["restored"]["pairs"]), (9, 4))
        nearest = found["restored"]["nearest"]
        self.assertEqual(nearest["pairs"], 4)
        self.assertLess(found["restored"]["delta_e"]["mean"], nearest["delta_e"]["mean"])
        self.assertEqual(found["restored"]["texture"]["pairs_scored"], 4)
        self.assertIn("4 that the material was not made from",
                      self.succeed("compare", "few.sateen", "ubo").out)

    def test_compare_takes_some_directions_and_writes_a_page(self):
        found = self.succeed_with_json(
            *["compare", "ubo", "m.sateen", "--directions", 4, "--report", "r.html"],
        )
        self.assertEqual(found["directions"]["pairs"], 4)
        page = (self.folder / "r.html").read_text()
        self.assertIn("Index table", page)
        for exhibit in ("Best texture", "Median texture", "Worst texture", "Most grazing"):
            self.assertIn(exhibit, page)
        self.assertEqual(page.count("drawn</figcaption>"), 5)
        self.assertNotIn("http", page.replace("http://www.w3.org", ""))


if __name__ == "__main__":
    unittest.main()
