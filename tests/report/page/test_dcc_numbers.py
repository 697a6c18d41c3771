"""A Digital Calibration Certificate holds the numbers of calibration.json, results to their digits, and nothing invented."""
import unittest
from decimal import Decimal

from certificates import NAMES, certified, texts, tree, written
import dcc
from test_dcc import as_found_scene
from synthetic import calibration, difference, said

UNITS = {"mm": "\\milli\\metre", "rad": "\\radian"}


class NumbersTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.calibration = certified()
        cls.root = tree(written(cls.calibration))

    def exact(self, value: float) -> Decimal:
        return Decimal(repr(value))

    def test_values_end_where_U_does_with_two_digits_and_k_has_three(self):
        quantities = self.root.findall(".//dcc:quantity[@refType='basic_measuredValue']", NAMES)
        told = [[quantity.findtext(path, None, NAMES) for path in (
            "si:real/si:label", "si:real/si:value", "si:real/si:unit", ".//si:valueExpandedMU", ".//si:coverageFactor",
            ".//si:coverageProbability")] for quantity in quantities]
        self.assertEqual(told, [["M", "123.002", UNITS["mm"], "0.011", "2.04", "0.95"],
                                ["N", "408.988", UNITS["mm"], "0.027", "2.04", "0.95"],
                                ["tilt_x", "-0.0001235", UNITS["rad"], "0.0000024", "2.04", "0.95"]])
        u, dof = quantities[0].findall("dcc:measurementMetaData//si:real", NAMES)
        self.assertEqual((u.findtext("si:value", None, NAMES), u.findtext("si:unit", None, NAMES)),
                         ("0.0054", UNITS["mm"]))
        self.assertEqual(dof.findtext("si:value", None, NAMES), "31")

    def test_rounding(self):
        for value, digits, expected in ((0.0996, 2, "0.10"), (0.0994, 2, "0.099"), (1.96463, 3, "1.96"),
                                        (12.7062, 3, "12.7"), (0, 2, "0"), (2.5e17, 2, "2.5E+17")):
            self.assertEqual(dcc.rounded(value, digits), expected)
        for U, value, expected in ((0.0996, 123.456, "123.46"), (0.011, 122.9999, "123.000"), (14.0, 1234.5, "1234")):
            self.assertEqual(dcc.to_last_digit_of(U, value), expected)

    def test_the_ellipsoid(self):
        region = self.root.find(".//si:realList", NAMES)
        self.assertEqual(texts(region, "si:real/si:label"), ["M", "N", "tilt_x"])
        self.assertEqual([Decimal(text) for text in texts(region, "si:real/si:value")],
                         [self.exact(p["value"]) for p in self.calibration.estimated])
        columns = region.findall(".//si:column", NAMES)
        units = [parameter["unit"] for parameter in self.calibration.estimated]
        for j, column in enumerate(columns):
            for i, element in enumerate(column.findall("si:covariance", NAMES)):
                self.assertEqual(Decimal(element.findtext("si:value", None, NAMES)),
                                 self.exact(self.calibration["covariance"][i][j]))
                self.assertEqual(element.findtext("si:unit", None, NAMES), UNITS[units[i]] + UNITS[units[j]])
        self.assertEqual([len(column) for column in columns], [3, 3, 3])
        self.assertEqual(texts(region, ".//si:coverageFactor"), ["2.93"])

    def test_the_budget(self):
        line = self.root.findall(".//dcc:list", NAMES)[1]
        self.assertEqual(texts(line, "dcc:name/dcc:content"), ["scale_y"])
        self.assertEqual([Decimal(text) for text in texts(line, "dcc:quantity//si:value")],
                         [Decimal("0.0001"), Decimal("0.002"), Decimal("0.001"), Decimal(0)])
        self.assertEqual(texts(line, "dcc:quantity//si:unit"), ["\\one", UNITS["mm"], UNITS["mm"], UNITS["rad"]])

    def test_a_number_keeps_every_digit(self):
        for value in (0.1 + 0.2, 123.00704315820686, 5e-324, 1.7976931348623157e308, -2.5, 7, 1e22):
            self.assertEqual(Decimal(dcc.number(value)), Decimal(repr(value)))
            self.assertEqual(float(dcc.number(value)), value)

    def test_a_quantity_without_a_unit(self):
        c = certified()
        c["parameters"][2]["unit"] = "1"
        units = texts(tree(written(c)), ".//si:ellipsoidalRegion//si:unit")
        self.assertEqual(units[2], "\\milli\\metre")
        self.assertEqual(units[-1], "\\one")

    def test_without_end_of_the_degrees_of_freedom(self):
        c = certified()
        c["parameters"][0]["dof"] = None
        quantity = tree(written(c)).find(".//dcc:quantity[@refType='basic_measuredValue']", NAMES)
        self.assertEqual(len(quantity.findall("dcc:measurementMetaData//si:real", NAMES)), 1)
        self.assertEqual(texts(quantity, ".//si:distribution"), ["normal"])


