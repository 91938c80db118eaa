"""Registers within the generated register block, for its clock rate: behind the address decoder, and in the read path.

What a request asks for (address, direction, data, enables) must then stay for two clocks after it, as `slog_axil`
keeps it; a write is acknowledged one clock after its request, a read two, with what the registers held at the request.
"""

from __future__ import annotations

import re

DECODER = """
    always_ff @(posedge clk) begin
        decoded_req <= rst ? '0 : cpuif_req_masked;
        decoded_reg_strb <= rst ? '{default: '0} : asked_reg_strb;
    end
"""
WORDS = """
    // Every word of the map; then one of four three times, with a register behind the first two.
    logic [31:0] readback_word[64];
    always_comb begin
        automatic logic [31:0] readback_data_var;
        automatic logic [7:0] rd_mux_addr;
        for(int word=0; word<64; word++) begin
            rd_mux_addr = 8'(4*word);
            readback_data_var = '0;
"""
CHOICES = """
            readback_word[word] = readback_data_var;
        end
    end
    logic [31:0] readback_four[16];
    logic [31:0] readback_sixteen[4];
    always_ff @(posedge clk) begin
        for(int i=0; i<16; i++) readback_four[i] <= readback_word[{i[3:0], decoded_addr[3:2]}];
        for(int i=0; i<4; i++) readback_sixteen[i] <= readback_four[{i[1:0], decoded_addr[5:4]}];
        readback_done <= rst ? '0 : decoded_req & ~decoded_req_is_wr;
    end
    assign readback_data = readback_sixteen[decoded_addr[7:6]];
    assign readback_err = '0;
"""
EDITS = (
    (r"^ +decoded_reg_strb_t decoded_reg_strb;\n", "    decoded_reg_strb_t decoded_reg_strb, asked_reg_strb;\n"),
    (r"^ +assign decoded_req = cpuif_req_masked;\n", DECODER[1:]),
    (r"^ +logic \[7:0\] rd_mux_addr;\n +assign rd_mux_addr = decoded_addr;\n", ""),
    (r"^ +always_comb begin\n +automatic logic \[31:0\] readback_data_var;\n +readback_data_var = '0;\n", WORDS[1:]),
    (r"^ +readback_data = readback_data_var;\n +readback_done = .*;\n +readback_err = '0;\n +end\n", CHOICES[1:]),
)
"""What is replaced, once each: a pattern and its replacement."""


def retimed(block: str) -> str:
    """The register block, from `peakrdl regblock --cpuif passthrough` of a map of 256 bytes, with its registers in.

    Raises:
        ValueError: the generator writes its block otherwise than this knows.
    """
    for pattern, new in EDITS:
        block, times = re.subn(pattern, new, block, flags=re.MULTILINE)
        if times != 1:
            raise ValueError(f"the generated register block has {times} places like {pattern}, not one: go back to the "
                             "locked version of peakrdl-regblock, or let sim/retime.py follow its new form")
    return re.sub(r"^( +)decoded_reg_strb\.(\S+ = )", r"\1asked_reg_strb.\2", block, flags=re.MULTILINE)
