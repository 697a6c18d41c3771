"""As found and as left: what the page shows of two calibrations that `scancal report` has compared."""
import unittest

from synthetic import CERTIFICATE, calibration, difference, estimated, text_of
import as_found
import page
from language import Language

DOUBT = {"en": "Both are the same file.", "de": "Beide sind dieselbe Datei."}


def compared(**changes):
    """This calibration, as it was compared with an earlier one."""
    return calibration(difference=difference(**changes))


def earlier(**changes):
    c = calibration(name="plate, last year", **changes)
    if c["parameters"][0]["name"] == "M":
        c["parameters"][0] = c["parameters"][0] | {"value": 122.9}
    return c


class WordsTest(unittest.TestCase):
    def test_both_values_change_and_meaning(self):
        shown = text_of("result", compared(), earlier())
        self.assertIn("As found plate, last year – – – As left plate – – –", shown)
        self.assertIn("M / mm 122.900 ± 0.011 123.002 ± 0.011 0.1021 6.6 changed", shown)
        self.assertIn("N / mm 408.988 ± 0.027 408.988 ± 0.027 0.000 0.0 no change shown", shown)
        self.assertIn("Counted once, as one and the same error in both: scale_y.", shown)
        self.assertNotIn("is doubtful", shown)
        self.assertNotIn("Counted once", text_of("result", compared(shared=[]), earlier()))

    def test_an_unknown_e_n_is_no_verdict(self):
        self.assertRegex(text_of("result", compared(), earlier()), "tilt_x / rad [^a-z]* – –")

    def test_doubts_in_the_readers_language(self):
        for language, about in (("en", "is doubtful"), ("de", "zweifelhaft")):
            shown = text_of("result", compared(doubts=[DOUBT]), earlier(), language)
            self.assertIn(about, shown)
            self.assertIn(DOUBT[language], shown)

    def test_dates_and_certificates_of_both(self):
        found = earlier(certificate={"identification": "K-1", "performed": {"begin": "2025-10-01"},
                                     "item": {"identifications": [{"value": "007"}]}})
        shown = text_of("result", calibration(certificate=CERTIFICATE, difference=difference()), found)
        self.assertIn("As found plate, last year K-1 2025-10-01 007 As left plate K-2026-0815 2026-11-02 to 2026-11-03 "
                      "007", shown)

    def test_nothing_in_common(self):
        shown = text_of("result", compared(changes=[]), earlier(parameters=[estimated("ball_x", 1.0, 0.1)]))
        self.assertIn("no estimated parameter in common", shown)


class UnreliableTest(unittest.TestCase):
    """Of an unreliable one no E_n and no U: nobody knows how far the two may lie apart."""

    def test_whichever_it_is(self):
        unreliable = calibration(status="unreliable", difference=difference())
        for found, left in ((earlier(status="unreliable"), compared()), (earlier(), unreliable)):
            change = as_found.changes(found, left)[0]
            self.assertEqual((change.change, change.u, change.e_n), (0.1021, None, None))
            table = text_of("result", left, found).split("Meaning")[-1].split("E_n")[0]
            self.assertIn("M / mm 122.900", table)
            self.assertNotRegex(table, "±|changed|no change")


class FirstPageTest(unittest.TestCase):
    def line(self, left, found=None, language="en"):
        found = found or earlier()
        return page.sections.content("head", left, found, Language(language, left, found))["as_found"]

    def test_one_line_of_it(self):
        unchanged = difference()["changes"][1:2]
        self.assertEqual(self.line(compared(changes=unchanged)), "As found: no change beyond the expanded uncertainties.")
        self.assertEqual(self.line(compared()),
                         "Against as found 1 of 2 quantities have changed, most of all M (E_n\u00a0=\u00a06.6).")
        self.assertIn("doubtful", self.line(compared(doubts=[DOUBT])))
        self.assertIn("cannot be said", self.line(compared(), earlier(status="unreliable")))


if __name__ == "__main__":
    unittest.main()
