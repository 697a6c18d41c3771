"""The page as a file: the same bytes from the same calibration, every picture in it whole, not too large to be sent."""
import base64
import re
import struct
import unittest
import zlib
from pathlib import Path
from xml.etree import ElementTree

import pages

MOST_BYTES = 3_000_000


def broken_svgs(html: str) -> list[str]:
    found = []
    for svg in re.findall(r"<svg.*?</svg>", html, re.S):
        try:
            ElementTree.fromstring(svg)
        except ElementTree.ParseError as error:
            found.append(str(error))
    return found


def broken_images(html: str) -> list[str]:
    """Embedded PNG files whose chunks or whose pixels are not all there."""
    return [text[:40] for text in re.findall(r'"data:image/([^"]*)"', html) if not _is_png(text)]


def _is_png(text: str) -> bool:
    kind, _, data = text.partition(";base64,")
    png = base64.b64decode(re.sub(r"\s", "", data))
    if kind != "png" or png[:8] != b"\x89PNG\r\n\x1a\n":
        return False
    at, pixels, kinds = 8, b"", []
    while at + 12 <= len(png):
        length = struct.unpack(">I", png[at:at + 4])[0]
        kinds.append(png[at + 4:at + 8])
        content = png[at + 8:at + 8 + length]
        if png[at + 8 + length:at + 12 + length] != struct.pack(">I", zlib.crc32(kinds[-1] + content)):
            return False
        pixels += content if kinds[-1] == b"IDAT" else b""
        at += 12 + length
    return at == len(png) and kinds[0] == b"IHDR" and kinds[-1] == b"IEND" and len(zlib.decompress(pixels)) > 0


class BytesTest(unittest.TestCase):
    def test_the_same_calibration_gives_the_same_bytes(self):
        for scene in ["sample", "robot"]:
            html, pdf = pages.folder() / "again.html", pages.folder() / "again.pdf"
            words = pages.report(pages.calibration(scene), f"--out={html}", f"--pdf={pdf}", PYTHONHASHSEED="2",
                                 TZ="Asia/Tokyo", SOURCE_DATE_EPOCH="7")
            self.assertEqual(words, "")
            self.assertEqual(html.read_bytes(), pages.page(scene).read_bytes())
            self.assertEqual(pdf.read_bytes(), pages.pdf(scene).read_bytes())

    def test_pictures_are_whole(self):
        for scene in pages.SCENES:
            html = pages.page(scene).read_text(encoding="utf-8")
            self.assertEqual(broken_svgs(html), [])
            self.assertEqual(broken_images(html), [])
            self.assertLess(len(html), MOST_BYTES)

    def test_a_broken_picture_is_seen(self):
        html = pages.page("sample").read_text(encoding="utf-8")
        self.assertEqual(len(broken_svgs(html.replace("</svg>", "<g></svg>", 1))), 1)
        image = re.search(r'data:image/png;base64,\s*([^"]*)"', html)[1]
        self.assertEqual(len(broken_images(html.replace(image, image[:len(image) // 2 // 4 * 4]))), 1)
        self.assertEqual(len(broken_images(html.replace(image, image[:100] + ("A" if image[100] != "A" else "B") +
                                                        image[101:]))), 1)


if __name__ == "__main__":
    unittest.main()
