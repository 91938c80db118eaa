# SPDX-License-Identifier: Apache-2.0
"""The register map: generation from SystemRDL, and addresses and fields for the host."""
