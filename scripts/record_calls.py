"""Records the calls that starts make of the compiled loops: `python scripts/record_calls.py FOLDER [EVERY]`.

With EVERY only every so many of the random starts and of the published cases are calculated, and of the calls of one
function those beyond the first 200 are noted so seldom.

A call is words of 64 bits: its arguments, and the structs and arrays that they point to. `replay_calls.c` makes the same
calls of the library of another system, without Python (`other_systems.py`). The folder gets

    recording    the calls
    calls.h      C that makes a call from its words
    expected     a line a call, as the driver is to print it: the function, and a digest of what it left
"""

from __future__ import annotations

import hashlib
import struct
import sys
from array import array
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT))

from engine.stepping import library as loaded  # noqa: E402

ffi, real = loaded.ffi, loaded.library
#: Functions of the library; the driver knows them by their place here. (`about` differs between systems.)
FUNCTIONS = [n for n in dir(real) if n != "about" and isinstance(getattr(real, n), ffi.CData)]
#: Called by tests only; the loops have the same steps inside.
ONLY_IN_TESTS = {"exponential_step", "first_fall", "newmark_step", "start_forces"}
#: Words of a page. Equal pages are kept once, which leaves a sixth: most of what is passed is passed again.
PAGE = 512
#: Calls of one function that are noted whatever the sample.
ALWAYS = 200
#: What an operation makes of no number: the sign is set by x86, not by ARM. It means nothing.
NAN, NEGATIVE_NAN = np.array([0x7FF8000000000000, 0xFFF8000000000000], dtype=np.uint64)
#: SplitMix64 spreads each bit over a word: Steele, Lea & Flood, "Fast splittable pseudorandom number generators",
#: OOPSLA 2014.
SPLIT_MIX = ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB), (31, 1))

Words = NDArray[np.uint64]


class Memory:
    """What one call can reach, as blocks of words: its result and its arguments, then structs and arrays."""

    def __init__(self, function: Any, arguments: tuple[Any, ...]) -> None:
        kinds = ffi.typeof(function).args
        self.call = np.zeros(1 + len(arguments), dtype=np.uint64)
        self.blocks: list[Words] = [self.call]
        self._pointers: list[
            tuple[int, int, int]
        ] = []  # block and word of each; block it points to
        self._numbers: dict[tuple[int, int], int] = {}
        for place, (kind, value) in enumerate(zip(kinds, arguments, strict=True), 1):
            if kind.kind == "primitive":
                self.call[place] = word(kind, value)
            elif value != ffi.NULL:
                self._pointers.append((0, place, self._block(value)))

    def _block(self, target: Any) -> int:
        """Number of the block of an array, or of a struct, which those of its arrays follow."""
        kind = ffi.typeof(target)
        size = len(target) * 8 if kind.kind == "array" else ffi.sizeof(kind.item)
        key = _address(target), size
        if key not in self._numbers:
            self._numbers[key] = number = len(self.blocks)
            self.blocks.append(np.frombuffer(ffi.buffer(target, size), dtype=np.uint64))
            if kind.kind == "pointer" and kind.item.kind == "struct":
                self._fields(number, target[0], 0, {_address(a): a for a in _arrays(target)})
        return self._numbers[key]

    def _fields(self, block: int, values: Any, offset: int, arrays: dict[int, Any]) -> None:
        for name, field in ffi.typeof(values).fields:
            value, place = getattr(values, name), offset + field.offset // 8
            if field.type.kind == "struct":
                self._fields(block, value, place, arrays)
            elif field.type.kind == "pointer" and value != ffi.NULL:
                self._pointers.append((block, place, self._block(arrays[_address(value)])))

    def pointers(self) -> list[tuple[int, int]]:
        """Place of each pointer among all words, and the place it points to."""
        starts = np.cumsum([0, *map(len, self.blocks)]).tolist()
        return [(starts[block] + place, starts[to]) for block, place, to in self._pointers]

    def words(self) -> Words:
        """All words, one block after the other; zero where a pointer stands."""
        every = np.concatenate(self.blocks)
        every[[place for place, _ in self.pointers()]] = 0
        return every


def word(kind: Any, value: Any) -> int:
    """The 64 bits of a number of a C type."""
    bits = struct.pack("<d" if kind.cname == "double" else "<q", value)
    return int.from_bytes(bits, "little")


def _address(pointer: Any) -> int:
    return int(ffi.cast("intptr_t", pointer))


def _arrays(target: Any) -> list[Any]:
    """Arrays of a struct and of those in it."""
    arrays = []
    for kept in loaded._kept[target]:
        arrays += [kept] if ffi.typeof(kept).kind == "array" else _arrays(kept)
    return arrays


def digest(before: Words, after: Words) -> int:
    """Of the words that a call changed and of their places."""
    before, after = (np.where(w == NEGATIVE_NAN, NAN, w) for w in (before, after))
    at = np.flatnonzero(before != after)
    places = _spread(at.astype(np.uint64) + np.uint64(1))  # nought would stay nought
    return int(np.sum(_spread(places + after[at])))


