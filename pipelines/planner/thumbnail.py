"""Makes PNG pictures of rt-trace small enough to embed: 8-bit RGB or RGBA, not interlaced."""
import struct
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def thumbnail(data, most_pixels):
    """PNG bytes of the picture, its longer side at most so long; None for a PNG of another kind."""
    chunks = dict(chunks_of(data)) if data.startswith(SIGNATURE) else {}
    if b"IHDR" not in chunks:
        return None
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", chunks[b"IHDR"])
    channels = {2: 3, 6: 4}.get(kind)
    if depth != 8 or channels is None or interlaced:
        return None
    step = max(1, -(-max(width, height) // most_pixels))
    if step == 1:
        return data
    rows = unfiltered(zlib.decompress(chunks[b"IDAT"]), width * channels, channels)
    return encoded([shrunk(rows[y : y + step], width, channels, step) for y in range(0, height - step + 1, step)], channels)


def chunks_of(data):
    """(kind, content); what is split into several comes joined, last."""
    position, image = len(SIGNATURE), b""
    while position + 8 <= len(data):
        length, kind = struct.unpack(">I4s", data[position : position + 8])
        content = data[position + 8 : position + 8 + length]
        position += length + 12
        if kind == b"IDAT":
            image += content
        else:
            yield kind, content
    yield b"IDAT", image


def unfiltered(data, stride, channels):
    rows, above = [], bytearray(stride)
    for begin in range(0, len(data), stride + 1):
        row = bytearray(data[begin + 1 : begin + 1 + stride])
        undo_filter(data[begin], row, above, channels)
        rows.append(row)
        above = row
    return rows


def undo_filter(kind, row, above, channels):
    if kind == 0:
        return
    for i in range(len(row)):
        left = row[i - channels] if i >= channels else 0
        corner = above[i - channels] if i >= channels else 0
        guess = (left, above[i], (left + above[i]) // 2, nearest(left, above[i], corner))[kind - 1]
        row[i] = (row[i] + guess) & 255


def nearest(left, above, corner):
    """The one of the three that is nearest to left + above - corner."""
    wanted = left + above - corner
    return min((left, above, corner), key=lambda value: abs(value - wanted))


def shrunk(rows, width, channels, step):
    """One row of means of step x step pixels."""
    area = step * len(rows)
    return bytes(
        sum(row[x * channels + c + i * channels] for row in rows for i in range(step)) // area
        for x in range(0, width - step + 1, step)
        for c in range(channels)
    )


def encoded(rows, channels):
    header = struct.pack(">IIBBBBB", len(rows[0]) // channels, len(rows), 8, {3: 2, 4: 6}[channels], 0, 0, 0)
    body = zlib.compress(b"".join(b"\0" + row for row in rows), 9)
    return SIGNATURE + b"".join(chunk(kind, content) for kind, content in ((b"IHDR", header), (b"IDAT", body), (b"IEND", b"")))


def chunk(kind, content):
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
