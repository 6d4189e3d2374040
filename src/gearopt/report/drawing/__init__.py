"""Tools of drawings of any kind: sheets, solids, bodies that move."""
