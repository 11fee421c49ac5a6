"""Builds the compiled loops: `engine/stepping/kernels/` → one library, and declarations for cffi.

pip and `make` call the hook; `python hatch_build.py` builds in the checkout. The compiler is `$CC`, else cc, clang
or gcc, else the one of the package ziglang (always on Windows). Every compiler gets the same flags: IEEE doubles, no
contraction, nothing of the machine at hand, so that results are equal to the bit.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib.util
import os
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from cffi import FFI
from hatchling.builders.hooks.plugin.interface import BuildHookInterface

KERNELS = Path("engine/stepping/kernels")
HEADER, MODULE = "kernels.h", "_declarations"
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}
FLAGS = ("-O3", "-std=c11", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared")
ZIG = (sys.executable, "-m", "ziglang", "cc")
#: In the header: a struct, and the names of its arrays with the comment, in which shapes stand in brackets.
STRUCT = re.compile(r"typedef struct \{(.*?)\} (\w+);", re.DOTALL)
ARRAYS = re.compile(
    r"^ +((?:const )?(?:double|int64_t)) ((?:\*\w+(?:, )?)+);\s*/\*(.*)", re.MULTILINE
)
SHAPE = re.compile(r"\((\w[\w +]*(?:[,;] ?\w[\w +]*)*|…[^()]*)\)")
#: Names a wheel for another system (`make wheels`): its tag, the target of ziglang, how a library ends there.
TARGET = "TORSIONBOOK_TARGET"
TARGETS = {
    "manylinux_2_17_x86_64": ("x86_64-linux-gnu.2.17", ".so"),
    "manylinux_2_17_aarch64": ("aarch64-linux-gnu.2.17", ".so"),
    "musllinux_1_2_x86_64": ("x86_64-linux-musl", ".so"),
    "musllinux_1_2_aarch64": ("aarch64-linux-musl", ".so"),
    "macosx_11_0_arm64": ("aarch64-macos.11.0", ".dylib"),
    "macosx_11_0_x86_64": ("x86_64-macos.11.0", ".dylib"),
    "win_amd64": ("x86_64-windows-gnu", ".dll"),
}
NO_COMPILER = (
    "torsionbook is built from source here and found no C compiler. Install one (Debian and Ubuntu: apt-get install "
    "gcc; macOS: xcode-select --install), name one in CC, or: pip install ziglang. A wheel needs none."
)


def compiler() -> tuple[str, ...] | None:
    """Words of the command that compiles; None if there is none."""
    if os.environ.get("CC"):
        return tuple(shlex.split(os.environ["CC"]))
    found = None if sys.platform == "win32" else _on_path()
    if found is None and importlib.util.find_spec("ziglang"):
        return ZIG
    return found


def _on_path() -> tuple[str, ...] | None:
    for name in ("cc", "clang", "gcc"):
        if shutil.which(name):
            return (name,)
    return None


def sources_digest(folder: Path) -> str:
    """Digest of the C sources and of this file, line ends as on Linux."""
    digest = hashlib.sha256()
    for path in (*sorted(folder.glob("*.[ch]")), Path(__file__)):
        digest.update(path.name.encode() + path.read_bytes().replace(b"\r\n", b"\n"))
    return digest.hexdigest()[:16]


def described_arrays(header: str) -> tuple[dict[str, dict[str, tuple[str, ...]]], set[str]]:
    """Of each struct the shapes of its arrays, as the comments beside them say; and the arrays that have to be finite."""
    shapes: dict[str, dict[str, tuple[str, ...]]] = {}
    finite = set()
    for body, struct in STRUCT.findall(header):
        shapes[struct] = {}
        for kind, names, comment in ARRAYS.findall(body):
            fields = re.findall(r"\w+", names)
            stated = [tuple(re.split(r"[,;] ?", one)) for one in SHAPE.findall(comment)]
            each = stated if len(stated) == len(fields) else stated[:1] * len(fields)
            pairs = zip(fields, each, strict=False)
            shapes[struct] |= {field: dims for field, dims in pairs if dims[0] != "…"}
            if kind == "const double" and not re.search("infinite|nan", comment):
                finite |= {f"{struct}.{field}" for field in fields}
    return shapes, finite


def declarations(made: Path) -> None:
    """Writes what `library.py` reads, from the header: declarations for cffi, and shapes of arrays."""
    header = (made.parent / HEADER).read_text(encoding="utf-8")
    ffi = FFI()
    ffi.cdef("\n".join(line for line in header.splitlines() if not line.startswith("#")))
    ffi.set_source(MODULE, None)
    partial = _partial(made)
    with contextlib.redirect_stdout(None):
        ffi.emit_python_code(str(partial))
    with partial.open("a", encoding="utf-8") as file:
        shapes, finite = described_arrays(header)
        file.write(
            f"\nshapes: dict[str, dict[str, tuple[str, ...]]] = {shapes!r}\nfinite: frozenset[str] = frozenset({sorted(finite)!r})\n"
        )
    partial.replace(made)
    made.touch()  # make compares its time with those of the sources


def _partial(made: Path) -> Path:
    """A name of this process: several may build the same file."""
    return made.with_suffix(f".{os.getpid()}.part")


def build(root: Path) -> list[Path]:
    """Compiles the library for this machine unless it is there from the same sources; the files that were made.

    Raises `SystemExit` with what to do where there is no compiler or it fails.
    """
    folder = root / KERNELS
    made, described = folder / f"_loops{SUFFIX.get(sys.platform, '.so')}", folder / f"{MODULE}.py"
    sources = sources_digest(folder)
    if is_built(made, described, sources) and not os.environ.get("CC"):
        return [made, described]
    command = compiler()
    if command is None:
        raise SystemExit(NO_COMPILER)
    declarations(described)
    compile_into(made, folder, command, sources)
    return [made, described]


def is_built(made: Path, described: Path, sources: str) -> bool:
    """Whether a library and its description are there, of these sources."""
    there = described.exists() and made.exists()
    return there and f"sources {sources}".encode() in made.read_bytes()


def build_for(root: Path, tag: str) -> list[Path]:
    """Compiles the library for another system into `build/` unless it is there; the files that were made."""
    target, suffix = TARGETS[tag]
    folder = root / KERNELS
    place = root / "build" / "loops" / tag
    place.mkdir(parents=True, exist_ok=True)
    made, described = place / f"_loops{suffix}", folder / f"{MODULE}.py"
    sources = sources_digest(folder)
    if not is_built(made, described, sources):
        declarations(described)
        compile_into(made, folder, (*ZIG, "-target", target, "-s"), sources)
    return [made, described]


def compile_into(made: Path, folder: Path, command: tuple[str, ...], sources: str) -> None:
    """Compiles the sources of a folder."""
    partial = _partial(made)
    words = [
        *command, *FLAGS, f'-DSOURCES="{sources}"', "-o", str(partial),
        *map(str, sorted(folder.glob("*.c"))), "-lm",
    ]  # fmt: skip
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False)
    except OSError as wrong:
        raise SystemExit(
            f"The C compiler {command[0]} cannot be run: {wrong}. {NO_COMPILER}"
        ) from None
    if done.returncode:
        raise SystemExit(f"The C compiler failed: {shlex.join(words)}\n{done.stderr}")
    partial.replace(made)


class KernelHook(BuildHookInterface[Any]):
    """Compiles before a wheel or an editable install is made."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """A compiler from the package index where there is none."""
        return [] if compiler() else ["ziglang"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build, and say what the wheel is for."""
        root, system = Path(self.root), os.environ.get(TARGET, "")
        made = build_for(root, system) if system else build(root)
        inside = {str(p): f"{KERNELS.as_posix()}/{p.name}" for p in made}
        if version == "standard":
            build_data["force_include"] |= inside
        system = system or sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{system}"


if __name__ == "__main__":
    for path in build(Path(__file__).resolve().parent):
        print(path)
