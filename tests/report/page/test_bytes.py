"""The page as a file: the same bytes from the same calibration, and a broken picture in it would be seen."""
import re
import unittest

import pages
from pictures import broken_images, broken_svgs


class BytesTest(unittest.TestCase):
    def test_the_same_calibration_gives_the_same_bytes(self):
        for scene, printed in [("sample", True), ("robot", False)]:  # a PDF takes its time
            html, pdf = pages.folder() / "again.html", pages.folder() / "again.pdf"
            words = pages.report(pages.calibration(scene), f"--out={html}", *[f"--pdf={pdf}"] * printed,
                                 PYTHONHASHSEED="2", TZ="Asia/Tokyo", SOURCE_DATE_EPOCH="7")
            self.assertEqual(words, "")
            self.assertEqual(html.read_bytes(), pages.page(scene).read_bytes())
            if printed:
                self.assertEqual(pdf.read_bytes(), pages.pdf(scene).read_bytes())

    def test_a_broken_picture_is_seen(self):
        html = pages.page("sample").read_text(encoding="utf-8")
        self.assertEqual(len(broken_svgs(html.replace("</svg>", "<g></svg>", 1))), 1)
        image = re.search(r'data:image/png;base64,\s*([^"]*)"', html)[1]
        self.assertEqual(len(broken_images(html.replace(image, image[:len(image) // 2 // 4 * 4]))), 1)
        self.assertEqual(len(broken_images(html.replace(image, image[:100] + ("A" if image[100] != "A" else "B") +
                                                        image[101:]))), 1)


if __name__ == "__main__":
    unittest.main()
