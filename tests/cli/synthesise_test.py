# SPDX-License-Identifier: Apache-2.0
"""sateen synthesise: what is drawn, read back."""

import signal
import subprocess
import time
import unittest

from support import PROGRAM, CliTest, read_png, seam_ratio


class Drawing(CliTest):
    def setUp(self):
        super().setUp()
        self.material()

    def draw(self, name, *arguments):
        self.succeed("synthesise", "m.sateen", "-o", name, *arguments)
        return (self.folder / name).read_bytes()

    def test_the_size_asked_for(self):
        self.draw("t.png", "--size", "40x24")
        cols, rows, _ = read_png(self.folder / "t.png")
        self.assertEqual((cols, rows), (40, 24))
        self.draw("t.png", "--size", "33", "--tileable")
        cols, rows, _ = read_png(self.folder / "t.png")
        self.assertEqual((cols, rows), (33, 33))

    def test_the_same_bytes_for_any_number_of_threads_and_again(self):
        for mode in ([], ["--tileable"], ["--recursive"]):
            with self.subTest(mode=mode):
                arguments = ["--size", "150x140", *mode]
                one = self.draw("t.png", *arguments, "--threads", "1")
                self.assertEqual(one, self.draw("t.png", *arguments, "--threads", "2"))
                self.assertEqual(one, self.draw("t.png", *arguments, "--threads", "2"))

    def test_another_seed_draws_another_texture(self):
        size = ["--size", "32x32"]
        default = self.draw("t.png", *size)
        self.assertEqual(default, self.draw("t.png", *size, "--seed", "0"))
        self.assertNotEqual(default, self.draw("t.png", *size, "--seed", "1"))
        self.assertNotEqual(default, self.draw("t.png", *size, "--seed", 2**64 - 1))

    def test_windows_agree_where_they_overlap(self):
        for mode in ([], ["--recursive"]):
            with self.subTest(mode=mode):
                self.draw("a.png", "--size", "90x70", *mode)
                self.draw("b.png", "--size", "64x48", "--offset", "-40,-24", *mode)
                _, _, a = read_png(self.folder / "a.png")
                _, _, b = read_png(self.folder / "b.png")
                for r in range(48 - 24):
                    self.assertEqual(a[r][: 3 * 24], b[r + 24][3 * 40 :])

    def test_tiles_have_no_seam(self):
        for size, seeds in (("64x64", 6), ("97x97", 4), ("128x128", 3), ("500x300", 1)):
            with self.subTest(size=size):
                ratios = []
                for seed in range(seeds):
                    self.draw("t.png", "--size", size, "--tileable", "--seed", seed)
                    ratios.append(seam_ratio(read_png(self.folder / "t.png")[2]))
                for mean in (sum(r) / seeds for r in zip(*ratios)):
                    self.assertLessEqual(mean, 1.1)

    def test_a_window_of_the_plane_has_a_seam(self):
        self.draw("t.png", "--size", "128x128")
        ratios = seam_ratio(read_png(self.folder / "t.png")[2])
        self.assertGreater(max(ratios), 1.1)

    def test_every_format_and_depth(self):
        for name, bits, start in (
            ("t.png", 8, b"\x89PNG"),
            ("t.png", 16, b"\x89PNG"),
            ("t.tif", 8, b"II*\0"),
            ("t.tif", 16, b"II*\0"),
            ("t.exr", 16, b"\x76\x2f\x31\x01"),
            ("t.exr", 32, b"\x76\x2f\x31\x01"),
            ("t.jpg", 8, b"\xff\xd8\xff"),
        ):
            with self.subTest(name=name, bits=bits):
                data = self.draw(name, "--size", "20x10", "--bits", bits)
                self.assertEqual(data[: len(start)], start)
                self.assertEqual(self.succeed_with_json("info", name)["size"], [20, 10])

    def test_the_american_spelling(self):
        british = self.draw("t.png", "--size", "16x16")
        self.succeed("synthesize", "m.sateen", "-o", "u.png", "--size", "16x16")
        self.assertEqual((self.folder / "u.png").read_bytes(), british)

    def test_json_and_messages(self):
        report = self.succeed_with_json(
            "synthesise", "m.sateen", "-o", "t.png", "--size", "20x10"
        )
        self.assertEqual(report["written"], ["t.png"])
        self.assertEqual(report["size"], [20, 10])
        self.assertEqual(report["subspace"], 0)
        outcome = self.succeed("synthesise", "m.sateen", "-o", "t.png", "--size", "20x10")
        self.assertEqual(outcome.out, "")

    def test_odd_sizes(self):
        for size in ("1x1", "1x50", "50x1", "7x3", "2x2"):
            for mode in ([], ["--tileable"], ["--recursive"]):
                with self.subTest(size=size, mode=mode):
                    self.draw("t.png", "--size", size, *mode)

    def test_the_ends_of_the_plane(self):
        for offset in ("1073741824,1073741824", "-1073741824,-1073741824"):
            self.draw("t.png", "--size", "8x8", "--offset", offset)


class Subspaces(CliTest):
    def setUp(self):
        super().setUp()
        self.measurement()
        car2d = ["--subspaces", "3", "--field", "car2d"]
        self.succeed("model", "ubo", "-o", "m.sateen", *car2d)

    def test_all_writes_all(self):
        report = self.succeed_with_json(
            "synthesise", "m.sateen", "-o", "deep/er", "--all", "--size", "48x32"
        )
        names = [f"deep/er/subspace_{k:02}.png" for k in range(3)]
        self.assertEqual(report["written"], names)
        textures = set()
        for k, name in enumerate(names):
            data = (self.folder / name).read_bytes()
            textures.add(data)
            self.succeed(
                *["synthesise", "m.sateen", "-o", "one.png", "--size", "48x32"],
                *["--tileable", "--subspace", k],
            )
            self.assertEqual((self.folder / "one.png").read_bytes(), data)
        self.assertEqual(len(textures), 3)
        self.assertEqual(self.leftovers(), [])

    def test_the_subspace_nearest_to_the_directions(self):
        chosen = {
            self.succeed_with_json(
                *["synthesise", "m.sateen", "-o", "t.png", "--size", "8x8"],
                *["--view", "0,0", "--light", light],
            )["subspace"]
            for light in ("0,0", "30,45", "60,-315")
        }
        self.assertGreater(len(chosen), 1)


class Interrupted(CliTest):
    def test_leaves_nothing_behind(self):
        self.material()
        before = sorted(p.name for p in self.folder.iterdir())
        command = [PROGRAM, "synthesise", "m.sateen", "-o", "t.png", "--size", "30000x30000"]
        with subprocess.Popen(command, cwd=self.folder, stderr=subprocess.PIPE) as process:
            while process.poll() is None and not self.leftovers():
                time.sleep(0.01)
            time.sleep(0.2)
            process.send_signal(signal.SIGINT)
            message = process.communicate(timeout=60)[1].decode()
        self.assertEqual(process.returncode, 1, message)
        self.assertTrue(message.startswith("sateen: error: cancelled"), message)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), before)


if __name__ == "__main__":
    unittest.main()
