"""Files broken as bytes: encodings, cuts, flips, depth; (random generator, base text) -> bytes."""

import re

from mutations import DEPTH, mutation

DOTS = 2000  # of a key, twice as deep as Python recurses: tomllib takes the square of them
SCRAMBLES = {}  # name -> Mutation, as in mutations.MUTATIONS


def scramble(steps=1):
    return mutation(steps, SCRAMBLES)


@scramble()
def byte_order_mark(rng, text):
    return b"\xef\xbb\xbf" + text.encode()


@scramble()
def windows_line_ends(rng, text):
    return text.replace("\n", "\r\n").encode()


@scramble()
def old_mac_line_ends(rng, text):
    return text.replace("\n", "\r").encode()


@scramble()
def utf_16(rng, text):
    return text.encode(rng.choice(["utf-16", "utf-16-le", "utf-32"]))


@scramble()
def invalid_utf_8(rng, text):
    place = rng.randrange(len(text))
    data = text.encode()
    return data[:place] + rng.choice([b"\xff", b"\xc3", b"\xed\xa0\x80", b"\x80"]) + data[place:]


@scramble()
def nul_byte(rng, text):
    place = rng.randrange(len(text))
    data = text.encode()
    return data[:place] + b"\0" + data[place:]


@scramble()
def empty_file(rng, text):
    return rng.choice([b"", b"\n \n", b"# nothing but a comment", b"\xef\xbb\xbf"])


@scramble(steps=5)
def truncated(rng, text):
    return text.encode()[: rng.randrange(len(text))]


@scramble(steps=5)
def bytes_flipped(rng, text):
    data = bytearray(text.encode())
    for _ in range(rng.randint(1, 4)):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return bytes(data)


@scramble(steps=5)
def bytes_replaced(rng, text):
    data = bytearray(text.encode())
    for _ in range(rng.randint(1, 4)):
        data[rng.randrange(len(data))] = rng.choice(b"\"[]{}=.,'+-_0159eE \n")
    return bytes(data)


@scramble()
def random_bytes(rng, text):
    return rng.randbytes(rng.randrange(1, 300))


@scramble()
def line_lost(rng, text):
    lines = text.split("\n")
    del lines[_entry(rng, lines)]
    return "\n".join(lines).encode()


@scramble()
def line_doubled(rng, text):
    lines = text.split("\n")
    k = _entry(rng, lines)
    return "\n".join(lines[: k + 1] + lines[k:]).encode()


@scramble()
def table_doubled(rng, text):
    return text.encode() + rng.choice([b"\n[duty]\n", b"\n[limits]\nk_factor = 1\n"])


@scramble()
def quotes_lost(rng, text):
    lines = text.split("\n")
    k = rng.choice([k for k, line in enumerate(lines) if '"' in line])
    lines[k] = lines[k].replace('"', "", rng.randint(1, 2))
    return "\n".join(lines).encode()


@scramble()
def integer_of_thousands_of_digits(rng, text):
    return _value(rng, text, rng.choice(["", "-"]) + "9" * DEPTH)


@scramble()
def deep_arrays(rng, text):
    return _value(rng, text, "[" * DEPTH + "]" * rng.choice([DEPTH, 0]))


@scramble()
def deep_inline_tables(rng, text):
    return _value(rng, text, "{a = " * DEPTH + "1" + "}" * DEPTH)


@scramble()
def deep_dotted_key(rng, text):
    lines = text.split("\n")
    k = _entry(rng, lines)
    lines[k] = re.sub(r"^([a-z_0-9]+) *=", lambda m: m[1] + ".a" * DOTS + " =", lines[k])
    return "\n".join(lines).encode()


@scramble()
def deep_arrays_of_ones_own(rng, text):
    return text.encode() + b"\n[x-deep]\na = " + b"[" * DEPTH + b"]" * DEPTH


@scramble()
def deep_keys_of_ones_own(rng, text):
    key = b"a" + b".a" * (DOTS - 1)
    return text.encode() + rng.choice([b"\n[x-deep]\n" + key + b" = 1", b"\n[x-deep." + key + b"]"])


def _value(rng, text, value):
    """The file with one value replaced by a text."""
    lines = text.split("\n")
    k = _entry(rng, lines)
    lines[k] = lines[k].split("=")[0] + "= " + value
    return "\n".join(lines).encode()


def _entry(rng, lines):
    """The number of a line with a key."""
    return rng.choice([k for k, line in enumerate(lines) if re.match("[a-z_]+ = ", line)])
