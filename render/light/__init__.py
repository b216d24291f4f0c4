"""Light transport: the projector's dots and the lamps' light as the two imagers see them."""
