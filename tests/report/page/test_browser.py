"""The page in a browser: it stands alone, nothing runs, nothing is cut off, everything is there.

Every check is also shown a page that it must object to.
"""
import os
import unittest
from pathlib import Path

import browser
import pages
from pictures import broken_images, broken_svgs
from printed import Printed

WIDTHS = [1280, 390]
WIDE = ["sample", "robot"]
MOST_BYTES = 3_000_000
FIRST_SCREEN = 844  # pixels of a phone; on 1280 x 800 it ends far above
OF_ALL = ["budget", "scene", "scene_3d"]
OF_SCANS = ["comparison", "residual_map", "residual_sweep", "residual_line", "residual_histogram", "surface_contour"]
OF_ROBOTS = ["correlation", "links", "robot_residuals", "joints", "workspace", "lengths"]  # two numbers need no matrix
FIGURES = {"sample": OF_ALL + OF_SCANS + ["leave_one_out", "monte_carlo"], "bad": OF_ALL + OF_SCANS,
           "many_targets": OF_ALL + OF_SCANS + ["residual_time", "correlation", "leave_one_out", "volume"],
           "robot": OF_ALL + OF_ROBOTS + ["robot_residual_map", "leave_one_out", "comparison"],
           "many_stations": OF_ALL + OF_ROBOTS + ["robot_residual_map", "comparison"],
           "flange": OF_ALL + OF_ROBOTS + ["comparison"]}
FIGURES |= {"named": FIGURES["sample"], "named_robot": FIGURES["robot"]}


@unittest.skipUnless(os.path.exists(browser.CHROMIUM) and os.path.exists(browser.DRIVER),
                     "NO BROWSER: install chromium and chromium-driver; the page was not looked at")
class InBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def each_page(self):
        """Opens every page in every language; a test that goes on with the next at a complaint.

        In the narrow window: figures scale with it, and what fits there fits in a wide one; the sample of either
        scanner in a wide one, too.
        """
        for scene in pages.SCENES:
            for language in pages.LANGUAGES.get(scene, ["en", "de"]):
                for width in WIDTHS if language == "en" and scene in WIDE else [min(WIDTHS)]:
                    self.browser.open(pages.page(scene, language), width)
                    yield f"{scene}, {language}, {width} px", scene

    def open_changed(self, change, width: int = 1280, scene: str = "sample") -> Path:
        page = pages.changed(pages.page(scene), change)
        self.browser.open(page, width)
        return page


def before_the_end(piece: str):
    return lambda html: html.replace("</main>", piece + "</main>")


def in_first_figure(piece: str):
    return lambda html: html.replace("</svg>", piece + "</svg>", 1)


class PageTest(InBrowser):
    def test_every_page_is_sound(self):
        for what, scene in self.each_page():
            for found in ["requests", "errors", "active_content", "texts_outside", "texts_on_texts"]:
                with self.subTest(what, of=found):
                    self.assertEqual(getattr(self.browser, found)(), [])
            with self.subTest(what, of="width"):
                self.assertEqual(self.browser.too_wide(), 0)
            if not scene.startswith("named"):  # whose names fill a screen
                with self.subTest(what, of="first screen"):
                    self.assertLess(self.browser.end_of_status(), FIRST_SCREEN)
            with self.subTest(what, of="figures"):
                self.assertEqual(sorted(self.browser.figures()), sorted(f"figure-{name}" for name in FIGURES[scene]))

    def test_pictures_are_whole_and_pages_can_be_sent(self):
        for scene in pages.SCENES:
            html = pages.page(scene).read_text(encoding="utf-8")
            with self.subTest(scene):
                self.assertEqual(broken_svgs(html), [])
                self.assertEqual(broken_images(html), [])
                self.assertLess(len(html), MOST_BYTES)

    def test_every_figure_is_on_a_page(self):
        drawn = {file.stem for file in (pages.SOURCE / "report/page/figures").glob("[!_]*.py")}
        self.assertEqual({name for names in FIGURES.values() for name in names}, drawn)

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

    def test_a_wide_page_is_seen(self):
        for width in WIDTHS:
            self.open_changed(before_the_end('<div style="width: 2000px">wide</div>'), width)
            self.assertGreater(self.browser.too_wide(), 600)

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
        figure = '<figure id="figure-budget"><div class="drawing">'
        self.open_changed(lambda html: html.replace(figure + "<svg", figure + "<p", 1))
        self.assertNotIn("figure-budget", self.browser.figures())
        self.assertIn("figure-scene", self.browser.figures())


class BrowserPrintTest(InBrowser):
    def printed(self) -> Printed:
        file = pages.folder() / "browser.pdf"
        file.write_bytes(self.browser.pdf())
        return Printed(file)

    def test_prints_whole_figures_and_tables(self):
        for scene in pages.PRINTED:
            self.browser.open(pages.page(scene))
            self.assert_whole(self.printed(), scene)
            with self.subTest(scene, of="width"):
                self.assertEqual(self.browser.too_wide_for_a_sheet(), 0)

    def test_so_does_the_pdf(self):
        for scene in pages.PRINTED:
            self.browser.open(pages.page(scene))
            self.assert_whole(Printed(pages.pdf(scene)), scene)

    def assert_whole(self, printed: Printed, what: str):
        for found in [printed.wrong_sheets(), printed.lost(self.browser), printed.cut_figures(self.browser),
                      printed.cut_rows(self.browser)]:
            with self.subTest(what):
                self.assertEqual(found, [])

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
