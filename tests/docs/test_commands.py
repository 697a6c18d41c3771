"""Every command and every data set in the documents, run in a copy of the project as they say."""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from documents import DOCUMENTS, SOURCE, Block, blocks, spans
from printed import difference

PROGRAM = os.environ.get("SCANCAL_PROGRAM", str(SOURCE / "build" / "scancal"))
DATA_SETS = Path(os.environ.get("SCANCAL_DATASETS", SOURCE.parent / "shared" / "datasets"))  # no part of the project
FEW_TRIALS = "--trials=200"  # of a Monte Carlo whose printout is not shown
KINDS = {"sh", "text", "yaml"}


def run(arguments: list[str], where: Path = SOURCE) -> subprocess.CompletedProcess:
    return subprocess.run(arguments, cwd=where, capture_output=True, text=True, timeout=1200)


def help_of(arguments: list[str]) -> str:
    done = run([*arguments, "--help"])
    if done.returncode or not done.stdout.strip():
        raise AssertionError(f"{arguments}: --help says nothing: {done.stderr}")
    return done.stdout


def check_flags(words: list[str], offered: str) -> None:
    for flag in (word.partition("=")[0] for word in words if word.startswith("--")):
        if not re.search(rf"{flag}\b", offered):
            raise AssertionError(f"{flag} is no flag of {words[0]}")


def check_script(words: list[str]) -> None:
    """The scripts take long: they are there and know the flags."""
    check_flags(words, help_of([str(SOURCE / words[0])]))


def check_use(words: list[str]) -> None:
    """scancal COMMAND --flag=VALUE with values that stand for others."""
    if len(words) == 1 or words[1] == "--version":
        return
    offered = help_of([PROGRAM, words[1]]) if words[1] != "COMMAND" else ""
    check_flags([word for word in words[1:] if word != "--help"], offered)


class Copy:
    """The project as a reader of a document has it: built, with room for results."""

    def __init__(self):
        self._folder = tempfile.TemporaryDirectory(prefix="scancal_docs_")
        self.root = Path(self._folder.name)
        shutil.copytree(SOURCE / "data", self.root / "data")
        shutil.copytree(SOURCE / "tests" / "real", self.root / "tests" / "real")
        (self.root / "build").mkdir()
        (self.root / "build" / "scancal").symlink_to(PROGRAM)

    def __enter__(self) -> "Copy":
        return self

    def __exit__(self, *_) -> None:
        self._folder.cleanup()

    def follow(self, document: str) -> None:
        """Runs its blocks from the top."""
        self.printed = None
        self.missing = []  # data that are not there
        for block in blocks(document):
            try:
                self._follow(block)
            except AssertionError as wrong:
                raise AssertionError(f"line {block.line}: {wrong}") from None

    def _follow(self, block: Block) -> None:
        if block.kind not in KINDS:
            raise AssertionError(f"a block of kind '{block.kind}', expected one of {', '.join(sorted(KINDS))}")
        if block.kind != "text":
            self.printed, self.missing = None, []
        for what, asked in block.before:
            if what == "data":
                self._bring(*asked.split(" at "))
            elif not self.missing:
                done = run(["bash", "-ec", asked], self.root)
                if done.returncode:
                    raise AssertionError(f"{asked}: {done.stderr}")
        if block.kind == "sh":
            commands = [line.partition(" # ")[0].strip() for line in block.lines]
            self.printed = [line for command in commands if command for line in self._perform(command)]
        elif block.kind == "yaml":
            self._calibrate(block.lines)
        elif self.printed is not None and not self.missing:
            if wrong := difference(block.lines, self.printed):
                raise AssertionError("another printout:\n" + wrong)

    def _bring(self, name: str, path: str) -> None:
        """Puts data that are no part of the project where the document has them."""
        if not (DATA_SETS / name).exists():
            print(f"NO DATA: {DATA_SETS / name} is not there", file=sys.stderr)
            self.missing.append(name)
            return
        where = self.root / path
        where.mkdir(parents=True, exist_ok=True)
        for file in (DATA_SETS / name).iterdir():
            if not (where / file.name).exists():
                (where / file.name).symlink_to(file)

    def _perform(self, command: str) -> list[str]:
        words = shlex.split(command)
        words[0] = words[0].removeprefix("./")
        if words[0].startswith("scripts/"):
            check_script(words)
            if words[0] != "scripts/run":
                return []
            words = shlex.split(re.search(r"^exec (.*)$", (SOURCE / "scripts" / "run").read_text(), re.M)[1])
        if words[0] != "build/scancal":
            raise AssertionError(f"{command}: neither scancal nor a script")
        if words[1] == "montecarlo" and not any(word.startswith("--trials") for word in words):
            words.append(FEW_TRIALS)
        done = run(words, self.root)
        self._judge(done, command)
        return done.stdout.splitlines()

    def _judge(self, done: subprocess.CompletedProcess, what: str) -> None:
        """0 and 2 are results; without its data a data set is understood, but for its files."""
        if self.missing:
            if done.returncode != 1 or "no such file" not in done.stderr.lower():
                raise AssertionError(f"{what}: without data expected a file that is missing, found {done.stderr}")
        elif done.returncode not in (0, 2):
            raise AssertionError(f"{what}: exit code {done.returncode}: {done.stderr}")

    def _calibrate(self, lines: list[str]) -> None:
        """A data set whose first line names its file; else a part of one, added to the sample."""
        named = re.fullmatch(r"# (\S+\.yaml)", lines[0])
        file = self.root / (named[1] if named else "build/part/dataset.yaml")
        if not named:
            shutil.copytree(self.root / "data" / "sample", file.parent, dirs_exist_ok=True)
            lines = [*file.read_text().splitlines(), *lines]
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join(lines) + "\n")
        if "features:" in lines:  # nothing to calibrate: the commands behind it measure them
            return
        done = run(["build/scancal", "refine", str(file), "--out=build/of_data_set"], self.root)
        self._judge(done, f"the data set {file.name}")


