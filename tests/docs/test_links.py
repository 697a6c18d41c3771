"""What the documents refer to is there."""
import re
import unittest

from documents import DOCUMENTS, SOURCE, anchors, links, spans

ROOMS = [folder.name for folder in SOURCE.iterdir() if folder.is_dir() and not folder.name.startswith((".", "build"))]
README = SOURCE / "README.md"


def files() -> set[str]:
    return {path.relative_to(SOURCE).as_posix() for room in ROOMS for path in (SOURCE / room).rglob("*")}


class Links(unittest.TestCase):
    def test_links(self):
        for document in DOCUMENTS:
            for link in links(document.read_text(encoding="utf-8")):
                path, _, anchor = link.partition("#")
                if path.startswith("http"):
                    continue
                with self.subTest(document=document.name, link=link):
                    target = (document.parent / path).resolve() if path else document
                    self.assertTrue(target.exists())
                    if anchor:
                        self.assertIn(anchor, anchors(target.read_text(encoding="utf-8")))

    def test_files(self):
        there = files()
        for document in DOCUMENTS:
            if document.name == "CHANGELOG.md":  # tells of what was
                continue
            for span in spans(document.read_text(encoding="utf-8")):
                with self.subTest(document=document.name, span=span):
                    if re.fullmatch(rf"({'|'.join(ROOMS)})/[\w./*-]*", span):
                        self.assertTrue(list(SOURCE.glob(span.rstrip("/"))))
                    elif re.fullmatch(r"\w+/|[a-z]\w+\.(h|cc|py)", span):
                        self.assertTrue(any(f"/{file}".endswith(f"/{span.rstrip('/')}") for file in there))

    def test_sections(self):
        """"[turntable.md](turntable.md), section 4" has such a section."""
        for document in DOCUMENTS:
            text = document.read_text(encoding="utf-8")
            for path, section in re.findall(r"\]\(([\w./]+\.md)\),\s+sections? (\d)", text):
                with self.subTest(document=document.name, path=path, section=section):
                    self.assertRegex((document.parent / path).read_text(encoding="utf-8"), rf"(?m)^## {section} ")

    def test_what_the_code_cites(self):
        for room in ROOMS:
            for file in (SOURCE / room).rglob("*"):
                if file.suffix not in (".h", ".cc", ".py") or file.parent.name == "docs":
                    continue
                text = re.sub(r"\n\s*(//|#)?\s*", " ", file.read_text(encoding="utf-8"))
                for page, section in re.findall(r"\bdocs/(\w+\.md)(?:,? sections? (\d))?", text):
                    with self.subTest(file=str(file.relative_to(SOURCE)), page=page, section=section):
                        self.assertTrue((SOURCE / "docs" / page).exists())
                        if section:
                            self.assertRegex((SOURCE / "docs" / page).read_text(encoding="utf-8"),
                                             rf"(?m)^## {section} ")

    def test_one_finds_every_page_from_the_first(self):
        for page in (SOURCE / "docs").glob("*.md"):
            self.assertIn(f"docs/{page.name}", links(README.read_text(encoding="utf-8")))

    def test_the_first_page_is_short(self):
        self.assertLessEqual(len(README.read_text(encoding="utf-8").splitlines()), 160)


if __name__ == "__main__":
    unittest.main()
