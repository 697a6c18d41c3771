"""The words of head, verdict, result and of what was taken for granted: that they say so much and no more."""
import copy
import re
import unittest

from synthetic import CERTIFICATE, calibration, estimated, said, text_of
import administration
import page
import procedure
from language import Language

EN, DE = Language("en"), Language("de")
SENTENCE = "N: leaving one target out moves it 2.7 times as far as its u explains; the targets disagree, so u is " \
           "too small, or the model lacks something"
GERMAN = "N: Wird ein Prüfkörper weggelassen, so ändert sich der Wert 2,7-mal so stark, wie es u erklärt"


def robot(**changes):
    links = [estimated(f"{kind}_{k}", 0.1, 0.01) for k in range(1, 7) for kind in ("theta", "a")]
    hand_eye = [estimated(f"hand_eye_{axis}", 1.0, 0.01) for axis in ("x", "rx")]
    n = len(links) + len(hand_eye)
    return calibration(model="robot-ball", residual="ball centre", parameters=hand_eye + links, budget=None,
                       misfits=None,
                       covariance=[[float(i == j) for j in range(n)] for i in range(n)], lack_of_fit={},
                       grid={"step": 0.0, "S": 0.0, "nodes": 0}, **changes)


class VerdictTest(unittest.TestCase):
    def test_no_word_is_stronger_than_the_data(self):
        shown = text_of("verdict", calibration())
        self.assertIn("Nothing in the data speaks against this result.", shown)
        self.assertIn("leaves no trace in the residuals", shown)
        for claim in ("valid", "correct", "proved", "certif", "guarantee", "accurate"):
            self.assertNotIn(claim, shown.lower())

    def test_every_warning_and_every_reason_in_words(self):
        shown = text_of("verdict", calibration(warnings=[SENTENCE]))
        self.assertIn("but it comes with these reservations", shown)
        self.assertNotIn("speaks against", shown)
        self.assertIn(SENTENCE, shown)
        shown = text_of("verdict",
                        calibration(status="unreliable", unreliable=["first", "second"], warnings=["third"]))
        self.assertIn("Do not rely on this result. Why: first Why: second third", shown)

    def test_unreliable_without_a_reason_or_of_a_status_to_come(self):
        for status in ("unreliable", "doubtful"):
            shown = text_of("verdict", calibration(status=status, unreliable=None, warnings=None))
            self.assertIn("Do not rely on this result.", shown)
            self.assertIn("without a reason", shown)

    def test_in_german(self):
        doubtful = calibration(status="unreliable", unreliable=[SENTENCE], messages=[said(SENTENCE, GERMAN)])
        self.assertIn(f"Auf dieses Ergebnis ist kein Verlass. Grund: {GERMAN}",
                      text_of("verdict", doubtful, language="de"))

    def test_a_file_of_before_there_were_messages_stays_english(self):
        shown = text_of("verdict", calibration(status="unreliable", unreliable=[SENTENCE]), language="de")
        self.assertIn(f"Auf dieses Ergebnis ist kein Verlass. Grund: {SENTENCE}", shown)

    def test_without_declared_influences_it_is_not_traceable(self):
        self.assertNotIn("not a traceable", text_of("verdict", calibration()))
        of_type_a = calibration()["budget"][:1]
        self.assertIn("not a traceable uncertainty", text_of("verdict", calibration(budget=of_type_a)))
        self.assertIn("not a traceable uncertainty", text_of("verdict", calibration(budget=None)))

    def test_lack_of_fit(self):
        shown = text_of("verdict", calibration())
        self.assertIn("F = 4.36 with 189 and 17 946 degrees of freedom, p < 10⁻¹⁶); errors common to a",
                      shown)
        self.assertIn("ask most for tilt_y (F = 1.20, p = 0.3), no more than chance gives", shown)
        agreeing = {"F": 1.06, "dof1": 189.0, "dof2": 17946.0, "p": 0.2}
        self.assertIn("no more than within them", text_of("verdict", calibration(lack_of_fit=agreeing)))
        equal = [{"source": "residuals, clustered by view", "type": "A"}]
        self.assertIn("The weights do not know of it", text_of("verdict", calibration(budget=equal)))

    def test_what_is_significant_is_told_by_the_program(self):
        misfits = [calibration()["misfits"][0] | {"p": 1e-9}]
        self.assertNotIn("no more than chance", text_of("verdict", calibration(misfits=misfits)))


