"""The words of head, verdict, result and of what was taken for granted: that they say so much and no more."""
import copy
import re
import unittest

from synthetic import CERTIFICATE, calibration, estimated, said, text_of
from fit_scenes import turntable_row
from uncertainty_scenes import whole
import administration
import page
import procedure
import uncertainty
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
        self.assertIn("but it comes with this reservation:", shown)
        self.assertNotIn("speaks against", shown)
        self.assertIn("with these reservations:", text_of("verdict", calibration(warnings=[SENTENCE, "two"])))
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
        for scope, told in (("view", True), ("point", True), ("target", False), ("system", False)):  # noise is declared, too
            influences = [{"source": "scale_y", "role": "consider", "u": 1e-4, "unit": "1", "scope": scope}]
            self.assertEqual("not a traceable" in text_of("verdict", calibration(influences=influences)), told, scope)

    def test_lack_of_fit(self):
        shown = text_of("verdict", calibration())
        self.assertIn("F = 4.36 with 189 and 17 946 degrees of freedom, p < 10⁻¹⁶); errors common to a",
                      shown)
        self.assertIn("ask most for tilt_y (F = 1.20; p = 0.3 by itself, p = 0.3 as the smallest of 1 tests), no more than chance gives", shown)
        agreeing = {"F": 1.06, "dof1": 189.0, "dof2": 17946.0, "p": 0.2}
        self.assertIn("no more than within them", text_of("verdict", calibration(lack_of_fit=agreeing)))
        equal = [{"source": "residuals, clustered by view", "type": "A"}]
        self.assertIn("The weights do not know of it", text_of("verdict", calibration(budget=equal)))

    def test_what_is_significant_is_told_by_the_program(self):
        misfits = [calibration()["misfits"][0] | {"p": 1e-9}]
        self.assertNotIn("no more than chance", text_of("verdict", calibration(misfits=misfits)))


    def test_influences_that_would_move_it_by_more_than_U_are_named(self):
        """Of which the residuals ask no more than chance does: neither shown nor excluded."""
        misfit = calibration()["misfits"][0] | {"moves": {"M": 4.4 * 0.0054, "N": 0.001, "tilt_x": 0.0}}
        shown = text_of("verdict", calibration(misfits=[misfit]))
        self.assertIn("neither show nor exclude: tilt_y (M by 4.4 u)", shown)
        self.assertIn("they cannot exclude what would move it by more than U", shown)
        for within in (misfit | {"moves": {"M": 2.0 * 0.0054}}, misfit | {"p": 1e-9}, misfit | {"considered": True}):
            self.assertNotIn("nor exclude", text_of("verdict", calibration(misfits=[within])), within)
        many = [misfit | {"source": f"form_{k}"} for k in range(5)]
        self.assertIn("and 2 more, as far", text_of("verdict", calibration(misfits=many)))

    def test_moves_without_one_target_are_held_against_chance_or_doubted(self):
        without = [{"without": name, "value": {}} for name in ("left", "right", "top")]
        self.assertIn("with 3 of them by no more than independent views make of it by chance",
                      text_of("verdict", calibration(jackknife=without)))
        said_so = [{"id": "solver.targets_disagree", "en": SENTENCE, "de": GERMAN}]
        self.assertNotIn("by chance", text_of("verdict", calibration(jackknife=without, messages=said_so)))

    def test_numbers_in_sentences_are_written_as_on_the_page(self):
        told = "moves by -0.22 mm (F = 64.3, p < 1e-16); 6e+06 nodes, 10 um, encoder-1, 3-4"
        self.assertIn("moves by −0.22 mm (F = 64.3, p < 10⁻¹⁶); 6 × 10⁶ nodes, 10 µm, encoder-1, 3-4",
                      text_of("verdict", calibration(warnings=[told])))


