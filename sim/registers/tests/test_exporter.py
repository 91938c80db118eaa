# SPDX-License-Identifier: Apache-2.0
"""The register block's exporter refuses what its pipeline does not serve; `test_control` checks each clock."""

from pathlib import Path

import pytest

from sim.registers.exporter import export

BLOCK = """addrmap block {{
    default regwidth = 32; default accesswidth = 32;
    {kind} reg {{ {width} field {{ sw = rw; hw = r; {property} }} value[31:0]; }} word @ {address};
}};
"""


@pytest.mark.parametrize(("words", "message"), [
    ({"address": "0x7c"}, "has 128 bytes"), ({"address": "0x1fc"}, "has 512 bytes"),
    ({"property": "onread = rclr;"}, "block.word.value: a read does not change"),
    ({"width": "regwidth = 64;", "address": "0xf8"}, "block.word: a register of a pipelined block is as wide"),
    ({"kind": "external"}, "block.word: a pipelined register block has no external parts")],
    ids=["small", "large", "read", "wide", "external"])
def test_what_the_pipeline_does_not_serve_is_refused(tmp_path: Path, words: dict[str, str], message: str) -> None:
    source = tmp_path / "block.rdl"
    plain = {"kind": "", "width": "", "property": "", "address": "0xfc"}
    source.write_text(BLOCK.format(**{**plain, **words}))
    with pytest.raises(ValueError, match=message):
        export(source, tmp_path)


def test_strobes_are_of_writes_where_there_is_something_to_write(tmp_path: Path) -> None:
    source = tmp_path / "block.rdl"
    source.write_text("addrmap block {\n reg { field { sw = r; hw = w; } value[31:0]; } seen @ 0x0;\n"
                      " reg { field { sw = rw; hw = r; } value[31:0]; } kept @ 0xfc;\n};\n")
    export(source, tmp_path)
    block = (tmp_path / "block.sv").read_text()
    assert "asked_reg_strb.seen = asked(asked_to_read, 8'h0);" in block
    assert "asked_reg_strb.kept = asked(asked_to_write, 8'hfc);" in block
