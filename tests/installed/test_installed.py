"""The program as `cmake --install` leaves it: in a folder with blanks in its name, moved, and used from there."""
import functools
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("SCANCAL_PROGRAM", SOURCE / "build" / "scancal"))


def run(*arguments, **more) -> subprocess.CompletedProcess:
    return subprocess.run([str(each) for each in arguments], capture_output=True, text=True, timeout=600, **more)


def files_in(folder: Path) -> list[Path]:
    return sorted(path.relative_to(folder) for path in folder.rglob("*"))


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory(prefix="scancal installed ")
        cls.root = Path(cls._folder.name)
        done = run("cmake", "--install", PROGRAM.parent, "--prefix", cls.root / "first place")
        if done.returncode:
            raise AssertionError(done.stderr)
        cls.prefix = (cls.root / "first place").rename(cls.root / "second place")
        cls.program = cls.prefix / "bin" / "scancal"
        cls.sample = cls.prefix / "share/doc/scancal/data/sample"

    @classmethod
    def tearDownClass(cls):
        cls._folder.cleanup()

    def surroundings(self, **more) -> dict:
        return {"PATH": os.environ["PATH"], "HOME": str(self.root / "home"), **more}

    def refine(self, name: str, **environment) -> subprocess.CompletedProcess:
        return run(self.program, "refine", self.sample, f"--out={self.root / name}", "--report", cwd=self.root,
                   env=self.surroundings(**environment))

    def test_the_report_of_the_sample_and_nothing_written_beside_the_program(self):
        before = files_in(self.prefix)
        done = self.refine("result")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        page = (self.root / "result" / "report.html").read_text(encoding="utf-8")
        self.assertIn("123.007", page)
        self.assertIn("data:font/woff", page)
        self.assertEqual(files_in(self.prefix), before)
        self.assertTrue((self.root / "home" / ".cache" / "scancal" / "fonts.css").exists())

    def test_no_python(self):
        done = self.refine("no python", SCANCAL_PYTHON=str(self.root / "no such python"))
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^scancal: .*no such python: No such file or directory; the report needs Python 3 with "
                                      r"Jinja2 and Matplotlib: install python3-jinja2 and .*\n$")

    def test_a_python_without_jinja(self):
        bare = self.root / "bare"
        bare.write_text('#!/bin/sh\nexec /usr/bin/env python3 -I -S "$@"\n')  # without Debian's packages
        bare.chmod(0o755)
        done = self.refine("without jinja", SCANCAL_PYTHON=str(bare))
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^scancal: \w+ is missing in .*python3.*: install python3-\w+, or name a Python .* "
                                      r"SCANCAL_PYTHON\n$")

    def test_a_program_without_its_page(self):
        shutil.copy(self.program, self.root / "alone")
        done = run(self.root / "alone", "refine", self.sample, f"--out={self.root / 'without page'}", "--report",
                   env=self.surroundings())
        self.assertEqual(done.returncode, 1)
        self.assertIn("share/scancal/page: no such folder, but it makes the report", done.stderr)

    def test_the_scripts_for_clusters_come_along(self):
        for name in ("parallel", "slurm"):
            done = run(self.prefix / "share/scancal/cluster" / name, "--help")
            self.assertEqual(done.returncode, 0)
            self.assertIn(f"scripts/cluster/{name} LIST OUT", done.stdout)

    @functools.cache
    def commands(self) -> list[str]:
        return re.findall(r"^  (\w+) ", run(self.program, "--help").stdout, re.M)

    @functools.cache
    def flags_of(self, command: str) -> list[str]:
        return re.findall(r"^  (--\w+)", run(self.program, command, "--help").stdout, re.M)

    def test_the_manual_has_every_flag_under_its_command(self):
        roff = (self.prefix / "share/man/man1/scancal.1").read_text(encoding="utf-8")
        sections = dict(re.findall(r"^\.SS scancal (\w+)[^\n]*\n(.*?)(?=^\.S[SH] )", roff, re.M | re.S))
        self.assertEqual(list(sections), self.commands())
        for command, section in sections.items():
            told = re.findall(r"^\.B (\\-\\-\w+)", section, re.M)
            self.assertEqual([flag.replace("\\", "") for flag in told], self.flags_of(command))
        if shutil.which("groff"):
            done = run("groff", "-man", "-Tutf8", "-ww", self.prefix / "share/man/man1/scancal.1")
            self.assertEqual(done.stderr, "")
            self.assertIn("calibrate: search, joint refinement", re.sub(r"\s+", " ", done.stdout))

    def test_bash_completes_commands_flags_and_files(self):
        def completed(*words: str) -> list[str]:
            script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _scancal; '
                      'printf "%s\\n" "${COMPREPLY[@]}"')
            file = self.prefix / "share/bash-completion/completions/scancal"
            done = run("bash", "-uec", script, "bash", file, self.program, *words, cwd=self.sample)
            self.assertEqual(done.stderr, "")
            return done.stdout.splitlines()
        self.assertEqual(completed(""), self.commands())
        self.assertEqual(completed("simul"), ["simulate"])
        for command in ("refine", "simulate", "report"):
            self.assertEqual([word.rstrip("=") for word in completed(command, "--")], self.flags_of(command))
        self.assertEqual(completed("refine", "--out", "=", "lef"), ["left.csv"])
        self.assertEqual(completed("refine", "dat"), ["dataset.yaml"])


if __name__ == "__main__":
    unittest.main()
