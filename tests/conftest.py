"""What every test may rely on: markers, what they require, LibreOffice, Hypothesis profiles.

TORSIONBOOK_REQUIRE_ALL=1   a test that would be skipped fails instead (set in CI)
TORSIONBOOK_RUN_SLOW=1      tests marked `slow` run too, properties try all their examples (set in CI)
TORSIONBOOK_RUN_LONG=1      tests marked `long` run too (set by `make test-long`); CI runs the slow sample beside each
TORSIONBOOK_EVERY=4         only every fourth of the tests is run: a sample of a repetition
TORSIONBOOK_SOFFICE=path    the LibreOffice to use, when it is not where one looks first

`make explore` sets TORSIONBOOK_EXPLORE_UNTIL, the time after which no further test is begun, and
TORSIONBOOK_EXPLORE_SEED, from which the tests are put in order.
"""

import io
import os
import random
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Generator
from pathlib import Path

import hypothesis
import pytest

# Before numpy is loaded: small matrices, several test processes, the same sums everywhere.
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

REQUIRE_ALL = os.environ.get("TORSIONBOOK_REQUIRE_ALL") == "1"
RUN_SLOW = os.environ.get("TORSIONBOOK_RUN_SLOW") == "1"
RUN_LONG = os.environ.get("TORSIONBOOK_RUN_LONG") == "1"
EVERY = int(os.environ.get("TORSIONBOOK_EVERY", "1"))
EXPLORE_UNTIL = float(os.environ.get("TORSIONBOOK_EXPLORE_UNTIL", "inf"))
EXPLORE_SEED = os.environ.get("TORSIONBOOK_EXPLORE_SEED")

# Every run tries the same examples: what is green stays green, on every machine, also on a busy one.
# `make explore` tries fresh ones, from a seed that it prints. A run without the slow tests tries
# fewer; `example_count` in tests/strategies.py gives a property that has its own number the same share.
for _name, _derandomize in (("same", True), ("explore", False)):
    hypothesis.settings.register_profile(
        _name,
        max_examples=100 if RUN_SLOW else 30,
        deadline=None,
        derandomize=_derandomize,
        database=None,
        print_blob=True,
        suppress_health_check=[hypothesis.HealthCheck.too_slow],
    )
hypothesis.settings.load_profile("same")


# --- what a marker requires -----------------------------------------------------------------------


def find_soffice() -> str | None:
    """The LibreOffice executable, or None."""
    named = os.environ.get("TORSIONBOOK_SOFFICE")
    if named is not None:
        return named if os.access(named, os.X_OK) else None
    usual = (
        "/Applications/LibreOffice.app/Contents/MacOS/soffice",
        r"C:\Program Files\LibreOffice\program\soffice.exe",
    )
    found = shutil.which("soffice") or shutil.which("libreoffice")
    return found or next((path for path in usual if os.access(path, os.X_OK)), None)


def find_browser() -> str | None:
    """A Chromium that can be driven headless, or None."""
    names = ("chromium", "chromium-browser", "google-chrome", "chrome")
    return next((found for found in map(shutil.which, names) if found), None)


def find_redis() -> str | None:
    """A server that shares memory, or None."""
    names = ("valkey-server", "redis-server")
    return next((found for found in map(shutil.which, names) if found), None)


REQUIREMENTS = {
    "needs_libreoffice": (find_soffice, "LibreOffice (soffice) is not installed"),
    "needs_browser": (find_browser, "no Chromium is installed"),
    "needs_redis": (find_redis, "neither valkey-server nor redis-server is installed"),
}


#: Rooms that calculate, and rooms that do not. The first of two test processes begins with the former, the
#: second with the latter (the halves are counted by tests: it begins among those of `contract`); all others
#: come last, and share the workbooks that the second process makes.
_CALCULATING = (
    "acceptance",
    "engine",
    "hard_cases",
    "numerics",
    "properties",
    "regression",
    "validation",
)
_NOT_CALCULATING = ("reading", "template", "contract", "boundaries", "xlsx", "excel", "hostile")


def _turn(item: pytest.Item) -> int:
    """Place of a test's room in the order in which rooms are tested."""
    order = (*_CALCULATING, *_NOT_CALCULATING)
    room = next(iter(item.path.parts[len(Path(__file__).parent.parts) :]), "")
    return order.index(room) if room in order else len(order)


#: Tests that were measured to be too dear for the default run: `make slow-tests`.
SLOW_TESTS = Path(__file__).with_name("slow_tests.txt")


