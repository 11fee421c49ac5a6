"""Words on what is being done that several rooms need."""

#: The stage told when the compiled loops are not on this machine yet.
COMPILING = "compiling the numerical routines, only once on this machine (about ten seconds)"


def is_compiling(stage: str) -> bool:
    """Whether a stage is one of the long waits that come once on a machine."""
    return stage.startswith("compiling the ")