class FirstScreenTest(unittest.TestCase):
    def head(self, c, previous=None, language="en"):
        return page.sections.content("head", c, previous, Language(language, c, previous))

    def test_value_and_U_with_k_and_coverage_of_every_quantity(self):
        told = self.head(calibration())
        self.assertEqual([(each["name"], each["result"], each["k"]) for each in told["quantities"]],
                         [("M", "(123.002 ± 0.011) mm", "2.04"), ("N", "(408.988 ± 0.027) mm", "2.04"),
                          ("tilt_x", "(−0.0001235 ± 2.4 × 10⁻⁶) rad", "2.04")])
        self.assertEqual(told["percent"], "95")
        self.assertIn("along X", told["quantities"][0]["meaning"])
        self.assertEqual(self.head(calibration(), language="de")["quantities"][0]["result"], "(123,002 ± 0,011) mm")
        bare = calibration(parameters=[{"name": "M", "unit": "mm", "role": "estimate", "value": 123.0}])
        self.assertEqual(self.head(bare)["quantities"][0]["result"], "123.000 mm")

    def test_of_a_robot_the_hand_eye_and_where_the_rest_stands(self):
        told = self.head(robot())
        self.assertEqual([each["name"] for each in told["quantities"]], ["hand_eye_x", "hand_eye_rx"])
        self.assertEqual(told["elsewhere"], 12)

    def test_who_what_which_and_when_and_what_of_it_is_missing(self):
        told = self.head(calibration(certificate=CERTIFICATE))
        self.assertIn(("Serial number", "007"), told["identification"])
        self.assertIn(("Performed", "2026-11-02 to 2026-11-03"), told["identification"])
        self.assertIn(("Certificate", "K-2026-0815"), told["identification"])
        self.assertEqual(told["missing"], "")
        for nothing in (None, {}, "text", {"item": "x", "performed": {"begin": None}},
                        {"item": {"identifications": "7"}}):
            told = self.head(calibration(certificate=nothing) if nothing is not None else calibration())
            self.assertEqual(told["identification"], [])
            self.assertIn("item, serial number, date, laboratory.", told["missing"])

    def test_status_in_one_line(self):
        only_a = calibration()["budget"][:1]
        for c, line, color in (
                (calibration(), "Status: ok. Nothing", "ok"),
                (calibration(budget=only_a), "repeatability and fit only. Not a traceable", "with_warnings"),
                (calibration(warnings=["a"]), "with one reservation", "with_warnings"),
                (calibration(warnings=["a", "b"]), "with 2 reservations", "with_warnings"),
                (calibration(status="unreliable"), "Do not rely", "unreliable")):
            self.assertIn(line, self.head(c)["status_line"])
            self.assertEqual(self.head(c)["status"], color)


class UnreliableTest(unittest.TestCase):
    """Nobody may read a promise under it."""
    JACKKNIFE = [{"without": name, "value": {"M": M, "N": 408.0}} for name, M in (("left", 121.9), ("right", 123.8))]

    def test_where_it_goes_without_one_target_in_place_of_U(self):
        c = calibration(status="unreliable", jackknife=self.JACKKNIFE)
        told = page.sections.content("head", c, None, EN)["quantities"]
        self.assertEqual((told[0]["result"], told[0]["k"]), ("123.0 mm", "121.9 to 123.8 mm"))
        self.assertEqual(told[2]["k"], "–")  # nobody knows of tilt_x

    def test_no_section_has_U_or_its_probability(self):
        c = whole(2)
        c["status"] = "unreliable"
        for section in ("verdict", "result", "leave_one_out", "monte_carlo", "volume", "comparison", "budget"):
            shown = text_of(section, c)
            self.assertNotIn("95 %", shown, section)
            self.assertNotRegex(shown, r"\bU\b", section)
        self.assertEqual(text_of("volume", c) + text_of("monte_carlo", c), "")

    def test_budget_of_shares_alone(self):
        two = {"parameters": calibration()["parameters"][:2]}
        shown = text_of("budget", calibration(**two))
        self.assertIn("u(M) / mm", shown)
        self.assertIn("Combined", shown)
        shown = text_of("budget", calibration(status="unreliable", **two))
        self.assertIn("no uncertainty of a parameter is stated", shown)
        self.assertIn("Share of M / % Share of N / % noise_y noise of a point along depth A 0.050 mm 18 000 86.0 99.0", shown)
        for promise in ("u(M)", "Combined", "the standard uncertainty u of each"):
            self.assertNotIn(promise, shown)

    def test_nor_what_would_be_more_than_U(self):
        misfit = calibration()["misfits"][0] | {"moves": {"M": 4.4 * 0.0054}}
        self.assertNotIn("nor exclude", text_of("verdict", calibration(misfits=[misfit], status="unreliable")))

    def test_methods_without_u(self):
        rows = [turntable_row("one", (122.36512, 0.045), (409.0, 0.05)), turntable_row("two", (122.4, 0.045), (409.0, 0.05))]
        for status, expected in (("ok", "122.365(45)"), ("unreliable", "122.365")):
            content = page.sections.content("comparison", calibration(compare=rows, status=status), None, EN)
            self.assertIn(expected, [cell for row in content["tables"][0]["rows"] for cell in row["cells"]])

    def test_links_without_intervals(self):
        shown = text_of("links", robot(status="unreliable"))
        self.assertIn("nobody knows how wrong they are", shown)
        self.assertNotIn("95 %", shown)
        self.assertNotIn("(10)", shown)


