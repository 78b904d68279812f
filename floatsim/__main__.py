"""`python -m floatsim`: the program, for machines whose path does not have it."""

from floatsim.cli import main

main()