def _slow_beyond_the_first(items: list[pytest.Item]) -> None:
    """Where a test is marked `first_ones(n)`, all its parameters but the first n are slow."""
    seen: Counter[str] = Counter()
    for item in items:
        marker = item.get_closest_marker("first_ones")
        if marker is not None:
            name = item.nodeid.partition("[")[0]
            seen[name] += 1
            if seen[name] > marker.args[0]:
                item.add_marker("slow")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    measured = SLOW_TESTS.read_text("utf-8").split() if SLOW_TESTS.is_file() else ()
    too_dear = frozenset(measured)
    for item in items:
        if "soffice" in getattr(item, "fixturenames", ()):
            item.add_marker("needs_libreoffice")
        if item.nodeid.partition("[")[0] in too_dear:
            item.add_marker("slow")
    _slow_beyond_the_first(items)
    not_run = [
        item
        for item in items
        if (not RUN_SLOW and item.get_closest_marker("slow"))
        or (not RUN_LONG and item.get_closest_marker("long"))
    ]
    if not_run:
        config.hook.pytest_deselected(items=not_run)
        dropped = set(not_run)
        items[:] = [item for item in items if item not in dropped]
    items.sort(key=_turn)
    if EVERY > 1:
        sample = items[::EVERY]
        config.hook.pytest_deselected(items=[item for n, item in enumerate(items) if n % EVERY])
        items[:] = sample
    if EXPLORE_SEED is not None:
        # Not the same ones each time where the time ends in the middle of a pass.
        random.Random(EXPLORE_SEED).shuffle(items)


def pytest_runtest_setup(item: pytest.Item) -> None:
    if time.time() > EXPLORE_UNTIL:
        pytest.skip("the time of make explore is up")
    for marker, (find, reason) in REQUIREMENTS.items():
        if item.get_closest_marker(marker) and find() is None:
            pytest.skip(reason)


def _refuse_skip(report: pytest.TestReport | pytest.CollectReport) -> None:
    if REQUIRE_ALL and report.skipped and not hasattr(report, "wasxfail"):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
        report.outcome = "failed"
        report.longrepr = f"TORSIONBOOK_REQUIRE_ALL=1 lets nothing be skipped. {reason}"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    _refuse_skip(report)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    report = yield
    _refuse_skip(report)
    return report


# --- LibreOffice, the tests' independent spreadsheet program -------------------------------------

# It recalculates every OOXML and ODF file on load, runs no macro and follows no link.
_PROFILE_SETTINGS = (
    ("Calc/Formula/Load", "OOXMLRecalcMode", "0"),
    ("Calc/Formula/Load", "ODFRecalcMode", "0"),
    ("Common/Security/Scripting", "MacroSecurityLevel", "3"),
    ("Common/Security/Scripting", "DisableMacrosExecution", "true"),
    ("Calc/Content/Update", "Link", "2"),
)


def write_profile(folder: Path) -> None:
    """A LibreOffice user profile with the settings above."""
    items = "\n".join(
        f'<item oor:path="/org.openoffice.Office.{path}">'
        f'<prop oor:name="{name}" oor:op="fuse"><value>{value}</value></prop></item>'
        for path, name, value in _PROFILE_SETTINGS
    )
    (folder / "user").mkdir(parents=True, exist_ok=True)
    (folder / "user" / "registrymodifications.xcu").write_text(
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<oor:items xmlns:oor="http://openoffice.org/2001/registry"'
        ' xmlns:xs="http://www.w3.org/2001/XMLSchema"'
        ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">\n'
        f"{items}\n</oor:items>\n",
        encoding="utf-8",
    )


