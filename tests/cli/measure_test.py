# SPDX-License-Identifier: Apache-2.0
"""sateen measure: virtual measurements, read back by the program itself."""

import json
import math
import signal
import subprocess
import time
import unittest
import zipfile

from support import PROGRAM, CliTest, png, read_png

SMALL = ["--size", "16", "--directions", "coarse", "--interreflection", "8"]


def srgb(value):
    if value <= 0.0031308:
        return 255 * 12.92 * value
    return 255 * (1.055 * value ** (1 / 2.4) - 0.055)


class Measuring(CliTest):
    def test_a_zip_that_info_and_model_understand(self):
        report = self.succeed_with_json("measure", "leather", "-o", "l.zip", *SMALL)
        self.assertEqual(report["images"], 625)
        self.assertEqual(report["written"], ["l.zip", "l_truth"])
        info = self.succeed_with_json("info", "l.zip")
        self.assertEqual(info["layout"], "ubo2003")
        self.assertEqual(info["size"], [16, 16])
        with zipfile.ZipFile(self.folder / "l.zip") as archive:
            self.assertIsNone(archive.testzip())
            names = archive.namelist()
            manifest = json.loads(archive.read("l/measurement.json"))
        self.assertEqual(len(names), 626)
        self.assertIn("l/tv030_pv000/00001 tl000 pl000 tv030 pv000.jpg", names)
        self.assertTrue(manifest["radiometry"]["cosine_included"])
        self.assertEqual(manifest["surface"], {"preset": "leather", "seed": 0})
        self.assertEqual(self.leftovers(), [])

    def test_the_truth_lies_beside_it(self):
        self.succeed("measure", "knit", "-o", "deep/k", "--size", "16", *self.lights("0,0"))
        truth = self.folder / "deep/k_truth"
        names = ["colour.png", "height.png", "measurement.json", "normal.png"]
        self.assertEqual(sorted(p.name for p in truth.iterdir()), [*names, "roughness.png"])
        for name, bits in (("height.png", 16), ("normal.png", 16), ("colour.png", 8)):
            header = (truth / name).read_bytes()[16:25]
            self.assertEqual(header[:8], b"\0\0\0\x10\0\0\0\x10")
            self.assertEqual(header[8], bits)

    def lights(self, *directions):
        rows = "".join(f"{d},0,0\n" for d in directions)
        path = self.file("l.csv", f"theta_i,phi_i,theta_v,phi_v\n{rows}".encode())
        return ["--directions", path]

    def test_a_flat_map_is_albedo_times_cosine(self):
        self.file("h.png", png([[100] * 8] * 8, 8, colour_type=0))
        self.file("c.png", png([[180, 120, 60] * 8] * 8, 8))
        self.succeed(
            *["measure", "--height", "h.png", "--colour", "c.png", "-o", "flat"],
            *["--lambert", "--size", "8", "--format", "png"],
            *self.lights("0,0", "60,90"),
        )
        for name, cosine in (
            ("00000 tl000 pl000 tv000 pv000.png", 1),
            ("00001 tl060 pl090 tv000 pv000.png", 0.5),
        ):
            _, _, rows = read_png(self.folder / "flat/tv000_pv000" / name)
            for band, code in enumerate((180, 120, 60)):
                value = code / 255
                linear = ((value + 0.055) / 1.055) ** 2.4
                for row in rows:
                    for c in range(8):
                        self.assertAlmostEqual(
                            row[3 * c + band], srgb(cosine * linear), delta=0.51
                        )

    def test_a_slope_turned_to_the_light_is_brighter(self):
        wave = [int(127 + 100 * math.sin(2 * math.pi * c / 32)) for c in range(32)]
        self.file("h.png", png([wave] * 32, 32, colour_type=0))
        self.succeed(
            *["measure", "--height", "h.png", "-o", "w", "--size", "32", "--format", "png"],
            *["--height-scale", "3", *self.lights("40,0")],
        )
        name = "w/tv000_pv000/00000 tl040 pl000 tv000 pv000.png"
        _, _, rows = read_png(self.folder / name)
        # Light from the right: the falling slope, columns 8 to 24, faces it.
        self.assertGreater(rows[5][3 * 16], rows[5][3 * 0] + 20)

    def test_every_format(self):
        for form, start in (
            ("jpg", b"\xff\xd8\xff"),
            ("png", b"\x89PNG"),
            ("png16", b"\x89PNG"),
            ("exr", b"\x76\x2f\x31\x01"),
        ):
            with self.subTest(form=form):
                self.succeed(
                    *["measure", "stone", "-o", form, "--format", form, "--size", "8"],
                    *self.lights("30,0"),
                )
                (image,) = (self.folder / form).glob("*/*")
                self.assertEqual(image.read_bytes()[: len(start)], start)

    def test_any_list_of_directions(self):
        self.file("d.csv", b"theta,phi\n0,0\n33.5,12.25\n")
        self.succeed(
            *["measure", "wood", "-o", "w.zip", "--directions", "d.csv", "--size", "8"]
        )
        info = self.succeed_with_json("info", "w.zip")
        self.assertEqual(info["layout"], "directions.csv")
        self.assertEqual(info["views"], [[0, 0], [33.5, 12.25]])
        # What was measured can be measured again.
        with zipfile.ZipFile(self.folder / "w.zip") as archive:
            self.file("again.csv", archive.read("w/directions.csv"))
        self.succeed(
            *["measure", "wood", "-o", "v.zip", "--directions", "again.csv", "--size", "8"]
        )
        self.assertEqual(self.succeed_with_json("info", "v.zip")["views"], info["views"])

    def test_the_same_bytes_for_any_number_of_threads(self):
        zips = []
        for threads in ("1", "2", "3"):
            self.succeed("measure", "twill", "-o", "t.zip", *SMALL, "--threads", threads)
            zips.append((self.folder / "t.zip").read_bytes())
        self.assertEqual(zips[0], zips[1])
        self.assertEqual(zips[0], zips[2])
        self.succeed("measure", "twill", "-o", "t.zip", *SMALL, "--seed", "1")
        self.assertNotEqual((self.folder / "t.zip").read_bytes(), zips[0])


