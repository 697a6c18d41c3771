"""--pdf: PDF/A as far as that can be told here; that it is whole, test_browser.py says."""
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
from synthetic import CERTIFICATE


def _without_compression(file: Path) -> bytes:
    """What it says and what it draws, whichever way a version of WeasyPrint packs them."""
    content = file.read_bytes()
    parts = [content]
    for stream in re.findall(rb">>\s*stream\r?\n(.*?)\r?\nendstream", content, re.S):
        try:
            parts.append(zlib.decompress(stream))
        except zlib.error:
            continue  # not packed
    return b"\n".join(parts)


class PdfTest(unittest.TestCase):
    def test_every_sheet_has_the_name(self):
        for scene in ["sample", "named_robot"]:
            name = re.sub(r"\s", "", json.loads(pages.calibration(scene).read_text())["name"])
            without = [k for k, letters in enumerate(Printed(pages.pdf(scene)).pages) if name[:40] not in letters]
            self.assertEqual(without, [], scene)  # of a long one more has no room

    def test_every_sheet_has_the_numbers_of_certificate_and_item_and_a_name_that_is_no_rule_of_style(self):
        found = json.loads(pages.calibration("sample").read_text()) | {
            "certificate": CERTIFICATE, "name": 'var(--evil) "; } h1 { font: 9px x'}
        file = pages.folder() / "numbers.json"
        file.write_text(json.dumps(found))
        pages.report(file, f"--pdf={file.with_suffix('.pdf')}")
        sheets = Printed(file.with_suffix(".pdf")).pages
        for k, letters in enumerate(sheets):
            self.assertIn("CertificateK-2026-0815,serialnumber007;var(--evil)\";}h1{font:9pxx", letters)
            self.assertIn(f"Page{k + 1}of{len(sheets)}", letters)
        self.assertIn("Endofthereport.", sheets[-1])

    def test_is_short(self):
        for scene, most in (("sample", 8), ("named_robot", 12)):  # of the sample with its Monte Carlo
            self.assertLessEqual(len(Printed(pages.pdf(scene)).pages), most, scene)

    def test_is_for_the_archive(self):
        file = pages.pdf("sample")
        content = _without_compression(file)
        for expected in (rb'pdfaid:part="2" pdfaid:conformance="B"', rb"/GTS_PDFA1", rb"/ID \[", rb"/Lang \(en\)",
                         rb"/Interpolate false"):  # there is an image, and it is not smoothed
            self.assertTrue(re.search(expected, content), expected)
        self.assertFalse(b"/Interpolate true" in content)
        self.assertIn("simulated plate, 3 placements, seed 1",
                      subprocess.run(["pdfinfo", file], capture_output=True, text=True, check=True).stdout)
        fonts = subprocess.run(["pdffonts", file], capture_output=True, text=True, check=True).stdout.splitlines()[2:]
        self.assertRegex(str(fonts), r"\+Inter[- ]")
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
