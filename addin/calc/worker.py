"""`python -m addin.calc.worker`, as extensions of version 0.1.0 start it; see `addin.libreoffice.worker`."""

from addin.libreoffice.worker import main

if __name__ == "__main__":
    main()
