# SPDX-License-Identifier: Apache-2.0
"""Work that cannot be done ends with exit code 1, one line, and no file."""

import gzip
import os
import unittest

from support import CliTest, photograph


class Inputs(CliTest):
    def test_a_missing_path(self):
        self.refuse("model", "nowhere", "-o", "m.sateen", names="nowhere: does not exist")
        self.refuse("info", "nowhere", names="nowhere: does not exist")
        self.refuse("synthesise", "nowhere", "-o", "t.png", names="nowhere")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_an_empty_folder(self):
        (self.folder / "empty").mkdir()
        self.refuse("model", "empty", "-o", "m.sateen", names="empty")
        self.refuse("info", "empty", names="empty")

    def test_files_that_are_no_images(self):
        self.file("a.png", b"")
        self.refuse("model", "a.png", "-o", "m.sateen", names="a.png")
        self.file("a.png", b"This is not an image.")
        self.refuse("model", "a.png", "-o", "m.sateen", names="a.png")
        self.file("a.png", photograph()[:1000])
        self.refuse("model", "a.png", "-o", "m.sateen", names="a.png")
        self.file("a.zip", b"PK\3\4 and no more")
        self.refuse("model", "a.zip", "-o", "m.sateen", names="a.zip")

    def test_inputs_that_do_not_go_together(self):
        self.file("a.png", photograph())
        self.measurement()
        self.refuse("model", "a.png", "ubo", "-o", "m.sateen", names="ubo")

    def test_a_list_that_names_a_missing_file(self):
        self.file("csv/a.png", photograph())
        self.file(
            "csv/directions.csv",
            b"file,theta_i,phi_i,theta_v,phi_v\na.png,0,0,0,0\nb.png,9,0,0,0\n",
        )
        names = ["directions.csv, line 3", "b.png"]
        self.refuse("model", "csv", "-o", "m.sateen", names=names)

    def test_a_material_is_not_a_measurement_nor_the_reverse(self):
        self.material()
        self.refuse("model", "m.sateen", "-o", "n.sateen", names="m.sateen")
        self.refuse("synthesise", "photo.png", "-o", "t.png", names="photo.png")
        self.refuse("synthesise", ".", "-o", "t.png", names="folder")

    def test_a_subspace_that_the_material_has_not(self):
        self.material()
        arguments = ["m.sateen", "-o", "t.png", "--subspace", "1"]
        self.refuse("synthesise", *arguments, names="subspace 1")
        self.assertFalse((self.folder / "t.png").exists())
        self.assertEqual(self.leftovers(), [])


class DamagedMaterials(CliTest):
    def refuse_material(self, data):
        self.file("bad.sateen", data)
        for arguments in (["info"], ["synthesise", "-o", "t.png", "--size", "8"]):
            self.refuse(*arguments, "bad.sateen", names="bad.sateen")

    def test_truncated(self):
        data = self.material().read_bytes()
        for length in (0, 1, 2, 10, 18, len(data) // 2, len(data) - 9, len(data) - 1):
            with self.subTest(length=length):
                self.file("bad.sateen", data[:length])
                self.refuse(
                    "synthesise", "bad.sateen", "-o", "t.png", names="bad.sateen"
                )

    def test_altered(self):
        payload = gzip.decompress(self.material().read_bytes())
        for at in range(0, 8):
            altered = bytearray(payload)
            altered[at] ^= 0x55
            with self.subTest(at=at):
                self.refuse_material(gzip.compress(bytes(altered)))

    def test_hostile(self):
        self.refuse_material(gzip.compress(b"SATEEN" * 100))
        self.refuse_material(gzip.compress(b"\xff" * 64))
        self.refuse_material(gzip.compress(bytes(1 << 27), compresslevel=1))


class Outputs(CliTest):
    def setUp(self):
        super().setUp()
        self.material()

    def refuse_output(self, out, names=None, *more):
        names = names or str(out)
        for verb, source in (("model", "photo.png"), ("synthesise", "m.sateen")):
            with self.subTest(verb=verb, out=out):
                self.refuse(verb, source, "-o", out, *more, names=names)
        self.assertEqual(self.leftovers(), [])

    def test_a_folder_that_does_not_exist(self):
        self.refuse_output("nowhere/t.png")

    def test_a_folder(self):
        (self.folder / "t.png").mkdir()
        self.refuse_output("t.png")

    def test_a_full_disk(self):
        (self.folder / "full.png").symlink_to("/dev/full")
        self.refuse_output("full.png")
        self.assertTrue((self.folder / "full.png").is_symlink())

    @unittest.skipIf(os.geteuid() == 0, "root may write anywhere")
    def test_a_folder_that_is_not_writable(self):
        (self.folder / "closed").mkdir(mode=0o555)
        self.refuse_output("closed/t.png")

    def test_an_unknown_extension(self):
        self.refuse(*["synthesise", "m.sateen", "-o", "t.xyz"], names=["t.xyz", ".png"])

    def test_a_depth_that_the_format_has_not(self):
        self.refuse(
            *["synthesise", "m.sateen", "-o", "t.png", "--bits", "32"], names="t.png"
        )

    def test_all_into_a_file(self):
        self.refuse("synthesise", "m.sateen", "-o", "photo.png", "--all", names="photo.png")

    def test_a_failure_leaves_the_old_file(self):
        self.file("t.sateen", b"old")
        self.file("bad.png", photograph()[:500])
        self.refuse("model", "bad.png", "-o", "t.sateen", names="bad.png")
        self.assertEqual((self.folder / "t.sateen").read_bytes(), b"old")


if __name__ == "__main__":
    unittest.main()
