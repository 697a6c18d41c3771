"""--dcc: valid against PTB's schema, or refused with all that is missing."""
import json
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import paths
import dcc
from calibration import Calibration, Complaint
from certificates import certified, texts, tree, written
from language import Language
from synthetic import CERTIFICATE, calibration, difference, said

SCHEMA = paths.DATA_SETS / "dcc-schema" / "v3.3.0" / "dcc.xsd"
MANDATORY = ["identification", "country", "performed: begin", "performed: end", "performed: place", "item: name",
             "item: identifications", "laboratory: name", "laboratory: address: city", "customer: name",
             "customer: address: city", "persons"]


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


def as_found_scene() -> Calibration:
    """A year before, of a certificate of its own."""
    c = certified(name="plate, last year")
    c["certificate"] |= {"identification": "K-2025-7", "performed": {"begin": "2025-11-02", "end": "2025-11-02"}}
    c["parameters"][0] = c["parameters"][0] | {"value": 122.9}
    c.sha256 = "e" * 64
    return c


class SchemaTest(unittest.TestCase):
    """Skipped aloud without the schema, which is no part of the project."""

    def setUp(self):
        if not SCHEMA.exists():
            self.skipTest(f"NOT VALIDATED: there is no {SCHEMA}; set SCANCAL_DATASETS to the folder that holds "
                          "dcc-schema/")

    def wrong(self, xml: str) -> str:
        """What xmllint has against it; empty if it is valid."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "dcc.xml"
            file.write_text(xml, encoding="utf-8")
            checked = subprocess.run(["xmllint", "--nonet", "--noout", "--schema", SCHEMA, file],
                                     capture_output=True, text=True)
        return "" if checked.returncode == 0 else checked.stderr

    def test_valid_in_every_language(self):
        warning = "the variances did not settle; compare u with u clustered"
        for language in ("en", "de"):
            for c in (certified(),
                      certified(warnings=[warning, "another"], montecarlo={"trials": 1000}, budget=None)):
                self.assertEqual(self.wrong(written(c, language)), "")
                c["difference"] = difference(doubts=[said("doubtful", "zweifelhaft")])
                self.assertEqual(self.wrong(written(c, language, previous=as_found_scene())), "")

    def test_valid_with_the_least_that_is_demanded(self):
        certificate = {"identification": 7, "country": "AT",
                       "performed": {"begin": "2026-01-02", "end": "2026-01-02",
                       "place": "customerBranch"}, "persons": [{"name": "A. Berg"}],
                       "item": {"name": "x", "identifications": [{"issuer": "other", "value": 1}]},
                       "laboratory": {"name": "L", "address": {"city": "C"}},
                       "customer": {"name": "K", "address": {"city": "D"}}}
        bare = calibration(certificate=certificate, warnings=None, inputs=None, name=None, version=None,
                           command=None,
                           budget=None, misfits=None, targets=None, lack_of_fit=None,
                           coverage_probability=None)
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
        self.assertIn(evil.replace("\x07\ufffe", "\ufffd\ufffd").strip(),
                      texts(tree(xml), ".//dcc:declaration/dcc:content"))

    def test_extreme_numbers(self):
        c = certified()
        c["parameters"][0] |= {"value": -1.5e-300, "u": 1e-320, "U": 2.5e17, "k": 12.706204736174698,
                               "dof": 1e-3}
        c["parameters"][1] |= {"value": 0, "k": 1e5, "dof": None}
        self.assertEqual(self.wrong(written(c)), "")

    def test_what_is_tampered_with_fails(self):
        xml = written(certified())
        for was, becomes in (
                ("<dcc:endPerformanceDate>2026-11-03</dcc:endPerformanceDate>", ""),  # a mandatory element
                ("<dcc:respPersons>", "<dcc:respPersons><dcc:respPerson/>"),
                ("<si:unit>\\milli\\metre</si:unit>", "<si:unit><si:metre/></si:unit>"),  # no text as unit
                ("<si:unit>\\milli\\metre</si:unit>", ""),
                ("<si:coverageProbability>0.95", "<si:coverageProbability>95"),
                ("<si:coverageFactor>2.04", "<si:coverageFactor>0.5"),
                ("<si:value>123.002<", "<si:value>123,002<"),
                ("2026-11-02<", "02.11.2026<"),
                ('schemaVersion="3.3.0"', 'schemaVersion="3.2.0"')):
            self.assertIn(was, xml)
            self.assertIn("error", self.wrong(xml.replace(was, becomes, 1)), was)


class RefusalTest(unittest.TestCase):
    def test_every_missing_field_is_listed_by_its_place_with_an_example(self):
        for c in (calibration(), calibration(certificate={}), calibration(certificate="text"),
                  calibration(certificate=[1])):
            lines = complaint(c).split("\n")
            self.assertIn("certificate: of dataset.yaml", lines[0])
            found = [line.removeprefix("  certificate: ").split(": missing, for example ")[0]
                     for line in lines[1:]]
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
                ("2.11.2026", ("performed", "begin"),
                 'performed: begin: found "2.11.2026", expected a date like'),
                ("2026-02-30", ("issued",), 'issued: found "2026-02-30", expected a date'),
                ("2026-11-01", ("performed", "end"),
                 "performed: end: 2026-11-01 lies before the begin, 2026-11-02"),
                ("Deutschland", ("country",), 'country: found "Deutschland", expected two capital letters'),
                ("de", ("laboratory", "address", "country"), 'laboratory: address: country: found "de"'),
                ("home", ("performed", "place"),
                 'performed: place: found "home", expected one of laboratory, customer'),
                ("me", ("item", "identifications", 0, "issuer"),
                 'item: identifications: item 1: issuer: found "me"'),
                ({"issuer": "owner"}, ("item", "identifications", 0),
                 "item: identifications: item 1: value: missing"),
                ("maybe", ("persons", 1, "signs"),
                 'persons: item 2: signs: found "maybe", expected yes or no'),
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
        for parameter, key, value in ((0, "U", None), (1, "k", math.inf), (2, "u", math.nan),
                                      (0, "value", "1"), (0, "unit", "kg")):
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
            run = subprocess.run([sys.executable, "-B", paths.SOURCE / "report" / "page", file, "--dcc",
                                  Path(folder) / "out.xml"],
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
                    dcc.write_certificate(certified(), None, Language("en"), file)
            self.assertEqual(file.read_text(), "old")
            self.assertEqual(len(list(Path(folder).iterdir())), 1)


if __name__ == "__main__":
    unittest.main()