class ContentTest(unittest.TestCase):
    def test_the_environment(self):
        conditions = tree(written(certified())).findall(".//dcc:influenceCondition", NAMES)
        self.assertEqual([(texts(each, "dcc:name/dcc:content"), texts(each, "dcc:data/dcc:text/dcc:content"))
                          for each in conditions], [(["temperature"], ["20.1 °C ± 0.3 K"])])
        c = certified()
        c["certificate"]["conditions"] = "quiet"
        self.assertEqual(texts(tree(written(c)), ".//dcc:influenceCondition/dcc:name/dcc:content"), ["environment"])
        del c["certificate"]["conditions"]
        self.assertEqual(tree(written(c)).findall(".//dcc:influenceConditions", NAMES), [])

    def test_as_found(self):
        changes = difference()["changes"]
        changes[2] |= {"U": 4e-6, "E_n": 0.0}
        compared = certified(difference=difference(changes=changes,
                                                   doubts=[said("Both use the same measurements", "")]))
        lines = [each for each in tree(written(compared, previous=as_found_scene())).findall(".//dcc:list", NAMES)
                 if each.findall("dcc:quantity", NAMES)[0].get("refType") == "basic_measuredValue"]
        self.assertEqual([texts(each, "dcc:quantity//si:value") for each in lines],
                         [["122.900", "0.102", "6.6"], ["408.988", "0.000", "0.0"], ["-0.0001235", "0.0000000", "0.0"]])
        self.assertEqual([texts(each, "dcc:description/dcc:content") for each in lines],
                         [["changed"], ["no change shown"], ["no change shown"]])
        shown = " ".join(tree(written(compared, previous=as_found_scene())).itertext())
        for text in ("K-2025-7, 2025-11-02, plate, last year", "Decision rule", "Both use the same measurements",
                     "as one and the same error in both: scale_y"):
            self.assertIn(text, shown)
        unreliable = as_found_scene()
        unreliable["status"] = "unreliable"
        self.assertNotIn("Decision rule", written(compared, previous=unreliable))
        self.assertNotIn("Decision rule", written(certified()))

    def test_influences_that_the_data_cannot_exclude(self):
        misfit = calibration()["misfits"][0] | {"moves": {"M": 0.03}}
        self.assertIn("neither show nor exclude: tilt_y", written(certified(misfits=[misfit])))

    def test_software_methods_hashes(self):
        root = tree(written(certified(montecarlo={"trials": 1000})))
        self.assertEqual(texts(root, ".//dcc:usedSoftware/dcc:software/dcc:release"), ["0.1.0"])
        self.assertEqual(texts(root, ".//dcc:usedMethod/dcc:norm"), ["JCGM 100:2008 (GUM)", "JCGM 101:2008"])
        hashes = [text for text in texts(root, ".//dcc:metaData/dcc:declaration/dcc:content")
                  if text.startswith("SHA-256")]
        self.assertEqual(hashes, [f"SHA-256 {digit * 64}" for digit in "cd12"])
        self.assertEqual(texts(tree(written(certified())), ".//dcc:usedMethod/dcc:norm"),
                         ["JCGM 100:2008 (GUM)"])

    def test_warnings_are_statements_in_the_language_they_are_in(self):
        warning = "the variances did not settle; compare u with u clustered"
        c = certified(warnings=[warning, "never heard of"],
                      messages=[said(warning, "Die Varianzen liefen nicht ein; u ist zu vergleichen")])
        statements = tree(written(c, "de")).findall(".//dcc:statement/dcc:declaration/dcc:content", NAMES)
        told = {each.text: each.get("lang") for each in statements}
        self.assertIn(("Die Varianzen liefen nicht ein", "de"),
                      [(key.split(";")[0], told[key]) for key in told])
        self.assertEqual(told["never heard of"], "en")
        self.assertIsNone(told["No part of this may be copied."])

    def test_what_is_not_traceable_says_so(self):
        self.assertEqual(texts(tree(written(certified())), ".//dcc:traceable"), [])
        only_a = certified(budget=calibration()["budget"][:1])
        self.assertEqual(texts(tree(written(only_a)), ".//dcc:traceable"), ["false"])

    def test_every_given_field_is_there(self):
        shown = {text.strip() for text in tree(written(certified())).itertext()}
        for text in ("K-2026-0815", "4711", "Liniensensor <am> Drehtisch", "Müller & Söhne", "LP 200", "007",
                     "serial number",
                     "D-K-00000-01-00", "lab@example.org", "Hauptstraße", "1", "38116", "Braunschweig",
                     "2nd floor", "Kunde AG",
                     "Wien", "A. Berg", "head of laboratory", "B. Tal", "plate", "2026-11-05",
                     "20.1 °C ± 0.3 K", "B 12", "room"):
            self.assertIn(text, shown)
        self.assertIn("certificate: PTB 1234-26", shown)

    def test_nobody_signs_who_was_not_named_to(self):
        persons = tree(written(certified())).findall(".//dcc:respPerson", NAMES)
        self.assertEqual([person.findtext("dcc:mainSigner", None, NAMES) for person in persons],
                         ["true", None])

    def test_the_same_bytes(self):
        self.assertEqual(written(certified()), written(certified()))


if __name__ == "__main__":
    unittest.main()
