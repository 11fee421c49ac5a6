"""What is locked, what is shipped, and under which licences."""

import os
import re
import subprocess
import sys
import tomllib
import venv
import zipfile
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
LOCKS = sorted((ROOT / "requirements").glob("*.txt"))


def locked(path: Path) -> dict[str, tuple[Requirement, int]]:
    """Name → requirement and number of hashes of a lock file."""
    text = path.read_text(encoding="utf-8").replace("\\\n", " ")
    found: dict[str, tuple[Requirement, int]] = {}
    for line in text.splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            words = line.split(" --hash=")
            requirement = Requirement(words[0].strip())
            name = canonicalize_name(requirement.name)
            assert name not in found, f"{name} is locked twice in {path.name}"
            found[name] = requirement, len(words) - 1
    return found


def dependencies(*lists: list[str]) -> list[Requirement]:
    return [Requirement(text) for texts in lists for text in texts]


# --- the lock files -------------------------------------------------------------------------------


def test_the_lock_files_are_there():
    assert [p.name for p in LOCKS] == [
        "build.txt", "cluster.txt", "dev.txt", "excel.txt", "lock.txt", "mcp.txt", "parquet.txt", "python.txt",
        "report.txt", "run.txt", "server.txt", "shared.txt",
    ]  # fmt: skip


@pytest.mark.parametrize("path", LOCKS, ids=lambda p: p.name)
def test_every_line_is_pinned_and_hashed(path):
    for requirement, hashes in locked(path).values():
        assert re.fullmatch(r"==[\w.]+", str(requirement.specifier)), str(requirement)
        assert hashes > 0, str(requirement)


@pytest.mark.parametrize("path", LOCKS, ids=lambda p: p.name)
def test_no_index_address(path):
    assert not re.search(
        r"(?m)^\s*-|://", path.read_text(encoding="utf-8").replace("    --hash", "")
    )


def test_compiled_packages_are_hashed_for_every_python_and_system():
    """Three Pythons on Linux, Windows and macOS are nine wheels at least."""
    run = locked(ROOT / "requirements" / "run.txt")
    for name in ("numpy", "scipy", "cffi", "lxml"):
        assert run[name][1] >= 9, name


@pytest.mark.parametrize(
    ("lock", "wanted"),
    [
        (
            "run.txt",
            dependencies(PROJECT["project"]["dependencies"], PROJECT["build-system"]["requires"]),
        ),
        ("parquet.txt", dependencies(PROJECT["project"]["optional-dependencies"]["parquet"])),
        ("excel.txt", dependencies(PROJECT["project"]["optional-dependencies"]["excel"])),
        ("server.txt", dependencies(PROJECT["project"]["optional-dependencies"]["server"])),
        ("shared.txt", dependencies(PROJECT["project"]["optional-dependencies"]["shared"])),
        ("mcp.txt", dependencies(PROJECT["project"]["optional-dependencies"]["mcp"])),
        ("report.txt", dependencies(PROJECT["project"]["optional-dependencies"]["report"])),
        ("python.txt", dependencies(PROJECT["project"]["optional-dependencies"]["python"])),
        (
            "dev.txt",
            dependencies(
                PROJECT["project"]["dependencies"],
                PROJECT["build-system"]["requires"],
                PROJECT["project"]["optional-dependencies"]["parquet"],
                PROJECT["project"]["optional-dependencies"]["excel"],
                PROJECT["project"]["optional-dependencies"]["server"],
                PROJECT["project"]["optional-dependencies"]["shared"],
                PROJECT["project"]["optional-dependencies"]["mcp"],
                PROJECT["project"]["optional-dependencies"]["report"],
                PROJECT["project"]["optional-dependencies"]["python"],
                PROJECT["dependency-groups"]["dev"],
            ),
        ),
        ("lock.txt", dependencies(PROJECT["dependency-groups"]["lock"])),
    ],
)
def test_the_lock_satisfies_pyproject(lock, wanted):
    pins = locked(ROOT / "requirements" / lock)
    for requirement in wanted:
        pin, _ = pins[canonicalize_name(requirement.name)]
        version = str(pin.specifier).removeprefix("==")
        assert requirement.specifier.contains(version), f"{requirement} against {pin}"
        assert pin.marker is None, f"{pin} must be locked for every system"


def test_dev_is_run_and_more():
    run, dev = (locked(ROOT / "requirements" / name) for name in ("run.txt", "dev.txt"))
    assert {n: str(r.specifier) for n, (r, _) in run.items()}.items() <= {
        n: str(r.specifier) for n, (r, _) in dev.items()
    }.items()


# --- licences -------------------------------------------------------------------------------------

NOT_FOR_US = re.compile(
    r"GPL|GNU (Lesser |Affero )?General|EUPL|PolyForm|SSPL|BUSL|proprietary", re.I
)
# GCC's run-time libraries inside numpy's and scipy's wheels carry the exception that makes them
# free for any use.
HARMLESS = re.compile(r"L?GPL-[\w.]+(-or-later)? WITH GCC-exception-[\d.]+", re.I)


