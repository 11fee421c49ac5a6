"""Settings of `torsionbook serve` from flags, the environment and a file.

A flag goes before the environment, the environment before the file, the file before the default. A
refusal names a setting as it was typed: ``--port``, ``TORSIONBOOK_PORT`` or ``port in server.toml``.
"""

from __future__ import annotations

import difflib
import ipaddress
import math
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from addin.server.dev_certificate import dev_certificate, folder_of
from addin.server.logs import FORMATS
from addin.server.settings import (
    Limits,
    Network,
    Settings,
    SettingsError,
    flag_of,
    read_keys,
    read_secret,
)

#: Before the names of settings and limits in the environment, and the table of limits in the file.
PREFIX, LIMIT_PREFIX, LIMITS = "TORSIONBOOK_", "TORSIONBOOK_LIMIT_", "limits"


@dataclass(frozen=True)
class Typed:
    """A setting where it was typed."""

    value: Any  #: As typed: text of the environment, or a value of TOML or of a flag.
    place: str  #: How it is called there. [words]
    folder: Path  #: What a path is relative to.


def _text(typed: Typed) -> str:
    if not isinstance(typed.value, str):
        raise SettingsError(f"{typed.place} is {typed.value}; write a text in quotation marks.")
    return typed.value


def _path(typed: Typed) -> Path:
    return typed.folder / Path(_text(typed)).expanduser()


def _converted(typed: Typed, kind: Callable[[str], Any]) -> Any:
    """Text as a number, where it is one; anything else as it is."""
    try:
        return kind(typed.value) if isinstance(typed.value, str) else typed.value
    except ValueError:
        return typed.value


def _whole(typed: Typed) -> int:
    value = _converted(typed, int)
    if not isinstance(value, int) or isinstance(value, bool):
        raise SettingsError(f"{typed.place} is '{typed.value}'; write a whole number.")
    return value


def _number(typed: Typed) -> float:
    value = _converted(typed, float)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise SettingsError(f"{typed.place} is '{typed.value}'; write a number.")
    return float(value)


def _flag(typed: Typed) -> bool:
    words = {"true": True, "1": True, "yes": True, "false": False, "0": False, "no": False}
    value = words.get(str(typed.value).casefold())
    if value is None:
        raise SettingsError(f"{typed.place} is '{typed.value}'; write true or false.")
    return value


def _networks(typed: Typed) -> tuple[Network, ...]:
    names = typed.value
    if isinstance(names, str):
        names = [name.strip() for name in names.split(",")]
    try:
        return tuple(ipaddress.ip_network(name) for name in names)
    except (TypeError, ValueError):
        raise SettingsError(
            f"{typed.place} is '{typed.value}'; write addresses or networks, such as 10.0.0.5 or "
            "10.0.0.0/24, separated by commas."
        ) from None


def _log_format(typed: Typed) -> str:
    if typed.value not in FORMATS:
        raise SettingsError(f"{typed.place} is '{typed.value}'; write {' or '.join(FORMATS)}.")
    return str(typed.value)


#: Every setting by its name in the file: how it is read. As a flag it has dashes, in the environment
#: capitals behind `PREFIX`.
OPTIONS: dict[str, Callable[[Typed], Any]] = {
    "host": _text,
    "port": _whole,
    "cert": _path,
    "key": _path,
    "dev_cert": _flag,
    "api_key_file": _path,
    "public_url": _text,
    "trusted_proxies": _networks,
    "shared": _text,
    "shared_key_file": _path,
    "shared_time": _number,
    "workers": _whole,
    "drain": _number,
    "grace": _number,
    "log_format": _log_format,
    "log_requests": _flag,
}
#: Names of the settings that are called otherwise inside.
_INSIDE = {
    "cert": "certificate",
    "key": "certificate_key",
    "api_key_file": "keys",
    "shared_key_file": "shared_key",
}
_LIMITS = {field.name: type(field.default) for field in fields(Limits)}


