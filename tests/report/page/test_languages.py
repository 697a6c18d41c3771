"""Every word is in the texts, in every language alike; what the program says in a calibration has its German."""
import ast
import html
import json
import re
import string
import tomllib
import unittest

import pages
import paths
from consistency import MODELS
from language import LANGUAGES, TEXTS, Language
from synthetic import calibration, said

PAGE = paths.SOURCE / "report" / "page"
# Signs, symbols and names that are the same in every language.
SIGNS = {"u", "U", "k", "F", "p", "rms", "%", "SHA-256", "scancal", "scancal refine", "±", "x", "y", "z"}


def texts(code: str) -> dict[str, str]:
    """All words by their keys."""
    found = {}
    for file in sorted((TEXTS / code).glob("*.toml")):
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


class TextsTest(unittest.TestCase):
    def test_the_same_files_keys_and_places(self):
        english = texts("en")
        for code in LANGUAGES:
            other = texts(code)
            self.assertEqual(sorted(set(english) ^ set(other)), [], code)
            for key, text in english.items():
                self.assertEqual(places(text), places(other[key]), f"{code}: {key}")

    def test_every_model_has_its_words(self):
        of_balls = {key for key in texts("en") if "robot-ball" in key}
        self.assertGreater(len(of_balls), 10)
        for model in MODELS:
            missing = {key.replace("robot-ball", model) for key in of_balls} - set(texts("en"))
            self.assertEqual({key for key in missing if model != "turntable" or "workspace" not in key}, set(), model)

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
    def test_what_the_program_says_has_its_german(self):
        for scene in ("sample", "robot", "bad"):
            c = json.loads(pages.calibration(scene).read_text(encoding="utf-8"))
            german = Language("de", c)
            told = [*c["unreliable"], *c["warnings"],
                    *[row[key] for row in c["compare"] for key in ("method", "note") if row[key]],
                    *[line["source"] for line in c["budget"] if line["source"].startswith(("residuals", "prior"))]]
            self.assertEqual([english for english in told if german.translated(english)[1] != "de"], [], scene)
            words = [("procedure.residual", c["residual"])] + [
                ("considered.set_aside.because", reason)
                for target in c["targets"] for reason in target["set_aside_reasons"]]
            self.assertEqual([word for key, word in words if german.named(key, word) == word], [], scene)

    def test_a_shown_page_has_no_sentence_in_english(self):
        for scene in ("sample", "bad"):
            shown = re.search('<section id="verdict".*?</section>', pages.page(scene, "de").read_text(encoding="utf-8"),
                              re.DOTALL)[0]
            self.assertIn("<li>" if scene == "bad" else "verdict", shown)
            self.assertNotIn('lang="en"', shown, scene)

    def test_messages_of_all_that_are_shown(self):
        german = Language("de", calibration(messages=[said("one", "eins")]), None,
                          calibration(messages=[said("two", "zwei")]), calibration())
        self.assertEqual([german.translated(word) for word in ("one", "two", "three")],
                         [("eins", "de"), ("zwei", "de"), ("three", "en")])

    def test_what_stays_english_is_marked(self):
        self.assertEqual(Language("de").sentence("not <known>"), '<span lang="en">not &lt;known&gt;</span>')
        self.assertEqual(Language("en").sentence("not <known>"), "not &lt;known&gt;")
        german = Language("de", calibration(messages=[said("known", "<bekannt>")]))
        self.assertEqual(german.sentence("known"), "&lt;bekannt&gt;")


if __name__ == "__main__":
    unittest.main()
