# SPDX-License-Identifier: Apache-2.0
"""Adds pipeline registers to the generated register block, in the address decoder and in the read path.

A request's strobe is decoded in two clocks and reaches its register, with the data written, in the third. Reads are
masked by their strobes and ORed, so that no address is needed after the decoder. Address, direction, data and enables
of a request must be held for three clocks after it, as `slog_axil` does; data and enables are used only from the second
of them on. A write is acknowledged three clocks after its request, a read six, with the values that the registers held
three clocks after it.
"""

from __future__ import annotations

import re

DECODED = """
    decoded_reg_strb_t decoded_reg_strb, found_reg_strb, asked_reg_strb;
    // An address in two halves, the lower one apart for writes and reads.
    logic [15:0] asked_high;
    logic [3:0] asked_to_write, asked_to_read;
    function automatic logic asked(logic [3:0] low, logic [7:0] address);
        return asked_high[address[7:4]] & low[address[3:2]];
    endfunction
"""
DECODER = """
    // The words that are read, by address; the strobes are those of writes where there is something to write.
    logic [63:0] found_read, decoded_read;
    logic asked_req, found_req;
    always_ff @(posedge clk) begin
        asked_high <= 16'd1 << cpuif_addr[7:4];
        asked_to_write <= (!rst & cpuif_req_masked & cpuif_req_is_wr) ? 4'd1 << cpuif_addr[3:2] : '0;
        asked_to_read <= (!rst & cpuif_req_masked & !cpuif_req_is_wr) ? 4'd1 << cpuif_addr[3:2] : '0;
        asked_req <= rst ? '0 : cpuif_req_masked;
        found_req <= rst ? '0 : asked_req;
        for(int i=0; i<64; i++) found_read[i] <= rst ? '0 : asked(asked_to_read, 8'(4*i));
        found_reg_strb <= rst ? '{default: '0} : asked_reg_strb;
        decoded_req <= rst ? '0 : found_req;
        decoded_read <= rst ? '0 : found_read;
        decoded_reg_strb <= rst ? '{default: '0} : found_reg_strb;
        decoded_wr_data <= cpuif_wr_data;
        decoded_wr_biten <= cpuif_wr_biten;
    end
"""
WORDS = """
    // Every word of the map; then the OR of two, of which one may be read, and of four, of four, of two such.
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
    logic [31:0] readback_two[32];
    logic [31:0] readback_eight[8];
    logic [31:0] readback_half[2];
    logic [1:0] readback_read;
    always_ff @(posedge clk) begin
        for(int i=0; i<32; i++) readback_two[i] <= (readback_word[2*i] & {32{decoded_read[2*i]}})
                                                 | (readback_word[2*i+1] & {32{decoded_read[2*i+1]}});
        for(int i=0; i<8; i++) readback_eight[i] <= readback_two[4*i] | readback_two[4*i+1]
                                                  | readback_two[4*i+2] | readback_two[4*i+3];
        for(int i=0; i<2; i++) readback_half[i] <= readback_eight[4*i] | readback_eight[4*i+1]
                                                 | readback_eight[4*i+2] | readback_eight[4*i+3];
        readback_read <= rst ? '0 : {readback_read[0], decoded_req & ~decoded_req_is_wr};
        readback_done <= rst ? '0 : readback_read[1];
    end
    assign readback_data = readback_half[0] | readback_half[1];
    assign readback_err = '0;
"""
EDITS = (
    (r"^ +decoded_reg_strb_t decoded_reg_strb;\n", DECODED[1:]),
    (r"^ +assign decoded_req = cpuif_req_masked;\n", DECODER[1:]),
    (r"^ +assign decoded_wr_data = cpuif_wr_data;\n", ""),
    (r"^ +assign decoded_wr_biten = cpuif_wr_biten;\n", ""),
    (r"^ +logic \[7:0\] rd_mux_addr;\n +assign rd_mux_addr = decoded_addr;\n", ""),
    (r"^ +always_comb begin\n +automatic logic \[31:0\] readback_data_var;\n +readback_data_var = '0;\n", WORDS[1:]),
    (r"^ +readback_data = readback_data_var;\n +readback_done = .*;\n +readback_err = '0;\n +end\n", CHOICES[1:]),
)
"""Patterns, each found exactly once, and their replacements."""


def retimed(block: str) -> str:
    """The register block from `peakrdl regblock --cpuif passthrough`, of a map of 256 bytes, with the registers added.

    Raises:
        ValueError: the generated block does not have the expected form.
    """
    for pattern, new in EDITS:
        block, times = re.subn(pattern, new, block, flags=re.MULTILINE)
        if times != 1:
            raise ValueError(f"the generated register block has {times} places like {pattern}, not one: go back to the "
                             "locked version of peakrdl-regblock, or adapt sim/registers/retime.py to its new form")
    block = re.sub(r"^( +)decoded_reg_strb\.(\S+ = )", r"\1asked_reg_strb.\2", block, flags=re.MULTILINE)
    block = re.sub(r"^( +asked_reg_strb\.\S+ = )cpuif_req_masked & \(cpuif_addr == (.*)\) & !cpuif_req_is_wr;$",
                   r"\1asked(asked_to_read, \2);", block, flags=re.MULTILINE)
    block = re.sub(r"^( +asked_reg_strb\.\S+ = )cpuif_req_masked & \(cpuif_addr == (.*)\)( & cpuif_req_is_wr)?;$",
                   r"\1asked(asked_to_write, \2);", block, flags=re.MULTILINE)
    return re.sub(r"(decoded_reg_strb\.\S+) && decoded_req_is_wr", r"\1", block)
