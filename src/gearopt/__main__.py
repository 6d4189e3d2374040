"""`python -m gearopt`."""

from gearopt.cli import main

main()
