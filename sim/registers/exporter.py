# SPDX-License-Identifier: Apache-2.0
"""Exporter of the register block with a pipelined address decoder and read path, built on PeakRDL-regblock.

A request's strobe is decoded in two clocks and reaches its register, with the data written, in the third. Reads are
masked by their strobes and ORed, so that no address is needed after the decoder. Address, direction, data and enables
of a request must be held for three clocks after it, as `slog_axil` does; data and enables are used only from the second
of them on. A write is acknowledged three clocks after its request, a read six, with the values that the registers held
three clocks after it.

Two templates of the library are replaced by those in `templates/`: the module and the read path. Ports, fields,
storage and the hardware interface are the library's own.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jinja2
from peakrdl_regblock import RegblockExporter
from peakrdl_regblock.addr_decode import DecodeLogicGenerator
from peakrdl_regblock.cpuif.passthrough import PassthroughCpuif
from peakrdl_regblock.udps import ALL_UDPS
from systemrdl.compiler import RDLCompiler
from systemrdl.node import AddressableNode, AddrmapNode, FieldNode, RegNode

TEMPLATES = Path(__file__).with_name("templates")
REPLACED = {
    "module_tmpl.sv": "module.sv.jinja",
    "readback/templates/readback_no_rt.sv": "readback.sv.jinja",
}
"""Templates of PeakRDL-regblock that are replaced, and the files that replace them."""
MAP_BYTES = 256
"""Size of the map for which the decoder's halves and the read path's tree are drawn."""


class Strobes(DecodeLogicGenerator):
    """The statements that decode each register's strobe: of its writes, or where it has none, of its reads."""

    def _add_reg_decoding_flags(self, node: RegNode, subword_index: int | None = None,
                                subword_stride: int | None = None) -> None:
        asked = "asked_to_write" if node.has_sw_writable else "asked_to_read"
        strobe = self.addr_decode.get_access_strobe(node).replace("decoded_reg_strb", "asked_reg_strb", 1)
        self.add_content(f"{strobe} = asked({asked}, {self._get_address_str(node)});")


class PipelinedExporter(RegblockExporter):
    """`peakrdl regblock --cpuif passthrough` with the pipeline that this module describes."""

    def __init__(self) -> None:
        super().__init__()
        own = jinja2.FunctionLoader(lambda name: (TEMPLATES / REPLACED[name]).read_text() if name in REPLACED else None)
        self.jj_env.loader = jinja2.ChoiceLoader([own, *([self.jj_env.loader] if self.jj_env.loader else [])])
        self.jj_env.globals["strobes"] = lambda: Strobes(self.address_decode).get_content(self.ds.top_node)

    def export(self, node: Any, output_dir: str, **kwargs: Any) -> None:
        """Write the module and its package into `output_dir`; arguments as for the library's exporter.

        Raises:
            ValueError: the map is not of 256 bytes, or has a part that the pipeline does not serve.
        """
        top = node if isinstance(node, AddrmapNode) else node.top
        for part in top.descendants(unroll=True):
            if isinstance(part, FieldNode) and part.get_property("onread") is not None:
                raise ValueError(f"{part.get_path()}: a read does not change a field of a pipelined register block")
            if isinstance(part, RegNode) and part.get_property("regwidth") != part.get_property("accesswidth"):
                raise ValueError(f"{part.get_path()}: a register of a pipelined block is as wide as the bus")
            if isinstance(part, AddressableNode) and part.external:
                raise ValueError(f"{part.get_path()}: a pipelined register block has no external parts")
        super().export(node, output_dir, cpuif_cls=PassthroughCpuif, **kwargs)
        if 1 << self.ds.addr_width != MAP_BYTES:
            raise ValueError(f"the register map has {1 << self.ds.addr_width} bytes of addresses; the templates in "
                             f"{TEMPLATES.name}/ are drawn for {MAP_BYTES}")


def export(source: Path, folder: Path) -> None:
    """Write the register block and its package, described in SystemRDL by `source`, into `folder`.

    Raises:
        ValueError: as `PipelinedExporter.export`.
        systemrdl.RDLCompileError: `source` is not correct SystemRDL.
    """
    compiler = RDLCompiler()
    for udp in ALL_UDPS:
        compiler.register_udp(udp)
    compiler.compile_file(str(source))
    PipelinedExporter().export(compiler.elaborate(), str(folder))
