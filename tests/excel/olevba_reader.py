"""oletools, the independent reader of VBA projects, without what it warns of on import."""

import warnings
from pathlib import Path

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from oletools.olevba import VBA_Parser, decompress_stream

__all__ = ["decompress_stream", "modules_of"]


def modules_of(path: Path | str, data: bytes | None = None) -> dict[str, str]:
    """Name → source of every module, attributes left out, as olevba shows them."""
    parser = VBA_Parser(str(path), data=data)
    try:
        return {
            name.rpartition(".")[0]: source if isinstance(source, str) else source.decode("cp1252")
            for _, _, name, source in parser.extract_all_macros()
        }
    finally:
        parser.close()
