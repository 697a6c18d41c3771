"""Puts report/page on the path: its modules import one another by their bare names."""
import os
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]
DATA_SETS = Path(os.environ.get("SCANCAL_DATASETS",
                                SOURCE.parent / "shared" / "datasets"))  # no part of the project

sys.path.insert(0, str(SOURCE / "report" / "page"))
