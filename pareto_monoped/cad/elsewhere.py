"""What the kernel's process makes for an export while this one simulates and checks: solids, drawings and pictures."""

from collections.abc import Collection, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pareto_monoped.cad.drawing.drawings import origin_of, part_drawings
from pareto_monoped.cad.kernel import client as kernel
from pareto_monoped.cad.product import Product, step_assembly
from pareto_monoped.cad.write import files
from pareto_monoped.cad.write.assembly_pack import assembly_pack
from pareto_monoped.cad.write.folder import safe, write


@dataclass(frozen=True, slots=True, kw_only=True)
class Ordered:
    """Files that are being made; None for what is not wanted.

    Attributes:
        solids: the STEP file of the assembly, and those of the parts by name.
        pack: the assembly pack: content by path.
        sheets: the parts' drawings by name.
        pictures: PNG files by name.
    """

    solids: Future[tuple[bytes, dict[str, bytes]]] | None
    pack: Future[dict[str, bytes]] | None
    sheets: Future[dict[str, bytes]] | None
    pictures: Mapping[str, Future[bytes]]

    def write(self, folder: Path) -> None:
        """Wait for everything and write it."""
        if self.sheets is not None:
            for name, content in self.sheets.result().items():
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
    return Ordered(
        solids=kernel.step_files(step_assembly(product, "monoped")) if "step" in formats else None,
        pack=kernel.do(assembly_pack, listed) if "assembly" in formats else None,
        sheets=kernel.do(part_drawings, listed.unique, origin_of(record)) if "pdf" in formats else None,
        pictures=files.pictures(product) if "png" in formats else {},
    )
