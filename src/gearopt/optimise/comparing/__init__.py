"""Methods on one problem, held side by side."""
