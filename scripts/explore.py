"""Run the properties with fresh examples until a time is up: `explore.py MINUTES [words for pytest...]`.

`make test` tries the same examples each time, so that what is green stays green. This finds new ones:
pass after pass over every test that uses Hypothesis, the slow ones too, each pass with a seed of its
own. A pass whose tests fail is kept in build/explore with the example and the line that reproduces
it; the failed tests are listed at the end. Exit status 1 when a test failed.
"""

from __future__ import annotations

import os
import re
import secrets
import shlex
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "build" / "explore"

#: Time that running examples get to end by themselves when the time is up, s.
GRACE = 600.0

#: pytest's exit status when all passed, and when it collected no test.
ALL_PASSED, NO_TESTS = 0, 5


def run_pass(seed: int, until: float, words: list[str], log: Path) -> tuple[int, str]:
    """One pass over the properties: pytest's exit status and what it printed, also in `log`."""
    command = [
        *(sys.executable, "-m", "pytest", "-q", "-m", "hypothesis", "-p", "no:cacheprovider"),
        *("--hypothesis-profile=explore", f"--hypothesis-seed={seed}", "-rfE", *words),
    ]
    environment = {
        **os.environ,
        "TORSIONBOOK_RUN_SLOW": "1",
        "TORSIONBOOK_REQUIRE_ALL": "0",  # what the time no longer allows is skipped
        "TORSIONBOOK_EXPLORE_UNTIL": repr(until),
        "TORSIONBOOK_EXPLORE_SEED": str(seed),
    }
    print(f"seed {seed}: {shlex.join(command[1:])}", flush=True)
    with log.open("w", encoding="utf-8") as file:
        # The tests stop by themselves; the limit is for one that hangs.
        limit = max(0.0, until - time.time()) + GRACE
        try:
            status = subprocess.run(
                command,
                cwd=ROOT,
                env=environment,
                stdout=file,
                stderr=subprocess.STDOUT,
                timeout=limit,
                check=False,
            ).returncode
        except subprocess.TimeoutExpired:
            file.write(f"\nFAILED (a test was still running {GRACE:g} s after the time was up)\n")
            status = -1
    return status, log.read_text(encoding="utf-8", errors="replace")


def main() -> int:
    """Pass after pass until the time is up."""
    minutes, words = float(sys.argv[1]), sys.argv[2:]
    until = time.time() + 60.0 * minutes
    FOLDER.mkdir(parents=True, exist_ok=True)
    failed: list[str] = []
    passes = 0
    while time.time() < until:
        passes += 1
        seed = secrets.randbelow(2**32)
        log = FOLDER / f"seed-{seed}.log"
        status, text = run_pass(seed, until, words, log)
        lines = text.rstrip().splitlines() or [""]
        print(f"    {lines[-1]}", flush=True)
        if status == ALL_PASSED:
            log.unlink()
            continue
        blobs = re.findall(r"@reproduce_failure\(.*\)", text)
        tests = [line for line in lines if re.match(r"(FAILED|ERROR)\b", line)]
        failed += [f"seed {seed}: {line}" for line in tests or [lines[-1]]]
        for line in (*tests, *blobs, f"in full: {log.relative_to(ROOT)}"):
            print(f"    {line}", flush=True)
        if status == NO_TESTS or not tests:
            break  # nothing was tried: another seed would do no better
    print(f"\n{passes} passes in {minutes:g} minutes, {len(failed)} failures")
    print("\n".join(failed))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
