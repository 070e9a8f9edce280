# SPDX-License-Identifier: Apache-2.0
"""sateen info: what a measurement or a material holds."""

import subprocess
import unittest

from support import PROGRAM, CliTest, photograph


class Info(CliTest):
    def test_a_measurement(self):
        info = self.succeed_with_json("info", self.measurement())
        self.assertEqual(info["kind"], "measurement")
        self.assertEqual(info["layout"], "ubo2003")
        self.assertEqual(info["images"], 9)
        self.assertEqual(info["size"], [32, 32])
        self.assertEqual(info["views"], [[0, 0], [30, 90], [60, 90]])
        self.assertEqual(info["lights"], [[0, 0], [30, 45], [60, 45]])
        self.assertEqual(info["missing_pairs"], 0)

    def test_a_photograph(self):
        self.file("stone.png", photograph(20, 30))
        info = self.succeed_with_json("info", "stone.png")
        self.assertEqual((info["layout"], info["images"]), ("photograph", 1))
        self.assertEqual((info["views"], info["lights"]), ([], []))

    def test_a_material_of_a_measurement(self):
        self.measurement()
        options = "--field car2d --subspaces 2 --seed 7"
        self.succeed("model", "ubo", "-o", "m.sateen", *options.split())
        info = self.succeed_with_json("info", "m.sateen")
        self.assertEqual(info["kind"], "material")
        self.assertEqual(info["name"], "ubo")
        self.assertEqual(info["bytes"], (self.folder / "m.sateen").stat().st_size)
        self.assertEqual(info["source"]["layout"], "ubo2003")
        self.assertEqual(info["source"]["options"], options)
        self.assertEqual(info["measured_pairs"], 9)
        self.assertEqual([len(row) for row in info["index"]], [3, 3, 3])
        self.assertEqual({k for row in info["index"] for k in row}, {0, 1})
        self.assertEqual(len(info["subspaces"]), 2)
        measured = self.succeed_with_json("info", "ubo")
        self.assertEqual(info["source"]["checksum"], measured["checksum"])
        self.assertEqual(info["views"], measured["views"])

    def test_text_says_what_json_says(self):
        self.material()
        text = self.succeed("info", "m.sateen").out
        self.assertIn("kind                  material\n", text)
        self.assertIn("sample_size           96x96\n", text)
        self.assertNotIn("null", text)

    def test_skip_bad_lists_what_it_leaves_out(self):
        folder = self.measurement()
        self.file("ubo/stray.png", photograph(32, 32))
        self.refuse("info", folder, names="stray.png")
        self.assertIn("stray.png", self.succeed("info", folder, "--skip-bad").out)

    def test_a_full_standard_output_is_an_error(self):
        self.material()
        with open("/dev/full", "wb") as full:
            process = subprocess.run(
                [PROGRAM, "info", "m.sateen"],
                cwd=self.folder,
                stdout=full,
                stderr=subprocess.PIPE,
            )
        self.assertEqual(process.returncode, 1)
        self.assertTrue(process.stderr.startswith(b"sateen: error: "))


if __name__ == "__main__":
    unittest.main()
