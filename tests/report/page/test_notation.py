"""Numbers as GUM 7.2 writes them, with the rules of the text that the program prints: its tests hold here, too."""
import math
import random
import re
import unittest
from decimal import Decimal

import paths
import notation
from language import Language

CPP = re.compile(r'EXPECT_EQ\((Concise|Significant)\(([^"]*)\), "([^"]*)"\)')
NUMBERS = {"kNan": math.nan, "kInfinity": math.inf, "-kInfinity": -math.inf}


def typeset(printed: str) -> str:
    """What the program prints, as it stands on the page."""
    power = re.fullmatch(r"(.*)e([+-])0?(\d+)", printed)
    if power:
        sign = "⁻" if power[2] == "-" else ""
        printed = f"{power[1]} × 10{sign}" + "".join("⁰¹²³⁴⁵⁶⁷⁸⁹"[int(digit)] for digit in power[3])
    return {"-": "–", "infinite": "∞", "-infinite": "−∞"}.get(printed, printed.replace("-", "−"))


def value_of(shown: str) -> Decimal:
    return Decimal(shown.replace("−", "-"))


class SameAsPrintedTest(unittest.TestCase):
    def test_the_cases_of_the_text(self):
        source = (paths.SOURCE / "tests/report/text_table_test.cc").read_text(encoding="utf-8")
        cases = [case for case in CPP.findall(source) if re.fullmatch(r"[-\d.e, kNanIfity]+", case[1])]
        self.assertGreater(len(cases), 25)
        for rule, arguments, printed in cases:
            numbers = [NUMBERS[each] if each in NUMBERS else float(each) for each in arguments.split(", ")]
            if rule == "Significant":
                shown = notation.significant(numbers[0], int(numbers[1]))
            else:
                shown = notation.concise(*numbers)
            self.assertEqual(shown, typeset(printed), f"{rule}({arguments})")


class ConciseTest(unittest.TestCase):
    def test_two_digits_of_u_and_the_value_to_its_last(self):
        drawn = random.Random(20210408)
        for _ in range(20000):
            u = 10.0 ** drawn.uniform(-12, 2) if drawn.random() < 0.8 else 10.0 ** drawn.randint(-9, 1)
            value = drawn.choice([-1, 1]) * 10.0 ** drawn.uniform(-6, 4)
            shown = notation.concise(value, u)
            whole, digits = re.fullmatch(r"(−?[\d.]+)\((\d+)\)", shown).groups()
            unit = Decimal(1).scaleb(-len(whole.partition(".")[2]))
            self.assertTrue(10 <= int(digits) <= 99 or (unit == 1 and int(digits) >= 100), (value, u, shown))
            self.assertLessEqual(abs(value_of(whole) - Decimal(value)), unit / 2, (value, u, shown))
            self.assertLessEqual(abs(int(digits) * unit - Decimal(u)), unit * Decimal("0.500001"),
                                 (value, u, shown))

    def test_the_example_of_the_gum(self):
        self.assertEqual(notation.concise(100.02147, 0.00035), "100.02147(35)")

    def test_without_its_brackets(self):
        self.assertEqual(notation.to_last_digit_of(0.0054, 123.00214), "123.0021")
        self.assertEqual(notation.to_last_digit_of(None, 123.456789), "123.457")

    def test_nothing_to_show(self):
        self.assertEqual(notation.concise(None, 0.1), "–")
        self.assertEqual(notation.concise(1.0, None), "1.00000")


class SentencesTest(unittest.TestCase):
    def test_micrometres_and_no_german_word(self):
        for said, shown in (("plates that are 10 um rms off", "plates that are 10 µm rms off"),
                            ("um 10 um, verschöbe M um -0.2 mm", "um 10 µm, verschöbe M um −0.2 mm"),
                            ("bei 5 um 3 mm, bei 5 um ±3 mm", "bei 5 um 3 mm, bei 5 um ±3 mm"), ("0.5 um)", "0.5 µm)")):
            self.assertEqual(notation.in_sentence(said), shown)

    def test_powers_of_ten_only_where_numbers_have_them(self):
        for said, shown in (("1.65e+03 degrees", "1650 degrees"), ("±1,8e+02 mm", "±180 mm"), ("2.5e+00", "2.5 × 10⁰"),
                            ("2e+07", "2 × 10⁷"), ("p < 1e-16", "p < 10⁻¹⁶"), ("3e-09", "3 × 10⁻⁹")):
            self.assertEqual(notation.in_sentence(said), shown)


class OtherRulesTest(unittest.TestCase):
    def test_degrees_of_freedom_are_truncated(self):
        self.assertEqual(notation.dof(31.999), "31")
        self.assertEqual(notation.dof(1e6), "∞")
        self.assertEqual(notation.dof(None), "∞")

    def test_probabilities(self):
        self.assertEqual(notation.p_value(0.0), "< 10⁻¹⁶")
        self.assertEqual(notation.p_value(0.034), "= 0.03")
        self.assertEqual(notation.p_value(None), "= –")

    def test_counts_in_groups_without_a_sign_of_any_language(self):
        self.assertEqual(notation.count(119146), "119\N{NARROW NO-BREAK SPACE}146")

    def test_the_decimal_sign_is_that_of_the_language(self):
        self.assertEqual(Language("de").number(notation.concise(123.00214, 0.0054)), "123,0021(54)")
        self.assertEqual(Language("en").number(notation.concise(123.00214, 0.0054)), "123.0021(54)")


if __name__ == "__main__":
    unittest.main()
