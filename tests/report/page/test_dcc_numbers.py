"""A Digital Calibration Certificate holds the numbers of calibration.json, to the last digit, and nothing invented."""
import unittest
from decimal import Decimal

from certificates import NAMES, certified, texts, tree, written
import dcc
from synthetic import calibration, said

POWERS = {"mm": -3, "rad": 0, "1": 0}


class NumbersTest(unittest.TestCase):
    """Each as Decimal: equal to the last digit of what calibration.json holds."""

    @classmethod
    def setUpClass(cls):
        cls.calibration = certified()
        cls.root = tree(written(cls.calibration))

    def exact(self, value: float, *units: str) -> Decimal:
        return Decimal(repr(value)).scaleb(sum(POWERS[unit] for unit in units))

    def test_values_expanded_uncertainties_and_factors(self):
        quantities = self.root.findall(".//dcc:quantity[@refType='basic_measuredValue']", NAMES)
        self.assertEqual(len(quantities), 3)
        for quantity, parameter in zip(quantities, self.calibration.estimated):
            unit = {"mm": "\\metre", "rad": "\\radian"}[parameter["unit"]]
            self.assertEqual(quantity.findtext("si:real/si:label", None, NAMES), parameter["name"])
            self.assertEqual(quantity.findtext("si:real/si:unit", None, NAMES), unit)
            for path, key, of in (("si:real/si:value", "value", parameter["unit"]),
                                  (".//si:valueExpandedMU", "U", parameter["unit"]),
                                  (".//si:coverageFactor", "k", "1")):
                self.assertEqual(Decimal(quantity.findtext(path, None, NAMES)),
                                 self.exact(parameter[key], of))
            self.assertEqual(quantity.findtext(".//si:coverageProbability", None, NAMES), "0.95")
            u, dof = quantity.findall("dcc:measurementMetaData//si:real", NAMES)
            self.assertEqual(Decimal(u.findtext("si:value", None, NAMES)),
                             self.exact(parameter["u"], parameter["unit"]))
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
                                 self.exact(self.calibration["covariance"][i][j], units[i], units[j]))
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
