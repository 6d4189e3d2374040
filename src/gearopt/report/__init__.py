"""Results for people: sections of tables, sentences and drawings, on pages and the terminal."""
