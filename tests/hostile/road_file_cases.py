"""Spoilt OpenCRG roads, text and binary, and tyre property files (.tir)."""

import functools
import struct

import mutations
import yaml_cases
from harness import Case
from yaml_cases import ROOT, SHORT

MARK = b"$$$$"
SETTINGS = [
    "reference_line_start_u", "reference_line_end_u", "reference_line_increment",
    "reference_line_start_phi", "reference_line_end_phi", "reference_line_end_x",
    "reference_line_end_y", "reference_line_start_z", "reference_line_end_z",
    "reference_line_start_s", "reference_line_start_b", "long_section_v_right",
    "long_section_v_left", "long_section_v_increment",
]  # fmt: skip
OPTIONS = [
    "border_mode_u", "border_mode_v", "border_offset_u", "border_smooth_ubeg",
    "border_smooth_uend", "refline_continuation",
]  # fmt: skip
MODIFIERS = [
    "scale_z_grid", "scale_slope", "scale_banking", "scale_length", "scale_width",
    "scale_curvature", "grid_nan_mode", "grid_nan_offset", "refline_rotcenter_x",
    "refline_offset_phi", "refline_offset_z", "refpoint_u", "refpoint_u_fraction",
    "refpoint_v_fraction", "refpoint_x", "refpoint_phi",
]  # fmt: skip
VALUES = [
    "0", "1", "2", "3", "-1", "0.5", "1e-7", "1e-5", "10", "1e5", "1e9", "1e12", "1e39", "1e301",
    "1e308", "-1e308", "nan", "inf", "1e400", "1.5+e00", "1d3", "", "x", "1 m", "4.7", "9" * 400,
]  # fmt: skip
CELLS = [
    "*missing*", "**unused**", "NaN", "nan", "inf", "1e38", "1e39", "-1e301", "1e400", "x", "",
    "1.0.0", "1d3", "*", "0x1", "\0",
]  # fmt: skip
UNITS = ["mm", "inch", "meter", "kN", "deg", "psi", "bar", "parsec", "", "slug", "hour", "x" * 300]
FITS = ["5", "6", "21", "52", "60", "61", "62", "7", "0", "-1", "nan", "1e400", "", "'61'", "6.1"]
NEEDED = {
    "UNLOADED_RADIUS": 0.3, "WIDTH": 0.2, "LONGVL": 16.6, "FNOMIN": 4000, "FZMIN": 100,
    "FZMAX": 9000, "KPUMIN": -1, "KPUMAX": 1, "ALPMIN": -0.5, "ALPMAX": 0.5, "PCX1": 1.6,
    "PDX1": 1.1, "PKX1": 20, "PCY1": 1.3, "PDY1": 1.0, "PKY1": -20, "PKY2": 2,
    "VERTICAL_STIFFNESS": 2e5,
}  # fmt: skip


@functools.cache
def roads():
    """Return whole OpenCRG files by format: text in two widths, binary in two precisions."""
    text = (ROOT / "tests/unit/road/measured_road.crg").read_bytes()
    end = text.index(b"\n", text.index(MARK)) + 1
    head, rows = text[:end], [[float(n) for n in line.split()] for line in text[end:].splitlines()]
    flat = [number for row in rows for number in row]
    long_lines = [
        "".join(f"{number:20.12f}" for number in row[at : at + 4])
        for row in rows
        for at in range(0, len(row), 4)
    ]
    bodies = {
        b"LRFI": text[end:],
        b"LDFI": "".join(line + "\n" for line in long_lines).encode(),
        b"KRBI": struct.pack(f">{len(flat)}f", *flat),
        b"KDBI": struct.pack(f">{len(flat)}d", *flat),
    }
    return {code: (head.replace(b"#:LRFI", b"#:" + code), body) for code, body in bodies.items()}


