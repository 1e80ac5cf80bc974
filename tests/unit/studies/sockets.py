"""The sockets of a process and all its descendants, as Linux reports them."""

import os
import re
from pathlib import Path

LISTENING_UNIX = 0x10000
NETWORK = ("tcp", "tcp6", "udp", "udp6", "raw", "raw6")


def family_of(root):
    """Return the number of a process and those of all its descendants."""
    parents = {}
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = entry.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        parents.setdefault(int(fields[1]), []).append(int(entry.parent.name))
    found, waiting = [], [root]
    while waiting:
        found.append(waiting.pop())
        waiting += parents.get(found[-1], [])
    return found


def open_sockets(process):
    """Return network sockets and listening Unix sockets that a process holds, as table lines.

    The server in which tests run commands is none of the program's.
    """
    servers = os.environ.get("VEHICLEDYN_TEST_SERVERS", "/nowhere")
    inodes = set()
    for link in Path(f"/proc/{process}/fd").iterdir():
        try:
            match = re.fullmatch(r"socket:\[(\d+)\]", str(link.readlink()))
        except OSError:
            continue
        inodes |= {match[1]} if match else set()
    found = []
    for name in NETWORK:
        table = Path(f"/proc/{process}/net/{name}")
        lines = table.read_text().splitlines()[1:] if table.exists() else []
        found += [f"{name}: {line}" for line in lines if line.split()[9] in inodes]
    for line in Path(f"/proc/{process}/net/unix").read_text().splitlines()[1:]:
        words = line.split()
        is_of_tests = words[-1].startswith(f"{servers}/")
        if words[6] in inodes and int(words[3], 16) & LISTENING_UNIX and not is_of_tests:
            found.append(f"unix: {line}")
    return found
