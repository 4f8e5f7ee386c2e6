"""Run files (MCAP) and the tables of experiments, as dicts and lists; `columns` as numpy arrays where numpy is there."""

import csv
import json
import pathlib
import re
import struct
import zlib

_MAGIC = b"\x89MCAP0\r\n"
_HEADER, _FOOTER, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 0x01, 0x02, 0x04, 0x05, 0x06, 0x0F


class RunFileError(ValueError):
    """A run file that cannot be read on: path, offset and cause."""


def _records(data, offset, end, path):
    while offset < end:
        if end - offset < 9:
            raise RunFileError(f"{path}: ends inside a record at offset {offset}")
        opcode, size = data[offset], struct.unpack_from("<Q", data, offset + 1)[0]
        if size > end - offset - 9:
            raise RunFileError(f"{path}: the record at offset {offset} claims {size} bytes, {end - offset - 9} are left")
        yield opcode, offset + 9, size
        offset += 9 + size


def _text(data, offset, path):
    size = struct.unpack_from("<I", data, offset)[0]
    if size > len(data) - offset - 4:
        raise RunFileError(f"{path}: a text at offset {offset} claims {size} bytes")
    return data[offset + 4:offset + 4 + size].decode("utf-8"), offset + 4 + size


def messages(path, topic=None):
    """The messages of a run file in the order of the file: (topic, time_s, dict). `topic`: only this one.

    A file that was cut off is read to its last whole chunk, then RunFileError says where it ends. RunFileError also for a
    chunk whose checksum is wrong and for anything that is no run file."""
    data = pathlib.Path(path).read_bytes()
    if not data.startswith(_MAGIC):
        raise RunFileError(f"{path}: not an MCAP file")
    topics = {}
    end = len(data) - len(_MAGIC) if data.endswith(_MAGIC) and len(data) >= 2 * len(_MAGIC) else len(data)
    for opcode, offset, size in _records(data, len(_MAGIC), end, path):
        if opcode == _CHUNK:
            if size < 32:
                raise RunFileError(f"{path}: the chunk at offset {offset} is too short")
            length, checksum = struct.unpack_from("<QI", data, offset + 16)
            compression, begin = _text(data, offset + 28, path)
            if compression:
                raise RunFileError(f"{path}: compression {compression!r}; regrasp writes none")
            stored = struct.unpack_from("<Q", data, begin)[0]
            if stored != length or begin + 8 + stored > offset + size:
                raise RunFileError(f"{path}: the chunk at offset {offset} claims {stored} bytes")
            if checksum and zlib.crc32(data[begin + 8:begin + 8 + stored]) != checksum:
                raise RunFileError(f"{path}: the checksum of the chunk at offset {offset} is wrong")
            inner = _records(data, begin + 8, begin + 8 + stored, path)
        else:
            inner = [(opcode, offset, size)]
        for kind, at, length in inner:
            if kind == _CHANNEL:
                number = struct.unpack_from("<H", data, at)[0]
                topics[number] = _text(data, at + 4, path)[0]
            elif kind == _MESSAGE:
                if length < 22:
                    raise RunFileError(f"{path}: the message at offset {at} is too short")
                number, _, log_time = struct.unpack_from("<HIQ", data, at)
                if number not in topics:
                    raise RunFileError(f"{path}: the message at offset {at} is of no channel")
                if topic in (None, topics[number]):
                    yield topics[number], log_time * 1e-9, json.loads(data[at + 22:at + length])


def load(path):
    """A run file as {topic: [message]}; each message is a dict, with the time in seconds as `time_s` where it has none."""
    run = {}
    for topic, time_s, message in messages(path):
        message.setdefault("time_s", time_s)
        run.setdefault(topic, []).append(message)
    return run


# Columns of experiments that are text, however it looks: a case may be called 0.80, a hash be 15815048586e0745.
_TEXT = frozenset("case finger criterion estimator axis_W noise object outcome error reason state_hash command".split())
_NUMBER = re.compile(r"-?\d+(\.\d+)?([eE][-+]?\d+)?", re.ASCII)


def trials(directory):
    """The rows of an experiment (`trials.csv`) as dicts, empty cells as None. A column is numbers (float) where every
    cell that is not empty is a decimal number, and text otherwise. Always text: case, finger, criterion, estimator,
    axis_W, noise, object, outcome, error, reason, state_hash, command."""
    with open(pathlib.Path(directory) / "trials.csv", newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        rows = list(reader)
    names = reader.fieldnames or []
    numbers = {name for name in names if name not in _TEXT and all(_NUMBER.fullmatch(row[name] or "0") for row in rows)}
    return [{name: (float(row[name]) if name in numbers else row[name]) if row[name] else None for name in names} for row in rows]


def summary(directory):
    """What an experiment says (`summary.json`)."""
    return json.loads((pathlib.Path(directory) / "summary.json").read_text(encoding="utf-8"))


def columns(rows):
    """Rows of dicts as {name: column}, for example of `trials` or of one topic of `load`: a numpy array where numpy is
    installed and the column holds numbers (None becomes NaN), a list otherwise."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    table = {name: [row.get(name) for row in rows] for name in names}
    try:
        import numpy
    except ImportError:
        return table
    for name, values in table.items():
        if all(v is None or isinstance(v, (int, float)) for v in values):
            table[name] = numpy.array([float("nan") if v is None else float(v) for v in values])
    return table