class Refusals(CliTest):
    def test_usage(self):
        for arguments, names in (
            (["velvet", "-o", "v.zip"], ["velvet", "leather"]),
            (["-o", "v.zip"], ["SURFACE"]),
            (["leather"], ["--output"]),
            (["leather", "-o", "v.zip", "--colour", "c.png"], ["--height"]),
            (["leather", "-o", "v.zip", "--height", "h.png"], ["--height"]),
            (["leather", "-o", "v.zip", "--samples", "0"], ["--samples"]),
            (["leather", "-o", "v.zip", "--format", "gif"], ["--format"]),
            (["leather", "-o", "v.zip", "--size", "5000"], ["--size"]),
        ):
            with self.subTest(arguments=arguments):
                self.refuse("measure", *arguments, names=names, code=2)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_work_that_cannot_be_done(self):
        self.file("full/file", b"x")
        self.file("d.csv", b"theta,phi\n0,0\n89.5,0\n")
        self.file("bad.csv", b"theta,phi\n0,0\n100,0\n")
        for arguments, names in (
            (["leather", "-o", "full"], ["full", "there already"]),
            (["leather", "-o", "v.zip", "--size", "8x16"], ["8x16", "square"]),
            (["leather", "-o", "v.zip", "--directions", "no.csv"], ["no.csv"]),
            (["leather", "-o", "v.zip", "--directions", "bad.csv"], ["line 3", "100"]),
            (["leather", "-o", "v.zip", "--directions", "d.csv"], ["89.5", "89"]),
            (["--height", "none.png", "-o", "v.zip"], ["none.png"]),
        ):
            with self.subTest(arguments=arguments):
                self.refuse("measure", *arguments, names=names)
        names = sorted(p.name for p in self.folder.iterdir())
        self.assertEqual(names, ["bad.csv", "d.csv", "full"])


class Interrupted(CliTest):
    def test_goes_on_to_the_same_bytes(self):
        arguments = ["measure", "plaster", "-o", "p.zip", "--size", "48"]
        arguments += ["--directions", "coarse", "--interreflection", "0"]
        partial = self.folder / "p.zip.partial"
        with subprocess.Popen(
            [PROGRAM, *arguments], cwd=self.folder, stderr=subprocess.PIPE
        ) as process:
            while process.poll() is None and not list(partial.glob("tv030_pv000/*.jpg")):
                time.sleep(0.005)
            process.send_signal(signal.SIGINT)
            message = process.communicate(timeout=60)[1].decode()
        self.assertEqual(process.returncode, 1, message)
        self.assertTrue(message.startswith("sateen: error: cancelled"), message)
        self.assertIn("--resume", message)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["p.zip.partial"])
        self.assertEqual(self.leftovers(), [])

        self.refuse(*arguments, "--resume", "--seed", "1", names="other options")
        report = self.succeed_with_json(*arguments, "--resume")
        self.assertGreaterEqual(report["resumed"], 25)
        self.assertLess(report["resumed"], 625)
        resumed = (self.folder / "p.zip").read_bytes()
        self.assertFalse(partial.exists())
        self.succeed(*arguments)
        self.assertEqual((self.folder / "p.zip").read_bytes(), resumed)


if __name__ == "__main__":
    unittest.main()
