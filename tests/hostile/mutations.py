"""Ways to spoil values, texts and bytes, each drawn from a random generator with a fixed seed."""

import json
import math
import sys


class Raw(str):
    """A YAML scalar to be written as it stands."""

    __slots__ = ()


NUMBERS = [
    0, -1, 1, 3, 1e308, -1e308, 1.7e308, 1e301, 1e-308, 5e-324, 1e-200, 1e200, 1e16, 1e9, -1e9,
    1e-9, 0.1, 1e5, 2**31, 2**63, 2**64, 10**30, Raw(".nan"), Raw(".inf"), Raw("-.inf"),
    Raw("1e400"), Raw("0x10"), Raw("0o17"), Raw("1_000"), Raw("-0.0"), Raw("9" * 400),
    Raw("9" * 5000),
]  # fmt: skip
TEXTS = [
    "", " ", "0", "1", "-1", "1e308", "1e308 m", "1e400 kg", "nan", "inf", "nan m", "-5 km/h",
    "1 m/s/s/s/s", "1 kg*m^99999", "1 m^1e9", "1 parsec", "1 m m", "m", "1m", "1,5 m", "5 %",
    "1/0", "1/40", "0/0", "true", "null", "~", "x", "speed", "time", "mass*", "a" * 300,
    "é" * 50, "日本語", "\u202e1 m", "\ufeff1 m", "\x85", "\x07", "\\0", "a\nb", "a\tb", "../..",
    "/dev/zero", "/etc/passwd", ".", "..", "/", "a/../b", "a.yaml", "a.csv", "con", "C:\\x",
    "${HOME}", "$(id)", "`id`", "%s%n", "{x}", "{i+1}", "*", "?", "[a-z]", "**/*", "(" * 200,
    "1+" * 2000 + "1", "-" * 3000 + "1", "__import__('os')", "().__class__", "lambda: 0",
    "sin(sin(1))", "sqrt(-1)", "log(0)", "1e308*10", "9**9**9**9", "2^2^2^2^2^2^2", "atan2(1)",
    "max()", "x if y else z", "a.b.c", "a[0]", "1 m + 1 kg", "'", '"', "#", ": ", "- ", "!!x y",
    "&a", "*a", "<<", "2020-01-01", "12:30:45", "yes", "1:40", "0:1:0", "1:2:3:4", "1 m:2 m:5",
    "1 m:2 kg:5", "5:1:1000000000", "1 m" + " " * 9000 + "x", " " * 9000 + "x", "m " * 9000,
    "x [" + " " * 9000, "1" * 9000 + "!", "a." * 9000,
]  # fmt: skip
UNITS = ["m", "kg", "s", "rad", "deg", "N", "mm", "km/h", "m/s", "N*m", "1", "Hz", "%", "kN/mm"]


def number(rng):
    return rng.choice(NUMBERS)


def text(rng):
    if rng.random() < 0.25:
        return f"{_near(rng.choice([1.0, 12.5, 0.3, 1e3]), rng)} {rng.choice(UNITS)}"
    return rng.choice(TEXTS)


def value(rng):
    """Return anything that a YAML file may hold."""
    kind = rng.random()
    if kind < 0.35:
        return number(rng)
    if kind < 0.75:
        return text(rng)
    if kind < 0.85:
        return rng.choice([None, True, False])
    if kind < 0.93:
        return [value(rng) for _ in range(rng.choice([0, 1, 2, 3, 7]))]
    return {text(rng): value(rng) for _ in range(rng.choice([0, 1, 3]))}


def near(old, rng):
    """Return a value of the same kind as another."""
    if isinstance(old, bool):
        return not old
    if isinstance(old, int | float):
        return _near(old, rng)
    if isinstance(old, str):
        return _near_text(old, rng)
    return value(rng)


def _near(old, rng):
    way = rng.randrange(9)
    factors = [1000.0, 1e-3, -1.0, 0.0, 1e6, 1e-6, 10.0]
    if way < len(factors):
        try:
            return type(old)(old * factors[way])
        except (OverflowError, ValueError):
            return old
    return number(rng)


def _near_text(old, rng):
    way = rng.randrange(12)
    words = old.split(" ")
    if way >= 8 and _is_number(words[0]):
        factor = rng.choice([0.5, 2.0, -1.0, 0.0, 1e-3, 1e3, 1e6, 1e12, 1e-12])
        return " ".join([repr(float(words[0]) * factor), *words[1:]])
    if way == 0 and len(words) == 2:
        return f"{words[0]} {rng.choice(UNITS)}"
    if way <= 2 and _is_number(words[0]):
        return " ".join([str(_near(float(words[0]), rng)), *words[1:]])
    if way == 3:
        place = rng.randrange(len(old) + 1)
        return old[:place] + rng.choice("()*/+-^.,:'\"{}[]#&é 0x") + old[place:]
    if way == 4 and old:
        place = rng.randrange(len(old))
        return old[:place] + old[place + 1 :]
    if way == 5:
        return old * rng.choice([2, 3, 50])
    if way == 6:
        return f"({old}) {rng.choice('+-*/^')} {rng.choice([old, '0', '1e308', 'time', '1 m'])}"
    return text(rng)


def _is_number(word):
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def places(data, at=()):
    """Yield the places of all values in plain data."""
    if isinstance(data, dict):
        for key, item in data.items():
            yield (*at, key)
            yield from places(item, (*at, key))
    elif isinstance(data, list):
        for key, item in enumerate(data):
            yield (*at, key)
            yield from places(item, (*at, key))


def get(data, place):
    for step in place:
        data = data[step]
    return data


