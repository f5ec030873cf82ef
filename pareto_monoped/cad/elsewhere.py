"""What the kernel's process makes for an export while this one simulates and checks: solids, drawings and pictures."""

from collections.abc import Collection, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pareto_monoped.cad.drawing.drawings import Origin, origin_of, part_drawings
from pareto_monoped.cad.kernel import client as kernel
from pareto_monoped.cad.product import ListedPart, Product, step_assembly
from pareto_monoped.cad.write import files
from pareto_monoped.cad.write.assembly_pack import assembly_pack
from pareto_monoped.cad.write.folder import safe, write

_AT_ONCE = 6
"""Drawings in a question: few, so that both processes end at about the same time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ordered:
    """Files that are being made; None for what is not wanted.

    Attributes:
        solids: the STEP file of the assembly, and those of the parts by name.
        pack: the assembly pack: content by path.
        sheets: the parts' drawings by name, some in each.
        pictures: PNG files by name.
    """

    solids: Future[tuple[bytes, dict[str, bytes]]] | None
    pack: Future[dict[str, bytes]] | None
    sheets: Sequence[Future[dict[str, bytes]]]
    pictures: Mapping[str, Future[bytes]]

    def write(self, folder: Path) -> None:
        """Do here what the kernel's process has not begun, wait for the rest, and write everything."""
        kernel.help_out()
        for sheets in self.sheets:
            for name, content in sheets.result().items():
                write(folder, f"drawings/{safe(name)}.pdf", content)
        if self.pack is not None:
            for path, content in self.pack.result().items():
                write(folder, path, content)
        for name, picture in self.pictures.items():
            write(folder, name, picture.result())
        if self.solids is not None:
            assembly, parts = self.solids.result()
            write(folder, "assembly.step", assembly)
            for name, content in parts.items():
                write(folder, f"parts/step/{safe(name)}.step", content)


def order(product: Product, record: Mapping[str, Any], formats: Collection[str]) -> Ordered:
    """Ask for all files of the formats that the kernel's process makes.

    Args:
        product: the parts.
        record: for the title blocks; it may still lack what is computed last.
        formats: of ``FORMATS``.
    """
    listed = product.listed
    # The longest first, as the last ones may be done in either process.
    pack = kernel.do(assembly_pack, listed) if "assembly" in formats else None
    solids = kernel.step_files(step_assembly(product, "monoped")) if "step" in formats else None
    return Ordered(
        solids=solids,
        pack=pack,
        sheets=_sheets(listed.unique, origin_of(record)) if "pdf" in formats else (),
        pictures=files.pictures(product) if "png" in formats else {},
    )


def _sheets(parts: Sequence[ListedPart], origin: Origin) -> list[Future[dict[str, bytes]]]:
    """Ask for the drawings of all parts that are made."""
    made = [part for part in parts if part.part.process != "bought"]
    return [
        kernel.do(part_drawings, made[start : start + _AT_ONCE], origin, start + 1)
        for start in range(0, len(made), _AT_ONCE)
    ]
