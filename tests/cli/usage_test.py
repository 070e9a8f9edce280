# SPDX-License-Identifier: Apache-2.0
"""Help, and arguments that make no sense: exit code 2."""

import unittest

from support import CliTest

VERBS = ("model", "synthesise", "info")


class Help(CliTest):
    def test_of_the_program_and_of_each_verb(self):
        text = self.succeed("--help").out
        for verb in VERBS:
            self.assertIn(verb, text)
            outcome = self.succeed(verb, "--help")
            self.assertIn(f"sateen {verb}", outcome.out)
            self.assertEqual(outcome.err, "")
            self.assertLessEqual(max(map(len, outcome.out.splitlines())), 100)

    def test_version(self):
        self.assertRegex(self.succeed("--version").out, r"^sateen \d+\.\d+\.\d+\n$")


class Usage(CliTest):
    def misuse(self, *arguments, names=()):
        self.refuse(*arguments, names=names, code=2)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_no_or_an_unknown_verb(self):
        self.misuse(names="verb")
        self.misuse("paint", names=["paint", "synthesise"])

    def test_an_unknown_option(self):
        for verb in VERBS:
            output = [] if verb == "info" else ["-o", "y"]
            names = ["--paint", f"sateen {verb} --help"]
            self.misuse(verb, "x", *output, "--paint", names=names)

    def test_a_missing_argument(self):
        self.misuse("model", "a.png", names="--output")
        self.misuse("model", "-o", "m.sateen", names="INPUT")
        self.misuse("synthesise", "m.sateen", names="--output")
        self.misuse("info", names="FILE")

    def test_values_out_of_range(self):
        wrong = {
            "--size": ["0x0", "0", "-5x5", "5x", "x5", "5x5x5", "1048577", "1e3", "9" * 30],
            "--offset": ["5", "1.5,0", "1073741825,0", "a,b", "1,2,3"],
            "--view": ["95,0", "-1,0", "10", "nan,0", "10,400", "inf,0"],
            "--light": ["95,0", "10,", ",10"],
            "--subspace": ["-1", "99999999999999999999", "one"],
            "--seed": ["-1", "18446744073709551616", "1.5", ""],
            "--threads": ["-1", "1025", "two"],
            "--bits": ["7", "64"],
        }
        for option, values in wrong.items():
            for value in values:
                with self.subTest(option=option, value=value):
                    self.misuse(
                        *["synthesise", "m.sateen", "-o", "t.png", f"{option}={value}"],
                        names=option,
                    )

    def test_values_out_of_range_for_models(self):
        wrong = {
            "--subspaces": ["0", "21", "-1", "many"],
            "--levels": ["0", "9"],
            "--field": ["car9d"],
            "--neighbourhood": ["order:99", "order:", "wide"],
            "--encoding": ["gamma"],
        }
        for option, values in wrong.items():
            for value in values:
                with self.subTest(option=option, value=value):
                    self.misuse(
                        *["model", "a.png", "-o", "m.sateen", option, value], names=option
                    )

    def test_options_that_exclude_each_other(self):
        for pair in (
            ["--all", "--subspace", "1"],
            ["--all", "--view", "0,0"],
            ["--tileable", "--offset", "1,1"],
            ["--subspace", "1", "--light", "0,0"],
            ["--format", "exr"],
        ):
            with self.subTest(pair=pair):
                self.misuse("synthesise", "m.sateen", "-o", "t", *pair, names="--")

    def test_negative_values_need_no_equals_sign(self):
        outcome = self.run_program(
            *["synthesise", "none.sateen", "-o", "t.png"],
            *["--offset", "-64,-32", "--light", "30,-90"],
        )
        self.assertEqual(outcome.code, 1, outcome)


if __name__ == "__main__":
    unittest.main()
