"""Station keeping: where the vehicle is relative to where it began, from a fixed view of the seafloor, and how it
stays there."""
