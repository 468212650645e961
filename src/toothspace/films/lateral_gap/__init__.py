"""Films beside the gears in balance with the bearings pressed against them."""
