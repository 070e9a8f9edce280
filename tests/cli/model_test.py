# SPDX-License-Identifier: Apache-2.0
"""sateen model: every kind of input, and odd ones."""

import signal
import subprocess
import time
import unittest
import zipfile

from support import PROGRAM, CliTest, photograph, png, texture


class Budget(CliTest):
    def test_is_kept_and_says_what_it_cost(self):
        self.file("stone.png", photograph(128, 128))
        free = self.succeed_with_json("model", "stone.png", "-o", "free.sateen")
        most = free["bytes"] * 8 // 10
        report = self.succeed_with_json(
            "model", "stone.png", "-o", "m.sateen", "--budget", str(most)
        )
        self.assertLessEqual(report["bytes"], most)
        self.assertEqual((self.folder / "m.sateen").stat().st_size, report["bytes"])
        self.assertTrue(report["budget"]["savings"])

    def test_of_a_measurement_is_kept_with_fewer_subspaces(self):
        free = self.succeed_with_json("model", self.measurement(), "-o", "f.sateen")
        most = free["bytes"] * 4 // 10
        report = self.succeed_with_json(
            "model", "ubo", "-o", "m.sateen", "--budget", str(most)
        )
        self.assertLessEqual(report["bytes"], most)
        self.assertLess(len(report["subspaces"]), len(free["subspaces"]))

    def test_changes_nothing_where_it_suffices(self):
        self.file("stone.png", photograph(64, 64))
        free = self.succeed_with_json("model", "stone.png", "-o", "free.sateen")
        report = self.succeed_with_json(
            "model", "stone.png", "-o", "m.sateen", "--budget", "100000"
        )
        self.assertEqual(report["budget"]["savings"], [])
        self.assertEqual(report["field"], free["field"])

    def test_that_nothing_can_keep_is_refused_with_the_size(self):
        self.file("stone.png", photograph(64, 64))
        self.refuse(
            "model", "stone.png", "-o", "m.sateen", "--budget", "100",
            names=["--budget 100", "stone", "bytes"],
        )
        self.assertFalse((self.folder / "m.sateen").exists())


class Inputs(CliTest):
    def model(self, *inputs):
        options = ["-o", "m.sateen", "--field", "car2d"]
        report = self.succeed_with_json("model", *inputs, *options)
        size = (self.folder / "m.sateen").stat().st_size
        self.assertEqual(report["bytes"], size)
        self.assertEqual(self.leftovers(), [])
        return report

    def test_one_photograph(self):
        self.file("stone.png", photograph(64, 96))
        report = self.model("stone.png")
        self.assertEqual(report["images"], 1)
        self.assertEqual(report["size"], [96, 64])
        self.assertEqual(len(report["subspaces"]), 1)
        self.assertLessEqual(report["bytes"], 4096)

    def test_several_photographs_of_different_sizes(self):
        self.file("a.png", photograph(64, 64, seed=1))
        self.file("b.png", photograph(80, 72, seed=2))
        self.assertEqual(self.model("a.png", "b.png")["images"], 2)

    def test_a_folder_named_as_by_ubo(self):
        report = self.model(self.measurement())
        self.assertEqual(report["images"], 9)
        members = sum(s["members"] for s in report["subspaces"])
        self.assertEqual(members, 9)

    def test_a_zip_gives_the_subspaces_of_its_folder(self):
        folder = self.measurement()
        with zipfile.ZipFile(self.folder / "ubo.zip", "w") as archive:
            for path in sorted(folder.iterdir()):
                archive.write(path, "deep/er/" + path.name)
        from_folder = self.model(folder)["subspaces"]
        from_zip = self.model("ubo.zip")["subspaces"]
        self.assertEqual(
            [s["members"] for s in from_folder], [s["members"] for s in from_zip]
        )

    def test_a_folder_with_directions_csv(self):
        lines = ["file,theta_i,phi_i,theta_v,phi_v"]
        for i, light in enumerate((0, 40, 70)):
            self.file(f"csv/shots/{i}.png", photograph(32, 32, seed=i))
            lines.append(f"shots/{i}.png,{light},10,0,0")
        self.file("csv/directions.csv", "\n".join(lines).encode())
        self.assertEqual(self.model("csv")["images"], 3)
        self.assertEqual(self.succeed_with_json("info", "csv")["layout"], "directions.csv")

    def test_a_number_of_subspaces(self):
        self.measurement()
        self.assertEqual(len(self.model("ubo", "--subspaces", "2")["subspaces"]), 2)

    def test_paper_mode(self):
        self.file("stone.png", photograph())
        report = self.succeed_with_json("model", "stone.png", "-o", "m.sateen", "--paper")
        self.assertTrue(report["paper"])
        self.assertEqual(report["subspaces"][0]["levels"], 3)
        self.assertEqual(self.succeed_with_json("info", "m.sateen")["drawing"], "recursive")

    def test_stdout_holds_data_only(self):
        self.file("stone.png", photograph(48, 48))
        outcome = self.succeed("model", "stone.png", "-o", "m.sateen")
        self.assertEqual(outcome.out, "")
        self.assertIn("m.sateen", outcome.err)
        self.assertEqual(outcome.err.count("\n"), 1)

    def test_the_same_bytes_for_any_number_of_threads_and_again(self):
        self.measurement()
        for name, threads in (("1", 1), ("2", 2), ("again", 2)):
            options = ["--field", "car2d", "--threads", threads]
            self.succeed("model", "ubo", "-o", name, *options)
        one = (self.folder / "1").read_bytes()
        self.assertEqual(one, (self.folder / "2").read_bytes())
        self.assertEqual(one, (self.folder / "again").read_bytes())


