"""The register map: generation from SystemRDL, and addresses and fields for the host."""