class ResultTest(unittest.TestCase):
    def test_value_u_expanded_u_factor_and_degrees_of_freedom(self):
        shown = text_of("result", calibration())
        self.assertIn("M = 123.0021(54) mm", shown)
        self.assertIn("offset of the profiler from the axis, along X 0.0054 mm 0.011 mm 2.04 31", shown)
        self.assertIn("tilt_x = −0.0001235(12) rad", shown)
        self.assertIn("U (95 %)", shown)
        self.assertIn("M = (123.002 ± 0.011) mm, where the number after ± is U = k u, with u = 0.0054 mm and "
                      "k = 2.04 from the t-distribution for 31 degrees of freedom", shown)
        self.assertIn("holds all 3 estimated quantities together with 95 % is an ellipsoid with k = 2.93",
                      shown)

    def test_in_german_with_commas(self):
        shown = text_of("result", calibration(), language="de")
        self.assertIn("M = 123,0021(54) mm", shown)
        self.assertIn("Überdeckungswahrscheinlichkeit von etwa 95 %", shown)
        self.assertNotRegex(re.sub(r"GUM [\dG.]+", "", shown), r"\d\.\d")

    def test_without_end_of_the_degrees_of_freedom(self):
        parameters = [estimated("M", 123.0, 0.01, dof=None)]
        self.assertIn("from the normal distribution", text_of("result", calibration(parameters=parameters)))

    def test_other_estimates_are_no_results(self):
        shown = text_of("result", calibration())
        self.assertIn("For comparison only", shown)
        self.assertIn("Not results.", shown)
        self.assertNotIn("jackknife M", shown)  # nobody has one: no column

    def test_of_a_robot_the_hand_eye_and_where_the_rest_stands(self):
        shown = text_of("result", robot())
        self.assertIn("hand_eye_rx = 1.000(10) mm", shown)
        self.assertNotIn("theta_1 =", shown)
        self.assertIn("The 12 link errors stand in Links and hand-eye", shown)

    def test_unreliable_numbers_are_marked(self):
        self.assertIn("For diagnosis only", text_of("result", calibration(status="unreliable")))

    def test_parts_may_be_missing(self):
        bare = calibration(parameters=[{"name": "M", "unit": "mm", "role": "estimate", "value": 123.0}],
                           joint=None,
                           coverage_probability=None, budget=None, misfits=None, lack_of_fit=None,
                           inputs=None,
                           data=None, targets=None, covariance=None, correlation=None, iterations=None,
                           version=None,
                           command=None, name=None, grid=None, warnings=None, unreliable=None, residual=None)
        for section in ("verdict", "result", "considered", "inputs", "certificate"):
            for language in ("en", "de"):
                text_of(section, bare, language=language)
        self.assertIn("M = 123.000 mm", text_of("result", bare))
        procedure.sentences(bare, EN)
        self.assertIn("No parameter was estimated", text_of("result", calibration(parameters=[])))


class ProcedureTest(unittest.TestCase):
    def test_what_was_done(self):
        told = " ".join(procedure.sentences(calibration(), EN))
        self.assertIn("scanned 2 flat targets (left, right): 120 profiles, 3 000 points used, 5 without return, "
                      "3 set aside.", told.replace("\N{NARROW NO-BREAK SPACE}", " "))
        self.assertIn("M, N, tilt_x and the plane of every target", told)
        self.assertIn("every view (profile or pose) weighted", told)
        self.assertIn("in 7 iterations; the start came from the middle of the searched box or, where that was better, "
                      "from a grid search in steps of 1 mm (651 nodes).",
                      told.replace(
            "\N{NO-BREAK SPACE}", " "))
        self.assertNotIn("Monte Carlo", told)

    def test_search_interval_and_monte_carlo_where_they_are_known(self):
        search = {"columns": ["M", "N", "S"], "units": ["mm"] * 3, "rows": [[110, 395, 1], [130, 425, 1]]}
        told = " ".join(procedure.sentences(calibration(surface={"search": search},
                                                        montecarlo={"trials": 10000}), EN))
        told = told.replace("\N{NO-BREAK SPACE}", " ")
        self.assertIn("grid search over M from 110 to 130 mm, N from 395 to 425 mm in steps", told)
        self.assertIn("10\N{NARROW NO-BREAK SPACE}000 Monte Carlo trials", told)

    def test_of_a_robot_in_german(self):
        told = " ".join(procedure.sentences(robot(), DE))
        self.assertIn("14 Parameter und die Lage des Normals", told)
        self.assertIn("Residuum: Kugelmittelpunkt", told)
        self.assertNotIn("Gittersuche", told)

    def test_equal_weights(self):
        equal = calibration(budget=[{"source": "residuals, clustered by view", "type": "A"}])
        self.assertIn("all points weighted alike", " ".join(procedure.sentences(equal, EN)))


