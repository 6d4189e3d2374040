# One command a task; `just` alone lists them.

_default:
    @just --list

# Format, lint and type-check.
lint:
    ruff format .
    ruff check .
    mypy

# The default test suite (below 3 minutes).
test:
    pytest

# Every test, slow ones included.
test-all:
    pytest -m ""

# Speed beside error of the main job.
bench:
    gearopt bench drive
