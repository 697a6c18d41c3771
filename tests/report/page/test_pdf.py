"""--pdf: whole tables and figures on A4, PDF/A as far as that can be told here, the same bytes from the same page."""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

import pages
from printed import Printed
from test_browser import InBrowser


def pdf_of(scene: str, name: str = "", **environment) -> Path:
    file = pages.folder() / f"{scene}{name}.pdf"
    pages.report(pages.calibration(scene), f"--pdf={file}", **environment)
    return file


class PdfTest(InBrowser):
    def test_prints_whole_figures_and_tables(self):
        for scene in ["sample", "robot", "bad", "named", "many_stations"]:
            self.browser.open(pages.page(scene))
            printed = Printed(pdf_of(scene))
            self.assertEqual(printed.wrong_sheets(), [])
            self.assertEqual(printed.lost(self.browser), [])
            self.assertEqual(printed.cut_figures(self.browser), [])
            self.assertEqual(printed.cut_rows(self.browser), [])
            name = re.sub(r"\s", "", json.loads(pages.calibration(scene).read_text())["name"])
            for letters in printed.pages:  # of every sheet, as far as the name has room
                self.assertIn(name[:40], letters)


class PdfFileTest(unittest.TestCase):
    def test_the_same_calibration_gives_the_same_bytes(self):
        one = pdf_of("sample", "1", PYTHONHASHSEED="1", TZ="UTC", SOURCE_DATE_EPOCH="7")
        two = pdf_of("sample", "2", PYTHONHASHSEED="2", TZ="Asia/Tokyo")
        self.assertEqual(one.read_bytes(), two.read_bytes())

    def test_is_for_the_archive(self):
        file = pdf_of("sample")
        content = file.read_bytes()
        self.assertIn(b'pdfaid:part="2" pdfaid:conformance="B"', content)
        self.assertIn(b"/GTS_PDFA1", content)
        self.assertRegex(content, rb"trailer[^>]*/ID \[")
        self.assertIn(b"/Interpolate false", content)  # there is an image, and it is not smoothed
        self.assertNotIn(b"/Interpolate true", content)
        fonts = subprocess.run(["pdffonts", file], capture_output=True, text=True, check=True).stdout.splitlines()[2:]
        self.assertRegex(str(fonts), r"\+Inter ")
        for font in fonts:
            self.assertRegex(font, r" yes yes yes ")  # embedded, a part, with its letters

    def test_says_what_is_missing(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "weasyprint.py").write_text("raise ImportError('No module named weasyprint')")
            self.refused(pages.calibration("sample"), "needs WeasyPrint .* install Debian's weasyprint$",
                         PYTHONPATH=folder)

    def test_a_letter_that_no_font_has_is_no_gap(self):
        found = json.loads(pages.calibration("sample").read_text()) | {"name": "plate \U0010fffd"}
        file = pages.folder() / "letter.json"
        file.write_text(json.dumps(found))
        self.refused(file, "no font of this computer has \U0010fffd: install one")

    def refused(self, calibration: Path, sentence: str, **environment):
        file = pages.folder() / "refused.pdf"
        done = subprocess.run([sys.executable, "-B", pages.SOURCE / "report/page", calibration, f"--pdf={file}"],
                              capture_output=True, text=True, env=os.environ | environment)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr.strip(), sentence)
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertFalse(file.exists())


if __name__ == "__main__":
    unittest.main()
