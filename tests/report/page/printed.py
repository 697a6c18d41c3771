"""A printed page, read back by Poppler: what of the page on the screen is not whole on one sheet of it."""
import re
import subprocess
from pathlib import Path

from browser import Browser

A4 = (595.3, 841.9)  # points
_INSIDE = ["-x", "14", "-y", "14", "-W", "567", "-H", "814"]  # what a printer's margin of 5 mm leaves


class Printed:
    def __init__(self, pdf: Path):
        self._pdf = pdf
        self.pages = [_letters(text) for text in _poppler("pdftotext", "-raw", *_INSIDE, pdf, "-").split("\f")[:-1]]

    def wrong_sheets(self) -> list[str]:
        """Sheets that are not A4, or do not say which of how many they are."""
        sizes = re.findall(r"Page +\d+ size: +([\d.]+) x ([\d.]+)",
                           _poppler("pdfinfo", "-f", "1", "-l", str(len(self.pages)), self._pdf))
        assert len(sizes) == len(self.pages), "pdfinfo is not understood"
        return ([f"page {k + 1}: {size}" for k, size in enumerate(sizes)
                 if any(abs(float(length) - of_a4) > 1 for length, of_a4 in zip(size, A4))] +
                [f"page {k + 1} has no number" for k, letters in enumerate(self.pages)
                 if f"Page{k + 1}of{len(self.pages)}" not in letters])

    def lost(self, browser: Browser) -> list[str]:
        """Words of the open page that are on no sheet; of long words, which break, the start."""
        words = browser.run("return document.body.innerText").split()
        everything = "".join(self.pages)
        return [word for word in words if word[:8] not in everything]

    def cut_figures(self, browser: Browser) -> list[str]:
        """Figures of the open page whose caption and texts do not stand on one sheet."""
        figures = browser.run("""
            return [...document.querySelectorAll("figure")].map(figure => [figure.id,
                [...figure.querySelectorAll("svg text, figcaption")].map(text => text.textContent)])""")
        return [name for name, texts in figures if not self._on_one_sheet(texts)]

    def cut_rows(self, browser: Browser) -> list[str]:
        """Rows of the open page's tables whose words do not stand on one sheet."""
        rows = browser.run("""
            return [...document.querySelectorAll("tr")].map(row => [...row.cells].map(cell => cell.innerText))""")
        return [str(row) for row in rows
                if not self._on_one_sheet([word[:8] for cell in row for word in cell.split()])]

    def _on_one_sheet(self, texts: list[str]) -> bool:
        return any(all(_letters(text) in letters for text in texts) for letters in self.pages)


def _letters(text: str) -> str:
    """Without white space: where a line breaks does not matter."""
    return re.sub(r"\s", "", text)


def _poppler(*command) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout
