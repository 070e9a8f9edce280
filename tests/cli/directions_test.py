# SPDX-License-Identifier: Apache-2.0
"""Views and lights: textures between measured directions, and all of them compared."""

import unittest

from support import CliTest, png, read_png, texture


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

    def payload(self, name):
        return self.succeed_with_json("info", name)["payload_bytes"]

    def test_reflectance_can_be_left_out(self):
        bytes_of = lambda name: (self.folder / name).stat().st_size
        for name, arguments in (("none.sateen", ["--reflectance", "none"]), ("paper.sateen", ["--paper"])):
            self.succeed("model", "ubo", "-o", name, "--subspaces", 2, *arguments)
            self.assertEqual(self.payload(name).get("reflectance", 0), 0)
        self.assertGreater(self.payload("m.sateen")["reflectance"], 0)
        self.assertLess(bytes_of("none.sateen"), bytes_of("m.sateen"))

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


class OddSets(CliTest):
    """Sets of directions that span no triangle, or say things twice."""

    def folder_of(self, pairs):
        """An image for every ((theta, phi) of the view, of the light), darker with the light."""
        for number, ((tv, pv), (tl, pl)) in enumerate(pairs):
            dim = 1 / (1 + 0.01 * tl + 0.002 * tv)
            rows = [[int(v * dim) for v in row] for row in texture(32, 32, seed=1)]
            self.file(
                f"set/{number:03} tl{tl:03} pl{pl:03} tv{tv:03} pv{pv:03}.png", png(rows, 32)
            )

    def answers_everywhere(self, pairs):
        self.folder_of(pairs)
        self.succeed("model", "set", "-o", "m.sateen", "--subspaces", 2)
        for view, light in (("0,0", "0,0"), ("80,200", "10,10"), ("33,45", "85,300")):
            self.succeed(
                *["synthesise", "m.sateen", "-o", "t.png", "--size", 32],
                *["--view", view, "--light", light],
            )
            values = [v for row in read_png(self.folder / "t.png")[2] for v in row]
            self.assertGreater(max(values), 0, (view, light))
        self.succeed("render", "m.sateen", "-o", "r.png", "--size", 16, "--texture", 32)
        self.assertGreater(max(max(row) for row in read_png(self.folder / "r.png")[2]), 60)

    RING = [(60, phi) for phi in range(0, 360, 60)]

    def test_one_view(self):
        self.answers_everywhere([((0, 0), light) for light in [(0, 0)] + self.RING])

    def test_one_light(self):
        self.answers_everywhere([(view, (30, 45)) for view in [(0, 0)] + self.RING])

    def test_one_pair(self):
        self.answers_everywhere([((0, 0), (30, 45))])

    def test_all_on_a_line(self):
        arc = [(theta, 90) for theta in (0, 20, 40, 60)]
        self.answers_everywhere([(view, light) for view in arc for light in arc])

    def test_views_on_a_ring_without_its_middle(self):
        self.answers_everywhere([(view, light) for view in self.RING for light in self.RING])

    def test_directions_that_coincide_are_one(self):
        # (0, 0) and (0, 90) are one direction: a pair may be written either way, but once.
        poles = [((0, 0), (0, 90)), ((0, 90), (45, 0)), ((0, 0), (45, 120)), ((45, 0), (0, 0))]
        self.answers_everywhere(poles)
        self.folder_of(poles + [((0, 90), (0, 0))])
        self.refuse("model", "set", "-o", "m.sateen", names="once")

    def test_directions_a_degree_apart(self):
        views = [(30, 0), (31, 0), (30, 1), (60, 180)]
        self.answers_everywhere([(view, light) for view in views for light in views])

    def test_half_of_the_pairs(self):
        grid = [(0, 0)] + self.RING
        pairs = [(view, light) for view in grid for light in grid]
        self.answers_everywhere(pairs[::2])

    def test_a_pair_measured_twice_is_named(self):
        self.folder_of([((0, 0), (0, 0)), ((0, 0), (45, 0))])
        self.file("set/9 tl045 pl000 tv000 pv000.png", png(texture(32, 32, seed=3), 32))
        self.refuse("model", "set", "-o", "m.sateen", names=["set/9", "001", "once"])

    def test_a_light_below_the_surface_is_named(self):
        self.folder_of([((0, 0), (0, 0)), ((0, 0), (120, 0))])
        self.refuse("model", "set", "-o", "m.sateen", names=["120"])


if __name__ == "__main__":
    unittest.main()