class ResultTest(unittest.TestCase):
    def test_u_expanded_u_factor_and_degrees_of_freedom(self):
        shown = text_of("result", calibration())
        self.assertIn("M / mm 0.0054 31", shown)
        self.assertIn("M = (123.002 ± 0.011) mm, where the number after ± is U = k u, with u = 0.0054 mm and "
                      "k = 2.04 from the t-distribution for 31 degrees of freedom", shown)
        self.assertIn("holds all 3 estimated quantities together with 95 % is an ellipsoid with k = 2.93",
                      shown)

    def test_in_german_with_commas(self):
        shown = text_of("result", calibration(), language="de")
        self.assertIn("M = (123,002 ± 0,011) mm", shown)
        self.assertIn("Überdeckungswahrscheinlichkeit von etwa 95 %", shown)
        self.assertNotRegex(re.sub(r"GUM [\dG.]+", "", shown), r"\d\.\d")

    def test_without_end_of_the_degrees_of_freedom(self):
        parameters = [estimated("M", 123.0, 0.01, dof=None)]
        self.assertIn("from the normal distribution", text_of("result", calibration(parameters=parameters)))

    def test_other_estimates_are_no_results(self):
        shown = text_of("result", calibration())
        self.assertIn("for comparison only, no results", shown)
        self.assertNotIn("bootstrap jackknife", shown)  # nobody has one: no column
        self.assertIn("naive clustered bootstrap M", shown)

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
        self.assertIn("M / mm – ∞", text_of("result", bare))
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
        self.assertIn("Laboratory Beispiel-Labor accreditation: D-K-00000-01-00 Hauptstraße 1 38116 Braunschweig DE further: 2nd floor", shown)
        self.assertIn("Item Liniensensor <am> Drehtisch", shown)
        self.assertIn("issued by: manufacturer, value: 007", shown)
        self.assertIn("Responsible A. Berg, function: head of laboratory", shown)
        self.assertIn("room B 12", shown)  # under its own name
        self.assertIn("Environment temperature: 20.1 °C ± 0.3 K", shown)
        self.assertIn("data for a calibration certificate after ISO/IEC 17025, 7.8; no conformity", shown)
        given = copy.deepcopy(CERTIFICATE)
        del given["laboratory"]
        self.assertNotIn("Beispiel", text_of("certificate", calibration(certificate=given)))

    def test_words_of_the_program_are_in_the_readers_language(self):
        shown = text_of("certificate", calibration(certificate=CERTIFICATE), language="de")
        self.assertIn("vergeben von: Hersteller", shown)
        self.assertIn("Ort: Laboratorium", shown)
        self.assertIn("unterzeichnet: ja", shown)

    def test_who_signs_has_a_line_for_it(self):
        shown = text_of("certificate", calibration(certificate=CERTIFICATE))
        self.assertTrue(shown.endswith("Date, signature A. Berg, head of laboratory"), shown)
        self.assertEqual(shown.count("signature"), 1)  # B. Tal does not

    def test_equipment_without_a_certificate_is_named(self):
        self.assertNotIn("No certificate is named", text_of("certificate", calibration(certificate=CERTIFICATE)))
        given = CERTIFICATE | {"equipment": [{"name": "plate", "certificate": "PTB 1"}, {"name": "encoder"}]}
        self.assertIn("No certificate is named of encoder: what it brings",
                      text_of("certificate", calibration(certificate=given)))

    def test_every_value_appears(self):
        shown = [line for block in administration.blocks(CERTIFICATE, EN) for line in block.lines]
        told = [{"true": "yes"}.get(text, text) for _, text in administration.leaves(CERTIFICATE)]
        for text in told:
            lines = [line for line in shown if re.search(rf"(^|[ ,]){re.escape(text)}($|[ ,])", line)]
            self.assertGreaterEqual(len(lines), told.count(text), text)

    def test_empty_fields_are_left_out(self):
        given = {"order": None, "customer": {"name": "", "address": {}}, "statements": [], "issued": " "}
        self.assertEqual(text_of("certificate", calibration(certificate=given)), "")
        self.assertEqual(text_of("certificate", calibration()), "")

    def test_anything_may_be_given(self):
        self.assertIn("<b>", text_of("certificate", calibration(certificate="<b>text</b>")))
        shown = text_of("certificate",
                        calibration(certificate={"a.b{c}": [1, [2, {"name": "x"}]], "name": {"": 3}}))
        self.assertIn("a.b{c}", shown)