class Soffice:
    """LibreOffice without a window, with a profile of this test process's own."""

    def __init__(self, program: str, folder: Path, timeout: float = 120.0) -> None:
        self.program = program
        self.folder = folder
        self.timeout = timeout
        self.profile = folder / "profile"
        self._count = 0
        write_profile(self.profile)

    def convert(self, path: Path, to: str = "xlsx", outdir: Path | None = None) -> Path:
        """Open a file, recalculate every formula, save it as another: `xlsx`, `pdf`, `csv`.

        `to` may carry a filter: `csv:Text - txt - csv (StarCalc):44,34,76,1,,0,false,true,false,
        false,false,-1`. Without `outdir` the result goes to a new temporary folder. The file
        itself is copied first, so that no lock file appears beside it.
        """
        path = Path(path)
        self._count += 1
        work = self.folder / f"{self._count:04d}"
        (work / "in").mkdir(parents=True)
        source = Path(shutil.copyfile(path, work / "in" / path.name))
        made = work / "out" / f"{path.stem}.{to.partition(':')[0]}"
        said = self._run(to, source, made.parent)
        if not made.is_file() or made.stat().st_size == 0:
            # A new profile's first start sometimes only sets the profile up.
            said = self._run(to, source, made.parent)
        # LibreOffice exits with 0 whether or not it could read the file.
        if not made.is_file() or made.stat().st_size == 0:
            raise RuntimeError(f"LibreOffice made no {to} of {path}. It said: {said.strip()}")
        if outdir is None:
            return made
        target = Path(outdir) / made.name
        if target.exists() and target.samefile(path):
            raise ValueError(f"the result would overwrite its source {path}")
        target.parent.mkdir(parents=True, exist_ok=True)
        return Path(shutil.move(made, target))

    def pages(self, path: Path, dpi: int = 80, outdir: Path | None = None) -> list[Path]:
        """Render a workbook (or a PDF) to one PNG a page, in page order; needs poppler."""
        if shutil.which("pdftoppm") is None:
            pytest.skip("poppler's pdftoppm is not installed")
        path = Path(path)
        pdf = path if path.suffix.lower() == ".pdf" else self.convert(path, "pdf")
        if outdir is None:
            self._count += 1
            outdir = self.folder / f"{self._count:04d}"
        outdir.mkdir(parents=True, exist_ok=True)
        subprocess.run(
            ["pdftoppm", "-r", str(dpi), "-png", str(pdf), str(outdir / "page")],
            check=True,
            capture_output=True,
            timeout=self.timeout,
        )
        return sorted(outdir.glob("page-*.png"), key=lambda p: int(re.findall(r"\d+", p.stem)[-1]))

    def _run(self, to: str, source: Path, outdir: Path) -> str:
        command = [
            self.program,
            f"-env:UserInstallation={self.profile.as_uri()}",
            "--headless",
            "--norestore",
            "--nolockcheck",
            "--nodefault",
            "--nologo",
            "--convert-to",
            to,
            "--outdir",
            str(outdir),
            str(source),
        ]
        # A session of its own, so that a hanging child of the starter script is ended with it.
        with subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        ) as process:
            try:
                return process.communicate(timeout=self.timeout)[0]
            except subprocess.TimeoutExpired:
                end_group(process)
                raise RuntimeError(
                    f"LibreOffice was still busy with {source.name} after {self.timeout:g} s"
                ) from None


def end_group(process: "subprocess.Popen[str]") -> None:
    if sys.platform == "win32":
        process.kill()
        return
    import signal

    os.killpg(process.pid, signal.SIGTERM)
    for _ in range(50):
        if process.poll() is not None:
            break
        time.sleep(0.1)
    else:
        os.killpg(process.pid, signal.SIGKILL)


@pytest.fixture(scope="session")
def soffice(tmp_path_factory: pytest.TempPathFactory) -> Soffice:
    """LibreOffice: `soffice.convert(path, to="xlsx" | "pdf", outdir)`, `soffice.pages(path)`."""
    program = find_soffice()
    if program is None:
        pytest.skip(REQUIREMENTS["needs_libreoffice"][1])
    return Soffice(program, tmp_path_factory.mktemp("soffice"))


@pytest.fixture(scope="session")
def checkout() -> Path:
    """The top folder of the checkout."""
    return Path(__file__).resolve().parent.parent


# --- workbooks calculated once a test run ---------------------------------------------------------
# Their modules are imported when the first test asks for one: collecting tests needs no engine.


@pytest.fixture(scope="session")
def examples(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the paper's two systems: NAME.in.xlsx, NAME.xlsx and NAME.results.json of each."""
    from tests.shared_files import calculate_examples, made_once

    return made_once(tmp_path_factory, "examples", calculate_examples)


@pytest.fixture(scope="session")
def studied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workbook with its results and four studies, of the rows in tests/shared_files.py."""
    from tests.shared_files import calculate_studies, made_once

    return made_once(tmp_path_factory, "studied", calculate_studies) / "train.xlsx"


@pytest.fixture(scope="session")
def derived(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with every file that is derived from the records, made anew."""
    from tests.shared_files import made_once, write_derived

    return made_once(tmp_path_factory, "derived", write_derived)


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reports whose figures are a dot: for tests that read text, as most of the time is drawing."""
    from matplotlib.figure import Figure

    from addin.report.figures import Pictures

    dot = io.BytesIO()
    Figure(figsize=(0.1, 0.1)).savefig(dot, format="png", dpi=10)
    pictures = {"png": dot.getvalue(), "svg": b'<svg xmlns="http://www.w3.org/2000/svg"/>'}
    monkeypatch.setattr(Pictures, "_saved", lambda self, drawing, form: pictures[form])
