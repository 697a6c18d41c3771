"""The page in a browser: it stands alone, nothing runs, nothing is cut off, everything is there.

Every check is also shown a page that it must object to.
"""
import os
import unittest
from pathlib import Path

import browser
import pages
from printed import Printed

SCENES = ["sample", "robot", "bad", "named", "named_robot"]
WIDTHS = [1280, 390]


@unittest.skipUnless(os.path.exists(browser.CHROMIUM) and os.path.exists(browser.DRIVER),
                     "NO BROWSER: install chromium and chromium-driver; the page was not looked at")
class InBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def each(self, check, widths=WIDTHS):
        """Every page in every language at every width."""
        for scene in SCENES:
            for language in ["en", "de"]:
                for width in widths:
                    with self.subTest(scene=scene, language=language, width=width):
                        self.browser.open(pages.page(scene, language), width)
                        check()

    def open_changed(self, change, width: int = 1280, scene: str = "sample") -> Path:
        page = pages.changed(pages.page(scene), change)
        self.browser.open(page, width)
        return page


def before_the_end(piece: str):
    return lambda html: html.replace("</main>", piece + "</main>")


def in_first_figure(piece: str):
    return lambda html: html.replace("</svg>", piece + "</svg>", 1)


class PageTest(InBrowser):
    def test_nothing_is_loaded_and_nothing_fails(self):
        def check():
            self.assertEqual(self.browser.requests(), [])
            self.assertEqual(self.browser.errors(), [])
        self.each(check, widths=[1280])

    def test_requests_and_errors_are_seen(self):
        image = before_the_end('<img src="https://example.invalid/x.png">')
        self.open_changed(image)
        self.assertRegex(str(self.browser.errors()), "Content Security Policy")
        self.open_changed(lambda html: image(pages.without_policy(html)))
        self.assertEqual(self.browser.requests(), ["https://example.invalid/x.png"])
        self.open_changed(before_the_end("<script>1</script>"))
        self.assertRegex(str(self.browser.errors()), "Content Security Policy")
        script = before_the_end("<script>throw Error('ours')</script>")
        self.open_changed(lambda html: script(pages.without_policy(html)))
        self.assertRegex(str(self.browser.errors()), "ours")

    def test_names_are_shown_and_do_not_run(self):
        for scene in ["named", "named_robot"]:
            page = pages.changed(pages.page(scene), pages.without_policy)
            self.browser.open(page)
            self.assertEqual(self.browser.active_content(), [])
            self.assertEqual(self.browser.errors(), [])
            self.assertEqual(self.browser.run("return document.querySelector('h1').innerText"), pages.LONG.strip())
            words = self.browser.run("return document.body.textContent")
            for name in pages.names(scene):
                self.assertIn(name, words)

    def test_a_name_that_runs_is_seen(self):
        def unescaped(html):
            return pages.without_policy(html).replace("</h1>", pages.EVIL + "</h1>")
        self.open_changed(unescaped)
        found = self.browser.active_content()
        self.assertIn("SCRIPT", found)
        self.assertIn("a name ran", found)
        self.assertRegex(str(found), "IMG onerror")

    def test_the_page_is_as_wide_as_the_window(self):
        def check():
            self.assertEqual(self.browser.too_wide(), 0)
        self.each(check)

    def test_a_wide_page_is_seen(self):
        for width in WIDTHS:
            self.open_changed(before_the_end('<div style="width: 2000px">wide</div>'), width)
            self.assertGreater(self.browser.too_wide(), 600)

    def test_figures_keep_their_texts_apart_and_inside(self):
        def check():
            self.assertEqual(self.browser.texts_outside(), [])
            self.assertEqual(self.browser.texts_on_texts(), [])
        self.each(check)

    def test_texts_outside_and_on_each_other_are_seen(self):
        self.open_changed(in_first_figure('<text x="-20" y="20">outside</text>'))
        self.assertEqual(self.browser.texts_outside(), ["figure-budget: outside"])
        two = ('<g font-size="10"><text x="50" y="50" transform="rotate({} 50 50)">one</text>'
               '<text x="{}" y="50">two</text></g>')
        self.open_changed(in_first_figure(two.format(0, 55)))
        self.assertIn("figure-budget: one | figure-budget: two", self.browser.texts_on_texts())
        self.open_changed(in_first_figure(two.format(45, 63)))  # their upright boxes meet, they do not
        self.assertNotIn("figure-budget: one | figure-budget: two", self.browser.texts_on_texts())

    def test_a_figure_that_is_not_drawn_is_seen(self):
        figure = '<figure id="figure-budget">'
        self.open_changed(lambda html: html.replace(figure + "<svg", figure + "<p", 1))
        self.assertNotIn("figure-budget", self.browser.figures())
        self.assertIn("figure-correlation", self.browser.figures())


class BrowserPrintTest(InBrowser):
    def printed(self) -> Printed:
        file = pages.folder() / "browser.pdf"
        file.write_bytes(self.browser.pdf())
        return Printed(file)

    def test_prints_whole_figures_and_tables(self):
        def check():
            printed = self.printed()
            self.assertEqual(self.browser.too_wide_for_a_sheet(), 0)
            self.assertEqual(printed.wrong_sheets(), [])
            self.assertEqual(printed.lost(self.browser), [])
            self.assertEqual(printed.cut_figures(self.browser), [])
            self.assertEqual(printed.cut_rows(self.browser), [])
        self.each(check, widths=[1280])

    def test_what_is_cut_is_seen(self):
        self.open_changed(lambda html: html.replace("size: A4;", "size: A5;").replace("counter(pages)", "1"))
        self.assertGreaterEqual(len(self.printed().wrong_sheets()), 2)
        self.open_changed(before_the_end('<div style="width: 690px">wider than the sheet</div>'))
        self.assertGreater(self.browser.too_wide_for_a_sheet(), 10)
        self.open_changed(before_the_end('<p style="transform: translate(95%)">farthest rightmost</p>'))
        self.assertEqual(self.printed().lost(self.browser), ["rightmost"])
        row = f"<table><tr style='break-inside: auto'><td>aardvark{'<br>' * 81}zymurgy</table>"
        self.open_changed(before_the_end(row))
        self.assertEqual(self.printed().cut_rows(self.browser), [str(["aardvark\n" + "\n" * 80 + "zymurgy"])])
        self.open_changed(before_the_end("<figure><svg viewBox='0 0 9 20'><text y='1' font-size='1'>aardvark</text>"
                                         "<text y='19' font-size='1'>zymurgy</text></svg></figure>"))
        self.assertEqual(self.printed().cut_figures(self.browser), [""])


if __name__ == "__main__":
    unittest.main()
