"""A spur pair: load sharing, contact, relief."""
