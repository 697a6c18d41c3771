"""Control charts: the page says what the program says of them, in either language."""
import copy
import unittest

import paths  # noqa: F401
import history
from language import Language


def point(**changes) -> dict:
    return {"value": 1.0, "u": 0.1, "U": 0.2, "low": 0.7, "high": 1.3, "deviation": 0.0, "up": 0.0, "down": 0.0,
            "beyond": False, "alarm": False} | changes


CHART = {"name": "M", "unit": "mm", "centre": 1.0, "u_centre": 0.05, "slope": -0.0123, "u_slope": 0.0021, "drifts": True,
         "chi_squared": 30.0, "p": 1e-4,
         "points": [point(), point(beyond=True, deviation=-4.06), point(alarm=True, down=6.0), point(alarm=True)]}
HISTORY = {"calibrations": ["a", "b", "c", "d"], "times": [0, 1, 2, 3], "unit_of_time": "day", "shared": [], "limit": 3.1,
           "cusum": {"slack": 0.5, "alarm": 4.8}, "charts": [CHART], "alarms": []}


class AlarmsTest(unittest.TestCase):
    def test_every_alarm_once_in_both_languages(self):
        self.assertEqual(history.alarms(HISTORY, Language("en")),
                         ["M: b lies −4.1 u from the centre, beyond the limits",
                          "M: CUSUM alarm at c: smaller since some calibrations",
                          "M: drifts by −0.0123(21) mm a day, 5.9 times its u"])
        self.assertEqual(history.alarms(HISTORY, Language("de"))[0],
                         "M: b liegt −4,1 u von der Mitte, außerhalb der Grenzen")
        quiet = copy.deepcopy(HISTORY)
        quiet["charts"][0] |= {"points": [point()] * 4, "drifts": False}
        self.assertEqual(history.alarms(quiet, Language("en")), [])

    def test_the_german_page_has_no_english_part(self):
        shown = history.render(HISTORY, Language("de"))
        self.assertIn("CUSUM-Alarm bei c: kleiner", shown)
        self.assertNotIn('lang="en"', shown)
        self.assertNotIn("beyond", shown)


if __name__ == "__main__":
    unittest.main()
