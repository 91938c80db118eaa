# SPDX-License-Identifier: Apache-2.0
"""Station keeping: the vehicle's offset from a reference view of the seafloor, and the control that holds it at 0."""
