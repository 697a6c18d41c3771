"""The Digital Calibration Certificate: valid against PTB's schema, the numbers of calibration.json, nothing invented."""
import copy
import json
import math
import subprocess
import sys
import tempfile
import unittest
from decimal import Decimal
from pathlib import Path
from unittest import mock
from xml.etree import ElementTree

import paths
import dcc
from calibration import Calibration, Complaint
from language import Language
from synthetic import CERTIFICATE, calibration

SCHEMA = paths.DATA_SETS / "dcc-schema" / "v3.3.0" / "dcc.xsd"
NAMES = {"dcc": "https://ptb.de/dcc", "si": "https://ptb.de/si"}
POWERS = {"mm": -3, "rad": 0, "1": 0}
MANDATORY = ["identification", "country", "performed: begin", "performed: end", "performed: place", "item: name",
             "item: identifications", "laboratory: name", "laboratory: address: city", "customer: name",
             "customer: address: city", "persons"]


def certified(**changes) -> Calibration:
    return calibration(certificate=copy.deepcopy(CERTIFICATE), **changes)


def written(c: Calibration, language: str = "en") -> str:
    return dcc.certificate(c, Language(language))


def tree(xml: str) -> ElementTree.Element:
    return ElementTree.fromstring(xml.encode("utf-8"))


def texts(root: ElementTree.Element, path: str) -> list[str]:
    return [each.text for each in root.findall(path, NAMES)]


def complaint(c: Calibration) -> str:
    try:
        written(c)
    except Complaint as found:
        return str(found)
    return ""


def without(*path: str) -> Calibration:
    c = certified()
    parent = c["certificate"]
    for key in path[:-1]:
        parent = parent[key]
    del parent[path[-1]]
    return c


def with_given(value: object, *path: str | int) -> Calibration:
    c = certified()
    parent = c["certificate"]
    for key in path[:-1]:
        parent = parent[key]
    parent[path[-1]] = value
    return c


