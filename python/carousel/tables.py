"""Reports as tables and arrays."""

import struct
import zlib
from pathlib import Path


def frame(rows):
    """A pandas DataFrame: of rows of sweep() with a column a key and a result, or of reports with a column a number,
    named by its path ("throughput.whole.rays_per_kilocycle")."""
    import pandas

    return pandas.DataFrame([_row(row) for row in rows])


def _row(row):
    if "keys" in row and "results" in row:
        return {**row["keys"], **row["results"], "status": row["status"], "point": row["point"]}
    return dict(_leaves(row, ""))


def _leaves(value, path):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _leaves(inner, f"{path}.{key}" if path else key)
    elif not isinstance(value, list):
        yield path, value


def time_series(report):
    """The report's time series: the times at which the samples begin, the unit of these, and a dict from (part,
    quantity) to a NumPy array of the samples."""
    import numpy

    series = report.get("time_series") or report.get("host", {}).get("time_series")
    if series is None:
        raise KeyError("the report has no time series")
    rows = {(row["part"], row["quantity"]): numpy.array(row["values"], dtype=float) for row in series["rows"]}
    return numpy.arange(series["samples"]) * series["interval"], series["unit"], rows


def picture(report):
    """The picture of a run, a NumPy array of shape (height, width, 3) of 8-bit sRGB."""
    data = getattr(report, "picture_bytes", None)
    if data is None:
        folder = getattr(report, "folder", None)
        if folder is None or not (Path(folder) / "image.png").exists():
            raise KeyError("the report comes without a picture")
        data = (Path(folder) / "image.png").read_bytes()
    return _decode_png(data)


def _decode_png(data):
    """An array of a PNG of 8 bits a channel without interlacing, which is what the program writes (PNG, third edition,
    W3C 2023: sections 5 and 9)."""
    import numpy

    at, body, header = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", chunk)
        elif kind == b"IDAT":
            body += chunk
        at += 12 + length
    width, height, bits, colour, _, _, interlaced = header
    channels = {0: 1, 2: 3, 4: 2, 6: 4}.get(colour)
    if bits != 8 or channels is None or interlaced:
        raise ValueError("expected a PNG of 8 bits a channel, without palette and interlacing")
    lines = numpy.frombuffer(zlib.decompress(body), dtype=numpy.uint8).reshape(height, 1 + width * channels)
    out = numpy.zeros((height, width * channels), dtype=numpy.uint8)
    above = out[0]
    for y in range(height):
        above = _unfilter(lines[y, 0], lines[y, 1:].copy(), above, channels)
        out[y] = above
    return out.reshape(height, width, channels)[:, :, :3]


def _unfilter(kind, line, above, step):
    if kind == 2:
        return line + above
    if kind == 0:
        return line
    values, up = line.tolist(), above.tolist()
    for i, value in enumerate(values):
        left = values[i - step] if i >= step else 0
        corner = up[i - step] if i >= step else 0
        if kind == 1:
            guess = left
        elif kind == 3:
            guess = (left + up[i]) // 2
        else:
            near = left + up[i] - corner
            guess = min((abs(near - left), 0, left), (abs(near - up[i]), 1, up[i]), (abs(near - corner), 2, corner))[2]
        values[i] = (value + guess) & 255
    line[:] = values
    return line
