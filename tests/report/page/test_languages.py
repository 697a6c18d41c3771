"""Every word is in the texts, in every language alike; every sentence of the program has its German."""
import ast
import html
import re
import string
import tempfile
import tomllib
import unittest
from pathlib import Path

import paths
from cpp_sentences import written
from language import LANGUAGES, PLACE, TEXTS, Language

PAGE = paths.SOURCE / "report" / "page"
# Signs, symbols and names that are the same in every language.
SIGNS = {"u", "U", "k", "F", "p", "rms", "%", "SHA-256", "scancal", "scancal refine", "±", "x", "y", "z"}


def texts(code: str) -> dict[str, str]:
    """All words by their keys; sentences.toml is of another kind."""
    found = {}
    for file in sorted((TEXTS / code).glob("*.toml")):
        if file.name != "sentences.toml":
            _collect(tomllib.loads(file.read_text(encoding="utf-8")), "", found)
    return found


def _collect(table: dict, prefix: str, into: dict[str, str]) -> None:
    for key, value in table.items():
        if isinstance(value, dict):
            _collect(value, f"{prefix}{key}.", into)
        else:
            assert f"{prefix}{key}" not in into, f"{prefix}{key} is there twice"
            into[f"{prefix}{key}"] = value


def places(text: str) -> set[str]:
    return {name for _, name, _, _ in string.Formatter().parse(text) if name is not None}


def sentences() -> list[dict[str, str]]:
    return tomllib.loads((TEXTS / "de" / "sentences.toml").read_text(encoding="utf-8"))["sentence"]


class TextsTest(unittest.TestCase):
    def test_the_same_files_keys_and_places(self):
        english = texts("en")
        for code in LANGUAGES:
            other = texts(code)
            self.assertEqual(sorted(set(english) ^ set(other)), [], code)
            for key, text in english.items():
                self.assertEqual(places(text), places(other[key]), f"{code}: {key}")

    def test_german_is_german(self):
        """Whole phrases that stand in both languages were forgotten."""
        english, german = texts("en"), texts("de")
        forgotten = [key for key, text in english.items() if german[key] == text
                     and re.search(r"[a-z]{3,} [a-z]{3,} ", text)]
        self.assertEqual(forgotten, [])

    def test_a_word_that_is_asked_for_is_there(self):
        english = texts("en")
        for file in [*PAGE.rglob("*.html"), *PAGE.rglob("*.xml"), *PAGE.rglob("*.py")]:
            source = file.read_text(encoding="utf-8")
            for key in re.findall(r"""\b(?:t|language|self\._language)\(f?["']([^"']*)["']\s*[,)]""", source):
                pattern = re.compile(re.sub(r"\\\{[^{}]*\\\}", r".+", re.escape(key)))
                self.assertTrue(any(pattern.fullmatch(each) for each in english),
                                f"{file.relative_to(PAGE)}: {key}")

    def test_no_word_of_the_page_outside_the_texts(self):
        for file in [*(PAGE / "templates").rglob("*.html")]:
            source = re.sub(r"<style>.*?</style>|<!DOCTYPE html>", "", file.read_text(encoding="utf-8"),
                            flags=re.S)
            bare = re.sub(r"\{\{.*?\}\}|\{%.*?%\}|\{#.*?#\}", "\n", source, flags=re.S)
            for text in re.sub(r"<[^>]*>", "\n", bare).split("\n"):
                words = html.unescape(text).strip(" \t()[],.:;/=–·")
                self.assertTrue(words in SIGNS or not re.search(r"[A-Za-zÄÖÜäöüß]", words),
                                f"{file.name}: {words}")
            for attribute in re.findall(r'\b(?:title|alt|aria-label|placeholder)="([^"]*)"', bare):
                self.assertNotRegex(attribute, "[A-Za-z]", file.name)

    def test_no_word_of_the_page_in_its_code(self):
        """What a section or figure made up by itself would be a phrase: words with blanks between them, but no
        column of the file with its unit."""
        for folder in ("sections", "figures"):
            for file in (PAGE / folder).glob("*.py"):
                tree = ast.parse(file.read_text(encoding="utf-8"))
                strings = [node for node in ast.walk(tree) if isinstance(node, ast.Constant)
                           and isinstance(node.value, str)]
                documentation = {id(node.body[0].value) for node in ast.walk(tree)
                                 if isinstance(node, (ast.Module, ast.FunctionDef, ast.ClassDef))
                                 and node.body
                                 and isinstance(node.body[0], ast.Expr)}
                phrases = [node.value for node in strings if id(node) not in documentation
                           and re.search(r"[A-Za-z]{3,} [A-Za-z]{2,}[^/]*$", node.value)]
                known = {"upper left", "upper right", "lower left", "lower right", "center left",
                         "center right",
                         "lower center", "upper center", "offset points", "axes fraction",
                         "outside upper left",
                         "equal", "data limits"}
                self.assertEqual([phrase for phrase in phrases if phrase not in known], [],
                                 f"{folder}/{file.name}")


class SentencesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.written = written([paths.SOURCE / "solver", paths.SOURCE / "models"])
        cls.english = [each["english"] for each in sentences()]
        cls.german = Language("de")

    def test_the_sources_were_read(self):
        self.assertGreater(len(self.written), 30)
        pieces = {piece for each in self.written for piece in each.pieces}
        for known in ("there is only one placement of the plate",
                      "is least determined: hold it, give it a prior, or allow "
                      "more iterations", "the equations are singular", "off the line of their profile",
                      "ball centre"):
            self.assertIn(known, pieces)

    def test_a_new_sentence_would_be_found(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "new.cc").write_text("""
                std::string Why(int k) { return k ? "because; so" : ""; }
                void Judge(Calibration* c) {
                  const std::string how = c->ok() ? "well" : fmt::format("badly by {}", 1);
                  (k > 1 ? c->unreliable : c->warnings)  // "no sentence"
                      .push_back(fmt::format("{}: found {:.2g} "
                                             "times", name, 3) + Why(1) + how);
                }
                """, encoding="utf-8")
            found = written([Path(folder)])
        self.assertEqual(len(found), 1)
        self.assertEqual(sorted(found[0].pieces), [": found", "badly by", "because; so", "times", "well"])

    def test_every_sentence_of_the_program_has_its_german(self):
        known = [PLACE.sub("{}", english) for english in self.english]
        missing = [f"{each.where}: {piece}" for each in self.written for piece in each.pieces
                   if piece not in SIGNS and not any(piece in english for english in known)]
        self.assertEqual(missing, [], "add them to texts/de/sentences.toml")

    def test_no_german_is_left_of_a_sentence_that_is_gone(self):
        code = "\n".join(file.read_text(encoding="utf-8") for room in ("solver", "models")
                         for file in (paths.SOURCE / room).rglob("*.cc"))
        code = re.sub(r'"\s*\n?\s*"', "", code)
        clauses = {english: max(re.split(r"[;:,()]", PLACE.sub(";", english)), key=len).strip()
                   for english in self.english}
        self.assertEqual([english for english, clause in clauses.items() if clause not in code], [])

    def test_both_sides_have_the_same_places(self):
        for each in sentences():
            self.assertEqual(sorted(set(PLACE.findall(each["english"]))),
                             sorted(set(PLACE.findall(each["here"]))), each["english"])

    def test_examples(self):
        ask = ("; estimate it, or declare how uncertain it is, if it is what it looks like",
               "Schätzen oder die Unsicherheit angeben, wenn es das ist, wonach es aussieht")
        for english, german in (
                ("lack of fit: tilt_x is held, but the residuals ask for -0.12 rad (F = 200, p < 1e-16), which "
                 f"would move N by 6.2 u (also seen as tilt_y, form){ask[0]}",
                 "Mangelnde Anpassung: tilt_x ist festgehalten, die Residuen verlangen jedoch -0,12 rad (F = 200, "
                 f"p < 1e-16); das verschöbe N um das 6,2-Fache von u (ebenso gedeutet als tilt_y, form). {ask[1]}"),
                ("lack of fit: form is considered with a smaller u, but the residuals ask for 0.02 mm rms "
                 f"(F = 3.5, p = 1e-05), which would move M by 0.4 u{ask[0]}",
                 "Mangelnde Anpassung: form ist mit kleinerer Unsicherheit berücksichtigt, die Residuen verlangen "
                 f"jedoch 0,02 mm rms (F = 3,5, p = 1e-05); das verschöbe M um das 0,4-Fache von u. {ask[1]}"),
                ("there is only one placement of the plate; N suffers most (u = 0.12 mm); add a placement with the "
                 "plate turned about the vertical by 20 deg or more against the others",
                 "Es gibt nur eine Aufstellung der Platte; am meisten leidet N (u = 0,12 mm). Eine Aufstellung "
                 "ergänzen, bei der die Platte gegen die übrigen um 20° oder mehr um die Senkrechte gedreht ist"),
                ("the refinement did not converge: no convergence after 100 iterations; tilt_x is least "
                 "determined: hold it, give it a prior, or allow more iterations",
                 "Die Ausgleichung konvergierte nicht: keine Konvergenz nach 100 Iterationen; am wenigsten bestimmt "
                 "ist tilt_x: festhalten, Vorwissen angeben oder mehr Iterationen zulassen"),
                ("the refinement did not converge: Ceres says so.",
                 "Die Ausgleichung konvergierte nicht: Ceres says so."),
                ("left v1.5.csv: 3 of 1200 points on balls were set aside, farther than 4.5 standard deviations "
                 "from the sphere",
                 "left v1.5.csv: 3 von 1200 Punkten auf Kugeln wurden ausgesondert, weiter als 4,5 "
                 "Standardabweichungen von der Kugel entfernt")):
            self.assertEqual(self.german.translated(english), (german, "de"))

    def test_a_number_is_no_word(self):
        self.assertEqual(self.german.translated("the sweep of many deg is too narrow")[1], "en")

    def test_what_stays_english_is_marked(self):
        self.assertEqual(self.german.sentence("not <known>"), '<span lang="en">not &lt;known&gt;</span>')
        self.assertEqual(Language("en").sentence("not <known>"), "not &lt;known&gt;")

    def test_names_that_look_like_places_or_groups(self):
        name = r"{~x} \g<0> \1 {0}"
        text, _ = self.german.translated(f"{name}: its prior and the data disagree: the result lies 3.5 times the "
                                         "prior's u away from it")
        self.assertTrue(text.startswith(name), text)


if __name__ == "__main__":
    unittest.main()
