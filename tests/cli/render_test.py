# SPDX-License-Identifier: Apache-2.0
"""sateen render: pictures, read back."""

import struct
import unittest

from support import CliTest, read_png

SQUARE = b"v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"


class Rendering(CliTest):
    def setUp(self):
        super().setUp()
        self.material()

    def picture(self, *arguments):
        small = ["--size", "32", "--texture", "64"]
        self.succeed("render", "m.sateen", "-o", "r.png", *small, *arguments)
        return read_png(self.folder / "r.png")[2]

    def test_every_mesh_fills_the_middle(self):
        self.file("square.obj", SQUARE)
        for mesh in ("sphere", "plane", "cloth", "square.obj"):
            with self.subTest(mesh=mesh):
                rows = self.picture("--mesh", mesh, "--light", "60,270")
                self.assertGreater(sum(rows[16][45:51]), 100)

    def test_the_lit_side_is_bright(self):
        rows = self.picture("--view", "90,270", "--light", "90,0")
        right, left = rows[16][3 * 24], rows[16][3 * 8]
        self.assertGreater(right, left + 60)

    def test_an_environment_lights(self):
        header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n"
        pixels = struct.pack("4B", 128, 128, 128, 128) * 8
        self.file("sky.hdr", header + pixels)
        rows = self.picture("--env", "sky.hdr", "--env-samples", "2")
        self.assertGreater(sum(rows[16][45:51]), 100)

    def test_animations_are_numbered(self):
        for option in ("--turntable", "--sweep"):
            report = self.succeed_with_json(
                *["render", "m.sateen", "-o", "a.png", "--size", "16", "--texture", "32"],
                *[option, "3"],
            )
            self.assertEqual(report["written"], [f"a_00{k}.png" for k in range(3)])
        self.assertEqual(self.leftovers(), [])

    def test_the_same_bytes_for_any_number_of_threads(self):
        pictures = []
        for threads in ("1", "2"):
            self.picture("--mesh", "cloth", "--threads", threads)
            pictures.append((self.folder / "r.png").read_bytes())
        self.assertEqual(*pictures)

    def test_refusals(self):
        self.file("bad.obj", b"v 0 0 0\n")
        for arguments, names, code in (
            (["--mesh", "none.obj"], "none.obj", 1),
            (["--mesh", "bad.obj"], ["bad.obj", "face"], 1),
            (["--env", "none.hdr"], "none.hdr", 1),
            (["--light", "100,0"], "--light", 2),
            (["--turntable", "2", "--sweep", "2"], "--", 2),
        ):
            with self.subTest(arguments=arguments):
                self.refuse(
                    "render", "m.sateen", "-o", "r.png", *arguments, names=names, code=code
                )


if __name__ == "__main__":
    unittest.main()