class SchemaTest(unittest.TestCase):
    """Skipped aloud without the schema, which is no part of the project."""

    def setUp(self):
        if not SCHEMA.exists():
            self.skipTest(f"NOT VALIDATED: there is no {SCHEMA}; set SCANCAL_DATASETS to the folder that holds dcc-schema/")

    def wrong(self, xml: str) -> str:
        """What xmllint has against it; empty if it is valid."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "dcc.xml"
            file.write_text(xml, encoding="utf-8")
            checked = subprocess.run(["xmllint", "--nonet", "--noout", "--schema", SCHEMA, file], capture_output=True, text=True)
        return "" if checked.returncode == 0 else checked.stderr

    def test_valid_in_every_language(self):
        warning = "the variances did not settle; compare u with u clustered"
        for language in ("en", "de"):
            for c in (certified(), certified(warnings=[warning, "another"], montecarlo={"trials": 1000}, budget=None)):
                self.assertEqual(self.wrong(written(c, language)), "")

    def test_valid_with_the_least_that_is_demanded(self):
        certificate = {"identification": 7, "country": "AT", "performed": {"begin": "2026-01-02", "end": "2026-01-02",
                       "place": "customerBranch"}, "persons": [{"name": "A. Berg"}],
                       "item": {"name": "x", "identifications": [{"issuer": "other", "value": 1}]},
                       "laboratory": {"name": "L", "address": {"city": "C"}},
                       "customer": {"name": "K", "address": {"city": "D"}}}
        bare = calibration(certificate=certificate, warnings=None, inputs=None, name=None, version=None, command=None,
                           budget=None, misfits=None, targets=None, lack_of_fit=None, coverage_probability=None)
        self.assertEqual(self.wrong(written(bare)), "")

    def test_valid_whatever_the_names_hold(self):
        evil = ']]>&lt;<script>\x07\ufffe "\' € 测量 ' + "long " * 60
        c = certified(name=evil, command=evil, warnings=[evil], version=" 1 ")
        c["certificate"] = json.loads(json.dumps(CERTIFICATE).replace('"Beispiel-Labor"', json.dumps(evil))
                                      .replace('"007"', json.dumps(evil)).replace('"B 12"', json.dumps(evil)))
        c["certificate"][evil] = {"a: b": [evil, {"{c}": True}]}
        for line in c["budget"]:
            line["source"] = evil
        xml = written(c)
        self.assertEqual(self.wrong(xml), "")
        self.assertIn(evil.replace("\x07\ufffe", "\ufffd\ufffd").strip(), texts(tree(xml), ".//dcc:declaration/dcc:content"))

    def test_extreme_numbers(self):
        c = certified()
        c["parameters"][0] |= {"value": -1.5e-300, "u": 1e-320, "U": 2.5e17, "k": 12.706204736174698, "dof": 1e-3}
        c["parameters"][1] |= {"value": 0, "k": 1e5, "dof": None}
        self.assertEqual(self.wrong(written(c)), "")

    def test_what_is_tampered_with_fails(self):
        xml = written(certified())
        for was, becomes in (
                ("<dcc:endPerformanceDate>2026-11-03</dcc:endPerformanceDate>", ""),  # a mandatory element
                ("<dcc:respPersons>", "<dcc:respPersons><dcc:respPerson/>"),
                ("<si:unit>\\metre</si:unit>", "<si:unit><si:metre/></si:unit>"),  # no text as unit
                ("<si:unit>\\metre</si:unit>", ""),
                ("<si:coverageProbability>0.95", "<si:coverageProbability>95"),
                ("<si:coverageFactor>2.04", "<si:coverageFactor>0.5"),
                ("<si:value>0.12300214", "<si:value>0,12300214"),
                ("2026-11-02<", "02.11.2026<"),
                ('schemaVersion="3.3.0"', 'schemaVersion="3.2.0"')):
            self.assertIn(was, xml)
            self.assertIn("error", self.wrong(xml.replace(was, becomes, 1)), was)


class NumbersTest(unittest.TestCase):
    """Each as Decimal: equal to the last digit of what calibration.json holds."""

    @classmethod
    def setUpClass(cls):
        cls.calibration = certified()
        cls.root = tree(written(cls.calibration))

    def exact(self, value: float, unit: str) -> Decimal:
        return Decimal(repr(value)).scaleb(POWERS[unit])

    def test_values_expanded_uncertainties_and_factors(self):
        quantities = self.root.findall(".//dcc:quantity[@refType='basic_measuredValue']", NAMES)
        self.assertEqual(len(quantities), 3)
        for quantity, parameter in zip(quantities, self.calibration.estimated):
            unit = {"mm": "\\metre", "rad": "\\radian"}[parameter["unit"]]
            self.assertEqual(quantity.findtext("si:real/si:label", None, NAMES), parameter["name"])
            self.assertEqual(quantity.findtext("si:real/si:unit", None, NAMES), unit)
            for path, key, of in (("si:real/si:value", "value", parameter["unit"]), (".//si:valueExpandedMU", "U", parameter["unit"]),
                                  (".//si:coverageFactor", "k", "1")):
                self.assertEqual(Decimal(quantity.findtext(path, None, NAMES)), self.exact(parameter[key], of))
            self.assertEqual(quantity.findtext(".//si:coverageProbability", None, NAMES), "0.95")
            u, dof = quantity.findall("dcc:measurementMetaData//si:real", NAMES)
            self.assertEqual(Decimal(u.findtext("si:value", None, NAMES)), self.exact(parameter["u"], parameter["unit"]))
            self.assertEqual(u.findtext("si:unit", None, NAMES), unit)
            self.assertEqual(Decimal(dof.findtext("si:value", None, NAMES)), Decimal(repr(parameter["dof"])))

    def test_the_ellipsoid(self):
        region = self.root.find(".//si:realList", NAMES)
        self.assertEqual(texts(region, "si:real/si:label"), ["M", "N", "tilt_x"])
        self.assertEqual([Decimal(text) for text in texts(region, "si:real/si:value")],
                         [self.exact(p["value"], p["unit"]) for p in self.calibration.estimated])
        columns = region.findall(".//si:column", NAMES)
        units = [parameter["unit"] for parameter in self.calibration.estimated]
        signs = {"mm": "\\metre", "rad": "\\radian"}
        for j, column in enumerate(columns):
            for i, element in enumerate(column.findall("si:covariance", NAMES)):
                self.assertEqual(Decimal(element.findtext("si:value", None, NAMES)),
                                 Decimal(repr(self.calibration["covariance"][i][j])).scaleb(POWERS[units[i]] + POWERS[units[j]]))
                self.assertEqual(element.findtext("si:unit", None, NAMES), signs[units[i]] + signs[units[j]])
        self.assertEqual([len(column) for column in columns], [3, 3, 3])
        self.assertEqual(texts(region, ".//si:coverageFactor"), ["2.93"])

    def test_the_budget(self):
        line = self.root.findall(".//dcc:list", NAMES)[1]
        self.assertEqual(texts(line, "dcc:name/dcc:content"), ["scale_y"])
        self.assertEqual([Decimal(text) for text in texts(line, "dcc:quantity//si:value")],
                         [Decimal("0.0001"), Decimal("0.000002"), Decimal("0.000001"), Decimal(0)])
        self.assertEqual(texts(line, "dcc:quantity//si:unit"), ["\\one", "\\metre", "\\metre", "\\radian"])

    def test_a_number_keeps_every_digit(self):
        for value in (0.1 + 0.2, 123.00704315820686, 5e-324, 1.7976931348623157e308, -2.5, 7, 1e22):
            self.assertEqual(Decimal(dcc.number(value, -3)) * 1000, Decimal(repr(value)))
            self.assertEqual(float(dcc.number(value)), value)

    def test_a_quantity_without_a_unit(self):
        c = certified()
        c["parameters"][2]["unit"] = "1"
        units = texts(tree(written(c)), ".//si:ellipsoidalRegion//si:unit")
        self.assertEqual(units[2], "\\metre")
        self.assertEqual(units[-1], "\\one")

    def test_without_end_of_the_degrees_of_freedom(self):
        c = certified()
        c["parameters"][0]["dof"] = None
        quantity = tree(written(c)).find(".//dcc:quantity[@refType='basic_measuredValue']", NAMES)
        self.assertEqual(len(quantity.findall("dcc:measurementMetaData//si:real", NAMES)), 1)
        self.assertEqual(texts(quantity, ".//si:distribution"), ["normal"])


class ContentTest(unittest.TestCase):
    def test_software_methods_hashes(self):
        root = tree(written(certified(montecarlo={"trials": 1000})))
        self.assertEqual(texts(root, ".//dcc:usedSoftware/dcc:software/dcc:release"), ["0.1.0"])
        self.assertEqual(texts(root, ".//dcc:usedMethod/dcc:norm"), ["JCGM 100:2008 (GUM)", "JCGM 101:2008"])
        hashes = [text for text in texts(root, ".//dcc:metaData/dcc:declaration/dcc:content") if text.startswith("SHA-256")]
        self.assertEqual(hashes, [f"SHA-256 {digit * 64}" for digit in "cd12"])
        self.assertEqual(texts(tree(written(certified())), ".//dcc:usedMethod/dcc:norm"), ["JCGM 100:2008 (GUM)"])

    def test_warnings_are_statements_in_the_language_they_are_in(self):
        c = certified(warnings=["the variances did not settle; compare u with u clustered", "never heard of"])
        statements = tree(written(c, "de")).findall(".//dcc:statement/dcc:declaration/dcc:content", NAMES)
        told = {each.text: each.get("lang") for each in statements}
        self.assertEqual(told["Die Varianzen liefen nicht ein; u ist mit der gruppierten Unsicherheit zu vergleichen"], "de")
        self.assertEqual(told["never heard of"], "en")
        self.assertIsNone(told["No part of this may be copied."])

    def test_what_is_not_traceable_says_so(self):
        self.assertEqual(texts(tree(written(certified())), ".//dcc:traceable"), [])
        only_a = certified(budget=calibration()["budget"][:1])
        self.assertEqual(texts(tree(written(only_a)), ".//dcc:traceable"), ["false"])

    def test_every_given_field_is_there(self):
        shown = {text.strip() for text in tree(written(certified())).itertext()}
        for text in ("K-2026-0815", "4711", "Liniensensor <am> Drehtisch", "Müller & Söhne", "LP 200", "007", "serial number",
                     "D-K-00000-01-00", "lab@example.org", "Hauptstraße", "1", "38116", "Braunschweig", "2nd floor", "Kunde AG",
                     "Wien", "A. Berg", "head of laboratory", "B. Tal", "plate", "2026-11-05", "20.1 °C ± 0.3 K", "B 12", "room"):
            self.assertIn(text, shown)
        self.assertIn("certificate: PTB 1234-26", shown)

    def test_nobody_signs_who_was_not_named_to(self):
        persons = tree(written(certified())).findall(".//dcc:respPerson", NAMES)
        self.assertEqual([person.findtext("dcc:mainSigner", None, NAMES) for person in persons], ["true", None])

    def test_the_same_bytes(self):
        self.assertEqual(written(certified()), written(certified()))


class RefusalTest(unittest.TestCase):
    def test_every_missing_field_is_listed_by_its_place_with_an_example(self):
        for c in (calibration(), calibration(certificate={}), calibration(certificate="text"), calibration(certificate=[1])):
            lines = complaint(c).split("\n")
            self.assertIn("certificate: of dataset.yaml", lines[0])
            found = [line.removeprefix("  certificate: ").split(": missing, for example ")[0] for line in lines[1:]]
            self.assertEqual(found, MANDATORY)

    def test_each_of_them_alone(self):
        self.assertEqual(complaint(certified()), "")
        for name in MANDATORY:
            with self.subTest(name):
                told = complaint(without(*name.split(": "))).split("\n")
                self.assertEqual(len(told), 2)
                self.assertTrue(told[1].startswith(f"  certificate: {name}: missing, for example "), told[1])

    def test_what_the_schema_would_not_take(self):
        for value, path, expected in (
                ("2.11.2026", ("performed", "begin"), 'performed: begin: found "2.11.2026", expected a date like'),
                ("2026-02-30", ("issued",), 'issued: found "2026-02-30", expected a date'),
                ("2026-11-01", ("performed", "end"), "performed: end: 2026-11-01 lies before the begin, 2026-11-02"),
                ("Deutschland", ("country",), 'country: found "Deutschland", expected two capital letters'),
                ("de", ("laboratory", "address", "country"), 'laboratory: address: country: found "de"'),
                ("home", ("performed", "place"), 'performed: place: found "home", expected one of laboratory, customer'),
                ("me", ("item", "identifications", 0, "issuer"), 'item: identifications: item 1: issuer: found "me"'),
                ({"issuer": "owner"}, ("item", "identifications", 0), "item: identifications: item 1: value: missing"),
                ("maybe", ("persons", 1, "signs"), 'persons: item 2: signs: found "maybe", expected yes or no'),
                ({"role": "x"}, ("persons", 1), "persons: item 2: name: missing"),
                ("A. Berg", ("persons",), "persons: found no list, for example"),
                ([], ("persons",), "persons: missing, for example"),
                ("plate", ("equipment",), "equipment: found no list")):
            with self.subTest(expected):
                told = complaint(with_given(value, *path))
                self.assertIn(f"  certificate: {expected}", told)
                self.assertEqual(told.count("\n"), 1, told)

    def test_a_result_that_should_not_be_relied_on(self):
        told = complaint(certified(status="unreliable", unreliable=["the sweep", "the search"]))
        self.assertIn("should not be relied on: the sweep (and 1 more)", told)
        self.assertIn("says so of itself", complaint(certified(status="unreliable", unreliable=None)))

    def test_a_result_that_is_not_whole(self):
        for parameter, key, value in ((0, "U", None), (1, "k", math.inf), (2, "u", math.nan), (0, "value", "1"), (0, "unit", "kg")):
            c = certified()
            c["parameters"][parameter][key] = value
            self.assertIn(c["parameters"][parameter]["name"], complaint(c))
        self.assertIn("joint", complaint(certified(joint={"k": None, "dof": None})))
        gap = certified()
        gap["covariance"][0][1] = None
        self.assertIn("covariance", complaint(gap))
        self.assertIn("nothing to certify", complaint(certified(parameters=[])))

    def test_nothing_is_written(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "calibration.json"
            file.write_text(json.dumps(calibration()), encoding="utf-8")
            run = subprocess.run([sys.executable, "-B", paths.SOURCE / "report" / "page", file, "--dcc", Path(folder) / "out.xml"],
                                 capture_output=True, text=True)
            self.assertEqual(run.returncode, 1)
            self.assertIn("scancal: ", run.stderr)
            self.assertNotIn("Traceback", run.stderr)
            self.assertEqual([each.name for each in Path(folder).iterdir()], ["calibration.json"])

    def test_a_run_that_breaks_leaves_the_old_file(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "out.xml"
            file.write_text("old")
            with mock.patch("os.replace", side_effect=OSError(28, "No space left on device")):
                with self.assertRaises(Complaint):
                    dcc.write_certificate(certified(), Language("en"), file)
            self.assertEqual(file.read_text(), "old")
            self.assertEqual(len(list(Path(folder).iterdir())), 1)


if __name__ == "__main__":
    unittest.main()
