"""The bundled vectors: how large they are, how wide their enclosures, and the SHA-256 of each file.

The set is what `rttrr-pin vectors -o FOLDER` writes. With --archive it is also packed, the same bytes each time: that
file goes with a release. Quaternions and the accelerations of the level `cancelling` come from the processor's own
vector instructions, so another machine may draw states whose last bit is another; what is proven holds there too.

Run: python benchmarks/vectors.py [--archive FILE.tar.gz] [--save].
"""

from __future__ import annotations

import gzip
import hashlib
import io
import sys
import tarfile
import tempfile
import time
from pathlib import Path

from common import arguments, finish
from rttrr_pin.conformance import write_vectors

LARGEST = 20e6
"""Bytes of the files of the set."""


def archived(folder: Path) -> bytes:
    """The files of a folder without times, owners and modes."""
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive:
        for path in sorted(path for path in folder.rglob("*") if path.is_file()):
            entry = tarfile.TarInfo(f"vectors/{path.relative_to(folder)}")
            content = path.read_bytes()
            entry.size, entry.mode = len(content), 0o644
            archive.addfile(entry, io.BytesIO(content))
    return gzip.compress(packed.getvalue(), mtime=0)


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--archive", type=Path, help="write the set here, packed")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        start = time.perf_counter()
        vectors = write_vectors(Path(temporary) / "vectors")
        seconds = time.perf_counter() - start
        packed = archived(vectors.folder)
        manifest = hashlib.sha256((vectors.folder / "manifest.json").read_bytes()).hexdigest()
    if chosen.archive:
        chosen.archive.write_bytes(packed)
    robots = {
        name: {
            "levels": {level["id"]: level["states"] for level in meta["levels"]},
            "bits": max(level["bits"] for level in meta["levels"]),
            "numbers": sum(count for level in meta["levels"] for count in level["widths"].values()),
            "mjcf": meta["mjcf"]["file"] or meta["mjcf"]["reason"],
            "sha256": meta["sha256"],
        }
        for name, meta in vectors.meta.items()
    }
    figures = {
        "states": vectors.states,
        "bytes": vectors.bytes,
        "bytes_packed": len(packed),
        "seconds": round(seconds, 1),
        "tight": vectors.passed,
        "widths": vectors.widths,
        "sha256_of_manifest": manifest,
        "sha256_of_archive": hashlib.sha256(packed).hexdigest(),
        "robots": robots,
    }
    finish("vectors", figures, chosen.save)
    return 0 if vectors.passed and vectors.bytes < LARGEST else 1


if __name__ == "__main__":
    sys.exit(main())