def follow(document: str) -> None:
    with Copy() as project:
        project.follow(document)


class Commands(unittest.TestCase):
    def test_all_blocks(self):
        for document in DOCUMENTS:
            with self.subTest(document=str(document.relative_to(SOURCE))):
                follow(document.read_text(encoding="utf-8"))

    def test_commands_in_sentences(self):
        every_flag = "".join(help_of([PROGRAM, command]) for command in self._commands())
        every_flag += "".join(help_of([str(script)]) for script in (SOURCE / "scripts").iterdir()
                              if script.is_file() and script.name not in ("jobs", "selftest_digits"))
        for document in DOCUMENTS:
            for span in spans(document.read_text(encoding="utf-8")):
                with self.subTest(document=str(document.relative_to(SOURCE)), span=span):
                    words = span.split()
                    words[0] = words[0].removeprefix("./")
                    if words[0] in ("scancal", "build/scancal"):
                        check_use(words)
                    elif words[0].startswith("scripts/") and not (
                            (SOURCE / words[0]).is_dir() or words[0].endswith("/Snakefile")):
                        check_script(words)
                    elif words[0].startswith("--"):
                        check_flags(["the program", *words], every_flag)

    def test_every_command_of_the_program_is_described(self):
        text = (SOURCE / "docs" / "program.md").read_text(encoding="utf-8")
        for command in self._commands():
            self.assertIn(f"`scancal {command}", text)

    def test_every_key_of_a_result_is_described(self):
        text = (SOURCE / "docs" / "data.md").read_text(encoding="utf-8").partition("## 8 ")[2]
        with tempfile.TemporaryDirectory(prefix="scancal_docs_") as folder:
            for data_set in ("sample", "robot-sample"):
                run([PROGRAM, "refine", str(SOURCE / "data" / data_set), f"--out={folder}"])
                for key in json.loads((Path(folder) / "calibration.json").read_text(encoding="utf-8")):
                    with self.subTest(data_set=data_set, key=key):
                        self.assertIn(f"`{key}`", text)

    @staticmethod
    def _commands() -> list[str]:
        return re.findall(r"^  (\w+)", run([PROGRAM, "--help"]).stdout, re.M)


class WhatIsWrongIsNoticed(unittest.TestCase):
    """The test itself, on documents with one mistake each."""

    def assert_wrong(self, document: str, reason: str) -> None:
        with self.assertRaisesRegex(AssertionError, reason):
            follow(document)

    def test_a_flag_that_is_none(self):
        self.assert_wrong("```sh\nbuild/scancal refine data/sample --outt=build/x\n```\n", "outt")
        self.assert_wrong("```sh\nscripts/coverage --sets_=10\n```\n", "is no flag")

    def test_a_data_set_that_is_not_there(self):
        self.assert_wrong("```sh\nbuild/scancal refine data/simple --out=build/x\n```\n", "exit code 1")

    def test_a_digit(self):
        simulate = "```sh\nbuild/scancal simulate --out=build/x --points=20\n```\n```text\nwrote build/x: {}\n```\n"
        right = "3 placements x 200 profiles x 20 points, M = 123 mm, N = 409 mm, seed 1; truth.json holds the truth"
        follow(simulate.format(right))
        self.assert_wrong(simulate.format(right.replace("409", "407")), "another printout")
        self.assert_wrong(simulate.format(right) + "```text\nmore\n```\n", "another printout")

    def test_a_key_of_a_data_set(self):
        self.assert_wrong("```yaml\ninfluences: {scale_w: 1e-4}\n```\n", "unknown influence")
        self.assert_wrong("```yaml\n# build/x/dataset.yaml\nscancal: 1\nmodell: turntable\n```\n", "model")


if __name__ == "__main__":
    unittest.main()
