"""Readers of what `export` and `video` write, by the specifications of the formats alone."""

import ast
import struct
import zipfile


def read_gif(data):
    """[(width, height, [(red, green, blue)])] of an animated GIF whose pictures have their own colours, by its specification."""
    assert data[:6] == b"GIF89a"
    assert not data[10] & 0x80
    at, pictures = 13, []

    def blocks():
        nonlocal at
        content = b""
        while data[at]:
            content += data[at + 1:at + 1 + data[at]]
            at += 1 + data[at]
        at += 1
        return content
    while data[at] != 0x3B:
        if data[at] == 0x21:  # an extension
            at += 2
            blocks()
            continue
        assert data[at] == 0x2C
        width, height = struct.unpack_from("<HH", data, at + 5)
        assert data[at + 9] & 0x80
        table, count = at + 10, 2 << (data[at + 9] & 7)
        colours = [tuple(data[i:i + 3]) for i in range(table, table + 3 * count, 3)]
        bits = data[table + 3 * count]
        at = table + 3 * count + 1
        pictures.append((width, height, [colours[i] for i in lzw(blocks(), bits)]))
    return pictures


def lzw(data, root):
    """The pixels behind variable-length codes."""
    clear, number, filled, at = 1 << root, 0, 0, 0
    pixels, table, bits, previous = bytearray(), {}, root + 1, None
    while True:
        while filled < bits:
            number |= data[at] << filled
            filled, at = filled + 8, at + 1
        code, number, filled = number & ((1 << bits) - 1), number >> bits, filled - bits
        if code == clear:
            table, bits, previous = {i: bytes([i]) for i in range(clear)}, root + 1, None
            following = clear + 2
            continue
        if code == clear + 1:
            return bytes(pixels)
        word = table[code] if code in table else previous + previous[:1]
        pixels += word
        if previous is not None and following < 4096:
            table[following] = previous + word[:1]
            following += 1
            if following == 1 << bits and bits < 12:
                bits += 1
        previous = word


def read_npz(path):
    """{name: (shape, flat values)}, without NumPy."""
    arrays = {}
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        for member in archive.namelist():
            data = archive.read(member)
            assert data[:8] == b"\x93NUMPY\x01\x00", member
            size = struct.unpack_from("<H", data, 8)[0]
            assert (10 + size) % 64 == 0, member
            header = ast.literal_eval(data[10:10 + size].decode())
            body, kind = data[10 + size:], header["descr"]
            if kind == "<f8":
                values = list(struct.unpack(f"<{len(body) // 8}d", body))
            elif kind == "|b1":
                values = [bool(b) for b in body]
            else:
                width = 4 * int(kind[2:])
                values = [body[i:i + width].decode("utf-32-le").rstrip("\0") for i in range(0, len(body), width)]
            arrays[member.removesuffix(".npy")] = (header["shape"], values)
    return arrays
