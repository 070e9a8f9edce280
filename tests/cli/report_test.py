# SPDX-License-Identifier: Apache-2.0
"""sateen model --report: a page that needs nothing but itself."""

import html
import html.parser
import unittest

from support import CliTest, photograph


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.sources = []
        self.cells = []
        self.in_cell = False

    def handle_starttag(self, tag, attributes):
        self.in_cell = tag in ("td", "th")
        for name, value in attributes:
            if name in ("src", "href"):
                self.sources.append(value)

    def handle_data(self, data):
        if self.in_cell:
            self.cells.append(data)


class Report(CliTest):
    def read(self, name):
        page = Page()
        page.feed((self.folder / name).read_text(encoding="utf-8"))
        return page

    def test_of_a_photograph_shows_bytes_and_scores(self):
        self.file("stone.png", photograph(96, 96))
        report = self.succeed_with_json(
            "model", "stone.png", "-o", "m.sateen", "--report", "r.html"
        )
        page = self.read("r.html")
        self.assertIn(str(report["bytes"]), page.cells)
        self.assertIn("stone.png", page.cells)
        self.assertGreaterEqual(len(page.sources), 4)
        for source in page.sources:
            self.assertTrue(source.startswith("data:"), source[:40])
        self.assertEqual(self.leftovers(), [])

    def test_of_a_measurement_has_a_row_for_every_subspace(self):
        report = self.succeed_with_json(
            "model", self.measurement(), "-o", "m.sateen", "--report", "r.html"
        )
        page = self.read("r.html")
        for subspace in report["subspaces"]:
            self.assertIn(subspace["representative"], page.cells)

    def test_names_what_the_published_estimators_ran_into(self):
        self.file("stone.png", photograph(96, 96))
        for says, options in (
            ("spectrum is not positive", ["--field", "gmrf2d"]),
            ("nearly singular", ["--field", "sar3d", "--neighbourhood", "order:2"]),
        ):
            report = self.succeed_with_json(
                "model", "stone.png", "-o", "m.sateen", "--paper", *options, "--report", "r.html"
            )
            self.assertTrue(any(says in note for note in report["notes"]), report["notes"])
            page = (self.folder / "r.html").read_text(encoding="utf-8")
            for note in report["notes"]:
                self.assertIn(html.escape(note), page.replace("'", "&#x27;"))

    def test_is_refused_before_the_work_where_it_cannot_be_written(self):
        self.file("stone.png", photograph(96, 96))
        self.refuse(
            "model", "stone.png", "-o", "m.sateen", "--report", "no/r.html",
            names=["no/r.html"],
        )
        self.assertFalse((self.folder / "m.sateen").exists())


if __name__ == "__main__":
    unittest.main()
