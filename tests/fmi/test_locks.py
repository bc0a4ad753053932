"""Two processes that want the same file: one makes it, the other waits."""

import subprocess
import sys
from pathlib import Path

CODE = """
import sys, time
from pathlib import Path
from fmus.locks import one_at_a_time
path = Path(sys.argv[1]) / "made" / "file"
with one_at_a_time(path):
    if path.exists():
        print("found")
    else:
        time.sleep(0.3)
        path.write_text("made")
        print("made")
"""


def test_only_one_process_makes_the_file(tmp_path: Path) -> None:
    running = [
        subprocess.Popen([sys.executable, "-c", CODE, str(tmp_path)], stdout=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    words = sorted(process.communicate()[0].strip() for process in running)
    assert words == ["found", "found", "made"]