def put(data, place, item):
    get(data, place[:-1])[place[-1]] = item


def spoil_data(data, others, rng):
    """Change one thing in plain data in place."""
    known = list(places(data))
    if not known:
        return
    place = rng.choice(known)
    leaves = [p for p in known if not isinstance(get(data, p), dict | list)]
    way = rng.random()
    if way < 0.6 and leaves:
        leaf = rng.choice(leaves)
        put(data, leaf, near(get(data, leaf), rng))
    elif way < 0.65:
        put(data, place, value(rng))
    elif way < 0.68:
        del get(data, place[:-1])[place[-1]]
    elif way < 0.76:
        other = rng.choice(others) if rng.random() < 0.5 else data
        found = [p for p in places(other) if p[-1] == place[-1]] or list(places(other))
        if found:
            put(data, place, _copy(get(other, rng.choice(found))))
    elif way < 0.84:
        other = rng.choice(known)
        first, second = _copy(get(data, place)), _copy(get(data, other))
        put(data, place, second)
        try:
            put(data, other, first)
        except (KeyError, IndexError, TypeError):
            return
    elif way < 0.9:
        holder = get(data, place[:-1])
        if isinstance(holder, dict):
            holder[rng.choice([text(rng), f"{place[-1]}x", str(place[-1])[:-1]])] = holder.pop(
                place[-1]
            )
        else:
            holder.insert(0, holder[-1])
    elif way < 0.95:
        holder = get(data, place)
        if isinstance(holder, dict):
            holder[rng.choice([text(rng), "kind", "for", "repeat", "mirror", "at"])] = value(rng)
        elif isinstance(holder, list):
            holder.extend([value(rng)] * rng.choice([1, 2, 30]))
    else:
        item = get(data, place)
        for _ in range(rng.choice([1, 5, 300])):
            item = [item] if rng.random() < 0.5 else {"a": item}
        put(data, place, item)


def _copy(item):
    if isinstance(item, dict):
        return {key: _copy(inner) for key, inner in item.items()}
    return [_copy(inner) for inner in item] if isinstance(item, list) else item


def spoil_lines(content, rng):
    """Return a text with lines moved, lost or changed."""
    lines = content.split("\n")
    for _ in range(rng.choice([1, 1, 2, 5])):
        at = rng.randrange(len(lines))
        way = rng.randrange(10)
        if way == 0:
            lines.insert(at, lines[rng.randrange(len(lines))])
        elif way == 1 and len(lines) > 1:
            del lines[at]
        elif way == 2:
            other = rng.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        elif way == 3:
            lines[at] = rng.choice(["  ", "\t", " ", "- ", "? ", "# "]) + lines[at]
        elif way == 4:
            lines[at] = lines[at][: rng.randrange(len(lines[at]) + 1)]
        elif way == 5:
            place = rng.randrange(len(lines[at]) + 1)
            lines[at] = lines[at][:place] + str(rng.choice(TEXTS)) + lines[at][place:]
        elif way == 6:
            lines[at] = _spoil_words(lines[at], rng)
        elif way == 7:
            lines[at] = lines[at].replace(
                rng.choice([":", ",", " ", ";", "["]),
                rng.choice(["", " ", ",", ":", "\t", "]", "{", ";;"]),
            )
        elif way == 8:
            lines[at:at] = lines[at:] * rng.choice([1, 3])
        else:
            lines[at] = _spoil_words(_spoil_words(lines[at], rng), rng)
        if len(lines) > 20_000:
            lines = lines[:20_000]
    return rng.choice(["\n", "\n", "\n", "\r\n", "\r"]).join(lines)


def _spoil_words(line, rng):
    words = line.split(" ")
    at = rng.randrange(len(words))
    bare = words[at].strip(",;{}[]")
    if bare:
        new = _near(float(bare), rng) if _is_number(bare) else text(rng)
        words[at] = words[at].replace(bare, str(new))
    return " ".join(words)


def spoil_bytes(content, rng):
    """Return bytes cut, flipped, doubled or filled."""
    found = bytearray(content)
    for _ in range(rng.choice([1, 1, 2, 8, 40])):
        if not found:
            break
        at = rng.randrange(len(found))
        way = rng.randrange(6)
        if way == 0:
            found[at] ^= 1 << rng.randrange(8)
        elif way == 1:
            found[at] = rng.choice([0, 0xFF, 0x80, 0xC3, 0xEF, 10, 13, 9, 32])
        elif way == 2:
            del found[at : at + rng.choice([1, 4, 64, 1 << 20])]
        elif way == 3:
            found[at:at] = bytes(rng.randrange(256) for _ in range(rng.choice([1, 8, 64])))
        elif way == 4:
            found[at : at + 8] = found[:8]
        else:
            found[at:at] = rng.choice([b"\xef\xbb\xbf", b"\xff\xfe", b"\0\0", b"\x1a", b"&a *a "])
    return bytes(found)


def dump(item):
    """Return plain data as YAML in one line, however deep it is nested."""
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(100_000)
    try:
        return _dump(item)
    finally:
        sys.setrecursionlimit(limit)


def _dump(item):
    if isinstance(item, dict):
        return "{" + ", ".join(f"{json.dumps(str(k))}: {_dump(v)}" for k, v in item.items()) + "}"
    if isinstance(item, list):
        return "[" + ", ".join(map(_dump, item)) + "]"
    if isinstance(item, Raw):
        return str(item)
    if isinstance(item, float) and not math.isfinite(item):
        return {True: ".nan"}.get(item != item, ".inf" if item > 0 else "-.inf")
    return json.dumps(item)
