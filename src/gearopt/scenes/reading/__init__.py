"""How problem files are read: field types, the loader and its messages."""
