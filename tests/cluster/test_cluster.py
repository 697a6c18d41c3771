"""scripts/cluster on small data sets: GNU parallel itself; Slurm's script with a stand-in for sbatch that runs jobs at once."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("SCANCAL_PROGRAM", str(SOURCE / "build" / "scancal"))
SBATCH = """#!/bin/bash
# Runs the jobs that it is given, and prints a number as sbatch does.
for word; do
  case $word in
    --array=1-*) jobs=${word##*-} ;;
    --output=*) output=${word#*=} ;;
    --wrap=*) bash -c "${word#*=}" > "$output" 2>&1; echo 2; exit ;;
    --*) ;;
    *) break ;;
  esac
  shift
done
for ((k = 1; k <= jobs; ++k)); do SLURM_ARRAY_TASK_ID=$k "$@" > "${output/\\%a/$k}" 2>&1; done
echo "1;cluster"
"""


class Cluster(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="scancal cluster ")
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "bin").mkdir()
        sbatch = self.root / "bin" / "sbatch"
        sbatch.write_text(SBATCH)
        sbatch.chmod(0o755)
        for seed, name in enumerate(["first", "the second", "it's a third"], 1):
            self.run_here(PROGRAM, "simulate", f"--out={name}", f"--seed={seed}", "--profiles=40", "--points=20")
        (self.root / "broken").mkdir()
        (self.root / "list").write_text("# a fleet\nfirst\nthe second\n\nbroken\nit's a third\n")

    def run_here(self, *arguments: str) -> subprocess.CompletedProcess:
        environment = {**os.environ, "PATH": f"{self.root / 'bin'}:{os.environ['PATH']}", "SCANCAL": PROGRAM, "JOBS": "3"}
        return subprocess.run(arguments, cwd=self.root, env=environment, capture_output=True, text=True, timeout=600)

    def summary(self) -> list[dict]:
        return json.loads((self.root / "out put" / "summary.json").read_text())["datasets"]

    def mend(self) -> None:
        shutil.copytree(self.root / "first", self.root / "broken", dirs_exist_ok=True)

    def follow(self, script: str) -> None:
        """All but the broken one are computed by the engine; mended, that one alone; the digits are those of a batch."""
        command = (str(SOURCE / "scripts" / "cluster" / script), "list", "out put", "--weights=equal")
        self.run_here(*command)
        self.assertEqual([each["status"] for each in self.summary()], ["ok", "ok", "failed", "ok"])
        self.assertEqual([each["unchanged"] for each in self.summary()], [True, True, False, True])  # for the last step
        before = (self.root / "out put/first/calibration.json").stat().st_mtime_ns
        self.mend()
        done = self.run_here(*command)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([each["status"] for each in self.summary()], ["ok"] * 4)
        self.assertTrue(all(each["unchanged"] for each in self.summary()))
        self.assertEqual((self.root / "out put/first/calibration.json").stat().st_mtime_ns, before)
        by_engine = [each["parameters"] for each in self.summary()]
        self.run_here(PROGRAM, "refine", "--batch=list", "--out=other", "--weights=equal")
        other = json.loads((self.root / "other" / "summary.json").read_text())["datasets"]
        self.assertEqual([each["parameters"] for each in other], by_engine)

    @unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed")
    def test_parallel(self):
        self.follow("parallel")
        log = (self.root / "out put" / "joblog").read_text().splitlines()
        self.assertEqual(len(log), 1 + 4 + 1)  # its header, all, the broken one again
        self.assertIn("broken", log[-1])

    def test_slurm_with_a_stand_in(self):
        self.follow("slurm")
        said = [(self.root / "out put" / f"slurm-{job}.txt").read_text() for job in (1, 2, 3)]
        self.assertEqual([text.count("unchanged: ") for text in said], [2, 1, 0])  # of the second time
        self.assertIn("status: ok", said[2])  # the broken one


if __name__ == "__main__":
    if not shutil.which("parallel"):
        print("NO GNU PARALLEL: its script is not tested", file=sys.stderr)
    unittest.main()