def _setting(lines, rng):
    """Change or add a line ``name = value``, in its block or in another."""
    name, value = rng.choice([*SETTINGS, *OPTIONS, *MODIFIERS]), rng.choice(VALUES)
    at = [k for k, line in enumerate(lines) if line.lower().startswith(name.encode())]
    line = f"{name} = {value}".encode()
    if at and rng.random() < 0.9:
        lines[at[0]] = line
    elif name in SETTINGS:
        lines.insert(lines.index(b"$ROAD_CRG") + 1, line)
    else:
        block = b"$ROAD_CRG_OPTS" if name in OPTIONS else b"$ROAD_CRG_MODS"
        lines[0:0] = [block, line, *([line] if rng.random() < 0.1 else [])]


def _channel(lines, rng):
    """Double, lose, renumber or replace a channel, or add very many."""
    at = rng.choice([k for k, line in enumerate(lines) if line.startswith(b"D:")])
    way = rng.randrange(6)
    if way == 0:
        lines.insert(at, lines[at])
    elif way == 1:
        del lines[at]
    elif way == 2:
        lines[at] = f"D:long section {rng.choice([0, 1, 7, 10**9, 10**30])},m".encode()
    elif way == 3:
        lines[at] = f"D:long section at v = {rng.choice(VALUES)},m".encode()
    elif way == 4:
        lines[at] = b"D:reference line " + rng.choice([b"x,m", b"u,m", b"phi,deg", b"z,m"])
    else:
        lines[at:at] = [f"D:long section {k},m".encode() for k in range(6, rng.choice([9, 20000]))]


def _format(lines, rng):
    """Announce another format than that of the data."""
    at = next(k for k, line in enumerate(lines) if line.startswith(b"#:"))
    lines[at] = b"#:" + rng.choice([b"LRFI", b"LDFI", b"KRBI", b"KDBI", b"XXXX", b""])


def _inclusion(lines, rng):
    names = [b"a.crg", b"missing.crg", b"/dev/zero", b"..", b"a.yaml", b"x" * 900]
    lines[0:0] = [b"$ROAD_CRG_FILE", rng.choice(names)]


def _any_line(lines, rng):
    text = b"\n".join(lines).decode("latin-1")
    lines[:] = mutations.spoil_lines(text, rng).encode("utf-8", "surrogatepass").split(b"\n")


