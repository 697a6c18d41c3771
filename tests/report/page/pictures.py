"""The pictures inside a page, as files: which of them are not whole."""
import base64
import re
import struct
import zlib
from xml.etree import ElementTree


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
