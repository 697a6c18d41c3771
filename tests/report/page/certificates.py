"""Digital Calibration Certificates of small calibrations, and how to look into them."""
import copy
from xml.etree import ElementTree

import paths  # noqa: F401
import dcc
from calibration import Calibration
from language import Language
from synthetic import CERTIFICATE, calibration

NAMES = {"dcc": "https://ptb.de/dcc", "si": "https://ptb.de/si"}


def certified(**changes) -> Calibration:
    return calibration(certificate=copy.deepcopy(CERTIFICATE), **changes)


def written(c: Calibration, language: str = "en", previous: Calibration | None = None) -> str:
    return dcc.certificate(c, previous, Language(language, c, previous))


def tree(xml: str) -> ElementTree.Element:
    return ElementTree.fromstring(xml.encode("utf-8"))


def texts(root: ElementTree.Element, path: str) -> list[str]:
    return [each.text for each in root.findall(path, NAMES)]
