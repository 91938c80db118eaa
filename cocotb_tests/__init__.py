# SPDX-License-Identifier: Apache-2.0
"""RTL blocks against their cycle models on every clock, in the rooms of `rtl/`.

There is one model a block; submodules are modelled with their parent and compared through its ports.
"""
