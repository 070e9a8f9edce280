# SPDX-License-Identifier: Apache-2.0
"""sateen render: pictures, read back."""

import signal
import struct
import subprocess
import time
import unittest

from support import PROGRAM, CliTest, read_png

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

    def test_an_animated_png_holds_all_frames(self):
        report = self.succeed_with_json(
            *["render", "m.sateen", "-o", "a.png", "--size", "16", "--texture", "32"],
            *["--turntable", "3", "--animate"],
        )
        self.assertEqual(report["written"][-1], "a.png")
        data = (self.folder / "a.png").read_bytes()
        self.assertEqual(data.count(b"acTL"), 1)
        self.assertEqual(data.count(b"fcTL"), 3)
        # Programs that know no animation show the first frame.
        first = read_png(self.folder / "a_000.png")
        self.assertEqual(read_png(self.folder / "a.png"), first)
        for arguments in (["-o", "b.jpg", "--sweep", "2"], ["-o", "b.png"]):
            self.refuse("render", "m.sateen", *arguments, "--animate", names="--animate")

    def test_one_pixel_is_a_picture(self):
        self.succeed("render", "m.sateen", "-o", "r.png", "--size", "1x1", "--texture", 32)
        self.assertEqual(read_png(self.folder / "r.png")[:2], (1, 1))

    def test_several_lights_add_up(self):
        exposed = ["--exposure", "0.5", "--mesh", "plane", "--view", "0,0"]
        one = self.picture(*exposed, "--light", "60,0")
        other = self.picture(*exposed, "--light", "60,90")
        both = self.picture(*exposed, "--light", "60,0", "--light", "60,90")
        self.assertGreater(both[16][48], max(one[16][48], other[16][48]))

    def test_odd_objects(self):
        square = SQUARE.decode()
        usable = {
            "quads.obj": square,
            "polygon.obj": square.replace("f 1/1 2/2 3/3 4/4", "v 2 6 0\nvt 0.5 1.5\nf 1/1 2/2 3/3 5/5 4/4"),
            "negative.obj": square.replace("f 1/1 2/2 3/3 4/4", "f -4/-4 -3/-3 -2/-2 -1/-1"),
            "windows.obj": square.replace("\n", "\r\n"),
            "flat_uv.obj": square.replace("vt 1 ", "vt 0 ").replace("0 1\n", "0 0\n"),
            "some_normals.obj": square.replace("f 1/1 2/2 3/3 4/4", "vn 0 0 1\nf 1/1/1 2/2 3/3/1 4/4/1"),
        }
        for name, text in usable.items():
            with self.subTest(name=name):
                self.file(name, text.encode())
                rows = self.picture("--mesh", name, "--light", "60,270")
                self.assertGreater(sum(rows[16][45:51]), 100)
        refused = {
            "empty.obj": "",
            "points.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\n",
            "no_uv.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "beyond.obj": square.replace("4/4", "9/9"),
            "text.obj": "this is no object\n",
        }
        for name, text in refused.items():
            with self.subTest(name=name):
                self.file(name, text.encode())
                self.refuse("render", "m.sateen", "-o", "r.png", "--mesh", name, names=name)

    def test_a_full_disk_is_told(self):
        self.refuse(
            *["render", "m.sateen", "-o", "/dev/full", "--size", "16", "--texture", "32"],
            names="/dev/full",
        )

    def test_an_interrupt_leaves_nothing(self):
        process = subprocess.Popen(
            [PROGRAM, "render", "m.sateen", "-o", "big.png", "--size", "4000"],
            cwd=self.folder,
            stderr=subprocess.PIPE,
        )
        time.sleep(1.5)
        process.send_signal(signal.SIGINT)
        _, message = process.communicate(timeout=60)
        self.assertNotEqual(process.returncode, 0)
        self.assertLessEqual(message.count(b"\n"), 1)
        self.assertFalse((self.folder / "big.png").exists())
        self.assertEqual(self.leftovers(), [])

    def test_displacement_needs_a_range_map(self):
        self.refuse(
            *["render", "m.sateen", "-o", "r.png", "--size", "16", "--displacement"],
            names=["m.sateen", "range map"],
        )

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