def configured(
    flags: Mapping[str, Any], environment: Mapping[str, str], limits: Sequence[str] = ()
) -> Settings:
    """The settings of a server.

    Parameters
    ----------
    flags : mapping
        Value of each flag by the name of its setting, and of ``config``; None where it was not given.
    environment : mapping of str to str
        Variables; those of other names and blank ones are not looked at.
    limits : sequence of str
        Limits given as flags, each ``NAME=VALUE``.

    Returns
    -------
    Settings
        What is served with.

    Raises
    ------
    SettingsError
        If something cannot be read or served with; the sentence names where it was typed.
    """
    _refuse_misspelt(environment)
    file = flags.get("config") or environment.get(f"{PREFIX}CONFIG")
    typed: dict[str, Typed] = {}
    typed_limits: dict[str, Typed] = {}
    if file:
        typed, typed_limits = _of_file(Path(file).expanduser())
    here = Path()
    for name in OPTIONS:
        if value := environment.get(PREFIX + name.upper()):
            typed[name] = Typed(value, PREFIX + name.upper(), here)
        if flags.get(name) is not None:
            typed[name] = Typed(flags[name], flag_of(name), here)
    for name in _LIMITS:
        if value := environment.get(LIMIT_PREFIX + name.upper()):
            typed_limits[name] = Typed(value, LIMIT_PREFIX + name.upper(), here)
    for name, value in map(_limit_of_flag, limits):
        typed_limits[name] = Typed(value, f"--limit {name}", here)
    values = {name: OPTIONS[name](given) for name, given in typed.items()}
    for name, read in (("api_key_file", read_keys), ("shared_key_file", read_secret)):
        if name in values:
            values[name] = read(values[name], typed[name].place)
    if values.pop("dev_cert", False):
        if "cert" in values or "key" in values:
            raise SettingsError(
                f"{typed['dev_cert'].place} makes a certificate; leave cert and key out, or it."
            )
        values["cert"], values["key"] = dev_certificate(folder_of(environment))
        values["is_dev"] = True
    return Settings(
        **{_INSIDE.get(name, name): value for name, value in values.items()},
        limits=Limits(**dict(_read_limits(typed_limits))),
        places={_INSIDE.get(name, name): given.place for name, given in typed.items()},
    )


def _read_limits(typed: Mapping[str, Typed]) -> Iterator[tuple[str, Any]]:
    for name, given in typed.items():
        value = _whole(given) if _LIMITS[name] is int else _number(given)
        if value <= 0:
            raise SettingsError(f"{given.place} is {value}; it must be above 0.")
        yield name, value


def _limit_of_flag(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise SettingsError(f"--limit {text} has no value. Write --limit body=50000000.")
    if name not in _LIMITS:
        raise SettingsError(f"--limit {name}: unknown limit.{_meant(name, _LIMITS)}")
    return name, value


def _of_file(path: Path) -> tuple[dict[str, Typed], dict[str, Typed]]:
    """Settings and limits of a file."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as wrong:
        raise SettingsError(f"{path} cannot be read: {wrong.strerror}. Check the path.") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as wrong:
        raise SettingsError(f"{path} is no TOML: {wrong}.") from None
    limits = content.pop(LIMITS, {})
    if not isinstance(limits, dict):
        raise SettingsError(f"{path}: write the limits as a table, below [{LIMITS}].")
    for table, known, words in ((content, OPTIONS, ""), (limits, _LIMITS, f" in [{LIMITS}]")):
        for name in table:
            if name not in known:
                raise SettingsError(
                    f"{path}: unknown setting '{name}'{words}.{_meant(name, known)}"
                )
    folder = path.parent
    return (
        {name: Typed(value, f"{name} in {path}", folder) for name, value in content.items()},
        {
            name: Typed(value, f"{LIMITS}.{name} in {path}", folder)
            for name, value in limits.items()
        },
    )


def _refuse_misspelt(environment: Mapping[str, str]) -> None:
    """Refuse variables that are almost, but not, ours; others may be of other programs."""
    known = ["CONFIG", *map(str.upper, OPTIONS), *(f"LIMIT_{name.upper()}" for name in _LIMITS)]
    for name in environment:
        last = name.removeprefix(PREFIX)
        if last == name or last in known:
            continue
        if last.startswith("LIMIT_") or difflib.get_close_matches(last, known, 1, 0.7):
            raise SettingsError(f"{name} is no setting.{_meant(last, known, PREFIX)}")


def _meant(name: str, known: Mapping[str, Any] | Sequence[str], prefix: str = "") -> str:
    """What was perhaps meant, or what there is."""
    close = difflib.get_close_matches(name, list(known), 1, 0.5)
    return f" Is {prefix}{close[0]} meant?" if close else f" There are {', '.join(known)}."