class OddImages(CliTest):
    def draws(self, data):
        """Models it, and draws from the model."""
        self.file("odd.png", data)
        self.succeed("model", "odd.png", "-o", "m.sateen")
        self.succeed("synthesise", "m.sateen", "-o", "t.png", "--size", "16x24")

    def test_grey(self):
        self.draws(png(texture(64, 64, bands=1), 64, colour_type=0))

    def test_16_bits(self):
        samples = [[257 * v for v in row] for row in texture(64, 64)]
        self.draws(png(samples, 64, bits=16))

    def test_palette(self):
        palette = [c for i in range(256) for c in (i, 255 - i, i // 2)]
        self.draws(png(texture(64, 64, bands=1), 64, colour_type=3, palette=palette))

    def test_alpha_is_dropped(self):
        rows = texture(64, 64)
        rgba = [[v for c in range(64) for v in (*row[3 * c : 3 * c + 3], 128)] for row in rows]
        self.draws(png(rgba, 64, colour_type=6))
        with_alpha = (self.folder / "t.png").read_bytes()
        self.draws(png(rows, 64))
        self.assertEqual((self.folder / "t.png").read_bytes(), with_alpha)

    def test_constant(self):
        self.draws(png([[90, 60, 30] * 64] * 64, 64))

    def test_slivers_draw_or_are_refused_in_one_line(self):
        for rows, cols in ((1, 1), (1, 64), (64, 1), (2, 2), (3, 200), (8, 8)):
            with self.subTest(rows=rows, cols=cols):
                self.file("odd.png", photograph(rows, cols))
                if self.run_program("model", "odd.png", "-o", "m.sateen").code == 0:
                    self.succeed("synthesise", "m.sateen", "-o", "t.png", "--size", "20x9")
                else:
                    self.refuse("model", "odd.png", "-o", "m.sateen", names="odd.png")

    def test_a_name_that_a_terminal_would_obey(self):
        name = "red\x1b[31m\nstone.png"
        self.file(name, photograph(48, 48))
        self.succeed("model", name, "-o", "m.sateen")
        self.assertEqual(self.succeed_with_json("info", "m.sateen")["name"], "red?[31m?stone")
        (self.folder / name).write_bytes(b"no image")
        self.refuse("model", name, "-o", "m.sateen", names="red?[31m?stone.png")


class BadMeasurements(CliTest):
    def test_skip_bad_leaves_out_and_lists_what_is_refused_otherwise(self):
        def truncate(folder):
            path = folder / "11 tl030 pl045 tv030 pv090.png"
            path.write_bytes(path.read_bytes()[:-400])
            return path.name

        def resize(folder):
            path = folder / "11 tl030 pl045 tv030 pv090.png"
            path.write_bytes(photograph(32, 31))
            return path.name

        def rename(folder):
            (folder / "11 tl030 pl045 tv030 pv090.png").rename(folder / "stray.png")
            return "stray.png"

        def repeat(folder):
            (folder / "99 tl030 pl045 tv030 pv090.png").write_bytes(photograph(32, 32))
            return "99 tl030 pl045 tv030 pv090.png"

        def misname(folder):
            name = "99 tl095 pl000 tv000 pv000.png"
            (folder / name).write_bytes(photograph(32, 32))
            return name

        for number, spoil in enumerate((truncate, resize, rename, repeat, misname)):
            with self.subTest(spoil=spoil.__name__):
                bad = spoil(self.measurement(f"set{number}"))
                self.refuse("model", f"set{number}", "-o", "m.sateen", names=bad)
                self.assertFalse((self.folder / "m.sateen").exists())
                outcome = self.succeed(
                    *["model", f"set{number}", "-o", "m.sateen", "--field", "car2d"],
                    *["--skip-bad", "--json"],
                )
                self.assertIn(bad, outcome.out)
                (self.folder / "m.sateen").unlink()

    def test_an_incomplete_set_is_fine(self):
        folder = self.measurement()
        (folder / "11 tl030 pl045 tv030 pv090.png").unlink()
        options = ["-o", "m.sateen", "--field", "car2d"]
        self.assertEqual(self.succeed_with_json("model", "ubo", *options)["images"], 8)
        self.assertEqual(self.succeed_with_json("info", "ubo")["missing_pairs"], 1)


class Interrupted(CliTest):
    def test_leaves_nothing_behind(self):
        image = photograph(128, 128)
        for light in range(0, 90, 5):
            for view in range(0, 90, 5):
                self.file(f"ubo/tl{light} pl0 tv{view} pv0.png", image)
        command = [PROGRAM, "model", "ubo", "-o", "m.sateen", "--threads", "1"]
        with subprocess.Popen(command, cwd=self.folder, stderr=subprocess.PIPE) as process:
            while process.poll() is None and not self.leftovers():
                time.sleep(0.002)
            process.send_signal(signal.SIGINT)
            message = process.communicate(timeout=60)[1].decode()
        self.assertEqual(process.returncode, 1, message)
        self.assertTrue(message.startswith("sateen: error: cancelled"), message)
        self.assertEqual(self.leftovers(), [])
        self.assertFalse((self.folder / "m.sateen").exists())


if __name__ == "__main__":
    unittest.main()
