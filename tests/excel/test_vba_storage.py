"""Compression and container of VBA projects, against oletools and olefile."""

import io
import os
import random

import olefile
import pytest
from hypothesis import given
from hypothesis import strategies as st
from olevba_reader import decompress_stream
from strategies import example_count

from addin.excel.compound_file import Storage, read_compound_file, write_compound_file
from addin.excel.errors import CompoundFileError, VbaCompressionError
from addin.excel.ovba import compress, decompress

FEW = example_count(60)
TEXTS = st.one_of(
    st.binary(max_size=300),
    st.text(alphabet="abc \r\n\tEndFunction()", max_size=9000).map(str.encode),
    st.tuples(st.binary(min_size=1, max_size=40), st.integers(1, 400)).map(lambda p: p[0] * p[1]),
)

# --- compression ----------------------------------------------------------------------------------


@FEW
@given(TEXTS)
def test_what_is_compressed_comes_back(data):
    assert decompress(compress(data)) == data


@FEW
@given(TEXTS.filter(bool))
def test_oletools_reads_what_is_compressed(data):
    assert bytes(decompress_stream(bytearray(compress(data)))) == data


@pytest.mark.parametrize("size", [1, 15, 16, 17, 4095, 4096, 4097, 8192, 3 * 4096 + 1])
@pytest.mark.parametrize("kind", ["zeros", "text", "counting"])
def test_sizes_about_the_limits_of_a_chunk(size, kind):
    data = {
        "zeros": bytes(size),
        "text": (b"Public Sub Recalculate()\r\n" * size)[:size],
        "counting": bytes(i * i % 251 for i in range(size)),
    }[kind]
    packed = compress(data)
    assert decompress(packed) == bytes(decompress_stream(bytearray(packed))) == data


def test_a_full_chunk_of_random_bytes_is_stored_raw():
    data = random.Random(1).randbytes(4096)
    packed = compress(data)
    assert len(packed) == 1 + 2 + 4096
    assert decompress(packed) == bytes(decompress_stream(bytearray(packed))) == data


def test_what_the_format_cannot_hold_is_named():
    with pytest.raises(VbaCompressionError, match="The last 4000 bytes cannot be compressed"):
        compress(random.Random(2).randbytes(4000))


def test_the_example_of_the_specification():
    """[MS-OVBA] 3.2.2 and 3.2.3: a text without repetition and one with, byte for byte."""
    plain = bytes.fromhex(
        "01 19 B0 00 61 62 63 64 65 66 67 68 00 69 6A 6B 6C 6D 6E 6F 70 00 71 72 73 74 75 76 2E"
    )
    assert decompress(plain) == b"abcdefghijklmnopqrstuv."
    assert compress(b"abcdefghijklmnopqrstuv.") == plain
    repeated = bytes.fromhex(
        "01 2F B0 00 23 61 61 61 62 63 64 65 82 66 00 70 61 67 68 69 6A 01 38 08 61 6B 6C 00 30 6D"
        "6E 6F 70 06 71 02 70 04 10 72 73 74 75 76 10 77 78 79 7A 00 3C"
    )
    assert decompress(repeated) == b"#aaabcdefaaaaghijaaaaaklaaamnopqaaaaaaaaaaaarstuvwxyzaaa"


@pytest.mark.parametrize(
    "data",
    [b"", b"\x02", b"\x01\x00", b"\x01\x00\x00", b"\x01\xff\xbf\x00", b"\x01\x03\xb0\x01\xff\xff"],
)
def test_damaged_sources_are_named(data):
    with pytest.raises(VbaCompressionError):
        decompress(data)


@FEW
@given(st.binary(max_size=200))
def test_no_bytes_break_the_decompressor(data):
    try:
        decompress(b"\x01" + data)
    except VbaCompressionError:
        pass


# --- the container --------------------------------------------------------------------------------

