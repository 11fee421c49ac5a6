"""`python -m addin.cli`."""

from addin.cli.app import main

if __name__ == "__main__":
    main()
