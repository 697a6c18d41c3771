"""Small calibrations of no instrument at all, in the form of calibration.json."""
import html
import re
from pathlib import Path

import paths  # noqa: F401
import page
from calibration import Calibration
from language import Language

CERTIFICATE = {
    "identification": "K-2026-0815", "country": "DE", "order": 4711, "issued": "2026-11-05",
    "performed": {"begin": "2026-11-02", "end": "2026-11-03", "place": "laboratory"},
    "item": {"name": "Liniensensor <am> Drehtisch", "manufacturer": "Müller & Söhne", "model": "LP 200",
             "identifications": [{"issuer": "manufacturer", "value": "007", "name": "serial number"}]},
    "laboratory": {"name": "Beispiel-Labor", "code": "D-K-00000-01-00", "email": "lab@example.org",
                   "address": {"street": "Hauptstraße", "number": 1, "postcode": "38116",
                               "city": "Braunschweig",
                               "country": "DE", "further": "2nd floor"}},
    "customer": {"name": "Kunde AG", "address": {"city": "Wien"}},
    "persons": [{"name": "A. Berg", "role": "head of laboratory", "signs": True}, {"name": "B. Tal"}],
    "equipment": [{"name": "plate", "certificate": "PTB 1234-26"}],
    "statements": ["The results relate only to the item calibrated.", "No part of this may be copied."],
    "conditions": {"temperature": "20.1 °C ± 0.3 K"}, "room": "B 12"}


def estimated(name: str, value: float, u: float, unit: str = "mm", **more) -> dict:
    return {"name": name, "unit": unit, "role": "estimate", "value": value, "u": u, "k": 2.04, "U": 2.04 * u,
            "dof": 31.0,
            "u_naive": u / 2, "u_clustered": u, "u_jackknife": None, "u_bootstrap": u} | more


def said(english: str, german: str) -> dict:
    """One of "messages"."""
    return {"id": "some.message", "en": english, "de": german}


def calibration(**changes) -> Calibration:
    """A turntable with a tilt, so that units are mixed; changes replace keys, None removes one."""
    c = Calibration({
        "scancal": 1, "model": "turntable", "name": "plate", "residual": "depth", "status": "ok",
                     "unreliable": [],
        "warnings": [],
        "parameters": [estimated("M", 123.00214, 0.0054), estimated("N", 408.98765, 0.0131),
                       estimated("tilt_x", -0.00012346, 1.2e-6, "rad"),
                       {"name": "tilt_y", "unit": "rad", "role": "hold", "value": 0.0, "u": 0.0},
                       {"name": "scale_y", "unit": "1", "role": "consider", "value": 0.0, "u": 1e-4}],
        "covariance": [[2.916e-05, -3.1e-06, 1.7e-09], [-3.1e-06, 1.7161e-04, -2.3e-09],
                       [1.7e-09, -2.3e-09, 1.44e-12]],
        "correlation": [[1, -0.04, 0.26], [-0.04, 1, -0.15], [0.26, -0.15, 1]],
                     "covariance_of": ["M", "N", "tilt_x"],
        "coverage_probability": 0.95, "joint": {"k": 2.93, "dof": 31.0},
        "grid": {"step": 1.0, "S": 0.05, "nodes": 651, "M": 123.0, "N": 409.0},
        "targets": [{"name": "left", "points": 1000, "missing": 5, "set_aside": 3,
                     "set_aside_reasons": {"off the line of their profile": 3}},
                    {"name": "right", "points": 2000, "missing": 0, "set_aside": 0, "set_aside_reasons": {}}],
        "lack_of_fit": {"F": 4.36, "dof1": 189.0, "dof2": 17946.0, "p": 0.0},
        "misfits": [{"source": "tilt_y", "considered": False, "size": 3e-6, "unit": "rad", "F": 1.2,
                     "dof1": 1.0,
                     "dof2": 31.0, "p": 0.28, "moves": {"M": 0.0027, "N": 0.001, "tilt_x": 0.0}}],
        "budget": [{"source": "noise_y", "type": "A", "value": 0.05, "unit": "mm", "dof": 18000.0,
                    "u": {"M": 0.005, "N": 0.013, "tilt_x": 1.2e-6},
                    "share": {"M": 0.86, "N": 0.99, "tilt_x": 1.0}},
                   {"source": "scale_y", "type": "B", "value": 1e-4, "unit": "1", "dof": None,
                    "u": {"M": 0.002, "N": 0.001, "tilt_x": 0.0},
                    "share": {"M": 0.14, "N": 0.01, "tilt_x": 0.0}}],
        "data": {"targets": [{"name": "left", "profiles": 40}, {"name": "right", "profiles": 80}]},
                     "converged": True,
        "iterations": 7, "inputs": [{"file": "dataset.yaml", "sha256": "d" * 64},
                                    {"file": "left.csv", "sha256": "1" * 64},
                                    {"file": "right.csv", "sha256": "2" * 64}],
        "command": "scancal refine plate", "version": "0.1.0"})
    c.file, c.sha256 = Path("calibration.json"), "c" * 64
    c |= changes
    for key in [key for key, value in changes.items() if value is None]:
        del c[key]
    return c


def difference(**changes) -> dict:
    """"difference" of that calibration against one with M = 122.9: what `scancal report` adds."""
    return {"changes": [{"name": "M", "unit": "mm", "change": 0.1021, "u": 0.0076, "U": 0.0155, "E_n": 6.6},
                        {"name": "N", "unit": "mm", "change": 0.0, "u": 0.0185, "U": 0.038, "E_n": 0.0},
                        {"name": "tilt_x", "unit": "rad", "change": 0.0, "u": 2e-6, "U": None, "E_n": None}],
            "shared": ["scale_y"], "doubts": []} | changes


def text_of(section: str, c: Calibration, previous: Calibration | None = None, language: str = "en") -> str:
    """What a reader sees of a section, in one line."""
    body = page.render_section(section, page.environment_of(c, previous, Language(language, c, previous)))
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", body)).split())
