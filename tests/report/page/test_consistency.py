"""What was edited or damaged is refused in one sentence, and no file is lost."""
import copy
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import paths
import consistency
from calibration import Calibration, Complaint
from synthetic import calibration


def edited(change) -> Calibration:
    c = copy.deepcopy(calibration())
    c.file = Path("some.json")
    change(c)
    return c


class ConsistencyTest(unittest.TestCase):
    def refuses(self, change, words: str) -> None:
        with self.assertRaisesRegex(Complaint, words):
            consistency.check(edited(change))

    def test_accepts_what_is_written_and_what_is_absent(self):
        consistency.check(edited(lambda c: None))
        consistency.check(edited(lambda c: c.pop("covariance", None)))
        consistency.check(edited(lambda c: c.estimated[0].update(dof=None, k=None)))

    def test_refuses_what_contradicts_itself(self):
        self.refuses(lambda c: c.update(model="../../etc"), "model: found '../../etc'")
        self.refuses(lambda c: c.update(status="fine"), "status: found 'fine'")
        self.refuses(lambda c: c.update(status="ok", unreliable=["x is wrong"]), "beside reasons")
        self.refuses(lambda c: c.estimated[0].update(U=c.estimated[0]["U"] / 2), "is not k u")
        self.refuses(lambda c: c.estimated[0].update(u=True), "u: found True, expected a number")
        self.refuses(lambda c: c.estimated[0].update(dof="inf"), "dof: found 'inf'")
        self.refuses(lambda c: c.estimated[0].update(name=None), "expected a name")
        u = [p["u"] for p in calibration().estimated]
        self.refuses(lambda c: c["covariance"][0].__setitem__(0, 4 * u[0] ** 2), "not u squared")
        self.refuses(lambda c: c["covariance"][0].__setitem__(1, u[0] * u[1] / 2), "not symmetric")
        self.refuses(lambda c: c.update(covariance=[[a * b * (1 if a == b else 5) for b in u] for a in u]),
                     "not positive definite")
        self.refuses(lambda c: c.update(covariance=[[1, 2, 3]]), "expected 3 x 3 numbers")


class FilesTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.file = self.folder / "calibration.json"
        self.file.write_text(json.dumps(calibration()))

    def says(self, *arguments: str) -> str:
        done = subprocess.run([sys.executable, "-B", paths.SOURCE / "report/page", self.file, *arguments],
                              capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, r"\Ascancal: [^\n]*\n\Z")
        return done.stderr

    def test_a_file_that_is_read_is_not_written(self):
        before = self.file.read_bytes()
        self.assertIn("name of its own", self.says("--out=calibration.json"))
        self.assertIn("name of its own", self.says("--out=a.html", "--pdf=./a.html"))
        self.assertEqual(self.file.read_bytes(), before)
        self.assertEqual([file.name for file in self.folder.iterdir()], ["calibration.json"])

    def test_what_is_no_file_is_not_replaced(self):
        (self.folder / "folder").mkdir()
        self.assertIn("no file that could be replaced", self.says("--out=folder"))
        self.assertIn("no file that could be replaced", self.says("--out=/dev/null"))

    def test_damage_is_told_in_one_sentence(self):
        for text in ["[" * 100_000, json.dumps(calibration() | {"targets": [1]})]:
            self.file.write_text(text)
            self.says("--out=a.html")


if __name__ == "__main__":
    unittest.main()
