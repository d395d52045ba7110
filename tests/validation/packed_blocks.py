"""A second decoder of compressed blocks of triangles, written from docs/reference/triangle-blocks.md alone. It works on a
block as one whole number. Coordinates have 26 bits or those of a float, so that doubles hold them exactly."""
import math
import struct

NON_OPAQUE = 1 << 31


class Bits:
    """A block's bits from the lowest of its first byte on."""

    def __init__(self, block):
        self.left = int.from_bytes(block, "little")

    def take(self, width):
        value = self.left & ((1 << width) - 1)
        self.left >>= width
        return value


def float_of(bits):
    return struct.unpack("<f", struct.pack("<I", bits))[0]


def raw(bits, count):
    out = []
    for _ in range(count):
        corners = [tuple(float_of(bits.take(32)) for _ in range(3)) for _ in range(3)]
        out.append((bits.take(32), corners))
    return out


def signed(bits, width):
    value = bits.take(width)
    return value - (1 << width if value >> (width - 1) else 0)


def vertices_of(bits, count):
    exponent = bits.take(9) - 149
    anchors, widths = [], []
    for _ in range(3):
        anchors.append(signed(bits, bits.take(5)))
        widths.append(bits.take(5))
    return [tuple(math.ldexp(anchor + bits.take(width), exponent) for anchor, width in zip(anchors, widths)) for _ in range(count)]


def primitives_of(bits, count):
    least = bits.take(bits.take(5))
    width, of_differences, opacity = bits.take(5), bits.take(5), bits.take(2)
    number, out = None, []
    for i in range(count):
        if i and of_differences and bits.take(1):
            number += signed(bits, of_differences)
        else:
            number = least + bits.take(width)
        out.append(number | (NON_OPAQUE if opacity == 1 or (opacity == 2 and bits.take(1)) else 0))
    return out


def corners_of(bits, count, vertices):
    name, seen, out = (vertices - 1).bit_length(), 0, []

    def vertex():
        nonlocal seen
        if not bits.take(1):
            return bits.take(name)
        seen += 1
        return seen - 1

    for i in range(count):
        edge = bits.take(2) if i else 0
        if edge == 0:
            out.append([vertex() for _ in range(3)])
            continue
        rotation, before = bits.take(2), out[-1]
        # A neighbour that turns the same way has the edge backwards.
        corners = [before[edge % 3], before[edge - 1], vertex()]
        out.append([corners[(i - rotation) % 3] for i in range(3)])
    return out


def decoded(block):
    """(primitive with the bit of non-opaque ones, three corners) of each triangle of 128 bytes."""
    bits = Bits(block)
    is_raw, count = bits.take(1), bits.take(6) + 1
    if is_raw:
        return raw(bits, count)
    vertices = vertices_of(bits, bits.take(6) + 1)
    primitives = primitives_of(bits, count)
    return [(primitive, [vertices[corner] for corner in corners])
            for primitive, corners in zip(primitives, corners_of(bits, count, len(vertices)))]


def is_raw(block):
    return block[0] & 1 == 1
