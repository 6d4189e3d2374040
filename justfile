# One command a task; `just` alone lists them.

_default:
    @just --list

# Format, lint and type-check.
lint:
    ruff format .
    ruff check .
    mypy

# The default test suite (two and a half minutes of one core).
test:
    pytest

# Every test, slow ones included.
test-all:
    pytest -m ""

# The site in build/docs; a warning is an error.
docs:
    sphinx-build -W --keep-going -b html docs build/docs

# Write the generated pages and pictures of the docs again.
pages:
    python docs/generate.py

# Speed beside error of the main job.
bench:
    gearopt bench drive