def licence_words(name: str) -> str:
    about = metadata.metadata(name)
    words = [about.get("License-Expression") or ""]
    words += [c for c in about.get_all("Classifier") or [] if c.startswith("License")]
    if not any(words):
        words = [(about.get("License") or "").strip().splitlines()[0:1]]
        words = words[0]
    return " | ".join(w for w in words if w)


@pytest.mark.parametrize(
    "name",
    sorted(
        n
        for n, (r, _) in locked(ROOT / "requirements" / "run.txt").items()
        if r.marker is None or r.marker.evaluate()
    ),
)
def test_licences_of_the_default_install(name):
    words = licence_words(name)
    assert words, f"{name} states no licence in its metadata"
    assert not NOT_FOR_US.search(HARMLESS.sub("", words)), f"{name}: {words}"


def test_every_direct_dependency_is_explained():
    page = (ROOT / "docs" / "development.md").read_text(encoding="utf-8")
    rows = {m[1].lower() for m in re.finditer(r"(?m)^\| ([\w.-]+) \|", page)}
    for requirement in dependencies(
        PROJECT["project"]["dependencies"], *PROJECT["project"]["optional-dependencies"].values()
    ):
        assert requirement.name.lower() in rows, (
            f"{requirement.name} is missing in docs/development.md"
        )


# --- the wheel ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [
            sys.executable,
            "-m",
            "pip",
            "wheel",
            "--quiet",
            "--disable-pip-version-check",
            "--no-deps",
            "--no-build-isolation",
            "--no-index",
            "--wheel-dir",
            str(folder),
            str(ROOT),
        ],
        check=True,
        timeout=300,
    )
    (built,) = folder.glob("torsionbook-*.whl")
    return built


def test_the_wheel_holds_the_packages_and_nothing_else(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    assert {name.split("/")[0] for name in names} == {
        "engine",
        "addin",
        "torsionbook",
        f"torsionbook-{PROJECT['project']['version']}.dist-info",
    }
    packages = ("engine/", "addin/", "torsionbook/")
    shipped = {n for n in names if n.startswith(packages) and not n.startswith("addin/_templates/")}
    ours = {
        path.relative_to(ROOT).as_posix()
        for package in packages
        for path in (ROOT / package).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert shipped == ours
    assert {"engine/py.typed", "torsionbook/py.typed"} <= set(names)
    assert not [n for n in names if "__pycache__" in n or "/test" in n]


def test_the_wheel_holds_the_workbooks_byte_for_byte(wheel):
    templates = sorted((ROOT / "templates").glob("*.xlsx"))
    assert {"example_proposed.xlsx", "example_modified.xlsx"} <= {p.name for p in templates}
    with zipfile.ZipFile(wheel) as archive:
        for path in templates:
            assert archive.read(f"addin/_templates/{path.name}") == path.read_bytes()


def test_the_wheel_states_name_command_licence_and_pythons(wheel):
    with zipfile.ZipFile(wheel) as archive:
        (info,) = {n.split("/")[0] for n in archive.namelist() if ".dist-info/" in n}
        about = archive.read(f"{info}/METADATA").decode()
        commands = archive.read(f"{info}/entry_points.txt").decode()
        assert f"{info}/licenses/LICENSE" in archive.namelist()
    assert re.search(r"(?m)^Name: torsionbook$", about)
    assert re.search(r"(?m)^License-Expression: Apache-2.0$", about)
    assert re.search(r"(?m)^Requires-Python: <3.15,>=3.11$", about)
    assert "torsionbook = addin.cli:main" in commands


def test_the_installed_wheel_finds_its_workbooks(wheel, tmp_path):
    """Outside the checkout; the packages it needs are borrowed from this environment."""
    place = tmp_path / "venv"
    venv.create(place, with_pip=False)
    python = place / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    site = Path(
        subprocess.run(
            [python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout.strip()
    )
    zipfile.ZipFile(wheel).extractall(site)
    script = (
        "import addin, engine, torsionbook; from addin.contract.shipped import template_path\n"
        "print(template_path('example_proposed.xlsx')); print(engine.__file__); print(torsionbook.__file__)"
    )
    clean = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    borrowed = str(Path(metadata.distribution("numpy").locate_file("")))
    said = subprocess.run(
        [python, "-c", f"import sys; sys.path.append({borrowed!r})\n{script}"],
        cwd=tmp_path,
        env=clean,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split("\n")
    assert Path(said[0]) == site / "addin" / "_templates" / "example_proposed.xlsx"
    assert Path(said[1]).is_relative_to(site)
    assert Path(said[2]).is_relative_to(site)


# --- the template finder --------------------------------------------------------------------------


def test_template_path_in_the_checkout():
    from addin.contract.shipped import template_path

    assert template_path("example_modified.xlsx") == ROOT / "templates" / "example_modified.xlsx"


def test_an_unknown_template_is_named_with_those_there_are():
    from addin.contract.shipped import template_path

    with pytest.raises(FileNotFoundError, match=r"'nonsense\.xlsx'.*example_proposed\.xlsx"):
        template_path("nonsense.xlsx")