class CertificateTest(unittest.TestCase):
    def test_as_given_and_nothing_else(self):
        shown = text_of("certificate", calibration(certificate=CERTIFICATE))
        self.assertIn("Laboratory name Beispiel-Labor", shown)
        self.assertIn("address, city Braunschweig", shown)
        self.assertIn("Item name Liniensensor <am> Drehtisch", shown)
        self.assertIn("identification, value 007", shown)  # the only one: without a number
        self.assertIn("Responsible 1, name A. Berg", shown)
        self.assertIn("room B 12", shown)  # under its own name
        self.assertIn("data for a calibration certificate after ISO/IEC 17025, 7.8", shown)
        given = copy.deepcopy(CERTIFICATE)
        del given["laboratory"]
        self.assertNotIn("Laboratory",
                         text_of("certificate", calibration(certificate=given)).split("As given")[-1])

    def test_every_value_appears_once(self):
        told = [text for _, text in administration.leaves(CERTIFICATE)]
        shown = administration.rows(CERTIFICATE, EN)
        self.assertEqual(sorted(text for _, _, text in shown), sorted(told))
        self.assertIn("true", told)

    def test_empty_fields_are_left_out(self):
        given = {"order": None, "customer": {"name": "", "address": {}}, "statements": [], "issued": " "}
        self.assertEqual(text_of("certificate", calibration(certificate=given)), "")
        self.assertEqual(text_of("certificate", calibration()), "")

    def test_anything_may_be_given(self):
        self.assertIn("<b>", text_of("certificate", calibration(certificate="<b>text</b>")))
        shown = text_of("certificate",
                        calibration(certificate={"a.b{c}": [1, [2, {"name": "x"}]], "name": {"": 3}}))
        self.assertIn("a.b{c}", shown)

    def test_the_head_names_what_was_given(self):
        environment = page.environment_of(calibration(certificate=CERTIFICATE), None, EN)
        self.assertIn("certificate", environment.globals["c"])
        content = page.sections.content("head", calibration(certificate=CERTIFICATE), None, EN)
        self.assertIn(("Performed", "2026-11-02 to 2026-11-03"), content["identification"])
        self.assertIn(("Certificate", "K-2026-0815"), content["identification"])
        for nothing in (None, {}, "text", {"item": "x", "performed": {"begin": None}}):
            c = calibration(certificate=nothing) if nothing is not None else calibration()
            self.assertEqual(page.sections.content("head", c, None, EN)["identification"], [])


class ConsideredTest(unittest.TestCase):
    def test_held_considered_and_set_aside(self):
        shown = text_of("considered", calibration())
        self.assertIn("scale_y considered 0.00010 instrument", shown)
        self.assertIn("Held at zero: tilt_y.", shown)
        self.assertIn("left 1 000 5 3 3 off the line of their profile", shown)
        self.assertIn("All 2 targets 3 000 5 3", shown)
        self.assertIn("tilt_y held", shown)
        self.assertIn("M by 0.50 u", shown)

    def test_influences_of_newer_files(self):
        influences = [{"source": "noise_y", "role": "estimate", "u": 0.05, "unit": "mm", "scope": "point"},
                      {"source": "tilt_y", "role": "hold", "u": 0.0, "unit": "rad", "scope": "system"},
                      {"source": "form", "role": "consider", "u": 0.002, "unit": "mm", "scope": "target"}]
        shown = text_of("considered", calibration(influences=influences))
        self.assertIn("form considered 0.0020 mm target noise_y variance from the residuals 0.050 mm point",
                      shown)

    def test_values_that_are_held_elsewhere(self):
        c = calibration()
        c["parameters"][3]["value"] = 0.01
        self.assertIn("tilt_y = 0.0100000 rad held", text_of("considered", c))

    def test_many_targets(self):
        targets = [{"name": f"t{k}", "points": 10, "missing": 0, "set_aside": k, "set_aside_reasons": {}}
                   for k in range(400)]
        shown = text_of("considered", calibration(targets=targets))
        self.assertIn("t399", shown)
        self.assertNotIn("t300 ", shown)
        self.assertIn("The 40 targets with the most points set aside; 360 more", shown)
        self.assertIn("All 400 targets 4 000 0 79 800", shown)


class InputsTest(unittest.TestCase):
    def test_files_hashes_version_command(self):
        shown = text_of("inputs", calibration(), calibration())
        for what in ("left.csv " + "1" * 64, "c" * 64, "scancal 0.1.0", "scancal refine plate",
                     "converged after 7 iterations",
                     "scancal refine calibration.json", "As found was taken from calibration.json"):
            self.assertIn(what, shown)
        self.assertIn("not converged after 7 iterations", text_of("inputs", calibration(converged=False)))

    def test_many_files(self):
        files = [{"file": f"{k}.csv", "sha256": f"{k:064}"} for k in range(400)]
        shown = text_of("inputs", calibration(inputs=files))
        self.assertIn("and 300 more, in calibration.json", shown)


if __name__ == "__main__":
    unittest.main()
