"""Bodies from STEP files, meshed by the program Gmsh in a process of its own."""

from __future__ import annotations

import hashlib
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.processes import program_named
from toothspace.elasticity.mesh import SolidMesh, tetrahedral_mesh

_STEP_UNIT = 1e-3
_TETRAHEDRON, _NODES = 11, 10
_LIMIT = 600.0
"""Longest time that the mesher may take. [s]"""

# the last two edges of a tetrahedron stand in the other order in these files
_ORDER = (0, 1, 2, 3, 4, 5, 6, 7, 9, 8)


@final
@dataclass(frozen=True)
class SolidFile:
    """Body of a STEP file, as ten-node tetrahedra.

    The file is in millimetres and in the frame of the body: for a bearing z = 0 on its film face,
    for a gear in the middle of its face width.
    """

    path: Path
    """STEP file with one body."""
    edge_length: float
    """Longest edge of the tetrahedra. [m]"""
    named_by: str = ""
    """Key of the case that names the file, for messages."""

    @property
    def label(self) -> str:
        """What the body is called in messages."""
        return f"{self.named_by}: {self.path.name}" if self.named_by else str(self.path)

    def mesh(self, scale: float = 1.0) -> SolidMesh:
        """Tetrahedra; elements larger by a factor.

        Raises
        ------
        GeometryError
            If the file or the program ``gmsh`` is missing or the body cannot be meshed.
        """
        if not self.path.is_file():
            raise GeometryError(self.label, "no file", "is a STEP file")
        program = program_named("gmsh")
        if program is None:
            raise GeometryError(
                self.label,
                "no program gmsh",
                'with it on the path (pip install "toothspace[bodies]")',
            )
        with tempfile.TemporaryDirectory() as folder:
            text = self._meshed(program, Path(folder), scale * self.edge_length / _STEP_UNIT)
        # nodes and tetrahedra of a mesh file of version 2
        lines = text.splitlines()
        nodes = np.array([line.split() for line in _block(lines, "Nodes")], dtype=float)
        rows = [line.split() for line in _block(lines, "Elements")]
        solid = [row[-_NODES:] for row in rows if int(row[1]) == _TETRAHEDRON]
        if not solid:
            raise GeometryError(self.label, "no body", "is one closed solid")
        number = np.full(int(nodes[:, 0].max()) + 1, -1, dtype=np.int64)
        number[nodes[:, 0].astype(np.int64)] = np.arange(len(nodes))
        elements = number[np.array(solid, dtype=np.int64)][:, _ORDER]
        used, index = np.unique(elements, return_inverse=True)
        return tetrahedral_mesh(
            (_STEP_UNIT * nodes[:, 1:4])[used], index.reshape(elements.shape).astype(np.int64)
        )

    def _meshed(self, program: str, folder: Path, size: float) -> str:
        """Mesh file of version 2, as text."""
        target = folder / "body.msh"
        command = [program, str(self.path.resolve()), "-3", "-order", "2", "-format", "msh22"]
        sizes = ["-clmax", f"{size:.9g}", "-clmin", f"{0.2 * size:.9g}"]
        straight = ["-setnumber", "Mesh.SecondOrderLinear", "1", "-setnumber", "Mesh.Binary", "0"]
        try:
            subprocess.run(
                [*command, *sizes, *straight, "-v", "1", "-o", str(target)],
                check=True,
                capture_output=True,
                timeout=_LIMIT,
                cwd=folder,
            )
        except (subprocess.SubprocessError, OSError) as error:
            raise GeometryError(
                self.label, "a body that gmsh cannot mesh", "are closed solids"
            ) from error
        if not target.is_file():
            raise GeometryError(self.label, "no body", "is one closed solid")
        return target.read_text()

    def key(self) -> tuple[object, ...]:
        """Everything that defines the shape: the content of the file, not its name."""
        content = self.path.read_bytes() if self.path.is_file() else b""
        return ("solid", hashlib.sha256(content).hexdigest(), self.edge_length)


def _block(lines: list[str], name: str) -> list[str]:
    """Lines of a section without its count."""
    start = lines.index(f"${name}") + 2
    return lines[start : lines.index(f"$End{name}")]
