"""What any kind draws with: sheets, solids, bodies that move."""
