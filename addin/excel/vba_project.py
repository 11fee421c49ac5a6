"""A VBA project: its modules read, added and taken out, after [MS-OVBA] 2.3.

Modules that are not named stay as they are stored, byte for byte. What Excel compiled before is left
out, as the specification asks of a program that changes sources, and Excel compiles anew: the
stream ``_VBA_PROJECT`` says so, and the streams ``__SRP_*`` go.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field, replace

from addin.excel.compound_file import Storage, read_compound_file, write_compound_file
from addin.excel.errors import ExcelError, VbaProjectError
from addin.excel.ovba import compress, decompress

# Records of the stream ``dir``.
_CODE_PAGE, _VERSION, _COUNT, _COOKIE, _END = 0x03, 0x09, 0x0F, 0x13, 0x10
_NAME, _NAME_UNICODE, _STREAM, _STREAM_UNICODE = 0x19, 0x47, 0x1A, 0x32
_DOC, _DOC_UNICODE, _OFFSET, _HELP, _MODULE_COOKIE = 0x1C, 0x48, 0x31, 0x1E, 0x2C
_STANDARD, _CLASS, _TERMINATOR = 0x21, 0x22, 0x2B

#: ``_VBA_PROJECT`` of a project that holds sources only.
_NOTHING_COMPILED = bytes.fromhex("CC61FFFF000000")
_NO_COOKIE = 0xFFFF
_REPAIR = (
    "Open the workbook in Excel, save it, and run again. If that does not help, move the inputs to a "
    "new workbook: torsionbook new NEW.xlsm --from FILE."
)

Record = tuple[int, bytes]


@dataclass(frozen=True)
class Module:
    """One module of a project."""

    name: str  #: As the VBA editor shows it.
    records: tuple[Record, ...]  #: Its records in the stream ``dir``.
    stream: bytes  #: Its stream: what was compiled, and the compressed source behind it.
    #: Its word in the stream ``PROJECT``: Module, Class, Document or BaseClass (a form).
    kind: str = "Module"

    @property
    def stored_under(self) -> str:
        """Name of its stream."""
        return _utf16(self.records, _STREAM_UNICODE) or self.name

    def source(self, code_page: str = "cp1252") -> str:
        """Its source with line ends as stored."""
        (offset,) = struct.unpack("<I", dict(self.records)[_OFFSET])
        return decompress(self.stream[offset:]).decode(code_page, "replace")


def standard_module(name: str, text: str) -> Module:
    """A module of functions and macros."""
    assert text.startswith(f'Attribute VB_Name = "{name}"\n'), name
    plain, wide = name.encode("ascii"), name.encode("utf-16-le")
    records = (
        (_NAME, plain), (_NAME_UNICODE, wide), (_STREAM, plain), (_STREAM_UNICODE, wide),
        (_DOC, b""), (_DOC_UNICODE, b""), (_OFFSET, bytes(4)), (_HELP, bytes(4)),
        (_MODULE_COOKIE, struct.pack("<H", _NO_COOKIE)), (_STANDARD, b""), (_TERMINATOR, b""),
    )  # fmt: skip
    return Module(name, records, compress(text.replace("\n", "\r\n").encode("ascii")))


@dataclass(frozen=True)
class VbaProject:
    """A project as it is stored."""

    #: Everything in its container but the modules' streams, the list of them and what was
    #: compiled.
    rest: Storage
    head: tuple[Record, ...]  #: Records of the stream ``dir`` before those of the modules.
    modules: tuple[Module, ...]  #: In the order of the stream ``dir``.
    code_page: str  #: Encoding of its texts.
    lines: tuple[str, ...] = field(repr=False)  #: Stream ``PROJECT``.

    @staticmethod
    def read(data: bytes) -> VbaProject:
        """Read ``vbaProject.bin``.

        Raises
        ------
        ExcelError
            If it is damaged; the sentence says what to do.
        """
        try:
            return _read(data)
        except ExcelError as problem:
            raise type(problem)(f"{problem} {_REPAIR}") from problem

    def module(self, name: str) -> Module | None:
        """A module by its name, in any capitals.

        Returns
        -------
        Module or None
            None if there is none.
        """
        return next((m for m in self.modules if m.name.casefold() == name.casefold()), None)

    def source(self, name: str) -> str | None:
        """Source of a module.

        Returns
        -------
        str or None
            None if there is no such module.
        """
        module = self.module(name)
        return None if module is None else module.source(self.code_page)

    def with_modules(self, new: Iterable[Module], without: Collection[str] = ()) -> VbaProject:
        """The project with some modules added or put in the place of those of the same name."""
        gone = {name.casefold() for name in without}
        coming = {module.name.casefold(): module for module in new}
        kept = [m for m in self.modules if m.name.casefold() not in gone]
        modules = [coming.pop(m.name.casefold(), m) for m in kept]
        modules += coming.values()
        names = {m.name.casefold() for m in modules}
        lines = [line for line in self.lines if _listed(line, names, self.modules)]
        return replace(self, modules=tuple(modules), lines=tuple(_with_lines(lines, modules)))

    def to_bytes(self) -> bytes:
        """The part ``vbaProject.bin``."""
        vba = self.rest.entries["VBA"]
        assert isinstance(vba, Storage)
        streams: dict[str, bytes | Storage] = {m.stored_under: m.stream for m in self.modules}
        streams |= {"dir": compress(self._directory()), "_VBA_PROJECT": _NOTHING_COMPILED}
        entries = dict(self.rest.entries)
        entries["VBA"] = Storage(vba.entries | streams, vba.class_id, vba.state)
        entries["PROJECT"] = ("\r\n".join(self.lines) + "\r\n").encode(self.code_page)
        entries["PROJECTwm"] = self._names()
        return write_compound_file(Storage(entries, self.rest.class_id, self.rest.state))

    def _directory(self) -> bytes:
        count = struct.pack("<H", len(self.modules))
        head = [(kind, count if kind == _COUNT else data) for kind, data in self.head]
        records = [*head, *(r for m in self.modules for r in m.records), (_END, b"")]
        return b"".join(
            # The version states four bytes and has six.
            struct.pack("<HI", kind, 4 if kind == _VERSION else len(data)) + data
            for kind, data in records
        )

    def _names(self) -> bytes:
        """Stream ``PROJECTwm``: each name in the code page and in Unicode."""
        pairs = (
            m.name.encode(self.code_page, "replace") + b"\0" + m.name.encode("utf-16-le") + b"\0\0"
            for m in self.modules
        )
        return b"".join(pairs) + b"\0\0"


def _without_modules(root: Storage, streams: Collection[str]) -> Storage:
    """The container without what is written anew."""
    vba = next((n for n in root.entries if n.casefold() == "vba"), "VBA")
    held = root.entries[vba]
    assert isinstance(held, Storage)  # its stream ``dir`` was read
    gone = {*streams, "dir", "_vba_project"}
    kept = {
        name: entry
        for name, entry in held.entries.items()
        if name.casefold() not in gone and not name.casefold().startswith("__srp_")
    }
    entries: dict[str, bytes | Storage] = {
        name: entry
        for name, entry in root.entries.items()
        if name.casefold() not in (vba.casefold(), "project", "projectwm")
    }
    entries["VBA"] = Storage(kept, held.class_id, held.state)
    return Storage(entries, root.class_id, root.state)


def _read(data: bytes) -> VbaProject:
    root = read_compound_file(data)
    records = _records(decompress(root.stream("VBA", "dir")))
    kinds = [kind for kind, _ in records]
    if _CODE_PAGE not in kinds or _COUNT not in kinds:
        raise VbaProjectError("The VBA project has no code page or no list of modules.")
    (number,) = struct.unpack("<H", dict(records)[_CODE_PAGE][:2])
    code_page = "mac_roman" if number == 10000 else f"cp{number}"
    try:
        text = root.stream("PROJECT").decode(code_page)
    except (LookupError, UnicodeDecodeError) as problem:
        raise VbaProjectError(
            f"The VBA project does not match its code page ({problem})."
        ) from None
    lines = tuple(text.rstrip().splitlines())
    start = next((i for i, kind in enumerate(kinds) if kind == _NAME), len(records) - 1)
    modules = tuple(_modules(records[start:-1], root, code_page, lines))
    rest = _without_modules(root, {m.stored_under.casefold() for m in modules})
    return VbaProject(rest, tuple(records[:start]), modules, code_page, lines)


def _records(data: bytes) -> list[Record]:
    records: list[Record] = []
    at = 0
    while at + 6 <= len(data):
        kind, size = struct.unpack_from("<HI", data, at)
        size = 6 if kind == _VERSION else size
        if at + 6 + size > len(data):
            break
        records.append((kind, data[at + 6 : at + 6 + size]))
        at += 6 + size
    if at != len(data) or not records or records[-1][0] != _END:
        raise VbaProjectError("The list of modules of the VBA project is damaged.")
    return records


def _modules(
    records: list[Record], root: Storage, code_page: str, lines: tuple[str, ...]
) -> Iterable[Module]:
    """Modules of the records behind the head."""
    words = {}
    for line in lines:
        kind, _, name = line.partition("=")
        if line.startswith(_KINDS):
            words[name.partition("/")[0].casefold()] = kind
    collected: list[Record] = []
    for record in records:
        collected.append(record)
        if record[0] != _TERMINATOR:
            continue
        held = dict(collected)
        if _NAME not in held or _OFFSET not in held:
            raise VbaProjectError("The list of modules of the VBA project is damaged.")
        name = _utf16(collected, _NAME_UNICODE) or held[_NAME].decode(code_page)
        stored = _utf16(collected, _STREAM_UNICODE) or name
        word = words.get(name.casefold(), "Module")
        yield Module(name, tuple(collected), root.stream("VBA", stored), word)
        collected = []


def _utf16(records: Iterable[Record], kind: int) -> str:
    return dict(records).get(kind, b"").decode("utf-16-le")


#: Beginnings of the lines that list a module.
_KINDS = ("Module=", "Class=", "Document=", "BaseClass=")
_WINDOW = re.compile(r"(?P<name>[^=\[\]&\"]+)=\s*-?\d+, -?\d+, -?\d+, -?\d+,")


def _listed(line: str, names: Collection[str], known: Iterable[Module]) -> bool:
    """Whether a line of ``PROJECT`` stays: those of modules that went do not."""
    if line.startswith(_KINDS):
        return line.partition("=")[2].partition("/")[0].casefold() in names
    window = _WINDOW.match(line)
    gone = {m.name.casefold() for m in known} - set(names)
    return window is None or window["name"].casefold() not in gone


def _with_lines(lines: list[str], modules: Iterable[Module]) -> Iterable[str]:
    """The lines of ``PROJECT`` with one for each module that has none yet."""
    listed = {line.partition("=")[2].partition("/")[0].casefold() for line in lines}
    missing = [m for m in modules if m.name.casefold() not in listed]
    last = max((i for i, line in enumerate(lines) if line.startswith(_KINDS)), default=0)
    for i, line in enumerate(lines):
        yield line
        if i == last:
            yield from (f"{m.kind}={m.name}" for m in missing)
    if missing and "[Workspace]" in lines:
        yield from (f"{m.name}=0, 0, 0, 0, C" for m in missing)