def _spoilt_data(body, code, rng):
    way = rng.randrange(5)
    if way == 0:
        return body[: rng.randrange(len(body) + 1)]
    if way == 1:
        return body * rng.choice([0, 2, 30])
    if way == 2:
        return mutations.spoil_bytes(body, rng)
    if code[2:3] == b"B":
        size, letter = (8, "d") if code[1:2] == b"D" else (4, "f")
        number = rng.choice([float("nan"), float("inf"), -float("inf"), 3e38, 1e-40])
        at = size * rng.randrange(len(body) // size)
        return body[:at] + struct.pack(f">{letter}", number) + body[at + size :]
    width = 20 if code[1:2] == b"D" else 10
    rows = body.split(b"\n")
    row = rng.randrange(len(rows) - 1)
    at = width * rng.randrange(max(1, len(rows[row]) // width))
    cell = rng.choice(CELLS).rjust(width)[:width].encode()
    rows[row] = rows[row][:at] + cell + rows[row][at + width :]
    return b"\n".join(rows)


def opencrg(rng, name):
    """Return a scenario on a road whose header, format, channels or data are spoilt."""
    code = rng.choice(list(roads()))
    head, body = roads()[code]
    lines = head.rstrip(b"\n").split(b"\n")
    for _ in range(rng.choice([0, 1, 1, 1, 2, 4])):
        change = rng.choice(
            [_setting, _setting, _setting, _channel, _format, _inclusion, _any_line]
        )
        try:
            change(lines, rng)
        except (ValueError, IndexError, StopIteration):  # an earlier change took the line away
            continue
    if rng.random() < 0.4:
        body = _spoilt_data(body, code, rng)
    ending = rng.choice([b"\n", b"\n", b"\r\n", b"\r", b""])
    content = ending.join(lines) + ending + body
    flat = "road:\n  kind: flat"
    kind = "road:\n  kind: opencrg\n  file: a.crg" + rng.choice([
        "", "", "\n  origin: file", "\n  interpolation: linear",
    ])  # fmt: skip
    scenario = yaml_cases.scenario_texts()["scenarios/iltis_ramp_steer.yaml"].replace(flat, kind)
    command = ["run", "a.yaml", "-o", "out.h5", *SHORT]
    if rng.random() < 0.8:
        command = ["validate", "a.yaml"]
    files = {"a.yaml": yaml_cases.lighter(scenario.encode(), command), "a.crg": content}
    return Case(name, files, command, yaml_cases.OUTPUTS)


@functools.cache
def tyres():
    """Return whole tyre property files: a short one of MF 6.1, and two of the library."""
    units = {"LENGTH": "meter", "FORCE": "newton", "ANGLE": "radians", "MASS": "kg"}
    lines = ["[UNITS]", *(f"{name} = '{unit}'" for name, unit in units.items())]
    lines += ["TIME = 'second'", "[MODEL]", "FITTYP = 61", "TYRESIDE = 'LEFT'", "[VERTICAL]"]
    lines += [f"{name} = {value}  $ comment" for name, value in NEEDED.items()]
    library = ROOT / "vehicledyn" / "library" / "tyres"
    names = ["passenger_R0394_mf61.tir", "passenger_235_60R16_pac2002.tir"]
    return ["\n".join(lines), *((library / n).read_text(encoding="latin-1") for n in names)]


def _spoilt_entry(lines, rng):
    """Change, double, lose or rename an entry, or turn a range round."""
    at = rng.choice([k for k, line in enumerate(lines) if "=" in line and line[:1] not in "$!#{"])
    name, _, value = lines[at].partition("=")
    bare = name.strip().upper()
    way = rng.randrange(6)
    if bare in ("LENGTH", "FORCE", "ANGLE", "MASS", "TIME", "PRESSURE") and way < 4:
        lines[at] = f"{name}= '{rng.choice(UNITS)}'"
    elif bare in ("FITTYP", "PROPERTY_FILE_FORMAT") and way < 4:
        lines[at] = f"{bare} = {rng.choice(FITS)}"
    elif way == 0:
        lines.insert(at, lines[at])
    elif way == 1:
        del lines[at]
    elif way == 2:
        lines[at] = f"{rng.choice([bare + 'X', '', bare.lower(), 'PKY1'])} ={value}"
    elif way == 3:
        _turn_range(lines, rng)
    else:
        lines[at] = f"{name}= {rng.choice([*VALUES, mutations.text(rng)])}"


def _turn_range(lines, rng):
    for pair in rng.sample([("FZMIN", "FZMAX"), ("KPUMIN", "KPUMAX"), ("ALPMIN", "ALPMAX")], 2):
        for k, line in enumerate(lines):
            bare = line.partition("=")[0].strip()
            if bare in pair:
                lines[k] = line.replace(bare, pair[1 - pair.index(bare)], 1)


def tyre(rng, name):
    """Return a command on a tyre property file that is spoilt: as curves, or in a scenario."""
    lines = rng.choice(tyres()).split("\n")
    for _ in range(rng.choice([1, 1, 1, 2, 5])):
        _spoilt_entry(lines, rng)
    content = "\n".join(lines)
    if rng.random() < 0.25:
        content = mutations.spoil_lines(content, rng)
    data = content.encode("utf-8", "surrogatepass")
    if rng.random() < 0.15:
        data = mutations.spoil_bytes(data, rng)
    files = {"a.tir": data}
    if rng.random() < 0.5:
        extra = rng.choice([[], [], ["--load", "4 kN"], ["--load", mutations.text(rng)],
                            ["--convention", mutations.text(rng)]])  # fmt: skip
        extra = [word.replace("\0", "") for word in extra]
        return Case(name, files, ["tyre", "a.tir", "-o", "out.csv", *extra], ("out.csv",))
    scenario = yaml_cases.scenario_texts()["scenarios/iltis_ramp_steer.yaml"]
    run = ["run", "a.yaml", "-o", "out.h5", *SHORT]
    command = rng.choice([["validate", "a.yaml"], ["validate", "a.yaml"], run])
    scenario = scenario.replace("kind: calspan", "file: a.tir").encode()
    files["a.yaml"] = yaml_cases.lighter(scenario, command)
    return Case(name, files, command, yaml_cases.OUTPUTS)
