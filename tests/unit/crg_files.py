"""OpenCRG files for tests, written in all four formats of data."""

import numpy as np

HEADER = """$CT
a test road
$ROAD_CRG
reference_line_start_u = 0.0
reference_line_end_u = {stop}
REFERENCE_LINE_INCREMENT = {step} ! capitals count the same
reference_line_start_phi = {phi}
reference_line_end_phi = {phi_end}
long_section_v_right = {right}
long_section_v_left = {left}
long_section_v_increment = {width}
{extra}$!**********
$KD_DEFINITION
#:{code}
U:reference line u,m,0,1
{channels}$!
* a comment
$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$
"""


def crg(
    heights,
    *,
    step=1.0,
    width=0.5,
    phi=None,
    bank=None,
    slope=None,
    places=None,
    extra="",
    code="LRFI",
    ending="\n",
):
    """Return the bytes of an OpenCRG file."""
    heights = np.asarray(heights, dtype=float)
    rows, columns = heights.shape
    along = {"phi,rad": phi, "banking,m/m": bank, "slope,m/m": slope}
    along = {name: np.asarray(of, dtype=float) for name, of in along.items() if of is not None}
    places = -0.5 * width * (columns - 1) + width * np.arange(columns) if places is None else places
    names = [f"D:reference line {name}\n" for name in along]
    even = np.ptp(np.diff(places)) < 1e-9
    names += [
        f"D:long section {n + 1},m\n" if even else f"D:long section at v = {v:.3f},m\n"
        for n, v in enumerate(places)
    ]
    first, last = (0.0, 0.0) if phi is None else (phi[0], phi[-1])
    text = HEADER.format(
        stop=step * (rows - 1),
        step=step,
        phi=repr(float(first)),
        phi_end=repr(float(last)),
        right=places[0],
        left=places[-1],
        width=width,
        extra=extra,
        code=code,
        channels="".join(names),
    )
    table = np.column_stack([*along.values(), heights])
    return text.replace("\n", ending).encode() + _payload(table, code, ending)


def _payload(table, code, ending):
    if code[2] == "B":
        kind, unit = (">f8", 10) if code[1] == "D" else (">f4", 20)
        flat = table.astype(kind).ravel()
        padding = np.full(-len(flat) % unit, np.nan, dtype=kind)
        return flat.tobytes() + padding.tobytes()
    width, each = (20, 4) if code[1] == "D" else (10, 8)
    lines = []
    for row in table:
        cells = ["*missing*".rjust(width) if np.isnan(n) else _number(n, width) for n in row]
        lines += ["".join(cells[at : at + each]) for at in range(0, len(cells), each)]
    return "".join(line + ending for line in lines).encode()


def _number(value, width):
    return f"{value:{width}.12f}" if width == 20 else f"{value:{width}.6f}"