NAMES = st.text(alphabet="abcXYZ_019 ", min_size=1, max_size=31).filter(lambda n: n.strip() == n)
SIZES = st.one_of(st.integers(0, 200), st.sampled_from([63, 64, 65, 4095, 4096, 4097, 9000]))
STREAMS = st.tuples(SIZES, st.integers(0, 255)).map(lambda p: bytes([p[1]]) * p[0])
FOLDED = {"unique_by": lambda pair: pair[0].upper()}
FLAT = st.lists(st.tuples(NAMES, STREAMS), max_size=20, **FOLDED).map(dict)
TREES = st.lists(
    st.tuples(NAMES, st.one_of(STREAMS, FLAT.map(lambda d: Storage(dict(d), os.urandom(16))))),
    max_size=8,
    **FOLDED,
).map(lambda pairs: Storage(dict(pairs)))


@FEW
@given(TREES)
def test_what_is_written_reads_back_here_and_in_olefile(tree):
    data = write_compound_file(tree)
    assert read_compound_file(data) == tree
    assert write_compound_file(read_compound_file(data)) == data
    with olefile.OleFileIO(io.BytesIO(data)) as ole:
        assert ole.parsing_issues == []
        for path in ole.listdir():
            assert ole.openstream(path).read() == tree.stream(*path)
        count = sum(len(v.entries) if isinstance(v, Storage) else 1 for v in tree.entries.values())
        assert len(ole.listdir(streams=True)) == count


def test_every_tree_is_a_red_black_one():
    """Each way down has as many black entries, and no red entry has a red one above it."""
    for count in range(1, 40):
        data = write_compound_file(Storage({f"n{i}": b"" for i in range(count)}))
        with olefile.OleFileIO(io.BytesIO(data)) as ole:
            entries = {e.sid: e for e in ole.direntries if e is not None}
            no_stream = 0xFFFFFFFF

            def black_height(sid, above_red, entries=entries, none=no_stream):
                if sid == none:
                    return 1
                entry = entries[sid]
                red = entry.color == 0
                assert not (red and above_red)
                left, right = (black_height(s, red) for s in (entry.sid_left, entry.sid_right))
                assert left == right
                return left + (not red)

            black_height(ole.root.sid_child, True)


def test_the_tree_is_in_the_order_that_programs_search_by():
    """Length, then capitals: `_` comes behind Z, lower case counts as upper ([MS-CFB] 2.6.4)."""
    ordered = ["b", "dir", "modABC", "Module", "MODUM1", "zebra1", "_a____", "__SRP_0"]
    shuffled = random.Random(3).sample(ordered, len(ordered))
    data = write_compound_file(Storage(dict.fromkeys(shuffled, b"")))
    with olefile.OleFileIO(io.BytesIO(data)) as ole:
        entries = {e.sid: e for e in ole.direntries if e is not None}

        def in_order(sid, none=0xFFFFFFFF):
            if sid == none:
                return []
            entry = entries[sid]
            return [*in_order(entry.sid_left), entry.name, *in_order(entry.sid_right)]

        assert in_order(ole.root.sid_child) == ordered


def test_a_missing_stream_is_named():
    with pytest.raises(CompoundFileError, match="no stream VBA/dir"):
        Storage({"VBA": Storage()}).stream("VBA", "dir")


@pytest.mark.parametrize("cut", [0, 8, 100, 511, 512, 600, 1024, 2000])
def test_a_file_cut_off_is_named(cut):
    whole = write_compound_file(Storage({"PROJECT": b"x" * 5000, "VBA": Storage({"dir": b"y"})}))
    with pytest.raises(CompoundFileError):
        read_compound_file(whole[:cut])


@FEW
@given(st.integers(0, 2**32 - 1), st.integers(1, 30))
def test_no_damage_breaks_the_reader(seed, count):
    """Any bytes changed: it reads something or says that it is damaged, in bounded time."""
    chance = random.Random(seed)
    data = bytearray(
        write_compound_file(Storage({"PROJECT": b"x" * 5000, "VBA": Storage({"dir": b"y" * 99})}))
    )
    for _ in range(count):
        data[chance.randrange(len(data))] = chance.randrange(256)
    try:
        read_compound_file(bytes(data))
    except CompoundFileError:
        pass