class ConsideredTest(unittest.TestCase):
    def test_held_and_set_aside_but_not_what_the_budget_has(self):
        shown = text_of("considered", calibration())
        self.assertNotIn("scale_y", shown)  # its line in the budget says all of it
        self.assertIn("scale_y relative scale error along depth considered 0.00010 instrument", text_of("considered", calibration(budget=None)))
        self.assertIn("Held at zero: tilt_y.", shown)
        self.assertIn("3 points were set aside: 3 off the line of their profile.", shown)

    def test_what_the_residuals_ask_for_with_both_p(self):
        asked = calibration()["misfits"][0] | {"F": 8.0, "dof2": 31.0, "p": 0.024, "source": "shear"}
        tests = [asked, calibration()["misfits"][0], calibration()["misfits"][0]]
        shown = text_of("considered", calibration(misfits=tests))
        self.assertIn("For each of 3 quantities", shown)
        self.assertIn("shear deviation of the profiler's axes from a right angle held 3.0 × 10⁻⁶ rad 8.00 0.008 0.02 M by 0.50 u", shown)
        self.assertNotIn("about its Y held", shown)  # it asks for nothing and moves nothing
        self.assertIn("2 more have no row", shown)

    def test_p_by_itself_is_that_of_the_tables(self):
        """Of F: its 5 % points (e.g. NIST/SEMATECH Handbook, 1.3.6.7.3); of t, squared."""
        for F, dof1, dof2, p in ((161.448, 1, 1, 0.05), (4.965, 1, 10, 0.05), (3.326, 5, 10, 0.05),
                                 (1.927, 10, 100, 0.05), (2.5706**2, 1, 5, 0.05), (1.0, 7, 7, 0.5), (0.0, 3, 4, 1.0)):
            self.assertAlmostEqual(uncertainty.f_upper_tail(F, dof1, dof2), p, delta=3e-4)
        self.assertAlmostEqual(uncertainty.f_upper_tail(64.3, 16, 589) / 1e-117, 0, delta=1e3)

    def test_influences_of_newer_files(self):
        influences = [{"source": "noise_z", "role": "estimate", "u": 0.05, "unit": "mm", "scope": "point"},
                      {"source": "tilt_y", "role": "hold", "u": 0.0, "unit": "rad", "scope": "system"},
                      {"source": "form", "role": "consider", "u": 0.002, "unit": "mm", "scope": "target"}]
        shown = text_of("considered", calibration(influences=influences))
        self.assertIn("form form of the plate considered 0.0020 mm target noise_z noise of a point along the line variance from the residuals 0.050 mm point",
                      shown)

    def test_values_that_are_held_elsewhere(self):
        c = calibration()
        c["parameters"][3]["value"] = 0.01
        self.assertIn("tilt_y tilt of the profiler about its Y = 0.0100000 rad held", text_of("considered", c))

    def test_points_set_aside_of_many_targets(self):
        targets = [{"name": f"t{k}", "points": 10, "missing": 0, "set_aside": k, "set_aside_reasons": {}}
                   for k in range(400)]
        self.assertIn("79 800 points were set aside.", text_of("considered", calibration(targets=targets)))
        for target in targets:
            target["set_aside_reasons"] = {"off the line of their profile": target["set_aside"]}
        self.assertIn("79 800 points were set aside: 79 800 off the line",
                      text_of("considered", calibration(targets=targets)))


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