def _spread(words: Words) -> Words:
    for shift, factor in SPLIT_MIX:
        words = (words ^ (words >> np.uint64(shift))) * np.uint64(factor)
    return words


class Recorder:
    """The library, which notes each call."""

    def __init__(self, every: int = 1) -> None:
        self.expected: list[str] = []
        self._every = every
        self._made: Counter[str] = Counter()  # calls of each function
        self._calls = array("q")
        self._pages: list[bytes] = []
        self._places: dict[bytes, int] = {}  # word at which a page begins, by its digest
        self._size = 0

    def __getattr__(self, name: str) -> Any:
        return partial(self._call, name) if name in FUNCTIONS else getattr(real, name)

    def _call(self, name: str, *arguments: Any) -> Any:
        function = getattr(real, name)
        self._made[name] += 1
        if self._made[name] > ALWAYS and self._made[name] % self._every:
            return function(*arguments)
        memory = Memory(function, arguments)
        before, pointers = memory.words(), memory.pointers()
        self._calls.extend((FUNCTIONS.index(name), len(before), len(pointers)))
        for i in range(0, len(before), PAGE):
            self._calls.append(self._place(before[i : i + PAGE].tobytes()))
        for pointer in pointers:
            self._calls.extend(pointer)
        result = function(*arguments)
        if result is not None:
            memory.call[0] = word(ffi.typeof(function).result, result)
        self.expected.append(f"{name} {digest(before, memory.words()):016x}")
        return result

    def _place(self, page: bytes) -> int:
        key = hashlib.blake2b(page).digest()
        if key not in self._places:
            self._places[key] = self._size
            self._pages.append(page)
            self._size += len(page) // 8
        return self._places[key]

    def write(self, folder: Path) -> None:
        """The three files."""
        with open(folder / "recording", "wb") as file:
            file.write(struct.pack("<2q", len(self._calls), self._size) + self._calls.tobytes())
            file.writelines(self._pages)
        (folder / "calls.h").write_text(driver_code(), encoding="utf-8")
        (folder / "expected").write_text("\n".join(self.expected) + "\n", encoding="utf-8")


def driver_code() -> str:
    """C that calls a function by its number, with arguments from words."""
    names = ", ".join(f'"{name}"' for name in FUNCTIONS)
    lines = [f"enum {{ PAGE = {PAGE} }};", f"static const char *const names[] = {{{names}}};"]
    lines += ["static void make_call(int64_t function, word_t *word)"]
    lines += ["{", "    switch (function) {"]
    member = {"int64_t": "i", "double": "d"}
    for number, name in enumerate(FUNCTIONS):
        kind = ffi.typeof(getattr(real, name))
        members = [member.get(argument.cname, "p") for argument in kind.args]
        words = ", ".join(f"word[{i}].{m}" for i, m in enumerate(members, 1))
        result = f"word[0].{member[kind.result.cname]} = " if kind.result.kind != "void" else ""
        lines.append(f"    case {number}: {result}FUNCTION({name})({words}); break;")
    return "\n".join([*lines, "    }", "}", ""])


def record(every: int = 1) -> Recorder:
    """Calls of random starts, of the published cases, of a study, of a motor and of the modes of a long chain.

    Of the first two every so many.
    """
    loaded.library = recorder = Recorder(every)
    # What a call leaves unwritten is then the same each time.
    np.empty, np.empty_like = np.zeros, np.zeros_like

    import compare_cases
    from results_digest import calculated
    from same_bits import TRAINS

    from addin.reading.workbook import read_workbook
    from benchmarks.study_trains import study_train
    from engine.numerics.singular_values import LARGE, singular_triplets
    from engine.run import run

    for number in TRAINS[::every]:
        run(study_train(number).case)
    published = list(compare_cases.published_cases(ROOT / "tests" / "validation" / "cases"))
    for _, case in published[::every]:
        calculated(case, ["recalc"])
    calculated(compare_cases.random_case("studies", 2), ["sensitivities", "--jobs", "1"])
    # the motor in time; its other event would repeat calls of starts
    motor = read_workbook(ROOT / "templates" / "example_motor.xlsx").case()
    run(replace(motor, event_torque=()))
    links = np.eye(LARGE - 1, LARGE, 1) - np.eye(LARGE - 1, LARGE)
    singular_triplets(np.ones((1, LARGE - 1)), links, np.ones((1, LARGE)), LARGE - 1)

    check_all_are_called(recorder.expected)
    return recorder


def check_all_are_called(lines: Iterable[str]) -> None:
    """Raises `SystemExit` unless every function of the library stands in the lines of the calls."""
    missing = set(FUNCTIONS) - {line.split()[0] for line in lines} - ONLY_IN_TESTS
    if missing:
        raise SystemExit(f"Nothing that is recorded calls {', '.join(sorted(missing))}.")


if __name__ == "__main__":
    record(*map(int, sys.argv[2:])).write(Path(sys.argv[1]))
